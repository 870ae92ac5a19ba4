"""A player for any motion of the disk, as a part of a page or as a page of its own.

The page needs no network and no other file. Lengths in it are rounded to 10 µm, those of small
disks to a thousandth of the radius, attitudes to some 2e-5 rad.
"""

import html
import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader

from analysis import StoredRun
from analysis.motion import frames
from analysis.motion.files import is_standard_output, whole_file, write_whole
from analysis.problem.checks import Array, within
from analysis.problem.limits import PLAYBACK_SPEEDS
from analysis.problem.names import ArgumentError
from validation.animation.body import LOOK, shape
from validation.animation.keyframes import SHORT, SLOW, keyframes, phases, source

COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "contactX", "contactY", "spin")
"""Of the data of a page: position of the geometric centre G in m, inertial; attitude of the body
frame as a quaternion of unit length, scalar part first, of the sign that is nearer to the one
before; where the disk touches the table in m; vertical angular velocity in rad/s, which unlike
the rate of alpha exists in every attitude."""

DIGITS = 5
"""Decimal places of numbers in a page, of which small ones have more."""

FINEST = 1e-9
"""Size in m, rad or s below which nothing is told apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A page of its own, which a notebook shows in a frame.

    Parameters
    ----------
    title : str
    fragment : str
        HTML element with everything a player needs; several may share a page.
    height : float
        Of the frame, in lines of text.
    """

    title: str
    fragment: str = field(repr=False)
    height: float = 54.0

    @property
    def text(self) -> str:
        """All of it as HTML; the player begins to play when it is opened."""
        alone = self.fragment.replace("<figure ", "<figure data-alone ", 1)
        return render("page.html", title=self.title, body=alone)

    def save(self, path: str | os.PathLike[str]) -> str:
        """Write it, as a page whatever its name; returns what was written, in words.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        content = self.text.encode()
        write_whole(path, content)
        return f"{len(content) / 1024:.0f} KB; open it in a browser"

    def _repr_html_(self) -> str:
        # In a frame of its own, as notebooks do not run scripts where they stand.
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" title="{html.escape(self.title)}" '
            f'style="width: 100%; height: {self.height:g}rem; border: 0"></iframe>'
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Animation(Page):
    """A player that is ready to be put on a page, to be shown in a notebook or to be saved.

    Parameters
    ----------
    title, fragment, height
        As in `Page`.
    poses : Trajectory or SpatialMotion
        What it plays, with few poses more than it needs.
    speed : float, optional
        As in `animate`.
    """

    poses: StoredRun = field(repr=False)
    speed: float | None = None

    def save(self, path: str | os.PathLike[str], **how: Any) -> str:
        """Write a page, or a GIF where the name ends in .gif; returns what was written, in words.

        Standard output, a pipe or a device gets a page where its name does not end so.

        Parameters
        ----------
        path : path-like
        **how
            `fps` and `width` of `picture.write_gif`.

        Raises
        ------
        OSError
            If the file cannot be written.
        ValueError
            If its name ends otherwise, or an argument is out of range.
        """
        suffix = Path(path).suffix.lower()
        if suffix == ".gif":
            from validation.animation import picture  # noqa: PLC0415 - it loads matplotlib

            with whole_file(path) as stream:
                frames = picture.write_gif(self.poses, stream, speed=self.speed, **how)
                return f"{frames} frame{'s' * (frames != 1)}, {stream.tell() / 1024:.0f} KB"
        has_place = not Path(path).exists() or Path(path).is_file()
        if suffix != ".html" and has_place and not is_standard_output(path):
            raise ArgumentError("path", f"must end in .html or .gif, got {path}")
        for name in how:
            raise ArgumentError(name, f"needs a file that ends in .gif, got {path}")
        return Page.save(self, path)


def animate(
    motion: StoredRun,
    begin: float | None = None,
    end: float | None = None,
    *,
    title: str,
    caption: str = "",
    speed: float | None = None,
) -> Animation:
    """Player for a motion.

    Parameters
    ----------
    motion : Trajectory or SpatialMotion
    begin, end : float, optional
        Part of it in s, by default all.
    title, caption : str
        Plain text.
    speed : float, optional
        Playback speed at first, 1 for real time. By default a tenth for motions up to `SHORT`;
        longer ones are played slowly until the disk is upside down and in real time from there.

    Raises
    ------
    ValueError
        If the speed is out of range; and see `keyframes`.
    """
    shown, disk = keyframes(motion, begin, end), motion.scenario.disk
    seen = shape(disk)
    if speed is not None:
        within("speed", speed, *PLAYBACK_SPEEDS)
    first, last = shown.times[[0, -1]]
    marks = {name: at for name, at in phases(motion).items() if first <= at <= last}
    positions, rotations, _, turning = shown.poses
    contact = shown.contact_points[:, :2]
    table = np.column_stack((positions, frames.quaternions(rotations), contact, turning[:, 2]))
    fragment = render(
        "player.html",
        title=title,
        caption=caption,
        source=source(motion),
        is_heavy=bool(seen.heavy),
        is_solid=seen.solid,
        data={
            "times": shown.times,
            "columns": dict(zip(COLUMNS, table.T, strict=True)),
            "radius": disk.radius,
            "shape": seen._asdict(),
            "marks": list(marks.items()),
            **_playback(last - first, marks.get("inversion"), speed),
        },
    )
    return Animation(title=title, fragment=fragment, poses=shown, speed=speed)


def render(template: str, **values: Any) -> str:
    """Text of a template beside this module.

    That of `player.html` is an element with the player, for a motion or, without `data`, for what
    a page's code gives it.
    """
    environment = Environment(autoescape=True, loader=FileSystemLoader(Path(__file__).parent))
    environment.filters["data"] = _script_data
    return environment.get_template(template).render(look=LOOK, **values)


def _script_data(value: Any) -> str:
    """JSON for a script element, within which only "</" could end it early."""
    text = json.dumps(value, default=lambda array: array.round(_places(array)).tolist())
    return text.replace("</", "<\\/")


def _places(array: Array) -> int:
    """Decimal places that show a disk of a millimetre, or a motion of one, as well as others."""
    largest = np.max(np.abs(array), initial=FINEST)
    return max(DIGITS, DIGITS - 2 - int(np.floor(np.log10(largest))))


def _playback(
    duration: float, inversion: float | None, speed: float | None
) -> dict[str, float | None]:
    """Speed at first, or None for the one that changes at the time `slowUntil`."""
    short = duration <= SHORT
    until = None if short or inversion is None else inversion + 0.2
    if speed is None and until is None:
        speed = SLOW if short else 1.0
    return {"speed": speed, "slow": SLOW, "slowUntil": until}
