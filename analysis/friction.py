"""The friction law of the contact."""

from dataclasses import dataclass
from typing import Literal, get_args

from analysis.checks import choice, not_negative, positive, within
from analysis.limits import LARGEST_FRICTION, SMOOTHING_RANGE, STEEPEST_FRICTION

Load = Literal["weight", "contact"]
LOADS: tuple[Load, ...] = get_args(Load)


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothCoulomb:
    """Smooth Coulomb friction, Eq. (3): force = -coefficient * load * slip / (|slip| + smoothing).

    Parameters
    ----------
    coefficient : float
        Friction coefficient, not negative (paper: mu).
    smoothing : float
        Slip speed in m/s at which half of the full force acts, positive (paper: epsilon).
    load : {"weight", "contact"}
        What presses the disk on the table: its weight m g, Eq. (81), or the actual normal
        contact force, Eq. (79).

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    coefficient: float = 0.3
    smoothing: float = 0.1
    load: Load = "weight"

    def __post_init__(self) -> None:
        coefficient = not_negative("coefficient", self.coefficient)
        within("coefficient", coefficient, 0.0, LARGEST_FRICTION)
        smoothing = within("smoothing", positive("smoothing", self.smoothing), *SMOOTHING_RANGE)
        if coefficient > STEEPEST_FRICTION * smoothing:
            raise ValueError(
                f"smoothing must be at least coefficient / {STEEPEST_FRICTION:g} = "
                f"{coefficient / STEEPEST_FRICTION:g}, got {smoothing:g}"
            )
        object.__setattr__(self, "coefficient", coefficient)
        object.__setattr__(self, "smoothing", smoothing)
        choice("load", self.load, LOADS)
