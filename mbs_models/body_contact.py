"""Contact of bodies other than a round disk, on a free body in inertial components."""

from math import cos, hypot, sin, sqrt

import numpy as np

from analysis.data import frames
from analysis.data.bodies import EllipticDisk, Sphere
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from mbs_models.loads import Loads, Matrix, Triple

_STEP = 1e-3
"""Angle in rad over which the surface of a body of one's own is differentiated."""


def loads_of(scenario: Scenario) -> Loads:
    """What acts on a body on its penalty contact."""
    body = scenario.disk
    if body.is_round_disk or isinstance(body, Sphere):
        return Loads(scenario)
    return _EllipticLoads(scenario) if isinstance(body, EllipticDisk) else _OwnLoads(scenario)


class _EllipticLoads(Loads):
    """An elliptic disk, rounded or not.

    With the semi-axes a as inertial vectors and B = sum a aᵀ, the lowest point is at p = -B e / H
    from the centre, at the depth H = sqrt(e . B e), and K = (B - B e (B e)ᵀ / H²) / H.
    """

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(scenario)
        body = scenario.disk
        assert isinstance(body, EllipticDisk)
        a, b, angle = body.radius, body.other_radius, body.long_axis
        # Columns of a rotation matrix make the semi-axes.
        self._first = a * cos(angle), a * sin(angle)
        self._second = -b * sin(angle), b * cos(angle)
        self._third = self._contact.half_thickness

    def _semi_axes(self, matrix: Matrix) -> tuple[Triple, Triple, Triple]:
        """The x, y and z components of the three."""
        (a, b), (c, d), third = self._first, self._second, self._third
        x, y, z = (
            (a * matrix[k] + b * matrix[k + 1], c * matrix[k] + d * matrix[k + 1],
             third * matrix[k + 2])
            for k in (0, 3, 6)
        )  # fmt: skip
        return x, y, z

    def lowest(self, matrix: Matrix) -> Triple:
        x, y, z = self._semi_axes(matrix)
        depth = sqrt(_dot(z, z))
        return -_dot(x, z) / depth, -_dot(y, z) / depth, -depth

    def spread(self, matrix: Matrix) -> Triple:
        x, y, z = self._semi_axes(matrix)
        square, along, across = _dot(z, z), _dot(x, z), _dot(y, z)
        xx, xy, yy = (
            _dot(x, x) - along * along / square,
            _dot(x, y) - along * across / square,
            _dot(y, y) - across * across / square,
        )
        depth = sqrt(square)
        return xx / depth, xy / depth, yy / depth


class _OwnLoads(Loads):
    """A body of one's own, whose lowest point is the one that it says."""

    def lowest(self, matrix: Matrix) -> Triple:
        return self._lowest(matrix, (0.0, 0.0, 1.0))

    def spread(self, matrix: Matrix) -> Triple:
        s, c, s2, c2 = (f(k * _STEP) for k in (1, 2) for f in (sin, cos))

        def slope(x: float, y: float) -> tuple[float, float]:
            """Minus the change of the lowest point as the vertical leans that way."""
            ahead, back, far, behind = (
                self._lowest(matrix, (x * level, y * level, up))
                for level, up in ((s, c), (-s, c), (s2, c2), (-s2, c2))
            )
            first, second = (
                (far[k] - behind[k] - 8.0 * (ahead[k] - back[k])) / (12.0 * _STEP) for k in (0, 1)
            )
            return first, second

        return *slope(1.0, 0.0), slope(0.0, 1.0)[1]

    def _lowest(self, matrix: Matrix, up: Triple) -> Triple:
        """Lowest point from the centre in m for a vertical in this direction."""
        rows = matrix[:3], matrix[3:6], matrix[6:]
        a, b, c = (_dot(up, column) for column in zip(*rows, strict=True))
        point = self._scenario.disk.lowest_point((a, b, c), self._contact.half_thickness)
        x, y, z = (_dot(row, point) for row in rows)
        return x, y, z


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def forces_on(scenario: Scenario, z: Array, u: Array) -> Array:
    """Normal force in N, shape (n,), of coordinates z and rates u, shape (n, 6) each."""
    loads, found = loads_of(scenario), []
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
