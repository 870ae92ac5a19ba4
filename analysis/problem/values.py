"""Values as people write them, with a warning where the unit they stand in is in doubt."""

import re
import warnings
from math import pi
from typing import Any

from analysis.problem.checks import choice, number
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import SPELLED, Quantity, declared

Value = float | str | bool
"""What a quantity may be set to."""

_WITH_UNIT = re.compile("pi|deg")

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FACTOR = rf"(?:{_NUMBER}\s*(?:pi|deg)?|pi)"
_SUM = re.compile(rf"\s*[-+]?\s*{_FACTOR}(?:\s*[-+*/]\s*{_FACTOR})*\s*", re.ASCII)
_STEP = re.compile(rf"([-+*/]?)\s*({_NUMBER}|pi)\s*(pi|deg)?", re.ASCII)

SPELLED_ANGLES = {float(part) * pi / 180.0: f"{part}deg" for part in range(1, 91)} | SPELLED
"""Texts that `angle` takes exactly for these angles in rad, and shorter than their digits."""


class UnitWarning(UserWarning):
    """A number is taken as it stands, but looks as if it were meant in another unit."""


def read_value(key: str, value: Any, name: str = "") -> Value:
    """Value of a quantity from text, as on the command line, or as TOML has it.

    Parameters
    ----------
    key : str
        Of the quantity, or "friction." and a parameter of a law of one's own.
    value : float, str or bool
    name : str
        What to call it in a message; by default the key.

    Raises
    ------
    ArgumentError
        If it is of the wrong kind.
    """
    name, about, result = name or key, declared(key), value
    if about.is_text:
        if not isinstance(value, str):
            raise ArgumentError(name, f"must be text, got {value!r}")
        return value.strip()
    if about.is_word:
        words: dict[str, Value] = {str(each).lower(): each for each in about.choices}
        return words[choice(name, str(value).strip().lower(), words)]
    if isinstance(value, str) and not about.is_angle:
        try:
            result = float(value)
        except ValueError:
            what = f"number in {about.unit}" if about.unit else "number"
            raise ArgumentError(name, f"must be a {what}, got {value!r}") from None
    result = angle(name, result)
    _warn_of_unit(about, value, result)
    return result


def _warn_of_unit(about: Quantity, given: Any, value: float) -> None:
    """Warn of a size that is doubted, and of an angle above a turn that is told without a unit."""
    # What is out of range is refused, and not doubted.
    if not about.least <= value <= about.most:
        return
    with_unit = isinstance(given, str) and _WITH_UNIT.search(given)
    if value > about.doubted:
        doubt = f"is in {about.unit}, and above {about.doubted:g} {about.unit}"
    elif about.is_angle and abs(value) > 2.0 * pi and not with_unit:
        doubt = "is in rad, and above a turn; degrees are written with their unit, as 90deg"
    else:
        return
    warnings.warn(f"{about.name} {doubt}", UnitWarning, stacklevel=3)


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
