"""How a disk touches the table on its way to rest, and where its energy may go."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from analysis.checks import Array, not_negative, positive
from analysis.disk import Disk

CAUSES = ("damping", "sliding", "rolling_dry", "rolling_viscous", "pivoting", "air_drag")
"""What takes energy from the disk: the contact's damper, sliding friction, and the options."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RimContact:
    """Contact of a thin spheroid with the table through a spring and a damper.

    The normal force is stiffness * penetration + damping * its rate. A unilateral contact never
    pulls, and its force is zero without penetration; a bilateral one holds the disk down.

    Parameters
    ----------
    stiffness : float
        In N/m, positive.
    damping : float
        In N s/m, not negative.
    half_thickness : float
        Half the thickness of the spheroid in m, positive and at most the radius of the disk
        (see `check`). The thin disk is the limit of zero.
    bilateral : bool
        Whether the contact may pull.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    stiffness: float = 1e6
    damping: float = 660.0
    half_thickness: float = 2e-4
    bilateral: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness))
        object.__setattr__(self, "damping", not_negative("damping", self.damping))
        thickness = positive("half_thickness", self.half_thickness)
        object.__setattr__(self, "half_thickness", thickness)

    @classmethod
    def damped(
        cls, stiffness: float, disk: Disk, *, ratio: float = 0.5, half_thickness: float = 2e-4
    ) -> "RimContact":
        """Contact on which the upright disk bounces with this part of the critical damping.

        Parameters
        ----------
        stiffness : float
            In N/m.
        disk : Disk
        ratio : float
            Damping ratio, not negative.
        half_thickness : float
            In m.
        """
        damping = (
            2.0 * not_negative("ratio", ratio) * sqrt(disk.mass * positive("stiffness", stiffness))
        )
        return cls(stiffness=stiffness, damping=damping, half_thickness=half_thickness)

    def check(self, disk: Disk) -> None:
        """Raise `ValueError` if the spheroid would be thicker than the disk is wide."""
        if self.half_thickness > disk.radius:
            raise ValueError(
                f"half_thickness must not exceed the radius of the disk = {disk.radius:g}, "
                f"got {self.half_thickness:g}"
            )

    def resting_penetration(self, disk: Disk) -> float:
        """Penetration in m at which the contact carries the weight of the disk."""
        return disk.weight / self.stiffness


@dataclass(frozen=True, slots=True, kw_only=True)
class Dissipation:
    """What may take energy besides sliding friction and the contact's damper; all off at first.

    All but the drag act at the contact in proportion to its force, so that they vanish when the
    contact opens. The contour velocity is that of the contact point along the disk's rim.

    Parameters
    ----------
    rolling_dry : float
        Coefficient of the dry rolling resistance; its power is
        rolling_dry * force * |contour velocity|, smoothed as the sliding friction is.
    rolling_viscous : float
        Coefficient of the viscous rolling resistance in s/m; its power is
        rolling_viscous * force * |contour velocity|².
    pivoting : float
        Lever of the pivoting friction in m; its power is pivoting * force * |vertical spin|,
        smoothed likewise.
    air_drag : float
        Density of the air times drag coefficient of a plate in kg/m³. Pressure acts on the faces
        alone, as if translation and each tumbling rate passed the air by themselves.
    rolling_smoothing : float
        Contour speed in m/s at which half of the dry rolling resistance acts, positive.
    pivoting_smoothing : float
        Spin in rad/s at which half of the pivoting friction acts, positive.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    rolling_dry: float = 0.0
    rolling_viscous: float = 0.0
    pivoting: float = 0.0
    air_drag: float = 0.0
    rolling_smoothing: float = 0.01
    pivoting_smoothing: float = 0.1

    def __post_init__(self) -> None:
        for name in ("rolling_dry", "rolling_viscous", "pivoting", "air_drag"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))
        for name in ("rolling_smoothing", "pivoting_smoothing"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))


@dataclass(frozen=True, slots=True, kw_only=True)
class RestCriterion:
    """When a disk counts as at rest: still, and no longer sinking, for some time.

    Parameters
    ----------
    energy : float
        Largest kinetic energy in J.
    height : float
        Largest change in m of the height of the centre of gravity.
    duration : float
        For how long both must hold, in s.

    Raises
    ------
    ValueError
        If a value is not positive.
    """

    energy: float = 1e-9
    height: float = 1e-7
    duration: float = 0.1

    def __post_init__(self) -> None:
        for name in ("energy", "height", "duration"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))

    def samples(self, spacing: float) -> int:
        """Number of samples this far apart (in s) that span the duration."""
        return max(2, 1 + int(np.ceil(self.duration / spacing - 1e-9)))

    def first(self, kinetic: Array, heights: Array, spacing: float) -> int | None:
        """Index of the first sample from which on the disk is at rest for long enough.

        Parameters
        ----------
        kinetic, heights : ndarray, shape (n,)
            Kinetic energy in J and height of the centre of gravity in m.
        spacing : float
            Time between samples in s.
        """
        length = self.samples(spacing)
        still = kinetic <= self.energy
        for begin in range(still.size - length + 1):
            window = slice(begin, begin + length)
            if np.all(still[window]) and np.ptp(heights[window]) <= self.height:
                return begin
        return None
