"""What `tippedisk show` does."""

import argparse

from analysis import load_run
from validation.commands.output import save
from validation.commands.scenarios import find_own
from validation.kit.differences import difference_table


def show(options: argparse.Namespace) -> int:
    """Print what stored motions are and how far apart, and plot them over each other."""
    find_own(options)
    runs = [(file.stem, load_run(file)) for file in options.files]
    for name, run in runs:
        print(f"{name}: {run!r}")
    if len(runs) > 1:
        table = difference_table(runs)
        print(f"\n{table.title}")
        if table.rows:
            print(table.to_text())
        if table.note:
            print(table.note)
    from validation.kit import figures

    if options.out is not None:
        figure, axes = figures.new_figure(4, height=8.5)
        figures.comparison(runs, axes)
        save(figure, options.out)
        return 0
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        print("\nno screen to open a window on; --out PICTURE draws the motions")
        return 0
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")
    figures.comparison(runs, axes)
    plt.show()
    return 0
