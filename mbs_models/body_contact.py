"""Contact of bodies other than a round disk, on a free body in inertial components."""

from abc import abstractmethod
from math import cos, hypot, sin, sqrt

import numpy as np

from analysis.data import frames
from analysis.data.bodies import EllipticDisk, Sphere
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.contact import PenaltyContact
from analysis.data.scenario import Scenario
from mbs_models.loads import Loading, Loads, Matrix, Triple

_STEP = 1e-3
"""Angle in rad over which the surface of a body of one's own is differentiated."""


def loads_of(scenario: Scenario, contact: PenaltyContact) -> Loads:
    """What acts on a body on this contact.

    Parameters
    ----------
    scenario : Scenario
    contact : PenaltyContact
        That of the scenario.
    """
    body = scenario.disk
    if body.is_round_disk:
        return Loads(scenario, contact)
    if isinstance(body, Sphere | EllipticDisk):
        return _EllipsoidLoads(scenario, contact)
    return _OwnLoads(scenario, contact)


class _SurfaceLoads(Loads):
    """The same for a surface that says how its lowest point moves over it."""

    @abstractmethod
    def carriers(self, matrix: Matrix) -> tuple[tuple[Triple, Triple], ...]:
        """Pairs of vectors a and g: the lowest point moves over the surface by -sum a (g . w)."""

    def contour(self, matrix: Matrix, w: Triple, point: Triple) -> tuple[float, float]:  # noqa: ARG002
        """Velocity p' - w x p in m/s of the contact point over the surface; see `Loads`."""
        x = y = 0.0
        for a, g in self.carriers(matrix):
            rate = _dot(g, w)
            x, y = x - a[0] * rate, y - a[1] * rate
        return x, y

    def _rolling(self, matrix: Matrix, w: Triple, load: Loading) -> None:
        """Add the torque of the resistance to that; a resistance F takes -sum (a . F) (g . w)."""
        along, across = self.contour(matrix, w, load.point)
        factor, load.taken[2], load.taken[3] = self._resistance(hypot(along, across), load)
        torque = [0.0, 0.0, 0.0]
        for a, g in self.carriers(matrix):
            size = factor * (a[0] * along + a[1] * across)
            torque = [old + size * each for old, each in zip(torque, g, strict=True)]
        load.add((0.0, 0.0, 0.0), (torque[0], torque[1], torque[2]))


class _EllipsoidLoads(_SurfaceLoads):
    """A sphere, or an elliptic disk, rounded or not.

    With a1, a2, a3 the semi-axes as inertial vectors and h1, h2, h3 their heights, the lowest
    point is at -sum h a / H from the centre, at the depth H = sqrt(sum h²). The heights change by
    w . (a x e), so that the point moves over the surface by -sum a (h / H)'.
    """

    def __init__(self, scenario: Scenario, contact: PenaltyContact) -> None:
        super().__init__(scenario, contact)
        body = scenario.disk
        self._semi_axes, self._turn = (body.radius,) * 3, (1.0, 0.0)
        if isinstance(body, EllipticDisk):
            self._semi_axes = (body.radius, body.other_radius, contact.half_thickness)
            self._turn = cos(body.long_axis), sin(body.long_axis)

    def _axes(self, matrix: Matrix) -> tuple[Triple, ...]:
        (first, second, third), (c, s) = self._semi_axes, self._turn
        xx, xy, xz, yx, yy, yz, zx, zy, zz = matrix
        return (
            (first * (c * xx + s * xy), first * (c * yx + s * yy), first * (c * zx + s * zy)),
            (second * (c * xy - s * xx), second * (c * yy - s * yx), second * (c * zy - s * zx)),
            (third * xz, third * yz, third * zz),
        )

    def lowest(self, matrix: Matrix) -> Triple:
        """Lowest point from the centre in m; see `Loads`."""
        axes = self._axes(matrix)
        depth = sqrt(sum(a[2] * a[2] for a in axes))
        x, y = (-sum(a[k] * a[2] for a in axes) / depth for k in (0, 1))
        return x, y, -depth

    def carriers(self, matrix: Matrix) -> tuple[tuple[Triple, Triple], ...]:
        """Semi-axes, and what the changes of their heights over the depth are by turning."""
        axes = self._axes(matrix)
        square = sum(a[2] * a[2] for a in axes)
        depth = sqrt(square)
        # Of H times its rate, the part for each angular velocity; the vertical is level with it.
        p, q = sum(a[2] * a[1] for a in axes), -sum(a[2] * a[0] for a in axes)
        return tuple(
            (a, ((a[1] - a[2] * p / square) / depth, -(a[0] + a[2] * q / square) / depth, 0.0))
            for a in axes
        )


