"""The table, a contact that yields, what takes energy there, and when the disk is at rest."""

from dataclasses import dataclass
from math import asin, pi, sqrt

import numpy as np

from analysis.problem.body import Body
from analysis.problem.checks import Array, Described, bound, instance, not_negative, one, positive
from analysis.problem.elementary import cos, sin
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import THINNEST_RIM, default

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


LARGEST_PART = 0.01
"""Largest resting penetration as a part of the radius; beyond, it is another disk's motion."""

USUAL_RIM = 2e-4
"""Half thickness in m of a rounded rim."""

FULL_GRIP = 0.01
"""Part of the weight from which on a normal force has friction act whole that is not in proportion
to it; less of the force has as much less of it act. A disk that lifts off with such a friction and
falls back without it would change between both without end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PenaltyContact(Described):
    """Contact through a spring and a damper: stiffness * penetration + damping * its rate.

    The penetration is that of the disk's lowest point. A unilateral contact never pulls, and
    without penetration neither the contact nor friction acts; a bilateral one holds the disk down.
    On a unilateral one, friction that is not in proportion to the contact's force fades below
    a hundredth of the weight.

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
        instance("disk", disk, Body)
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
            In m; by default 0.2 mm for a body with an edge, and none for one without.
        """
        if half_thickness is None:
            half_thickness = USUAL_RIM if instance("disk", disk, Body).has_edge else 0.0
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

    def resting_lean(self, disk: Body) -> float:
        """Lean in rad of the plane of its edge at rest, pi/2 without an edge that is rounded."""
        if not self.is_rounded:
            return pi / 2
        return asin(min(1.0, disk.resting_place(self.half_thickness)[1]))

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
                f"must be 0 for {one(type(disk))}, which has no edge, got {self.half_thickness:g}",
            )
        least = weight / (LARGEST_PART * disk.radius)
        what, why = f"weight / ({LARGEST_PART:g} radius)", "the disk does not sink into the table"
        bound("stiffness", self.stiffness, "be at least", least, what, why=f" N/m so that {why}")
        thickness, what = self.half_thickness, "the radius of the disk"
        bound("half_thickness", thickness, "not exceed", disk.radius, what)


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
        Contour speed in m/s at which half of the dry rolling resistance acts, positive. Below it
        a nearly flat disk creeps on: the smaller it is, the later the disk lies still.
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
        Largest kinetic energy, as a part of weight times radius.
    height : float
        Largest distance of the centre of gravity from its height in the stable place, as a part
        of the radius.
    duration : float
        For how long both must hold, in s.

    Raises
    ------
    ValueError
        If a value is not positive.
    """

    energy: float = 5e-9
    height: float = 2e-5
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
            Kinetic energy, and height of the centre of gravity over that in the stable place, as
            such parts.
        spacing : float
            Time between samples in s.
        """
        length = self.samples(spacing)
        still = (kinetic <= self.energy) & (np.abs(rise) <= self.height)
        for begin in range(still.size - length + 1):
            if np.all(still[begin : begin + length]):
                return begin
        return None
