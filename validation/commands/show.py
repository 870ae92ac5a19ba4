"""The commands on stored motions, and a page to play with: `show`, `animate` and `play`."""

from argparse import ArgumentTypeError
from collections.abc import Sequence
from pathlib import Path

import validation
from analysis import StoredRun
from analysis.problem.names import ArgumentError
from validation.commands.options import stored_runs
from validation.comparison.differences import difference_table, fields_table
from validation.display.figures import comparison
from validation.parser.files import CsvOut, PictureOut, Result, names_of, writable
from validation.parser.kinds import AnimationOut, PageOut, Run, Runs, UserClasses


def show(
    files: Runs,
    *,
    classes: UserClasses,
    json: bool = False,
    csv: CsvOut = None,
    plot: PictureOut = None,
) -> Result:
    """Say how far stored motions differ, and plot them over each other.

    Print in what stored motions differ besides their source, what each is and, for each but the
    first, how far its quantities are from those of the first; and plot inclination, rotation angle
    (with rest files: height of the centre of gravity), spin and normal force, in a window unless
    an output is asked for. The table of --csv holds the differences, or the samples of a single
    motion.

    Parameters
    ----------
    files
        Written by simulate or rest.
    """
    runs = list(zip(names_of(files), stored_runs(files, **classes), strict=True))
    apart, alone = fields_table(runs), len(runs) == 1
    differences = difference_table(runs)
    # What is not compared is told beside the file, too.
    told = [f"{name}: {run!r}" for name, run in runs]
    notes = told if csv is None else [differences.note] * bool(differences.note)
    if not json and csv is None and plot is None and not _opened(runs):
        notes.append("no screen to open a window on; --plot PICTURE draws the motions")
    return Result(
        tables=([apart] if apart.rows else []) + ([] if alone else [differences]),
        values={
            "runs": {name: repr(run) for name, run in runs},
            "fields": [
                {"field": field, "values": dict(zip(apart.columns[1:], values, strict=True))}
                for field, *values in apart.rows
            ],
            "differences": differences.records(),
            "note": differences.note,
        },
        csv=runs[0][1].to_csv if alone else differences,
        draw=lambda: comparison(runs),
        notes=notes,
    )


def _opened(runs: Sequence[tuple[str, StoredRun]]) -> bool:
    """Show motions over each other in a window; whether there is a screen for it."""
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        return False
    comparison(runs, plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")[1])
    plt.show()
    return True


def animate(
    file: Run,
    *,
    out: AnimationOut = None,
    begin: float | None = None,
    end: float | None = None,
    speed: float | None = None,
    fps: float | None = None,
    width: int | None = None,
    classes: UserClasses,
) -> None:
    """Turn a stored motion into a page that plays it, or a GIF.

    Write a page that plays a motion stored by simulate or rest, and needs no network; or, with
    --out FILE.gif, an animated picture.

    Parameters
    ----------
    file
        Motion written by simulate or rest, .npz.
    out
        .html or .gif to write (FILE with .html).
    begin
        In s (that of the motion).
    end
        In s (that of the motion).
    speed
        1 for real time (0.1 until the disk is inverted; in a GIF of more than 5 s 1).
    fps
        GIF only: frames per second (20).
    width
        GIF only: width and height in pixels (480).
    """
    try:
        out = out or writable(str(file.with_suffix(".html")), ".html")
    except ArgumentTypeError as error:
        raise ArgumentError("out", f"{error}; --out leads elsewhere") from None
    of_gif = {"fps": fps, "width": width}
    (run,) = stored_runs([file], **classes)
    title = f"The tippedisk: {names_of([file])[0]}"
    shown = run.animate(begin=begin, end=end, speed=speed, title=title)
    given = {name: value for name, value in of_gif.items() if value is not None}
    detail, poses = shown.save(out, **given), shown.poses
    print(f"{out}: {poses.times[0]:g} to {poses.times[-1]:g} s, {detail}")


def play(*, out: PageOut = Path("play.html")) -> None:
    """Write a page on which the disk is spun by hand.

    Its sliders set the start, the friction and the disk; the equations of Model 1 are integrated
    in the browser, without a network.

    Parameters
    ----------
    out
        Page to write, .html or -.
    """
    print(f"{out}: {validation.play().save(out)}")
