"""What may take energy from the disk, and when it counts as at rest."""

from dataclasses import dataclass

import numpy as np

from analysis.data.checks import Array, positive
from analysis.data.described import Described
from analysis.data.quantities import default

CAUSES = ("damping", "sliding", "rolling_dry", "rolling_viscous", "pivoting", "air_drag")
"""What takes energy from the disk: the contact's damper, sliding friction, and the options."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Dissipation(Described):
    """What may take energy besides sliding friction and the contact's damper; all off at first.

    All but the drag act at the contact in proportion to its force, so that they vanish when the
    contact opens. The contour velocity is that of the contact point along the disk's rim.

    Parameters
    ----------
    rolling_dry : float
        Coefficient of the dry rolling resistance; its power is
        rolling_dry * force * ‖contour velocity‖, smoothed as the sliding friction is.
    rolling_viscous : float
        Coefficient of the viscous rolling resistance in s/m; its power is
        rolling_viscous * force * ‖contour velocity‖².
    pivoting : float
        Lever of the pivoting friction in m; its power is pivoting * force * ‖vertical spin‖,
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

    TABLE = "dissipation"

    rolling_dry: float = default("dissipation.rolling_dry")
    rolling_viscous: float = default("dissipation.rolling_viscous")
    pivoting: float = default("dissipation.pivoting")
    air_drag: float = default("dissipation.air_drag")
    rolling_smoothing: float = default("dissipation.rolling_smoothing")
    pivoting_smoothing: float = default("dissipation.pivoting_smoothing")

    @property
    def is_on(self) -> bool:
        """Whether any of it takes energy."""
        return any(getattr(self, name) > 0.0 for name in CAUSES[2:])


@dataclass(frozen=True, slots=True, kw_only=True)
class RestCriterion(Described):
    """When a disk counts as at rest: still, and in a stable place, for some time.

    Stable is where the potential energy is least. A disk balanced on its rim is still, too.

    Parameters
    ----------
    energy : float
        Largest kinetic energy in J.
    height : float
        Largest distance in m of the centre of gravity from its height in the stable place.
    duration : float
        For how long both must hold, in s.

    Raises
    ------
    ValueError
        If a value is not positive.
    """

    energy: float = 1e-9
    height: float = 1e-6
    duration: float = 0.1

    def __post_init__(self) -> None:
        for name in ("energy", "height", "duration"):
            positive(name, getattr(self, name))

    def samples(self, spacing: float) -> int:
        """Number of samples this far apart (in s) that span the duration."""
        return max(2, 1 + int(np.ceil(self.duration / spacing - 1e-9)))

    def first(self, kinetic: Array, rise: Array, spacing: float) -> int | None:
        """Index of the first sample from which on the disk is at rest for long enough.

        Parameters
        ----------
        kinetic, rise : ndarray, shape (n,)
            Kinetic energy in J, and height in m of the centre of gravity over that in the stable
            place, `PenaltyContact.resting_height`.
        spacing : float
            Time between samples in s.
        """
        length = self.samples(spacing)
        still = (kinetic <= self.energy) & (np.abs(rise) <= self.height)
        for begin in range(still.size - length + 1):
            if np.all(still[begin : begin + length]):
                return begin
        return None
