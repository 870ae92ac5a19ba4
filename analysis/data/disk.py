"""The disk: geometry, mass, eccentricity and inertia."""

from dataclasses import dataclass
from math import pi, sqrt

from analysis.data.described import Described, checked
from analysis.data.names import ArgumentError, Named, check_names
from analysis.data.quantities import QUANTITIES, RING, default


@dataclass(frozen=True, slots=True, kw_only=True)
class Disk(Described):
    """An eccentric rigid disk (paper, Sect. 2).

    The body frame sits at the geometric centre G: x points to the centre of gravity S, z is
    normal to the disk.

    Parameters
    ----------
    radius : float
        Distance of the rolling edge from G in m (paper: r).
    mass : float
        Mass in kg (paper: m).
    eccentricity : float
        Distance from G to S in m (paper: e), from 0 to less than the radius.
    inertia_x, inertia_y, inertia_z : float
        Principal moments of inertia about G in kg m² (paper: A, B, C).

    Raises
    ------
    ValueError
        If a value is out of range, or if no rigid body has these moments of inertia: about S
        they must be positive and none may exceed the sum of the two others.

    Examples
    --------
    >>> from analysis import STEEL_DISK, Disk
    >>> disk = Disk.ring(
    ...     radius=0.045, hole_radius=0.015, hole_distance=0.02, thickness=0.01, density=7700.0
    ... )
    >>> disk.eccentricity < STEEL_DISK.radius
    True
    """

    TABLE = "disk"

    radius: float
    mass: float
    eccentricity: float
    inertia_x: float
    inertia_y: float
    inertia_z: float

    def __post_init__(self) -> None:
        if not self.eccentricity < self.radius:
            raise ArgumentError(
                "eccentricity",
                f"must lie in [0, radius) = [0, {self.radius:g}), got {self.eccentricity:g}",
            )
        names, moments = ("inertia_x", "inertia_y", "inertia_z"), self.inertia_about_cog
        for name, moment in zip(names, moments, strict=True):
            if moment <= 0.0:
                raise ArgumentError(
                    name,
                    "must exceed mass * eccentricity² (the moment about the COG must be "
                    f"positive), got {getattr(self, name):g}, which leaves {moment:g}",
                )
        for name, moment, axis in zip(names, moments, "xyz", strict=True):
            others = sum(moments) - moment
            # A lamina meets the bound exactly, so rounding must not refuse it.
            if moment > others * (1.0 + 1e-12):
                raise ArgumentError(
                    name,
                    "must not exceed the sum of the two other moments about the COG, "
                    f"got {moment:g} > {others:g} about the {axis} axis",
                )

    @property
    def inertia_about_cog(self) -> tuple[float, float, float]:
        """Principal moments of inertia about S in kg m²."""
        shift = self.mass * self.eccentricity**2
        return self.inertia_x, self.inertia_y - shift, self.inertia_z - shift

    @property
    def contact_mobility(self) -> float:
        """Acceleration of the contact point by a force on it, at most, in 1/kg."""
        inertia = min(self.inertia_about_cog[:2])
        return 1.0 / self.mass + (self.radius + self.eccentricity) ** 2 / inertia

    @property
    def hole(self) -> tuple[float, float] | None:
        """Radius and distance in m of the round hole that this mass distribution tells of.

        It lies against the x axis. Eccentricity and `inertia_z` of a flat disk of uniform density
        follow from it alone and tell it again; None where no hole inside the disk would do.
        """
        r, e = self.radius, self.eccentricity
        linear = r**2 + 2.0 * e**2 - 2.0 * self.inertia_z / self.mass
        square = 0.5 * (-linear + sqrt(linear**2 + 8.0 * (e * r) ** 2))
        if square < (1e-6 * r) ** 2:
            return None
        radius, distance = sqrt(square), e * (r**2 - square) / square
        return (radius, distance) if radius + distance < r else None

    @classmethod
    def ring(
        cls,
        *,
        radius: float = default("disk.radius"),
        hole_radius: float = default("disk.hole_radius"),
        hole_distance: float = default("disk.hole_distance"),
        thickness: float = default("disk.thickness"),
        density: float = default("disk.density"),
        **others: float,
    ) -> "Disk":
        """Disk of uniform density with an off-centre circular hole (paper, Fig. 4).

        Parameters
        ----------
        radius, hole_radius, hole_distance, thickness : float
            Lengths in m (paper: r, a, b, h); the hole must lie inside the disk.
        density : float
            Density in kg/m³. What is not given is that of the paper's disk.
        **others
            None; an unknown name is told what it may stand for.

        Raises
        ------
        TypeError
            If a name is unknown.
        ValueError
            If a length or the density is out of range, or the hole cuts the edge.
        """
        check_names("Disk.ring", others, RING)
        given = (radius, hole_radius, hole_distance, thickness, density)
        radius, hole_radius, hole_distance, thickness, density = (
            checked(QUANTITIES[f"disk.{name}"], value)
            for name, value in zip(RING, given, strict=True)
        )
        if hole_distance + hole_radius >= radius:
            raise ArgumentError(
                "hole_distance",
                f"+ hole_radius must be less than radius = {radius:g}, "
                f"got {hole_distance + hole_radius:g}",
            )
        full = density * thickness * pi * radius**2
        hole = density * thickness * pi * hole_radius**2
        full_across = full * (radius**2 / 4 + thickness**2 / 12)
        hole_across = hole * (hole_radius**2 / 4 + thickness**2 / 12)
        return cls(
            radius=radius,
            mass=full - hole,
            eccentricity=hole_radius**2 * hole_distance / (radius**2 - hole_radius**2),
            inertia_x=full_across - hole_across,
            inertia_y=full_across - hole_across - hole * hole_distance**2,
            inertia_z=full * radius**2 / 2 - hole * (hole_radius**2 / 2 + hole_distance**2),
        )


STEEL_RING: dict[str, float] = {name: default(f"disk.{name}") for name in RING}
"""Arguments of `Disk.ring` for the paper's disk."""

STEEL_DISK = Disk.ring()
"""The paper's disk, unrounded: the printed eigenvalues and critical speed come from it."""

CENTRED_DISK = Disk.ring(hole_distance=0.0)
"""The same with its hole in the middle, for which textbooks have closed forms."""

ROUNDED_STEEL_DISK = Disk(
    radius=0.045,
    mass=0.435,
    eccentricity=2.5e-3,
    inertia_x=0.249e-3,
    inertia_y=0.227e-3,
    inertia_z=0.468e-3,
)
"""The paper's disk as Table 1 prints it, rounded to three digits."""

DISKS = Named(
    "DISKS",
    dict(zip(QUANTITIES["disk.name"].choices, (STEEL_DISK, ROUNDED_STEEL_DISK), strict=True)),
)
"""Named disks, as the command line takes them."""
