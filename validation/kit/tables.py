"""Tables a person can read and a file can hold."""

import csv
import html
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, log10
from typing import Any, Protocol, TypeVar

Cell = str | float | int | bool | None

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A titled table.

    Parameters
    ----------
    name : str
        Short name, used for its file.
    title : str
    columns : sequence of str
        Headings, with units.
    rows : sequence of sequences
        Cells; a float is shown with few digits but stored with all of them.
    note : str
        What to read from it.
    file_only : bool
        Whether it is too long for a page, and only goes to its file.
    worst : str
        The column whose largest values a page shows of a long table, the rest being folded away;
        without one it shows the first rows. Rows with a failed check are always shown.
    digits : int
        Significant digits on a page.
    folded : bool
        Whether a page folds it if it is long.

    Raises
    ------
    ValueError
        If a row has another number of cells than there are columns, a cell is none (a check of
        NumPy would not count as one), or `worst` is no column.
    """

    name: str
    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""
    file_only: bool = False
    worst: str = ""
    digits: int = 4
    folded: bool = True

    def __post_init__(self) -> None:
        if self.worst and self.worst not in self.columns:
            raise ValueError(
                f"worst must be one of {', '.join(self.columns)} in table {self.name!r}, "
                f"got {self.worst!r}"
            )
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(
                    f"rows must have {len(self.columns)} cells in table {self.name!r}, "
                    f"got {len(row)}"
                )
            for cell in row:
                if not isinstance(cell, str | float | int | None):
                    raise ValueError(
                        f"rows must hold text, numbers, truth values and None in table "
                        f"{self.name!r}, got {cell!r}"
                    )

    def checks(self) -> list[bool]:
        """Every check: its cells that say whether something holds."""
        return [check for row in self.rows for check in _checks(row)]

    @classmethod
    def of(
        cls, items: Iterable[T], columns: Mapping[str, Callable[[T], Cell]], **told: Any
    ) -> "Table":
        """Table with a row for each item.

        Parameters
        ----------
        items : iterable
        columns : mapping
            From headings to functions that make the cells of an item.
        **told
            All parameters but `columns` and `rows`.
        """
        rows = [[cell(each) for cell in columns.values()] for each in items]
        return cls(columns=tuple(columns), rows=rows, **told)

    def records(self) -> list[dict[str, Cell]]:
        """Rows by their headings."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]

    def to_csv(self) -> str:
        """Comma-separated text with full precision."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([["" if cell is None else cell for cell in row] for row in self.rows])
        return stream.getvalue()

    def to_text(self) -> str:
        """Aligned text for a terminal."""
        lines = [list(self.columns)] + [[show(cell) for cell in row] for row in self.rows]
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.columns))]
        padded = [
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
            for line in lines
        ]
        padded.insert(1, "  ".join("-" * width for width in widths))
        return "\n".join(padded)

    def to_html(self) -> str:
        """HTML table with caption and note, folded if it is long."""
        note = f'<p class="note">{html.escape(self.note)}</p>' if self.note else ""
        identifier = f' id="{html.escape(self.name)}"'
        if len(self.rows) <= LONG or not self.folded:
            return f"{self._html(self.title, self.rows, identifier)}{note}"
        shown = self._worst_rows()
        which = f"those with the largest: {self.worst}" if self.worst else "the first"
        title = f"{self.title} ({len(shown)} of {len(self.rows)} rows, {which})"
        return (
            f"{self._html(title, shown, identifier)}{note}"
            f"<details><summary>All {len(self.rows)} rows</summary>"
            f"{self._html(self.title, self.rows)}</details>"
        )

    def _worst_rows(self) -> list[Sequence[Cell]]:
        """Rows a page shows of a long table, in their order."""
        chosen = [index for index, row in enumerate(self.rows) if False in _checks(row)]
        others = [index for index in range(len(self.rows)) if index not in chosen]
        if self.worst:
            column = self.columns.index(self.worst)
            others.sort(key=lambda index: -_size(self.rows[index][column]))
        chosen += others[: max(0, SHOWN - len(chosen))]
        return [self.rows[index] for index in sorted(chosen)]

    def _html(self, title: str, rows: Sequence[Sequence[Cell]], identifier: str = "") -> str:
        head = "".join(f"<th>{html.escape(column)}</th>" for column in self.columns)
        body = "\n".join(
            "<tr>"
            + "".join(
                _cell(cell, column, self.digits)
                for cell, column in zip(row, self.columns, strict=True)
            )
            + "</tr>"
            for row in rows
        )
        return (
            f'<div class="table"{identifier}><table><caption>{html.escape(title)}</caption>'
            f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
        )


LONG = 12
"""Most rows of a table that a page shows as it is."""

SHOWN = 5
"""Rows that a page shows of a longer one."""


def show(cell: Cell, digits: int = 6) -> str:
    """Short text of a cell, with so many significant digits."""
    if cell is None:
        return "–"
    if isinstance(cell, bool):
        return "yes" if cell else "NO"
    if isinstance(cell, float):
        if 10.0**digits <= abs(cell) < 1e6:
            return f"{cell:.0f}"
        return f"{cell:.{digits}g}" if 1e-3 <= abs(cell) < 1e6 or cell == 0.0 else f"{cell:.2e}"
    return str(cell)


def _checks(row: Sequence[Cell]) -> list[bool]:
    return [cell for cell in row if isinstance(cell, bool)]


def _size(cell: Cell) -> float:
    """For sorting: what is no number is smallest."""
    return abs(cell) if isinstance(cell, int | float) else -1.0


def _cell(cell: Cell, column: str, digits: int) -> str:
    kind = ""
    if isinstance(cell, bool):
        kind = ' class="good"' if cell else ' class="bad"'
    elif isinstance(cell, int | float):
        kind = ' class="number"'
    # Narrow screens show the heading in front of each cell.
    return f'<td{kind} data-head="{html.escape(column)}">{html.escape(show(cell, digits))}</td>'


class HasTables(Protocol):
    """A section of a report."""

    @property
    def tables(self) -> Sequence[Table]:
        """Its tables."""


@dataclass(frozen=True, slots=True)
class Tables:
    """Tables of a report, to be asked for numbers.

    Parameters
    ----------
    by_name : dict
    """

    by_name: dict[str, Table]

    @classmethod
    def of(cls, sections: Iterable[HasTables]) -> "Tables":
        """All tables of some sections.

        Raises
        ------
        ValueError
            If two have the same name, of which one would not count.
        """
        by_name: dict[str, Table] = {}
        for table in (table for section in sections for table in section.tables):
            if by_name.setdefault(table.name, table) is not table:
                raise ValueError(f"sections must hold each table once, got two of {table.name}")
        return cls(by_name)

    def column(self, table: str, column: str) -> list[Cell]:
        """Cells of a column."""
        found = self.by_name[table]
        index = list(found.columns).index(column)
        return [row[index] for row in found.rows]

    def numbers(self, table: str, *starts: str) -> list[float]:
        """All numbers of the columns whose headings start so."""
        return [
            float(cell)
            for column in self.by_name[table].columns
            if column.startswith(starts)
            for cell in self.column(table, column)
            if isinstance(cell, int | float) and not isinstance(cell, bool)
        ]

    def row(self, table: str, *keys: str) -> dict[str, Cell]:
        """Cells by heading of the row that starts with these cells."""
        found = self.by_name[table]
        for row in found.rows:
            if tuple(row[: len(keys)]) == keys:
                return dict(zip(found.columns, row, strict=True))
        raise KeyError(f"{table} has no row {', '.join(keys)}")

    def checks(self) -> tuple[int, list[str]]:
        """Number of checks, and the titles of the tables in which some fail."""
        tables = self.by_name.values()
        failed = [table.title for table in tables if not all(table.checks())]
        return sum(len(table.checks()) for table in tables), failed


def at_most(value: float) -> str:
    """One digit, rounded up, for what is no larger: "8e-10"."""
    if not 0.0 < value < inf:
        return f"{value:g}"
    exponent = floor(log10(value))
    # Rounding to some digits first keeps 2e-7 what it is.
    digit = ceil(round(value / 10.0**exponent, 6))
    return f"{digit}e{exponent}" if digit < 10 else f"1e{exponent + 1}"
