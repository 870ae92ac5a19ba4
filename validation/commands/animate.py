"""What the commands that write pages to play with do: `animate` and `play`."""

import argparse
from pathlib import Path

import validation
from analysis import load_run
from analysis.data.files import whole_file
from validation.commands.output import name_of
from validation.commands.scenarios import find_own


def animate(options: argparse.Namespace) -> int:
    """Write an animation of a stored motion."""
    source: Path = options.file
    out: Path = options.out or source.with_suffix(".html")
    find_own(options)
    told = {name: getattr(options, name) for name in ("fps", "width")}
    given = {name: value for name, value in told.items() if value is not None}
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
