"""What the commands that write pages to play with do: `animate` and `play`."""

import argparse
from pathlib import Path

import validation
from analysis import load_run
from analysis.data.checks import number, positive, within
from analysis.data.files import whole_file
from analysis.data.limits import PLAYBACK_SPEEDS
from analysis.data.names import ArgumentError
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


def play(options: argparse.Namespace) -> int:
    """Write the page on which the disk is spun by hand."""
    from validation.kit.animation.play import page

    made = page().encode()
    with whole_file(options.out) as stream:
        stream.write(made)
    print(f"{options.out}: a page of {len(made) / 1e3:.0f} kB; open it in a browser")
    return 0


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
        if out.suffix.lower() != ".gif":
            raise ArgumentError(name, "needs --out FILE.gif; a page has none")
