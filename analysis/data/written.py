"""Numbers as people write them: a warning where the unit they stand in is in doubt."""

import re
import warnings
from math import pi
from typing import Any

LARGEST_RADIUS = 1.0
"""Of a disk in m, from which on millimetres may be meant."""

DOUBTED = (
    "disk.radius",
    "table.inclination",
    "table.downhill",
    "start.alpha",
    "start.beta",
    "start.gamma",
)
"""Fields that are easily given in another unit."""

_WITH_UNIT = re.compile("pi|deg")


class UnitWarning(UserWarning):
    """A number is taken as it stands, but looks as if it were meant in another unit."""


def warn_of_unit(field: str, told: Any, value: Any) -> None:
    """Warn of a radius above `LARGEST_RADIUS`, and of an angle above a turn without a unit.

    Parameters
    ----------
    field : str
        Its dotted name; others than `DOUBTED` are passed over.
    told : float or str
        What was written.
    value : float
        What it stands for.
    """
    if field not in DOUBTED:
        return
    name = field.rpartition(".")[2]
    if name == "radius":
        doubt = f"is in m, and above {LARGEST_RADIUS:g} m" if value > LARGEST_RADIUS else ""
    elif abs(value) <= 2.0 * pi or (isinstance(told, str) and _WITH_UNIT.search(told)):
        doubt = ""
    else:
        doubt = "is in rad, and above a turn; degrees are written with their unit, as 90deg"
    if doubt:
        warnings.warn(f"{name} {doubt}", UnitWarning, stacklevel=3)