class _OwnLoads(_SurfaceLoads):
    """A body of one's own, whose lowest point is the one that it says."""

    def __init__(self, scenario: Scenario, contact: PenaltyContact) -> None:
        super().__init__(scenario, contact)
        self._body, self._half = scenario.disk, contact.half_thickness

    def lowest(self, matrix: Matrix) -> Triple:
        """Lowest point from the centre in m; see `Loads`."""
        return _seen(matrix, self._body.lowest_point(matrix[6:9], self._half))

    def carriers(self, matrix: Matrix) -> tuple[tuple[Triple, Triple], ...]:
        """Changes of the lowest point by differences, for turning about the level axes."""
        found = []
        for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
            rate = [0.0, 0.0, 0.0]
            for weight, part in ((-2 / 3, 1.0), (1 / 12, 2.0)):
                for side in (1.0, -1.0):
                    point = self._body.lowest_point(
                        _turned_up(matrix, axis, side * part * _STEP), self._half
                    )
                    rate = [
                        old + weight * side / _STEP * new
                        for old, new in zip(rate, point, strict=True)
                    ]
            found.append((_seen(matrix, (rate[0], rate[1], rate[2])), axis))
        return tuple(found)


def _turned_up(matrix: Matrix, axis: Triple, angle: float) -> Triple:
    """The vertical in axes of a body that has turned about a level axis by an angle."""
    x, y = axis[1] * sin(-angle), -axis[0] * sin(-angle)
    z = cos(angle)
    return (
        matrix[0] * x + matrix[3] * y + matrix[6] * z,
        matrix[1] * x + matrix[4] * y + matrix[7] * z,
        matrix[2] * x + matrix[5] * y + matrix[8] * z,
    )


def _seen(matrix: Matrix, vector: Triple) -> Triple:
    """Inertial components of a vector in axes of the body."""
    x, y, z = (_dot((matrix[k], matrix[k + 1], matrix[k + 2]), vector) for k in (0, 3, 6))
    return x, y, z


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def forces_on(scenario: Scenario, contact: PenaltyContact, z: Array, u: Array) -> Array:
    """Normal force in N, shape (n,), of coordinates z and rates u, shape (n, 6) each."""
    loads, found = loads_of(scenario, contact), []
    states = (*frames.poses(z), *frames.twists(z, u))
    for place, rotation, velocity, angular in zip(
        *(each.tolist() for each in states), strict=True
    ):
        matrix = (*rotation[0], *rotation[1], *rotation[2])
        found.append(loads.at(place[2], matrix, tuple(velocity), tuple(angular)).force[2])
    return np.array(found)


def largest_lever(body: Body, leaning: float, half_thickness: float) -> float:
    """Largest rate of the contact point over the surface in m/s, for each rad/s of turning.

    Parameters
    ----------
    body : Body
    leaning : float
        Sine of the smallest inclination, 0 flat.
    half_thickness : float
        Of the contact in m.
    """
    if not body.has_edge:
        return body.radius
    least = body.other_radius if isinstance(body, EllipticDisk) else body.radius
    return body.radius**2 / hypot(least * leaning, half_thickness)
