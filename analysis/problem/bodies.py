"""Bodies other than the round disk, and bodies by name."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from analysis.problem.body import Body, Triple
from analysis.problem.checks import number, one, within
from analysis.problem.disk import Disk
from analysis.problem.elementary import cos, sin, sqrt
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import default
from analysis.problem.user_modules import Kinds


@dataclass(frozen=True, slots=True, kw_only=True)
class Sphere(Body):
    """A sphere whose centre of gravity may lie off its middle, such as a tippe top.

    Parameters
    ----------
    radius : float
        In m.
    mass, eccentricity, inertia_x, inertia_y, inertia_z, inertia_xy, inertia_xz, inertia_yz : float
        See `Body`. A tippe top is symmetric about x, which points to the centre of gravity.

    Raises
    ------
    ValueError
        As for `Body`.

    Examples
    --------
    >>> from analysis import Sphere
    >>> top = Sphere(
    ...     radius=0.02, mass=0.02, eccentricity=0.003,
    ...     inertia_x=3.0e-6, inertia_y=2.98e-6, inertia_z=2.98e-6,
    ... )
    >>> top.lowest_point((0.0, 0.0, 1.0))
    (-0.0, -0.0, -0.02)
    """

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Triple:  # noqa: ARG002
        """Lowest point of the surface; see `Body`."""
        x, y, z = up
        return -(self.radius * x), -(self.radius * y), -(self.radius * z)

    def resting_place(self, half_thickness: float) -> tuple[float, float]:  # noqa: ARG002
        """Height of S in m and lean where it lies stable; see `Body`."""
        return self.radius - self.eccentricity, 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class EllipticDisk(Body):
    """A disk with an ellipse for an edge.

    Parameters
    ----------
    radius, other_radius : float
        Semi-axes in m, the larger one first.
    long_axis : float
        Angle in rad by which the larger semi-axis is turned from x, which points to the centre of
        gravity, towards y.
    mass, eccentricity, inertia_x, inertia_y, inertia_z, inertia_xy, inertia_xz, inertia_yz : float
        See `Body`.

    Raises
    ------
    ValueError
        As for `Body`, or if the other semi-axis is the larger one.
    """

    has_edge: ClassVar[bool] = True

    other_radius: float = default("disk.other_radius")
    long_axis: float = default("disk.long_axis")

    def __post_init__(self) -> None:
        if self.other_radius > self.radius:
            raise ArgumentError(
                "other_radius",
                f"must not exceed the larger semi-axis, radius = {self.radius:g}, "
                f"got {self.other_radius:g}",
            )
        Body.__post_init__(self)

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Triple:
        """Lowest point of the edge, or of an ellipsoid if it is rounded; see `Body`."""
        a, b = self.radius * self.radius, self.other_radius * self.other_radius
        square, c, s = half_thickness * half_thickness, cos(self.long_axis), sin(self.long_axis)
        along, across, z = c * up[0] + s * up[1], c * up[1] - s * up[0], up[2]
        height = sqrt(a * (along * along) + b * (across * across) + square * (z * z))
        x, y = -(a * along) / height, -(b * across) / height
        return c * x - s * y, c * y + s * x, -(square * z) / height


BODIES = Kinds[Body]("BODIES", "body", "disk.body", Body, (Disk, Sphere, EllipticDisk))
"""Bodies by name; others are `module:class`."""


_DIRECTIONS = ((0.0, 0.0, 1.0), (0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (-0.48, 0.6, 0.64))
"""Verticals in which the surface of a body of one's own is tried."""

_LITTLE = 1e-5
"""Change of these, over which slopes of the surface are looked at."""


def check_surface(body: Body) -> None:
    """Raise if what a body says is no lowest point: one of one's own may say anything."""
    if type(body) in BODIES.values():
        return
    deepest = body.radius * (1.0 + 1e-9)
    with BODIES.answering(body):
        _check_kind(body)
        for up in _DIRECTIONS[body.has_edge :]:
            point = [number(f"lowest_point({up})", each) for each in body.lowest_point(up)]
            depth = -sum(each * along for each, along in zip(point, up, strict=True))
            within(f"depth of lowest_point({up})", depth, 0.0, deepest)
            slopes = [_slope(body, up, axis) for axis in range(3)]
            _check_level(body, up, slopes)


def _check_kind(body: Body) -> None:
    """Raise if a body is one of these but for its surface, which closed forms know already."""
    for kind in BODIES.values():
        is_one = isinstance(body, kind) or (body.is_round_disk and kind.is_round_disk)
        if is_one and type(body).lowest_point is not kind.lowest_point:
            raise ArgumentError(
                "lowest_point",
                f"must be that of {one(kind)}, which the body is by its class; one with another "
                "surface derives from Body",
            )


def _check_level(body: Body, up: tuple[float, ...], slopes: list[list[float]]) -> None:
    """Raise if the point moves up or down as the vertical turns: it is then not the lowest."""
    vertical = np.array(up)
    rises = np.array(slopes) @ vertical
    # The vertical is of unit length: of its changes those count that turn it.
    rise = float(np.abs(rises - (rises @ vertical) * vertical).max())
    if rise > 0.01 * body.radius:
        raise ArgumentError(
            f"lowest_point({up})",
            "must be where the surface is level: as the vertical turns from there, the point "
            f"moves along it by {rise:.3g} m/rad",
        )


def _slope(body: Body, up: tuple[float, ...], axis: int) -> list[float]:
    """Slope of the lowest point by a part of the vertical in m.

    Raises
    ------
    ArgumentError
        If complex numbers, by which slopes are told, find another one than differences.
    """

    def moved(by: complex) -> list[complex]:
        vertical = [each + by * (place == axis) for place, each in enumerate(up)]
        return [complex(each) for each in body.lowest_point(vertical)]

    slopes, pairs = [], zip(moved(_LITTLE), moved(-_LITTLE), moved(1e-20j), strict=True)
    for ahead, back, exact in pairs:
        by_difference, slope = (ahead - back).real / (2.0 * _LITTLE), exact.imag / 1e-20
        if not abs(by_difference - slope) <= 0.01 * (body.radius + abs(slope)):
            raise ArgumentError(
                f"lowest_point({up})",
                "must be told by the four operations and `analysis.problem.elementary`: its slope "
                f"by complex numbers is {slope:.3g} m, and by differences {by_difference:.3g} m",
            )
        slopes.append(slope)
    return slopes
