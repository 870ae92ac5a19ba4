"""The table: how it leans, and how strongly gravity pulls."""

from dataclasses import dataclass
from math import pi

from analysis.data.checks import not_negative, positive, within
from analysis.data.elementary import cos, sin
from analysis.data.limits import LARGEST_ANGLE, STRONGEST_GRAVITY
from analysis.data.names import suggesting_fields

GRAVITY = 9.81
"""Gravitational acceleration in m/s²; the value behind the paper's printed results."""


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A flat table. Its normal is the z axis of the inertial frame, however it leans.

    Parameters
    ----------
    gravity : float
        Gravitational acceleration in m/s², positive.
    inclination : float
        Angle in rad between the table and the horizontal, from 0 to less than pi / 2.
    downhill : float
        Direction of steepest descent in rad, from the inertial x axis about the normal.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    gravity: float = GRAVITY
    inclination: float = 0.0
    downhill: float = 0.0

    def __post_init__(self) -> None:
        gravity = within("gravity", positive("gravity", self.gravity), 0.0, STRONGEST_GRAVITY)
        object.__setattr__(self, "gravity", gravity)
        inclination = not_negative("inclination", self.inclination)
        if inclination >= pi / 2:
            raise ValueError(f"inclination must be less than pi / 2, got {inclination:g}")
        object.__setattr__(self, "inclination", inclination)
        downhill = within("downhill", self.downhill, -LARGEST_ANGLE, LARGEST_ANGLE)
        object.__setattr__(self, "downhill", downhill)

    @property
    def is_horizontal(self) -> bool:
        """Whether gravity acts along the normal alone."""
        return self.inclination == 0.0

    @property
    def vector(self) -> tuple[float, float, float]:
        """Gravitational acceleration in m/s², in axes of the table."""
        along = self.gravity * sin(self.inclination)
        return along * cos(self.downhill), along * sin(self.downhill), -self.pressing

    @property
    def pressing(self) -> float:
        """Part of the gravitational acceleration in m/s² that presses on the table."""
        return self.gravity * cos(self.inclination)
