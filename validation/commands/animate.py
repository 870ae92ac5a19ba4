"""What `tippedisk animate` does."""

import argparse
from pathlib import Path

import validation
from analysis import load_run
from analysis.data.checks import number, positive, within
from analysis.data.limits import PLAYBACK_SPEEDS
from validation.commands.output import name_of
from validation.commands.scenarios import find_own


def animate(options: argparse.Namespace) -> int:
    """Write an animation of a stored motion."""
    source: Path = options.file
    out: Path = options.out or source.with_suffix(".html")
    _check_numbers(options, out)
    find_own(options)
    given = {name: value for name in ("fps", "width") if (value := getattr(options, name))}
    shown = validation.animate(
        load_run(source),
        begin=options.begin,
        end=options.end,
        speed=options.speed,
        title=f"The tippedisk: {name_of(source)}",
    )
    detail, poses = shown.save(out, **given), shown.poses
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
