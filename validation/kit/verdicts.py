"""What a terminal shows of a report: verdicts with their criteria, and checks that fail."""

import textwrap
from collections.abc import Iterable, Iterator

from validation.kit.page import Section
from validation.kit.tables import Table, show

WIDTH = 98
"""Of a line."""

_JUDGED = ("verdict", "statement", "criterion")
"""Columns of a table of statements."""


def verdicts(sections: Iterable[Section]) -> str:
    """Verdicts and checks of sections, as lines of at most `WIDTH` characters.

    Parameters
    ----------
    sections : iterable of Section
        Those without a verdict and without a check are left out.
    """
    blocks = ((section.title, list(_items(section))) for section in sections)
    return "\n\n".join(
        "\n".join((title, *map(_wrapped, items))) for title, items in blocks if items
    )


def _wrapped(text: str) -> str:
    return textwrap.fill(text, WIDTH, initial_indent="  ", subsequent_indent="      ")


def _items(section: Section) -> Iterator[str]:
    for each in section.verdicts:
        answer = each.answer[:1].upper() + each.answer[1:]
        yield f"{each.statement} {answer}: {each.numbers}"
    for table in section.tables:
        if set(_JUDGED) <= set(table.columns):
            for row in table.rows:
                cells = dict(zip(table.columns, row, strict=True))
                verdict, statement, criterion = (cells[name] for name in _JUDGED)
                yield f"{verdict}: {statement} [{criterion}]"
        yield from _checks(table)


def _checks(table: Table) -> Iterator[str]:
    """How many checks of a table hold, by the heading that names them, and each that does not."""
    for index, heading in enumerate(table.columns):
        checked = [row for row in table.rows if isinstance(row[index], bool)]
        failed = [row for row in checked if row[index] is False]
        if checked:
            held = len(checked) - len(failed)
            yield f"{held} of {len(checked)} hold: {table.title} [{heading}]"
        for row in failed:
            told = zip(table.columns, map(show, row), strict=True)
            yield f"FAILS: {'; '.join(f'{name}: {cell}' for name, cell in told)}"
