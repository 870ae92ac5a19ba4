"""Numbers that texts state, against those that a report or a study has found."""

import re
from collections.abc import Iterable

NUMBER = re.compile(r"(?<![\w.−-])[-−]?\d+(?:\.\d+)?(?:e[-−]?\d+)?(?![\w])")

NAMES = re.compile(r"(Models?|Table|Figures?) \d( (to|and) \d\b)?")

NOISE = 1e-6
"""Differences below it come from rounding, which is another on every machine."""

BELOW, ABOVE = 5.0, 1.5
"""Factors by which what is measured may lie below and above a stated difference of that kind."""


def numbers(text: str) -> list[str]:
    """Numbers in a text, as they are written there, names of models and tables left out."""
    return NUMBER.findall(NAMES.sub("", text))


def stands(stated: str, found: Iterable[float]) -> bool:
    """Whether one of the found numbers is the stated one, to the digits it is stated with."""
    plain = stated.replace("−", "-")
    value = float(plain)
    if 0.0 < abs(value) < NOISE:
        return any(abs(value) / BELOW <= abs(each) <= abs(value) * ABOVE for each in found)
    mantissa, _, exponent = plain.partition("e")
    decimals = len(mantissa.partition(".")[2])
    half = 0.5001 * 10.0 ** (int(exponent or 0) - decimals)
    return any(abs(each - value) <= half for each in found)


def values(text: str) -> list[float]:
    """Numbers in a text as numbers."""
    return [float(each.replace("−", "-")) for each in numbers(text)]


def missing(text: str, found: Iterable[float]) -> list[str]:
    """Numbers that a text states and nothing has found."""
    known = list(found)
    return [each for each in numbers(text) if not stands(each, known)]


def words(text: str) -> str:
    """A text without its numbers."""
    return NUMBER.sub("#", text)


def rows_below(text: str, heading: str) -> list[list[str]]:
    """Cells of the Markdown table with that heading line."""
    lines, rows = text.splitlines(), []
    for line in lines[lines.index(heading) + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def chapter(text: str, title: str) -> str:
    """What stands below a Markdown heading, up to the next one, without code."""
    _, _, rest = text.partition(f"\n## {title}\n")
    return re.sub(r"```.*?```|`[^`]*`", "", rest.partition("\n## ")[0], flags=re.DOTALL)
