"""What `tippedisk show` does."""

import argparse
from collections.abc import Sequence
from functools import partial
from typing import Any

from analysis import StoredRun, load_run
from validation.commands.output import Result, name_of, write
from validation.commands.scenarios import find_own
from validation.kit.differences import difference_table, fields_table

Runs = Sequence[tuple[str, StoredRun]]


def show(options: argparse.Namespace) -> Result:
    """Say what stored motions are and how far apart, and plot them over each other."""
    find_own(options)
    runs = [(name_of(file), load_run(file)) for file in options.files]
    apart, alone = fields_table(runs), len(runs) == 1
    wanted = (options.csv, options.plot, options.json or None)
    notes = [f"{name}: {run!r}" for name, run in runs] if options.csv is None else []
    notes += [] if any(each is not None for each in wanted) else _window(runs)
    differences = difference_table(runs)
    return Result(
        tables=([apart] if apart.rows else []) + ([] if alone else [differences]),
        values={
            "runs": {name: repr(run) for name, run in runs},
            "fields": apart.records(),
            "differences": differences.records(),
        },
        csv=runs[0][1].to_csv if alone else partial(write, differences),
        draw=lambda: picture(runs),
        notes=notes,
    )


def picture(runs: Runs) -> Any:
    """Figure of motions over each other."""
    from validation.kit import figures

    figure, axes = figures.new_figure(4, height=8.5)
    figures.comparison(_labelled(runs), axes)
    return figure


def _window(runs: Runs) -> list[str]:
    """Show motions over each other in a window, or say that there is no screen for it."""
    import matplotlib.pyplot as plt

    from validation.kit import figures

    if plt.get_backend().lower() == "agg":
        return ["no screen to open a window on; --plot PICTURE draws the motions"]
    _, axes = plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")
    figures.comparison(_labelled(runs), axes)
    plt.show()
    return []


def _labelled(runs: Runs) -> list[tuple[str, StoredRun]]:
    # Between two dollars there would be a formula.
    return [(name.replace("$", r"\$"), run) for name, run in runs]
