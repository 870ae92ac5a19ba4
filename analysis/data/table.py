"""The table: how it leans, and how strongly gravity pulls."""

from dataclasses import dataclass

from analysis.data.described import Described
from analysis.data.elementary import cos, sin
from analysis.data.quantities import default

GRAVITY: float = default("table.gravity")
"""Gravitational acceleration in m/s²; the value behind the paper's printed results."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Described):
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

    TABLE = "table"

    gravity: float = GRAVITY
    inclination: float = default("table.inclination")
    downhill: float = default("table.downhill")

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
