"""The commands on the studies: `report`, `study` and `benchmark`."""

import textwrap
from typing import Annotated, Literal

from analysis.problem.checks import whole
from validation.commands.options import output_folder
from validation.parser.kinds import Folder, OtherFolder, Sections, TextOut

_WIDTH = 98
"""Of a line."""


def report(
    *,
    only: Sections = None,
    out: Folder = "report",
    fresh: bool = False,
    text: TextOut = None,
    verbose: bool = False,
) -> int:
    """Measure or confirm all studies and write two pages with what they found.

    Run engine and in-house equations, compare them, and write a page on the disk and one on the
    method, with the tables as CSV and the figures as PNG and SVG beside them. Printed are verdicts
    and checks that fail; the exit code is 1 if one does. What has been measured is kept in the
    folder: another call takes it as it is while the code behind it, the versions and the machine
    stay the same.

    Parameters
    ----------
    only
        Make this section alone; may be given several times.
    out
        Folder to write to.
    fresh
        Measure again what is kept.
    text
        Write verdicts and sections as Markdown, .md or -.
    verbose
        Print all checks.
    """
    from analysis.motion.files import write_whole
    from validation.report import as_text, make

    made = make(output_folder("out", out), only=only or (), fresh=fresh)
    for section in made.sections:
        held = sum(check.holds for check in section.checks)
        print(f"{section.title}: {held} of {len(section.checks)} checks hold")
        for verdict in section.verdicts:
            said = f"{verdict.statement} {verdict.answer.capitalize()}: {verdict.numbers}"
            print(_indented(f"{said} [{verdict.criterion}]"))
        for check in section.checks:
            if verbose or not check.holds:
                word = "holds" if check.holds else "FAILS"
                compared = f"{check.value}, limit {check.limit} ({check.where})"
                print(_indented(f"{word}: {check.name}: {compared}"))
        print()
    if text is not None:
        write_whole(text, as_text(made))
    failed = sum(not check.holds for check in made.checks)
    said = f"{failed} of {len(made.checks)} checks FAIL" if failed else "All checks hold"
    if not made.holds and not failed:
        said = "Nothing was measured on the spot"
    print(f"{said}. Open {made.page}")
    return 0 if made.holds else 1


def _indented(text: str) -> str:
    return textwrap.fill(text, _WIDTH, initial_indent="  ", subsequent_indent="      ")


def study(
    name: Annotated[
        Literal["claims", "rest", "maps", "work-precision", "robustness"], {"metavar": "STUDY"}
    ],
    *,
    out: Folder = "study",
    results: OtherFolder = None,
    fresh: bool = False,
) -> int:
    """Measure the stored tables of a study anew, all of their cases.

    A report shows these tables and measures a sample of their cases again. An interrupted call
    goes on where it stopped. Run times mean something on an idle machine alone.

    Parameters
    ----------
    out
        Folder for what is finished.
    results
        Folder for the tables (that of --out).
    fresh
        Measure again what is kept.
    """
    from validation.report import find, measure

    # The one that is asked for by name first: a refusal leaves no folder behind.
    asked = None if results is None else output_folder("results", results)
    folder = output_folder("out", out)
    for each in find(name).STUDIES:
        if each.is_stored:
            table = measure(each, folder, results=asked or folder, fresh=fresh)
            path = (asked or folder) / f"{each.name}.csv"
            print(f"{path}: {len(table)} rows of {len(each.cases())} cases")
    return 0


def benchmark(*, repeats: int = 7) -> int:
    """Measure what runs, sweeps and ensembles take, before and after a change.

    Runs that are compared are timed in turns. The exit code is 1 if something takes longer than
    it should. It takes two minutes of an idle machine.

    Parameters
    ----------
    repeats
        Timed calls of each run.
    """
    from validation.benchmark import main

    return main(whole("repeats", repeats))
