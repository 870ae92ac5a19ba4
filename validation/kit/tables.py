"""Tables a person can read and a file can hold."""

import csv
import html
import io
from collections.abc import Sequence
from dataclasses import dataclass

Cell = str | float | int | bool | None


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
    """

    name: str
    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""
    file_only: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(
                    f"rows must have {len(self.columns)} cells in table {self.name!r}, "
                    f"got {len(row)}"
                )

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
        """HTML table with caption and note."""
        head = "".join(f"<th>{html.escape(column)}</th>" for column in self.columns)
        body = "\n".join(
            "<tr>" + "".join(_cell(cell) for cell in row) + "</tr>" for row in self.rows
        )
        note = f'<p class="note">{html.escape(self.note)}</p>' if self.note else ""
        return (
            f'<table id="{html.escape(self.name)}"><caption>{html.escape(self.title)}</caption>'
            f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{note}"
        )


def show(cell: Cell) -> str:
    """Short text of a cell."""
    if cell is None:
        return "–"
    if isinstance(cell, bool):
        return "yes" if cell else "NO"
    if isinstance(cell, float):
        return f"{cell:.6g}" if 1e-3 <= abs(cell) < 1e6 or cell == 0.0 else f"{cell:.2e}"
    return str(cell)


def _cell(cell: Cell) -> str:
    kind = ""
    if isinstance(cell, bool):
        kind = ' class="good"' if cell else ' class="bad"'
    elif isinstance(cell, int | float):
        kind = ' class="number"'
    return f"<td{kind}>{html.escape(show(cell))}</td>"
