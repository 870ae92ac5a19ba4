"""What `tippedisk animate` does."""

import argparse
from pathlib import Path

from analysis import load_run
from analysis.data.checks import number, positive, within
from analysis.data.files import whole_file
from analysis.data.limits import PLAYBACK_SPEEDS
from analysis.data.names import ArgumentError
from validation.commands.output import name_of
from validation.commands.scenarios import find_own
from validation.kit.animation.keyframes import Keyframes, keyframes


def animate(options: argparse.Namespace) -> int:
    """Write an animation of a stored motion."""
    source: Path = options.file
    out: Path = options.out or source.with_suffix(".html")
    _check_numbers(options, out)
    find_own(options)
    poses = keyframes(load_run(source)).between(options.begin, options.end)
    detail = _write_gif(poses, out, options) if _is_gif(out) else _write_page(poses, out, options)
    print(f"{out}: {poses.times[0]:g} to {poses.times[-1]:g} s, {detail}")
    return 0


def _is_gif(out: Path) -> bool:
    return out.suffix.lower() == ".gif"


def _check_numbers(options: argparse.Namespace, out: Path) -> None:
    told = {name: value for name, value in vars(options).items() if value is not None}
    for name in {"begin", "end"} & told.keys():
        number(name, told[name])
    for name in {"speed", "fps", "width"} & told.keys():
        positive(name, told[name])
    if "speed" in told:
        within("speed", options.speed, *PLAYBACK_SPEEDS)
    if {"begin", "end"} <= told.keys() and options.begin >= options.end:
        raise ArgumentError("begin", f"must lie before {options.end:g}, got {options.begin:g}")
    for name in {"fps", "width"} & told.keys():
        if not _is_gif(out):
            raise ArgumentError(name, "needs --out FILE.gif; a page has none")


def _write_page(poses: Keyframes, out: Path, options: argparse.Namespace) -> str:
    from validation.kit.animation.player import player

    title = f"The tippedisk: {name_of(options.file)}"
    page = player(poses, name="tippedisk", title=title, speed=options.speed).page.encode()
    with whole_file(out) as stream:
        stream.write(page)
    return f"{len(page) / 1024:.0f} KB; open it in a browser"


def _write_gif(poses: Keyframes, out: Path, options: argparse.Namespace) -> str:
    from validation.kit.animation import gif as animation_gif

    given = {
        name: value
        for name in ("speed", "fps", "width")
        if (value := getattr(options, name)) is not None
    }
    animation_gif.frame_times(poses, **{k: v for k, v in given.items() if k != "width"})
    with whole_file(out) as stream:
        frames = animation_gif.write(poses, stream, **given)
        size = stream.tell()
    return f"{frames} frames, {size / 1024:.0f} KB"
