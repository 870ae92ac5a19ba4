"""A study's section: its text with numbers, tables and figures filled in, and the files beside it.

The text is Markdown with Jinja2 in it. A name that is none is an error, as is a table or figure
that the text leaves out: everything that a study shows is shown once.
"""

import base64
import io
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from analysis.problem.names import Named
from validation.display.tables import power, show
from validation.study import Content, Verdict

LONG = 12
"""Most rows of a table that a page shows as it is."""

SHOWN = 10
"""Rows that a page shows of a longer one."""

_DPI = 140

_MARK = "\ue000{}\ue001"
_MARKED = re.compile("(?:<p>)?\ue000(\\d+)\ue001(?:</p>)?")
"""Where a piece goes: characters that no text has. By itself, it is a paragraph to Markdown."""


class Section:
    """A section that is being filled in, for a page of HTML and for one of Markdown alone.

    Parameters
    ----------
    name : str
        Of the study's module, and in front of the names of its files.
    content : Content
    text : Path
        Drawings lie beside it.

    Attributes
    ----------
    files : dict
        From names to contents of all that lies beside the page: text, and pictures in base 64.
    verdicts : list of Verdict
        For the front of the page.
    """

    def __init__(self, name: str, content: Content, text: Path) -> None:
        self.name, self._content, self._text = name, content, text
        self.files: dict[str, str] = {}
        self.verdicts: list[Verdict] = []
        self._left = {*content.tables, *content.figures, *content.animations}
        self._pieces: list[tuple[str, str]] = []

    def filled(self, known: Mapping[str, Any]) -> tuple[str, str]:
        """The text with everything filled in, as HTML and as Markdown.

        Parameters
        ----------
        known : mapping
            What the text may name beside the content's tables and numbers, which come first.

        Raises
        ------
        ValueError
            If it leaves out a table, figure or animation, or a verdict has not 3 paragraphs.
        jinja2.UndefinedError
            If it names what there is not.
        """
        kinds = ("verdict", "table", "file", "figure", "drawing", "animation")
        names = {
            **known,
            **self._content.numbers,
            "tables": self._content.tables,
            **{kind: getattr(self, kind) for kind in kinds},
        }
        filled = environment(self._text.parent).get_template(self._text.name).render(names)
        if self._left:
            raise ValueError(f"{self._text.name} leaves out {', '.join(sorted(self._left))}")
        page = MarkdownIt("commonmark", {"html": True}).enable("table").render(filled)
        return self._put(page, 0), self._put(filled, 1)

    def _piece(self, page: str, plain: str) -> str:
        """What is put into the text in place of a thing that pages of both kinds show."""
        self._pieces.append((page, plain))
        return _MARK.format(len(self._pieces) - 1)

    def _put(self, text: str, kind: int) -> str:
        """The text with all pieces, as a page of HTML (0) or of Markdown (1) has them."""
        while (put := _MARKED.sub(lambda found: self._pieces[int(found[1])][kind], text)) != text:
            text = put
        return text

    def verdict(self, answer: str, hoped: str = "yes", *, caller: Callable[[], str]) -> str:
        """A result that is read first, on the front of the page and not here.

        Parameters
        ----------
        answer, hoped : str
        caller : callable
            Returns its block of the text: statement, numbers and criterion, a paragraph each.
        """
        said = [" ".join(paragraph.split()) for paragraph in caller().strip().split("\n\n")]
        if len(said) != 3:
            raise ValueError(f"a verdict must have 3 paragraphs, got {len(said)}: {said[0]}")
        statement, numbers, criterion = said
        self.verdicts.append(Verdict(statement, answer, numbers, criterion, hoped))
        return ""

    def table(
        self,
        name: str,
        title: str,
        note: str = "",
        *,
        worst: str = "",
        rows: int = SHOWN,
        digits: int = 4,
    ) -> str:
        """A table, of a long one some rows; all of it is in a file.

        Parameters
        ----------
        name, title, note : str
        worst : str
            The column whose largest values are shown of a long one; without it, the first rows.
        rows : int
            How many these are.
        digits : int
            Significant digits that are shown.
        """
        shown = Named(f"{self._text.name}: tables", dict(self._content.tables))[name]
        if (total := len(shown)) > max(LONG, rows):
            if worst:
                sizes = pd.to_numeric(shown[worst], errors="coerce").abs()
                shown = shown.loc[sizes.nlargest(rows).index].sort_index()
            which = f"with the largest: {worst}" if worst else "the first"
            shown = shown[:rows]
            title = f"{title} ({rows} of {total} rows, {which})"
        lines = [list(map(str, shown.columns)), ["---"] * shown.shape[1]]
        lines += [[show(cell, digits) for cell in row] for row in _cells(shown)]
        body = "\n".join(f"| {' | '.join(c.replace('|', '∣') for c in line)} |" for line in lines)
        return self._piece(
            f'<div class="table" id="{self.name}-{name}">{table_html(shown, title, digits)}</div>'
            f'<p class="note">{_inline(note)} <span class="files">{self.file(name)}</span></p>',
            f"**{title}.** {note}\n\n{body}",
        )

    def file(self, name: str) -> str:
        """Put a whole table beside the page; a link to it."""
        path = f"{self.name}-{name}.csv"
        text = self._content.tables[name].to_csv(index=False, lineterminator="\n")
        return self._piece(self._linked(name, path, text), f"`{path}`")

    def figure(self, name: str, title: str, caption: str = "", wide: bool = False) -> str:
        """A figure, embedded."""
        png, svg = drawn(Named(f"{self._text.name}: figures", dict(self._content.figures))[name]())
        links = self._linked(name, f"{self.name}-{name}.png", png)
        links += ", " + self._linked(name, f"{self.name}-{name}.svg", svg)
        image = f'<img alt="{{}}" src="data:image/png;base64,{png}">'
        kind = ' class="wide"' if wide else ""
        return self._figure(f' id="{self.name}-{name}"{kind}', image, title, caption, links)

    def drawing(self, name: str, title: str, caption: str = "") -> str:
        """A drawing that lies beside the text as NAME.svg, in the colours of the page."""
        svg = self._text.with_name(f"{name}.svg").read_text("utf-8")
        self.files[f"{self.name}-{name}.svg"] = svg
        return self._figure(' class="drawing"', svg, title, caption)

    def _figure(self, kind: str, picture: str, title: str, caption: str, links: str = "") -> str:
        page = _pieces().figure(kind, picture, title, caption, links)
        return self._piece(page, f"*Figure in the report: {title}.* {caption}")

    def animation(self, name: str) -> str:
        """A player in the page, and as a page of its own; a page of text does not move."""
        made = self._content.animations[name]()
        link = self._linked(name, f"{self.name}-{name}.html", made.text)
        page = f'{made.fragment}<p class="files">The animation alone: {link}</p>'
        return self._piece(page, "")

    def _linked(self, name: str, path: str, content: str) -> str:
        self._left.discard(name)
        self.files[path] = content
        return f'<a href="{path}">{path}</a>'


