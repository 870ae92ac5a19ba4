"""The subcommand `robustness`: numerical stability on stiff and extreme cases."""

import argparse

from validation.commands.options import output_folder


def robustness(options: argparse.Namespace) -> int:
    """Run the study and write its page, the full one as data, too; options are out and quick.

    Returns 1 if a result came back as right and is not, or if a run took the interpreter down.
    """
    from validation.studies.robustness import section as study

    folder = output_folder("--out", options.out)
    page, tables, wrong = study.make(folder, quick=options.quick)
    for table in tables:
        print(f"\n{table.title}\n{table.to_text()}")
    verdict = "No case crashed or broke its promise" if not wrong else f"{wrong} cases FAIL"
    print(f"\n{verdict}. Open {page}")
    return 1 if wrong else 0
