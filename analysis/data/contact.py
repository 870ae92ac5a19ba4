"""The penalty form of the contact, on a thin disk or on one with a rounded rim."""

from dataclasses import dataclass
from math import sqrt

from analysis.data.body import Body
from analysis.data.checks import not_negative, positive
from analysis.data.described import Described
from analysis.data.names import ArgumentError
from analysis.data.quantities import THINNEST_RIM, default

LARGEST_PART = 0.01
"""Largest resting penetration as a part of the radius; beyond, it is another disk's motion."""

USUAL_RIM = 2e-4
"""Half thickness in m of a rounded rim."""


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
        cls, stiffness: float, disk: Body, *, ratio: float = 0.5, half_thickness: float = 0.0
    ) -> "PenaltyContact":
        """Contact on which the upright disk bounces with this part of the critical damping.

        Parameters
        ----------
        stiffness : float
            In N/m.
        disk : Body
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
        cls, disk: Body, *, stiffness: float = 1e6, half_thickness: float | None = None
    ) -> "PenaltyContact":
        """Contact for the way to rest: a rounded rim on a stiff, damped table.

        Parameters
        ----------
        disk : Body
        stiffness : float
            In N/m.
        half_thickness : float, optional
            In m; by default `USUAL_RIM` for a body with an edge, and none for one without.
        """
        if half_thickness is None:
            half_thickness = USUAL_RIM if disk.has_edge else 0.0
        return cls.damped(stiffness, disk, half_thickness=half_thickness)

    @property
    def is_rounded(self) -> bool:
        """Whether an edge is rounded, so that its lowest point is defined in every attitude."""
        return self.half_thickness > 0.0

    def resting_penetration(self, weight: float) -> float:
        """Penetration in m at which the contact carries this weight in N."""
        return weight / self.stiffness

    def resting_height(self, disk: Body, weight: float) -> float:
        """Height in m of the centre of gravity of a body of this weight in N where it lies stable.

        The weight presses the contact together; see `Body.resting_place`.
        """
        return disk.resting_place(self.half_thickness)[0] - self.resting_penetration(weight)

    def lies(self, disk: Body) -> bool:
        """Whether it can lie on a face; a disk nearly as thick as wide rests on its rim."""
        return self.is_rounded and disk.resting_place(self.half_thickness)[1] < 1.0

    def check(self, disk: Body, weight: float) -> None:
        """Check the contact against the disk that is to lie on it, of this weight in N.

        Raises
        ------
        ValueError
            If the disk sinks in by more than a small part of its radius, would be thicker than
            it is wide, or has no edge that could be rounded.
        """
        if self.is_rounded and not disk.has_edge:
            raise ArgumentError(
                "half_thickness",
                f"must be 0 for a {type(disk).__name__}, which has no edge, "
                f"got {self.half_thickness:g}",
            )
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
