"""The report as one HTML page that needs no network and no other file."""

import base64
import html
import re
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from itertools import count

from analysis.data.trajectory import versions
from validation.kit.animation.player import Animation
from validation.kit.figures import Picture
from validation.kit.provenance import machine
from validation.kit.tables import Table

TITLE = "The tippedisk: multibody engine against closed equations"

PAPER = (
    (
        "S. Sailer and R. I. Leine, Model reduction of the tippedisk: a path to the full "
        "analysis, Nonlinear Dynamics 105 (2021)"
    ),
    "10.1007/s11071-021-06649-z",
)
"""Source and its DOI."""

ENGINE = (
    (
        "J. Gerstmayr, Exudyn: a C++-based Python package for flexible multibody systems, "
        "Multibody System Dynamics (2024)"
    ),
    "10.1007/s11044-023-09937-1",
)
"""The engine and its DOI."""


_DENSITY = 1.6
"""Pixels of a panel to one of the page, so that three of them find room in a row."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """A result that is read first.

    Parameters
    ----------
    statement : str
    answer : str
        A word or two: "confirmed".
    numbers : str
        What was found, with units.
    certainty : str
        How sure that is, and why.
    section : str
        Name of the section that shows it.
    good : bool
        Whether an answer other than "yes" and "confirmed" is as good as these.
    """

    statement: str
    answer: str
    numbers: str
    certainty: str
    section: str
    good: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A figure without data, drawn as SVG in the colours of the text around it.

    Parameters
    ----------
    name : str
        Used for its file.
    title, caption : str
    svg : str
    """

    name: str
    title: str
    caption: str
    svg: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the report.

    Parameters
    ----------
    name : str
        Anchor.
    title : str
    paragraphs : sequence of str
        Plain text.
    verdicts : sequence of Verdict
    drawings : sequence of Drawing
    animations : sequence of Animation
    pictures : sequence of Picture
    tables : sequence of Table
    """

    name: str
    title: str
    paragraphs: Sequence[str] = ()
    verdicts: Sequence[Verdict] = ()
    drawings: Sequence[Drawing] = ()
    animations: Sequence[Animation] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()
    files: Sequence[str] = field(init=False)

    def __post_init__(self) -> None:
        names = [f"{each.name}.svg" for each in self.drawings]
        names += [f"{each.name}.html" for each in self.animations]
        names += [f"{each.name}.{kind}" for each in self.pictures for kind in ("png", "svg")]
        names += [f"{table.name}.csv" for table in self.tables]
        object.__setattr__(self, "files", tuple(names))


def page(sections: Sequence[Section], *, made: str) -> str:
    """The page.

    Parameters
    ----------
    sections : sequence of Section
        In reading order, in which figures are numbered.
    made : str
        How it was made, for its foot: "in 120 s".
    """
    links = "".join(
        f'<a href="#{section.name}">{html.escape(section.title)}</a>' for section in sections
    )
    numbers = count(1)
    body = "\n".join(_section(section, numbers) for section in sections)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>The tippedisk</title><style>{_style()}</style></head><body>"
        f"<h1>{html.escape(TITLE)}</h1><nav>{links}</nav>{body}"
        f"{_files(sections)}{_footer(made)}</body></html>"
    )


def _style() -> str:
    return files("validation.kit").joinpath("page.css").read_text(encoding="utf-8")


def _footer(how: str) -> str:
    used = ", ".join(
        f"{name} {version}"
        for name, version in versions("exudyn", "numpy", "scipy", "matplotlib").items()
    )
    made = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime())
    sources = "".join(
        f'<p>{html.escape(text)}, <a href="https://doi.org/{doi}">doi:{doi}</a>.</p>'
        for text, doi in (PAPER, ENGINE)
    )
    return (
        f"<footer><p>Made on {made} with {html.escape(used)}, on {html.escape(machine())}, "
        f"{html.escape(how)}.</p>{sources}</footer>"
    )


def _files(sections: Sequence[Section]) -> str:
    """Links to everything that lies beside the page."""
    rows = "".join(
        f"<li>{html.escape(section.title)}: {_links(section.files)}</li>"
        for section in sections
        if section.files
    )
    return (
        f'<h2 id="files">Files beside this page</h2><details class="files"><summary>'
        "Every table as CSV, every figure as PNG and SVG, every animation</summary>"
        f"<ul>{rows}</ul></details>"
    )


def _links(names: Sequence[str]) -> str:
    return ", ".join(f'<a href="{html.escape(name)}">{html.escape(name)}</a>' for name in names)


def _section(section: Section, numbers: Iterator[int]) -> str:
    parts = [f'<h2 id="{section.name}">{html.escape(section.title)}</h2>']
    parts += [f"<p>{_words(paragraph)}</p>" for paragraph in section.paragraphs]
    if section.verdicts:
        parts.append(f'<ol class="verdicts">{"".join(map(_verdict, section.verdicts))}</ol>')
    for drawing in section.drawings:
        caption = _caption(next(numbers), drawing.title, "", drawing.caption)
        parts.append(f'<figure class="drawing">{drawing.svg}{caption}</figure>')
    for animation in section.animations:
        parts.append(animation.fragment)
        parts.append(
            f'<p class="files">The animation alone: {_links([f"{animation.name}.html"])}</p>'
        )
    parts += [_picture(picture, next(numbers)) for picture in section.pictures]
    parts += [_table(table) for table in section.tables if not table.file_only]
    return "\n".join(parts)


def _verdict(verdict: Verdict) -> str:
    good = " good" if verdict.answer in {"yes", "confirmed"} or verdict.good else ""
    return (
        f"<li><b>{html.escape(verdict.statement)}</b> "
        f'<span class="answer{good}">{html.escape(verdict.answer)}</span>'
        f"<p>{html.escape(verdict.numbers)}</p>"
        f'<p class="note">How sure: {html.escape(verdict.certainty)} '
        f'<a href="#{verdict.section}">Shown below</a>.</p></li>'
    )


def _picture(picture: Picture, number: int) -> str:
    caption = _caption(number, picture.title, picture.paper, picture.caption)
    links = _links([f"{picture.name}.svg", f"{picture.name}.png"])
    title = html.escape(picture.title)
    if picture.panels:
        shown = "".join(
            _image(png, f"{title}, panel", _width(png) / _DENSITY) for png in picture.panels
        )
        kind, shown = ' class="wide"', f'<div class="panels">{shown}</div>'
    else:
        kind, shown = "", _image(picture.png, title)
    return (
        f'<figure id="{html.escape(picture.name)}"{kind}>{shown}{caption}'
        f'<p class="files">{links}</p></figure>'
    )


def _image(png: bytes, text: str, width: float | None = None) -> str:
    data = base64.b64encode(png).decode()
    size = "" if width is None else f' width="{width:.0f}"'
    return f'<img src="data:image/png;base64,{data}" alt="{text}"{size}>'


def _width(png: bytes) -> int:
    """Pixels in a row of a PNG, as its header has them."""
    return int.from_bytes(png[16:20], "big")


def _caption(number: int, title: str, paper: str, text: str) -> str:
    beside = f" (paper: {paper})" if paper else ""
    return (
        f"<figcaption><b>Figure {number}{html.escape(beside)}: {html.escape(title)}.</b> "
        f"{_words(text)}</figcaption>"
    )


def _words(text: str) -> str:
    """Plain text as HTML, with what stands between grave accents as code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text))


def _table(table: Table) -> str:
    return f'{table.to_html()}<p class="files">{_links([f"{table.name}.csv"])}</p>'
