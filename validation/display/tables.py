"""Tables a person can read and a file can hold."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap
from typing import Any

_GAP = "  "
"""Between columns of a text."""

_SHORT, _LONG = 16, 30
"""Letters of a cell of a text that always stay in a line, and of a word, such as a path."""

_AT_SPACES: Mapping[str, Any] = {"break_long_words": False, "break_on_hyphens": False}

Cell = str | float | int | bool | None


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
    digits : int
        Significant digits of a float that are shown; 0 for all that tell it from others.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str = ""
    digits: int = 6

    @classmethod
    def of(cls, records: Sequence[Mapping[str, Cell]], title: str, note: str = "") -> "Table":
        """Table of rows by their headings, of which there is one at least."""
        rows = [tuple(each.values()) for each in records]
        return cls(title=title, columns=tuple(records[0]), rows=rows, note=note)

    def records(self) -> list[dict[str, Cell]]:
        """Rows by their headings."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]

    def to_csv(self, path: Path) -> None:
        """Write it as comma-separated text with all digits."""
        from analysis.motion.files import write_csv  # noqa: PLC0415 - no help waits for NumPy

        write_csv(path, self.columns, self.rows)

    def to_text(self, width: int = 100) -> str:
        """Title, aligned cells and note for a terminal of so many columns.

        What is too wide is wrapped within its columns; where even that does not suffice, the last
        columns stand below the others, beside the first one again.
        """
        cells = zip(
            self.columns,
            *([show(cell, self.digits) for cell in row] for row in self.rows),
            strict=True,
        )
        first, *others = map(list, cells)
        blocks = [[first]]
        for column in others:
            if _taken(map(_narrowest, [*blocks[-1], column])) > width:
                blocks.append([first])
            blocks[-1].append(column)
        shown = [_aligned(each, width) for each in blocks] if self.rows else ["none"]
        title, *notes = (
            "\n".join(wrap(line, width)) for line in (self.title, *self.note.splitlines())
        )
        return "\n".join([title, "\n\n".join(shown), *notes, ""])


def _narrowest(column: Sequence[str]) -> int:
    """Width below which words of a column would be cut, or what is short would be wrapped."""
    parts = (part for cell in column for part in wrap(cell, _SHORT, **_AT_SPACES))
    return min(_LONG, max(map(len, parts), default=1))


def _taken(widths: Iterable[int]) -> int:
    """Width of columns beside each other."""
    return sum(each + len(_GAP) for each in widths) - len(_GAP)


def _aligned(columns: Sequence[Sequence[str]], width: int) -> str:
    widths, least = [max(map(len, each)) for each in columns], [*map(_narrowest, columns)]
    if _taken(widths) > width:
        # The headings first, which are there once; then the widest column again and again.
        widths = [max(low, *map(len, each[1:])) for low, each in zip(least, columns, strict=True)]
    while _taken(widths) > width and widths != least:
        _, widest = max((wide, n) for n, wide in enumerate(widths) if wide > least[n])
        widths[widest] -= 1
    lines = [
        _GAP.join(cell.ljust(wide) for cell, wide in zip(line, widths, strict=True)).rstrip()
        for row in zip(*columns, strict=True)
        for line in zip_longest(*map(_wrapped, row, widths), fillvalue="")
    ]
    head = max(len(_wrapped(each[0], wide)) for each, wide in zip(columns, widths, strict=True))
    lines.insert(head, _GAP.join("-" * each for each in widths))
    return "\n".join(lines)


def _wrapped(cell: str, width: int) -> list[str]:
    return [cell] if len(cell) <= width else wrap(cell, width, break_on_hyphens=False)


def show(cell: Cell, digits: int = 6) -> str:
    """Short text of a cell, with so many significant digits, or 0 for all."""
    if cell is None:
        return "–"
    if isinstance(cell, bool):
        return "yes" if cell else "NO"
    if isinstance(cell, float) and digits:
        if 10.0**digits <= abs(cell) < 1e6:
            return f"{cell:.0f}"
        return f"{cell:.{digits}g}" if 1e-4 <= abs(cell) < 1e6 or cell == 0.0 else f"{cell:.2e}"
    return str(cell)


def power(value: float) -> str:
    """A power of ten as 1e-3.

    Examples
    --------
    >>> power(1e-3), power(1e-12), power(1.0), power(1e6), power(1e10)
    ('1e-3', '1e-12', '1e0', '1e6', '1e10')
    """
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")
