"""Bodies other than the round disk, and bodies by name."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from analysis.problem.body import Body, Triple
from analysis.problem.checks import Array, bound, number, numbers, one, several, within
from analysis.problem.disk import Disk
from analysis.problem.elementary import Members, cos, sin, sqrt
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import default
from analysis.problem.user_modules import Kinds, error_text


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

    SURFACE: ClassVar[tuple[str, ...]] = ()

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

    SURFACE: ClassVar[tuple[str, ...]] = ("other_radius", "long_axis")

    other_radius: float = default("disk.other_radius")
    long_axis: float = default("disk.long_axis")

    def __post_init__(self) -> None:
        what = "the larger semi-axis, radius"
        bound("other_radius", self.other_radius, "not exceed", self.radius, what)
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
        hash(body)
        for each in several("SURFACE", body.SURFACE or (), "names of fields"):
            number(each, getattr(body, each))
        if body.SURFACE is not None:
            # Whatever else it depends on, code for all of them would not know.
            told = {each: np.atleast_1d(getattr(body, each)) for each in ("radius", *body.SURFACE)}
            one_like: Any = SimpleNamespace(**{k: each.view(Members) for k, each in told.items()})
            try:
                type(body).lowest_point(one_like, _DIRECTIONS[1])
            except AttributeError as error:
                fault = f"must name all that the surface depends on, and lacks {error.name}"
                raise ArgumentError("SURFACE", fault) from error
        for up in _DIRECTIONS[body.has_edge :]:
            what = f"lowest_point({up})"
            point = numbers(what, body.lowest_point(up), "xyz")
            depth = -sum(each * along for each, along in zip(point, up, strict=True))
            within(f"depth of {what}", depth, 0.0, deepest)
            _check_level(body, np.array(up), what)


@contextmanager
def noting(body: Body | type[Body] | None) -> Iterator[None]:
    """Tell that a surface of one's own cannot be asked with symbols or arrays as its fault."""
    try:
        yield
    except Exception as error:
        kind: Any = body if isinstance(body, type) else type(body)
        if body is None or kind in BODIES.values():
            raise
        raise ArgumentError(
            "body",
            "must tell its lowest point by the four operations and the functions of "
            "`analysis.problem.elementary`, not those of NumPy or `math`, and by the same ones "
            f"for all verticals: {error_text(error, TypeError)}",
            f"body {BODIES.name_of(kind)!r}",
        ) from error


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


def _check_level(body: Body, up: Array, what: str) -> None:
    """Raise if the point moves up or down as the vertical turns: it is then not the lowest.

    Or if complex numbers, by which slopes are told, find another one than differences.
    """

    def moved(by: complex) -> Array:
        """Points where each part of the vertical is changed, and 1j times their slopes."""
        verticals = (up + by * np.eye(3)).tolist()
        return np.array([[complex(each) for each in body.lowest_point(at)] for at in verticals])

    by_difference = (moved(_LITTLE) - moved(-_LITTLE)).real / (2.0 * _LITTLE)
    slopes = moved(1e-20j).imag / 1e-20
    wrong = ~(np.abs(by_difference - slopes) <= 0.01 * (body.radius + np.abs(slopes)))
    if wrong.any():
        raise ArgumentError(
            what,
            "must be told by the four operations and `analysis.problem.elementary`: its slope by "
            f"complex numbers is {slopes[wrong][0]:.3g} m, and by differences "
            f"{by_difference[wrong][0]:.3g} m",
        )
    rises = slopes @ up
    # The vertical is of unit length: of its changes those count that turn it.
    rise = float(np.abs(rises - (rises @ up) * up).max())
    if rise > 0.01 * body.radius:
        raise ArgumentError(
            what,
            "must be where the surface is level: as the vertical turns from there, the point "
            f"moves along it by {rise:.3g} m/rad",
        )
