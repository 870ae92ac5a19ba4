"""A player for any motion of the disk, as a part of a page or as a page of its own.

The page needs no network and no other file. The motion lies in it as 16-bit integers: each
column (three of the position, four of the quaternion, two of the contact point, the spin) is
rounded to a 65535th of its range. That is at most 0.5 / 65535 of the range off, so 1 µm in a
motion 0.13 m wide, and at most 7e-5 rad in attitude. Times are 32-bit floats, counted from the
first, and good to 6e-8 of the duration.
"""

import base64
import html
import json
import os
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment

from analysis import StoredRun
from analysis.data.checks import within
from analysis.data.files import whole_file
from analysis.data.limits import PLAYBACK_SPEEDS
from analysis.data.names import ArgumentError
from validation.kit.animation.body import shape
from validation.kit.animation.keyframes import COLUMNS, Keyframes, keyframes

LEVELS = 65535
"""Largest integer of a column."""

SHORT = 5.0
"""Longest motion in s that is played slowly from begin to end."""

SLOW = 0.1
"""Speed at which the eye can follow a disk that turns six times a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A page of its own, which a notebook shows in a frame.

    Parameters
    ----------
    title : str
    text : str
        All of it, as HTML.
    height : float
        Of the frame, in lines of text.
    """

    title: str
    text: str = field(repr=False)
    height: float = 54.0

    def _repr_html_(self) -> str:
        # In a frame of its own, as notebooks do not run scripts where they stand.
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" title="{html.escape(self.title)}" '
            f'style="width: 100%; height: {self.height:g}rem; border: 0"></iframe>'
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Animation:
    """A player that is ready to be put on a page, to be shown in a notebook or to be saved.

    Parameters
    ----------
    name : str
        Used for its file and as the identifier of its element.
    title : str
    fragment : str
        HTML element with everything the player needs; several may share a page.
    poses : Keyframes
        What it plays.
    speed : float, optional
        As in `player`.
    """

    name: str
    title: str
    fragment: str = field(repr=False)
    poses: Keyframes = field(repr=False)
    speed: float | None = None

    @property
    def page(self) -> str:
        """The player as an HTML page of its own, which begins to play when it is opened."""
        fragment = self.fragment.replace("<figure ", "<figure data-alone ", 1)
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{html.escape(self.title)}</title>"
            "<style>body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; "
            "max-width: 50rem; margin: 1rem auto; padding: 0 1rem; }</style></head><body>"
            f"{fragment}</body></html>\n"
        )

    def _repr_html_(self) -> str:
        return Page(title=self.title, text=self.page)._repr_html_()

    def save(self, path: str | os.PathLike[str], **how: Any) -> str:
        """Write a page, or a GIF where the name ends in .gif; returns what was written, in words.

        Parameters
        ----------
        path : path-like
        **how
            `fps` and `width` of `gif.write`.

        Raises
        ------
        OSError
            If the file cannot be written.
        ValueError
            If its name ends otherwise, or an argument is out of range.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in {".html", ".gif"}:
            raise ArgumentError("path", f"must end in .html or .gif, got {path}")
        for name in how if suffix != ".gif" else ():
            raise ArgumentError(name, f"needs a file that ends in .gif, got {path}")
        with whole_file(path) as stream:
            if suffix == ".html":
                size = stream.write(self.page.encode())
                return f"{size / 1024:.0f} KB; open it in a browser"
            from validation.kit.animation import gif  # noqa: PLC0415 - it loads matplotlib

            frames = gif.write(self.poses, stream, speed=self.speed, **how)
            return f"{frames} frames, {stream.tell() / 1024:.0f} KB"


def player(
    motion: StoredRun | Keyframes,
    *,
    name: str,
    title: str,
    caption: str = "",
    speed: float | None = None,
) -> Animation:
    """Player for a motion.

    Parameters
    ----------
    motion : Trajectory, SpatialMotion or Keyframes
    name : str
        Identifier: a letter first, then letters, digits and hyphens.
    title, caption : str
        Plain text.
    speed : float, optional
        Playback speed at first, 1 for real time. By default a tenth for motions up to `SHORT`;
        longer ones are played slowly until the disk is upside down and in real time from there.

    Raises
    ------
    ValueError
        If the disk of a spatial motion turns by about half a turn between samples, or the speed
        is out of range.
    """
    if speed is not None:
        within("speed", speed, *PLAYBACK_SPEEDS)
    poses = motion if isinstance(motion, Keyframes) else keyframes(motion)
    # Within a script element, only "</" could end it early.
    told = encode(poses) | _playback(poses, speed)
    data = json.dumps(told, default=lambda outline: outline.round(6).tolist())
    fragment = frame(
        name=name,
        title=title,
        caption=caption,
        source=poses.source,
        is_heavy=bool(poses.disk.eccentricity),
        data=data.replace("</", "<\\/"),
    )
    return Animation(name=name, title=title, fragment=fragment, poses=poses, speed=speed)


def frame(*, name: str, title: str, **about: Any) -> str:
    """Element with the player, for a motion or, without `data`, for what a page's code gives it.

    Parameters
    ----------
    name, title : str
        As in `player`.
    **about
        What else `player.html` names.
    """
    template = Environment(autoescape=True).from_string(asset("player.html"))
    return template.render(
        name=name,
        title=title,
        style=asset("player.css"),
        script=asset("player.js"),
        **about,
    )


def encode(poses: Keyframes) -> dict[str, object]:
    """The motion as JSON holds it.

    Returns
    -------
    dict
        `begin` in s; `times`, base64 of little-endian 32-bit floats from there; `columns`, base64
        of little-endian 16-bit integers, one of `COLUMNS` after the other; `low` and `step`, so
        that a value is low + step * integer; `radius` in m; `shape`, that of `body.shape`;
        `marks`.
    """
    table = poses.table
    low, step = table.min(axis=0), np.ptp(table, axis=0) / LEVELS
    integers = np.rint((table - low) / np.where(step > 0.0, step, 1.0))
    return {
        "begin": float(poses.times[0]),
        "times": _base64((poses.times - poses.times[0]).astype("<f4")),
        "columns": _base64(integers.T.astype("<u2")),
        "low": dict(zip(COLUMNS, low.tolist(), strict=True)),
        "step": dict(zip(COLUMNS, step.tolist(), strict=True)),
        "radius": poses.disk.radius,
        "shape": shape(poses.disk)._asdict(),
        "marks": [list(mark) for mark in poses.marks],
    }


def _playback(poses: Keyframes, speed: float | None) -> dict[str, object]:
    """Speed at first, or None for the one that changes at the time `slowUntil`."""
    inversion = dict(poses.marks).get("inversion")
    short = poses.times[-1] - poses.times[0] <= SHORT
    until = None if short or inversion is None else inversion + 0.2
    if speed is None and until is None:
        speed = SLOW if short else 1.0
    return {"speed": speed, "slow": SLOW, "slowUntil": until}


def _base64(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def asset(name: str) -> str:
    """Text of a file beside this module."""
    return files("validation.kit.animation").joinpath(name).read_text(encoding="utf-8")
