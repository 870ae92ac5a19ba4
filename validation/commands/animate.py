"""What `tippedisk animate` does."""

import argparse
from pathlib import Path

from analysis import load_run
from analysis.data.checks import number, positive, within
from analysis.data.files import whole_file
from analysis.data.limits import PLAYBACK_SPEEDS
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
    for name in ("begin", "end"):
        if getattr(options, name) is not None:
            number(f"--{name}", getattr(options, name))
    for name in ("speed", "fps", "width"):
        if getattr(options, name) is not None:
            positive(f"--{name}", getattr(options, name))
    if options.speed is not None:
        within("--speed", options.speed, *PLAYBACK_SPEEDS)
    if None not in (options.begin, options.end) and options.begin >= options.end:
        raise ValueError(
            f"--begin must lie before --end, got {options.begin:g} and {options.end:g}"
        )
    if not _is_gif(out) and (options.fps, options.width) != (None, None):
        raise ValueError("--fps and --width need --out FILE.gif; a page has neither")


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
