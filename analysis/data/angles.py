"""Angles as people write them: 1.2, pi/2, 90deg."""

import re
from math import pi
from typing import Any

from analysis.data.checks import number
from analysis.data.names import ArgumentError

_WORD = re.compile(
    r"(?P<n>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<p>pi)|(?P<d>deg)|[-+*/]", re.ASCII
)
_SUM = re.compile(r"[-+]?(?:n[pd]?|p)(?:[-+*/](?:n[pd]?|p))*")
"""Sums of products, in one letter for each word."""

_SPELLED = ("pi/2", "-pi/2", "-pi/2 + 0.1", *(f"{part}deg" for part in range(1, 91)))


def angle(name: str, value: Any) -> float:
    """Return an angle in rad as a finite float.

    Parameters
    ----------
    name : str
        Of the argument, for the message.
    value : float or str
        A number in rad; or text with sums and products of numbers, `pi` and numbers of `deg`,
        worked off from left to right: "pi/2", "-pi/2 + 0.1", "90deg".

    Raises
    ------
    ValueError
        If it is neither, or not finite.
    """
    if not isinstance(value, str):
        return number(name, value)
    words = list(_WORD.finditer(value))
    shape = "".join(word.lastgroup or word[0] for word in words)
    if _WORD.sub("", value).strip() or not _SUM.fullmatch(shape):
        raise ArgumentError(
            name,
            f"must be an angle: a number in rad, or text such as pi/2 or 90deg, got {value!r}",
        )
    try:
        result = _evaluated([word[0] for word in words])
    except ZeroDivisionError:
        raise ArgumentError(name, f"must be finite, got {value!r}") from None
    return number(name, result)


def spelled_angle(value: float) -> str | None:
    """Text for an angle in rad that says it exactly and shorter than its digits, if there is."""
    return next((text for text in _SPELLED if angle("angle", text) == value), None)


def _evaluated(words: list[str]) -> float:
    total, term, divides, begun = 0.0, 1.0, False, False
    for word in words:
        if word in "+-":
            total += term if begun else 0.0
            term, divides = (-1.0 if word == "-" else 1.0), False
        elif word in "*/":
            divides = word == "/"
        elif word == "deg":
            term = term * pi / 180.0
        else:
            factor = pi if word == "pi" else float(word)
            term, divides = (term / factor if divides else term * factor), False
        begun = True
    return total + term
