"""The disk: geometry, mass, eccentricity and inertia."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any, ClassVar, NamedTuple

import numpy as np

from analysis.problem.body import Body, Triple
from analysis.problem.checks import bound, checked, not_negative, numbers, positive, several
from analysis.problem.elementary import cos, hypot, sin, sqrt
from analysis.problem.names import ArgumentError, Named, check_names
from analysis.problem.quantities import PLATE, QUANTITIES, RING, default

CENTRED = 1e-12
"""Part of the radius below which a centre of gravity lies in the middle, but for rounding."""

ROUNDING = 1e-14
"""Part of the moment of inertia below which a product of it is none, but for rounding."""


class Plate(NamedTuple):
    """A round plate of uniform density: radius and thickness in m, density in kg/m³."""

    radius: float
    thickness: float
    density: float


class Hole(NamedTuple):
    """A round hole through a plate: its middle, seen from that of the plate, and radius in m."""

    x: float
    y: float
    radius: float


class PointMass(NamedTuple):
    """A small mass in the middle plane of a plate: its place in m, and the mass in kg."""

    x: float
    y: float
    mass: float


Parts = tuple[Plate, tuple[Hole, ...], tuple[PointMass, ...]]
"""What a disk is made of: a plate, holes in it and masses on it."""


@dataclass(frozen=True, kw_only=True)
class Disk(Body):
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
        Moments of inertia about G in kg m² (paper: A, B, C).
    inertia_xy, inertia_xz, inertia_yz : float
        See `Body`; zero for the paper's disk.

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

    is_round_disk: ClassVar[bool] = True
    has_edge: ClassVar[bool] = True

    @cached_property
    def parts(self) -> dict[str, Any] | None:
        """Plain data of which `of_parts` or `ring` made it; None where its numbers are told."""
        return None

    def outline(self) -> tuple[list[Hole], list[PointMass]]:
        """Holes and masses in axes of the body; none of a disk that is told by its numbers."""
        return vars(self).get("_pieces", ([], []))

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Triple:
        """Lowest point of the edge; see `Body`.

        Rounded, the edge is that of a thin spheroid of semi-axes r, r, c, which has a smooth
        lowest point in every attitude. A circle has none when it lies flat; a torus of tube
        radius c has none either. With u the vertical, D = diag(r², r², c²) and
        H = sqrt(u^T D u), the point is -D u / H, and H is the height of the centre over it.

        The thin disk has H = r sin(beta). The spheroid lies higher by about
        c² cos²(beta) / (2 r sin(beta)), second order in c, and by c when flat; a torus by
        c (1 - sin(beta)), first order.
        """
        a, b = self.radius * self.radius, half_thickness * half_thickness
        x, y, z = up
        height = sqrt(a * (x * x + y * y) + b * (z * z))
        return -(a * x) / height, -(a * y) / height, -(b * z) / height

    def clearance(self, beta: Any, gamma: Any, half_thickness: Any = 0.0) -> Triple:  # noqa: ARG002
        """Height of G over the lowest point in m, and its slopes; see `Body`."""
        r, sb, cb = self.radius, sin(beta), cos(beta)
        height = hypot(r * sb, half_thickness * cb)
        # In the order in which it is r cos(beta) to the last digit on a sharp rim.
        return height, r * cb * (1.0 - (half_thickness / r) ** 2) * (r * sb / height), 0.0

    def resting_place(self, half_thickness: float) -> tuple[float, float]:
        """Height of S in m and lean where it lies stable; see `Body`.

        It then lies all but flat, with the centre of gravity over the contact point. One too
        thick for that stands on its rim, the centre of gravity below the centre.
        """
        e, square = self.eccentricity, half_thickness**2
        flattening, lean = self.radius**2 - square, 1.0
        # The height sqrt(c^2 + k s^2) - e s over 0 <= s <= 1, the part of the way from flat to
        # upright, is stationary at one s. A disk of thickness zero lies flat.
        if flattening > e**2:
            lean = min(1.0, e * sqrt(square / (flattening * (flattening - e**2))))
        return sqrt(square + flattening * lean**2) - e * lean, lean

    @classmethod
    def of_parts(
        cls,
        plate: Iterable[float],
        holes: Iterable[Iterable[float]] = (),
        masses: Iterable[Iterable[float]] = (),
    ) -> "Disk":
        """Disk of a round plate with holes in it and small masses on it.

        The axes of the body are those of the plate, turned about its normal until x points to
        the centre of gravity, or until they are principal axes where that is the middle.

        Parameters
        ----------
        plate : Plate, or its 3 numbers
        holes : iterable of Hole, or of their 3 numbers
            They lie within the plate, and not over each other.
        masses : iterable of PointMass, or of their 3 numbers
            They lie on the plate.

        Raises
        ------
        ValueError
            If a number is out of range, a hole cuts the edge or another hole, or a mass does not
            lie on the plate.

        Examples
        --------
        >>> from analysis import Disk
        >>> disk = Disk.of_parts(
        ...     (0.045, 0.01, 7700.0), holes=[(-0.02, 0.0, 0.012)], masses=[(0.0, 0.03, 0.02)]
        ... )
        >>> disk.inertia_xy < 0.0
        True
        """
        parts = _checked(plate, holes, masses)
        radius = parts[0].radius
        mass, (x, y), (xx, yy, zz, xy) = _mass_properties(parts)
        e = hypot(x, y)
        if e < CENTRED * radius:
            turn = 0.5 * np.arctan2(2.0 * xy, xx - yy) if _product(xy, zz) else 0.0
            e, c, s = 0.0, cos(turn), sin(turn)
        else:
            c, s = x / e, y / e
        disk = cls(
            radius=radius,
            mass=mass,
            eccentricity=e,
            inertia_x=c * c * xx + s * s * yy + 2.0 * c * s * xy,
            inertia_y=c * c * yy + s * s * xx - 2.0 * c * s * xy,
            inertia_z=zz,
            inertia_xy=_product(c * s * (yy - xx) + (c * c - s * s) * xy, zz),
        )

        def turned(part: Any) -> Any:
            return part._replace(x=c * part.x + s * part.y, y=c * part.y - s * part.x)

        pieces = [*map(turned, parts[1])], [*map(turned, parts[2])]
        vars(disk).update(parts=_plain(*parts), _pieces=pieces)
        return disk

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
        told = zip(RING, (radius, hole_radius, hole_distance, thickness, density), strict=True)
        r, a, b, h, rho = (checked(QUANTITIES[f"disk.{name}"], each) for name, each in told)
        bound("hole_distance", b, "be less than", r - a, "radius - hole_radius")
        return cls.of_parts(Plate(r, h, rho), [Hole(-b, 0.0, a)])


def _checked(
    plate: Iterable[float],
    holes: Iterable[Iterable[float]],
    masses: Iterable[Iterable[float]],
) -> Parts:
    """Parts of a disk, or `ArgumentError`."""
    sizes = zip(PLATE, numbers("plate", plate, PLATE), strict=True)
    round_plate = Plate(*(checked(QUANTITIES[f"disk.{name}"], value) for name, value in sizes))
    cut, added = _pieces("holes", Hole, holes), _pieces("masses", PointMass, masses)
    reach = round_plate.radius
    for number, hole in enumerate(cut):
        not_negative("holes", hole.radius)
        if hypot(hole.x, hole.y) + hole.radius >= reach:
            raise ArgumentError(
                "holes", f"must lie within the plate of radius {reach:g}, got {hole}"
            )
        for other in cut[:number]:
            if hypot(hole.x - other.x, hole.y - other.y) < hole.radius + other.radius:
                raise ArgumentError("holes", f"must not overlap, got {other} and {hole}")
    for mass in added:
        positive("masses", mass.mass)
        if hypot(mass.x, mass.y) > reach:
            raise ArgumentError("masses", f"must lie on the plate of radius {reach:g}, got {mass}")
    return round_plate, cut, added


def _pieces(name: str, kind: Any, given: Any) -> Any:
    """Holes or masses, each of three numbers, or `ArgumentError`."""
    pieces = several(name, given, kind.__name__)
    return tuple(kind(*numbers(name, each, kind._fields)) for each in pieces)


def _mass_properties(parts: Parts) -> tuple[Any, tuple[Any, Any], tuple[Any, Any, Any, Any]]:
    """Mass, centre of gravity, and entries xx, yy, zz, xy of the inertia, in axes of the plate."""
    (radius, thickness, density), holes, masses = parts
    axial = thickness**2 / 12
    unit = density * thickness * pi
    # Areas over pi, which a hole takes away and a mass stands for; places; radius² and
    # thickness² / 12 of a round piece.
    pieces = [
        (radius**2, 0.0, 0.0, radius**2, axial),
        *((-(each.radius**2), each.x, each.y, each.radius**2, axial) for each in holes),
        *((each.mass / unit, each.x, each.y, 0.0, 0.0) for each in masses),
    ]
    area = mass = x = y = xx = yy = zz = xy = across = 0.0
    for share, a, b, square, height in pieces:
        added = unit * share
        area, x, y, mass = area + share, x + share * a, y + share * b, mass + added
        xx, yy, xy = xx + added * b**2, yy + added * a**2, xy - added * a * b
        across = across + added * (square / 4 + height)
        zz = zz + added * (square / 2 + (a**2 + b**2))
    return mass, (x / area, y / area), (across + xx, across + yy, zz, xy)


def _plain(plate: Plate, holes: tuple[Hole, ...], masses: tuple[PointMass, ...]) -> dict[str, Any]:
    """Plain data that make a disk again: arguments of `Disk.ring` where it is one."""
    values, listed = plate._asdict(), [list(each) for each in holes]
    if masses or len(holes) != 1 or holes[0].y != 0.0 or holes[0].x > 0.0:
        return values | {"holes": listed, "masses": [list(each) for each in masses]}
    values |= {"hole_radius": holes[0].radius, "hole_distance": 0.0 - holes[0].x}
    return {name: values[name] for name in RING}


def _product(value: Any, scale: Any) -> Any:
    """A product of inertia, without what is rounding alone."""
    return 0.0 if abs(value) <= ROUNDING * scale else value


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