def environment(folder: Path) -> Environment:
    """Templates of a folder, with the filters that they use."""
    made = Environment(
        loader=FileSystemLoader([folder, Path(__file__).parent]),
        undefined=StrictUndefined,
        autoescape=False,  # noqa: S701 # texts are Markdown of this package
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"sig": sig, "power": power, "span": span, "listed": listed, "cell": show}
    made.filters["inline"] = _inline
    return made


def drawn(figure: Figure) -> tuple[str, str]:
    """A figure as PNG in base 64 and as SVG."""
    png, svg = io.BytesIO(), io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "tippedisk"}):
        figure.savefig(png, format="png", dpi=_DPI, pil_kwargs={"optimize": True})
        # What is laid out need not be laid out again.
        figure.set_layout_engine("none")
        figure.savefig(svg, format="svg", metadata={"Date": None})
    return base64.b64encode(png.getvalue()).decode(), svg.getvalue()


def table_html(table: pd.DataFrame, title: str = "", digits: int = 4) -> str:
    """A table, with the heading beside each cell for narrow screens."""
    heads = [str(name) for name in table.columns]
    return str(_pieces().table(heads, _cells(table), digits, title))


@cache
def _pieces() -> Any:
    return environment(Path(__file__).parent).get_template("pieces.html").module


def _cells(table: pd.DataFrame) -> list[list[Any]]:
    """Cells as Python has them; a number that is none is missing."""
    rows = table.astype(object).where(table.notna(), None).to_numpy().tolist()
    return [[cell.item() if hasattr(cell, "item") else cell for cell in row] for row in rows]


def _inline(text: str) -> str:
    return str(MarkdownIt("commonmark").renderInline(" ".join(text.split())))


def sig(value: float, digits: int = 2) -> str:
    """Number with so many significant digits, not in exponents where it is short.

    Examples
    --------
    >>> sig(0.01234), sig(99.6), sig(-1234.5), sig(123456.0), sig(2.0, 3)
    ('0.012', '100', '-1200', '1.2e+05', '2')
    """
    # Unary plus is the first that reckons with a name that is undefined, and says so.
    short = float(f"{+value:.{digits}g}")
    return f"{short:.0f}" if 10.0**digits <= abs(short) < 1e5 else f"{value:.{digits}g}"


def span(values: Iterable[float], digits: int = 2) -> str:
    """Least and largest.

    Examples
    --------
    >>> span([3.0, 1.0, 2.0]), span([1.0, 1.001])
    ('1 to 3', '1')
    """
    values = list(values)
    low, high = sig(min(values), digits), sig(max(values), digits)
    return low if low == high else f"{low} to {high}"


def listed(values: Iterable[Any], digits: int = 2) -> str:
    """Values with commas between them, numbers with so many digits.

    Examples
    --------
    >>> listed([0.5, 1 / 3, 2, "none"])
    '0.5, 0.33, 2, none'
    """
    return ", ".join(sig(v, digits) if isinstance(v, float) else str(v) for v in values)
