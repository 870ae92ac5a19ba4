"""What `tippedisk work-precision` does."""

import argparse

from validation.commands.options import output_folder


def work_precision(options: argparse.Namespace) -> int:
    """Run the work-precision study and print its tables.

    Parameters
    ----------
    options : argparse.Namespace
        `out`, `quick` and `fresh`.

    Returns
    -------
    int
        Exit code.
    """
    from validation.studies.work_precision import study

    folder = output_folder("--out", options.out)
    page, tables = study.make(folder, quick=options.quick, fresh=options.fresh)
    for table in tables:
        print(f"\n{table.title}\n{table.to_text()}")
    print(f"\nOpen {page}")
    return 0
