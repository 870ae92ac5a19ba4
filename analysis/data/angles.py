"""Angles as people write them: 1.2, pi/2, 90deg."""

import re
from math import pi
from typing import Any

from analysis.data.checks import number
from analysis.data.names import ArgumentError

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FACTOR = rf"(?:{_NUMBER}\s*(?:pi|deg)?|pi)"
_SUM = re.compile(rf"\s*[-+]?\s*{_FACTOR}(?:\s*[-+*/]\s*{_FACTOR})*\s*", re.ASCII)
_STEP = re.compile(rf"([-+*/]?)\s*({_NUMBER}|pi)\s*(pi|deg)?", re.ASCII)

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
    if not _SUM.fullmatch(value):
        raise ArgumentError(
            name,
            f"must be an angle: a number in rad, or text such as pi/2 or 90deg, got {value!r}",
        )
    try:
        result = _evaluated(value)
    except ZeroDivisionError:
        raise ArgumentError(name, f"must be finite, got {value!r}") from None
    return number(name, result)


def spelled_angle(value: float) -> str | None:
    """Text for an angle in rad that says it exactly and shorter than its digits, if there is."""
    return next((text for text in _SPELLED if angle("angle", text) == value), None)


def _evaluated(text: str) -> float:
    total = term = 0.0
    for sign, digits, unit in _STEP.findall(text):
        factor = pi if digits == "pi" else float(digits)
        if sign in ("*", "/"):
            term = term * factor if sign == "*" else term / factor
        else:
            total, term = total + term, -factor if sign == "-" else factor
        if unit:
            term = term * pi / 180.0 if unit == "deg" else term * pi
    return total + term
