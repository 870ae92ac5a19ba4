"""What the subcommands on the studies do; each returns the exit code."""

import argparse
import textwrap

from validation.commands.options import output_folder

_WIDTH = 98
"""Of a line."""


def report(options: argparse.Namespace) -> int:
    """Write the report and print its verdicts and the checks that fail, or all of them."""
    from validation.report import as_text, make
    from validation.study import put

    made = make(output_folder("out", options.out), only=options.only or (), fresh=options.fresh)
    for section in made.sections:
        held = sum(check.holds for check in section.checks)
        print(f"{section.title}: {held} of {len(section.checks)} checks hold")
        for verdict in section.verdicts:
            said = f"{verdict.statement} {verdict.answer.capitalize()}: {verdict.numbers}"
            print(_indented(f"{said} [{verdict.criterion}]"))
        for check in section.checks:
            if options.verbose or not check.holds:
                word = "holds" if check.holds else "FAILS"
                compared = f"{check.value}, limit {check.limit} ({check.where})"
                print(_indented(f"{word}: {check.name}: {compared}"))
        print()
    if options.text is not None:
        put(options.text, as_text(made))
    failed = sum(not check.holds for check in made.checks)
    said = f"{failed} of {len(made.checks)} checks FAIL" if failed else "All checks hold"
    if not made.holds and not failed:
        said = "Nothing was measured on the spot"
    print(f"{said}. Open {made.page}")
    return 0 if made.holds else 1


def _indented(text: str) -> str:
    return textwrap.fill(text, _WIDTH, initial_indent="  ", subsequent_indent="      ")


def study(options: argparse.Namespace) -> int:
    """Measure the stored tables of a study anew, all cases of them."""
    from validation.report import find, measure

    # The one that is asked for by name first: a refusal leaves no folder behind.
    asked = None if options.results is None else output_folder("results", options.results)
    folder = output_folder("out", options.out)
    results = asked or folder
    stored = [each for each in find(options.name).STUDIES if each.is_stored]
    if not stored:
        raise ValueError(
            f"study must be one whose results are stored, got {options.name!r}, which every "
            "report measures as a whole"
        )
    for each in stored:
        table = measure(each, folder, results=results, fresh=options.fresh)
        print(f"{results / each.name}.csv: {len(table)} rows of {len(each.cases())} cases")
    return 0
