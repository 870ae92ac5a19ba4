"""The command `show`."""

from collections.abc import Sequence
from functools import partial

from analysis import StoredRun
from validation.commands.output import CsvOut, PictureOut, Result, name_of, pictured, write
from validation.commands.scenarios import stored_runs
from validation.kit.differences import difference_table, fields_table
from validation.parser.kinds import Own, Runs


def show(
    files: Runs,
    *,
    own: Own,
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
    json
        Print everything as JSON in place of the table.
    csv
        Write the table with all digits, .csv or -.
    plot
        Draw it, .png, .svg, .pdf or -.
    """
    runs = list(zip(map(name_of, files), stored_runs(files, **own), strict=True))
    apart, alone = fields_table(runs), len(runs) == 1
    notes = [f"{name}: {run!r}" for name, run in runs] if csv is None else []
    if not json and csv is None and plot is None and not _opened(runs):
        notes.append("no screen to open a window on; --plot PICTURE draws the motions")
    differences = difference_table(runs)
    return Result(
        tables=([apart] if apart.rows else []) + ([] if alone else [differences]),
        values={
            "runs": {name: repr(run) for name, run in runs},
            "fields": apart.records(),
            "differences": differences.records(),
        },
        csv=runs[0][1].to_csv if alone else partial(write, differences),
        draw=lambda: pictured(runs),
        notes=notes,
    )


def _opened(runs: Sequence[tuple[str, StoredRun]]) -> bool:
    """Show motions over each other in a window; whether there is a screen for it."""
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        return False
    pictured(runs, plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")[1])
    plt.show()
    return True
