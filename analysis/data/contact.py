"""The penalty form of the contact, on a thin disk or on one with a rounded rim."""

from dataclasses import dataclass
from math import sqrt

from analysis.data.checks import not_negative, positive
from analysis.data.described import Described
from analysis.data.disk import Disk
from analysis.data.names import ArgumentError
from analysis.data.quantities import THINNEST_RIM, default

LARGEST_PART = 0.01
"""Largest resting penetration as a part of the radius; beyond, it is another disk's motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PenaltyContact(Described):
    """Contact through a spring and a damper: stiffness * penetration + damping * its rate.

    The penetration is that of the disk's lowest point. A unilateral contact never pulls, and
    without penetration neither the contact nor friction acts; a bilateral one holds the disk down.

    Parameters
    ----------
    stiffness : float
        In N/m, positive.
    damping : float
        In N s/m, not negative.
    half_thickness : float
        In m, not negative and at most the radius of the disk (see `check`). Zero is the paper's
        thin disk, whose lowest point is undefined when it lies flat. Otherwise the disk is a thin
        spheroid of this half thickness, which touches the table smoothly in every attitude.
    bilateral : bool
        Whether the contact may pull.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    TABLE = "contact"

    stiffness: float
    damping: float = default("contact.damping")
    half_thickness: float = default("contact.half_thickness")
    bilateral: bool = default("contact.bilateral")

    def __post_init__(self) -> None:
        if 0.0 < self.half_thickness < THINNEST_RIM:
            raise ArgumentError(
                "half_thickness",
                f"must be 0 or at least {THINNEST_RIM:g} m, got {self.half_thickness:g}",
            )

    @classmethod
    def damped(
        cls, stiffness: float, disk: Disk, *, ratio: float = 0.5, half_thickness: float = 0.0
    ) -> "PenaltyContact":
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
        stiffness = positive("stiffness", stiffness)
        damping = 2.0 * not_negative("ratio", ratio) * sqrt(stiffness * disk.mass)
        return cls(stiffness=stiffness, damping=damping, half_thickness=half_thickness)

    @classmethod
    def rounded(
        cls, disk: Disk, *, stiffness: float = 1e6, half_thickness: float = 2e-4
    ) -> "PenaltyContact":
        """Contact for the way to rest: a rounded rim on a stiff, damped table.

        Parameters
        ----------
        disk : Disk
        stiffness : float
            In N/m.
        half_thickness : float
            In m.
        """
        return cls.damped(stiffness, disk, half_thickness=half_thickness)

    @property
    def is_rounded(self) -> bool:
        """Whether the lowest point is defined in every attitude."""
        return self.half_thickness > 0.0

    def resting_penetration(self, weight: float) -> float:
        """Penetration in m at which the contact carries this weight in N."""
        return weight / self.stiffness

    def resting_height(self, disk: Disk, weight: float) -> float:
        """Height in m of the centre of gravity of the disk where it lies stable.

        That is the lowest there is, at the least potential energy; the weight presses the contact
        together. The disk then lies all but flat, with the centre of gravity over the contact
        point. One too thick for that stands on its rim, the centre of gravity below the centre.

        Parameters
        ----------
        disk : Disk
        weight : float
            In N.
        """
        square, lean = self.half_thickness**2, self._resting_lean(disk)
        height = sqrt(square + (disk.radius**2 - square) * lean**2) - disk.eccentricity * lean
        return height - self.resting_penetration(weight)

    def lies(self, disk: Disk) -> bool:
        """Whether the disk can lie on a face; one nearly as thick as wide rests on its rim."""
        return self._resting_lean(disk) < 1.0

    def _resting_lean(self, disk: Disk) -> float:
        """Sine of the angle between disk and table where the disk lies stable."""
        eccentricity, square = disk.eccentricity, self.half_thickness**2
        flattening = disk.radius**2 - square
        # The height sqrt(c^2 + k s^2) - e s over 0 <= s <= 1, the part of the way from flat to
        # upright, is stationary at one s. A disk of thickness zero lies flat.
        if flattening <= eccentricity**2:
            return 1.0
        lean = eccentricity * sqrt(square / (flattening * (flattening - eccentricity**2)))
        return min(lean, 1.0)

    def check(self, disk: Disk, weight: float) -> None:
        """Check the contact against the disk that is to lie on it, of this weight in N.

        Raises
        ------
        ValueError
            If the disk sinks in by more than a small part of its radius, or would be thicker
            than it is wide.
        """
        least = weight / (LARGEST_PART * disk.radius)
        if self.stiffness < least:
            raise ArgumentError(
                "stiffness",
                f"must be at least weight / ({LARGEST_PART:g} radius) = {least:.4g} N/m so that "
                f"the disk does not sink into the table, got {self.stiffness:g}",
            )
        if self.half_thickness > disk.radius:
            raise ArgumentError(
                "half_thickness",
                f"must not exceed the radius of the disk = {disk.radius:g}, "
                f"got {self.half_thickness:g}",
            )
