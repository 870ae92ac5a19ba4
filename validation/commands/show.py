"""What `tippedisk show` does."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from analysis import StoredRun, load_run
from validation.commands.output import name_of, save, write
from validation.commands.scenarios import find_own
from validation.kit.differences import difference_table, fields_table

Runs = Sequence[tuple[str, StoredRun]]


def show(options: argparse.Namespace) -> int:
    """Print what stored motions are and how far apart, and plot them over each other."""
    find_own(options)
    runs = [(name_of(file), load_run(file)) for file in options.files]
    _tell(runs, options.csv)
    if options.out is not None or options.csv is None:
        _draw(runs, options.out)
    return 0


def _tell(runs: Runs, out: Path | None) -> None:
    """Print what tells motions apart and by how much; store that, or the samples of one alone."""
    apart = fields_table(runs)
    if apart.rows:
        print(f"{apart.title}\n{apart.to_text()}\n")
    for name, run in runs:
        print(f"{name}: {run!r}")
    if len(runs) == 1:
        if out is not None:
            runs[0][1].to_csv(out)
        return
    table = difference_table(runs)
    print(f"\n{table.title}")
    if table.rows:
        print(table.to_text())
    if table.note:
        print(table.note)
    if out is not None:
        write(table, out)


def _draw(runs: Runs, out: Path | None) -> None:
    """Plot motions over each other into a file or a window."""
    from validation.kit import figures

    # Between two dollars there would be a formula.
    labelled = [(name.replace("$", r"\$"), run) for name, run in runs]
    if out is not None:
        figure, axes = figures.new_figure(4, height=8.5)
        figures.comparison(labelled, axes)
        save(figure, out)
        return
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        print("\nno screen to open a window on; --out PICTURE draws the motions")
        return
    _, axes = plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")
    figures.comparison(labelled, axes)
    plt.show()
