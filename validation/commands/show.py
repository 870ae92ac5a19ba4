"""What `tippedisk show` does."""

import argparse

from analysis import load_run
from validation.commands.output import name_of, save
from validation.commands.scenarios import find_own
from validation.kit.differences import difference_table


def show(options: argparse.Namespace) -> int:
    """Print what stored motions are and how far apart, and plot them over each other."""
    find_own(options)
    runs = [(name_of(file), load_run(file)) for file in options.files]
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

    # Between two dollars there would be a formula.
    labelled = [(name.replace("$", r"\$"), run) for name, run in runs]
    if options.out is not None:
        figure, axes = figures.new_figure(4, height=8.5)
        figures.comparison(labelled, axes)
        save(figure, options.out)
        return 0
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        print("\nno screen to open a window on; --out PICTURE draws the motions")
        return 0
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")
    figures.comparison(labelled, axes)
    plt.show()
    return 0
