"""The commands on the studies: `report`, `study` and `benchmark`."""

import textwrap
from collections.abc import Iterator
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from analysis.problem.checks import whole
from validation.display.figures import against_limits
from validation.display.tables import Table
from validation.measurement.provenance import machine
from validation.parser.files import Result
from validation.parser.kinds import Folder, Numbers, OtherFolder, Sections, TextOut
from validation.study import Verdict

if TYPE_CHECKING:
    from validation.report import Report

_WIDTH = 98
"""Of a line."""


def report(
    *,
    only: Sections = None,
    out: Folder = Path("report"),
    fresh: bool = False,
    text: TextOut = None,
    verbose: bool = False,
) -> Result:
    """Measure or confirm all studies and write two pages with what they found.

    Run engine and in-house equations, compare them, and write a page on the disk and one on the
    method, with the tables as CSV and the figures as PNG and SVG beside them. Printed are verdicts
    and checks that fail; the exit code is 1 if one does. What has been measured is kept in the
    folder: another call takes it as it is while the code behind it, the versions and the machine
    stay the same. The table of --csv holds the verdicts; the picture is that of all checks against
    their limits.

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

    made = make(out, only=only or (), fresh=fresh)
    failed = sum(not check.holds for check in made.checks)
    said = f"{failed} of {len(made.checks)} checks FAIL" if failed else "All checks hold"
    if not made.holds and not failed:
        said = "Nothing was measured on the spot"
    parts, heads = made.sections, ("section", *Verdict._fields[:-1], "good")
    rows = [(each.title, *told[:-1], told.good) for each in parts for told in each.verdicts]
    table = Table(title="Verdicts", columns=heads, rows=rows)
    checks: list[Any] = [
        {"section": each.title, **row._asdict()} for each in parts for row in each.checks
    ]
    limits = [(row["section"], row["value"], row["limit"], row["holds"]) for row in checks]
    return Result(
        values={"holds": made.holds, "verdicts": table.records(), "checks": checks},
        csv=table.to_csv,
        files=[(text, lambda path: write_whole(path, as_text(made)))],
        draw=lambda: against_limits(limits),
        notes=[*_lines(made, verbose=verbose), f"{said}. Open {made.page}"],
        code=0 if made.holds else 1,
    )


def _lines(made: "Report", *, verbose: bool) -> Iterator[str]:
    """Verdicts, and checks that fail or all of them, by section."""
    for section in made.sections:
        held = sum(check.holds for check in section.checks)
        yield f"{section.title}: {held} of {len(section.checks)} checks hold"
        for verdict in section.verdicts:
            said = f"{verdict.statement} {verdict.answer.capitalize()}: {verdict.numbers}"
            yield _indented(f"{said} [{verdict.criterion}]")
        for check in section.checks:
            if verbose or not check.holds:
                word = "holds" if check.holds else "FAILS"
                compared = f"{check.value}, limit {check.limit} ({check.where})"
                yield _indented(f"{word}: {check.name}: {compared}")
        yield ""


def _indented(text: str) -> str:
    return textwrap.fill(text, _WIDTH, initial_indent="  ", subsequent_indent="      ")


def study(
    name: Annotated[
        Literal["claims", "rest", "maps", "work-precision", "robustness"], {"metavar": "STUDY"}
    ],
    *,
    out: Folder = Path("study"),
    results: OtherFolder = None,
    fresh: bool = False,
) -> Numbers:
    """Measure the stored tables of a study anew, all of their cases.

    A report shows these tables and measures a sample of their cases again. An interrupted call
    goes on where it stopped. Run times mean something on an idle machine alone. Its pictures are
    those of a report.

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

    tables, rows = results or out, []
    for each in (each for each in find(name).STUDIES if each.is_stored):
        table = measure(each, out, results=tables, fresh=fresh)
        rows.append((str(tables / f"{each.name}.csv"), len(table), len(each.cases())))
    return Result(tables=[Table(title=name, columns=("file", "rows", "cases"), rows=rows)])


def benchmark(*, repeats: int = 7) -> Result:
    """Measure what runs, sweeps and ensembles take, before and after a change.

    Runs that are compared are timed in turns. The exit code is 1 if something takes longer than
    it should. It takes two minutes of an idle machine.

    Parameters
    ----------
    repeats
        Timed calls of each run; of what takes long, 3 at most.
    """
    whole("repeats", repeats)
    from validation.benchmark import measured_parts

    rows: list[Any] = [
        # Of what is only told, nothing is asked.
        (part, *each[:2], *((None, None) if each.limit == inf else (each.limit, each.holds)))
        for part, checks in measured_parts(repeats).items()
        for each in checks
    ]
    heads = ("part", "measured", "value", "at most", "reached")
    missed = sum(row[-1] is False for row in rows)
    return Result(
        tables=[Table(title=f"Machine: {machine()}", columns=heads, rows=rows)],
        draw=lambda: against_limits([row[1:] for row in rows if row[-1] is not None]),
        notes=[f"{missed} of these miss what they should reach."],
        code=1 if missed else 0,
    )
