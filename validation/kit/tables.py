"""Tables a person can read and a file can hold."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

Cell = str | float | int | bool | None

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A titled table.

    Parameters
    ----------
    title : str
    columns : sequence of str
        Headings, with units.
    rows : sequence of sequences
        Cells; a float is shown with few digits but stored with all of them.
    note : str
        What to read from it.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""

    @classmethod
    def of(
        cls, items: Iterable[T], columns: Mapping[str, Callable[[T], Cell]], **texts: Any
    ) -> "Table":
        """Table with a row for each item.

        Parameters
        ----------
        items : iterable
        columns : mapping
            From headings to functions that make the cells of an item.
        **texts
            All parameters but `columns` and `rows`.
        """
        rows = [[cell(each) for cell in columns.values()] for each in items]
        return cls(columns=tuple(columns), rows=rows, **texts)

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


def show(cell: Cell, digits: int = 6) -> str:
    """Short text of a cell, with so many significant digits."""
    if cell is None:
        return "–"
    if isinstance(cell, bool):
        return "yes" if cell else "NO"
    if isinstance(cell, float):
        if 10.0**digits <= abs(cell) < 1e6:
            return f"{cell:.0f}"
        return f"{cell:.{digits}g}" if 1e-4 <= abs(cell) < 1e6 or cell == 0.0 else f"{cell:.2e}"
    return str(cell)
