"""Penalty contact and what goes with it, on a free body in inertial components.

With e the vertical and B = sum a aᵀ over the semi-axes a of an ellipsoid as inertial vectors, its
lowest point is at p = -B e / H from its centre, at the depth H = sqrt(e . B e). A disk is one of
semi-axes r, r, c, and an elliptic one of a, b, c.

A body that turns by w moves its lowest point over its surface by p' - w x p = K (w x e), which is
level. K is symmetric: minus the derivative of p by the direction of the vertical. That of an
ellipsoid is (B - B e (B e)ᵀ / H²) / H, and its level part is told by the cofactors C of B:
K_xx = C_yy / H³, K_xy = -C_xy / H³ and K_yy = C_xx / H³.
"""

from collections.abc import Callable, Iterator
from math import cos, hypot, pi, sin, sqrt
from typing import Any, NamedTuple

from analysis.problem.bodies import EllipticDisk, Sphere
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.contact import FULL_GRIP
from analysis.problem.scenario import Scenario
from mbs_models.friction import free_slip_force

IMAGINARY = 1e-20
"""Imaginary part by which the surface of a body is differentiated, free of rounding."""

Triple = tuple[float, float, float]

Press = Callable[[float, float], tuple[float, float, float, float]]
"""From the depth of a penetration in m, and the speed in m/s by which it shrinks, to the forces of
spring, and of spring and damper, in N; the part of friction that acts (see `FULL_GRIP`); and its
load in N."""

Matrix = tuple[float, float, float, float, float, float, float, float, float]
"""A rotation matrix row by row; its columns are the axes of the body."""


class Loading(NamedTuple):
    """What acts on the disk at one instant.

    Parameters
    ----------
    force, torque : list of 3 floats
        On the disk at its centre in N and N m, without its weight.
    normal : float
        Normal contact force in N.
    point : tuple of 3 floats
        Contact point from the centre in m.
    slip : float
        Speed in m/s of the material at the contact point.
    elastic : float
        Energy in J in the contact's spring.
    taken : list of 6 floats
        Power in W taken by each of `CAUSES`.
    """

    force: list[float]
    torque: list[float]
    normal: float
    point: Triple
    slip: float
    elastic: float
    taken: list[float]


class Loads:
    """Force and torque about the geometric centre G from table and air.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact. At a thickness of zero, the disk must not lie flat.
    slip_part : float
        See `free_slip_force`; so for rolling resistance.

    Attributes
    ----------
    last : Loading
        The last answer of `at`.
    """

    last: Loading

    def __init__(self, scenario: Scenario, slip_part: float) -> None:
        disk = self._disk = scenario.disk
        self._loss = scenario.dissipation
        self._contact = scenario.penalty_contact
        self._press, self._law = pressing(scenario), free_slip_force(scenario, slip_part)
        self._has_direction = not scenario.friction.IS_ISOTROPIC
        self._squares, self._cofactors = _ellipsoid(disk, self._contact.half_thickness)
        self._rolls = self._loss.rolling_dry > 0.0 or self._loss.rolling_viscous > 0.0
        self._dry = self._loss.rolling_dry / slip_part
        self._smoothing = self._loss.rolling_smoothing / slip_part
        half_air = 0.5 * self._loss.air_drag
        self._push = half_air * pi * disk.radius**2
        self._brake = half_air * 8.0 / 15.0 * disk.radius**5
        self._state: tuple[float, Matrix, Triple, Triple] | None = None

    def lowest(self, matrix: Matrix) -> Triple:
        """Lowest point from the centre in m, in inertial axes.

        Parameters
        ----------
        matrix : tuple of 9 floats
            Rotation.
        """
        a, b, c, d, e, f, x, y, z = matrix
        square, xx, xy, yy, zz = self._squares
        p, q, s = xx * x + xy * y, xy * x + yy * y, zz * z
        depth = sqrt(square + p * x + q * y + s * z)
        return -(a * p + b * q + c * s) / depth, -(d * p + e * q + f * s) / depth, -depth

    def spread(self, matrix: Matrix, depth: float) -> Triple:
        """Entries xx, xy and yy of K in m, where the lowest point is so deep; see above."""
        a, b, c, d, e, f, *_unused = matrix
        square, xx, xy, yy, zz = self._cofactors
        p, q, s = xx * a + xy * b, xy * a + yy * b, zz * c
        cube = depth * depth * depth
        return (
            (square + xx * d * d + 2.0 * xy * d * e + yy * e * e + zz * f * f) / cube,
            -(d * p + e * q + f * s) / cube,
            (square + a * p + b * q + c * s) / cube,
        )

    def at(self, centre_height: float, matrix: Matrix, v: Triple, w: Triple) -> Loading:
        """Force and torque on the disk, and what they tell about the contact.

        The last answer is kept: an engine that integrates the powers too asks twice.

        Parameters
        ----------
        centre_height : float
            Height of G over the table in m.
        matrix : tuple of 9 floats
            Rotation.
        v, w : tuple of 3 floats
            Velocity of G in m/s and angular velocity in rad/s.
        """
        state = (centre_height, matrix, v, w)
        if self._state != state:
            self._state, self.last = state, self._new(*state)
        return self.last

    def along(
        self, place: Array, rotation: Array, velocity: Array, angular: Array
    ) -> Iterator[tuple[Loading, float]]:
        """What acts at each sample of a motion, and the speed over the surface in m/s.

        Parameters
        ----------
        place, velocity, angular : ndarray, shape (n, 3)
            As in `at`, in inertial components.
        rotation : ndarray, shape (n, 3, 3)
        """
        matrices: Any = map(tuple, rotation.reshape(-1, 9).tolist())
        states = zip(place[:, 2].tolist(), velocity.tolist(), angular.tolist(), strict=True)
        for matrix, (height, v, w) in zip(matrices, states, strict=True):
            load = self.at(height, matrix, v, w)
            yield load, hypot(*_contour(self.spread(matrix, -load.point[2]), w))

    def _new(self, centre_height: float, matrix: Matrix, v: Triple, w: Triple) -> Loading:
        px, py, pz = point = self.lowest(matrix)
        # Velocity of the material at the contact point.
        sx = v[0] + w[1] * pz - w[2] * py
        sy = v[1] + w[2] * px - w[0] * pz
        rise = v[2] + w[0] * py - w[1] * px
        depth = -pz - centre_height
        spring, normal, part, pressed = self._press(depth, rise)
        fx = fy = 0.0
        if part:
            fx, fy = self._friction(matrix, sx, sy, pressed)
            fx, fy = part * fx, part * fy
        force = [fx, fy, normal]
        torque = [py * normal - pz * fy, pz * fx - px * normal, px * fy - py * fx]
        taken = [(spring - normal) * rise, -(fx * sx + fy * sy), 0.0, 0.0, 0.0, 0.0]
        elastic = 0.5 * spring * depth
        load = Loading(force, torque, normal, point, hypot(sx, sy), elastic, taken)
        if self._rolls:
            self._rolling(self.spread(matrix, -pz), w, load)
        if self._loss.pivoting:
            moment = self._loss.pivoting * normal / (abs(w[2]) + self._loss.pivoting_smoothing)
            load.torque[2] -= moment * w[2]
            load.taken[4] = moment * w[2] * w[2]
        if self._push:
            self._air((matrix[2], matrix[5], matrix[8]), v, w, load)
        return load

    def _friction(self, matrix: Matrix, sx: float, sy: float, load: float) -> tuple[float, float]:
        if not self._has_direction:
            return self._law(sx, sy, load)
        # The edge points along the horizontal at a right angle to the axis.
        level = hypot(matrix[2], matrix[5])
        c, s = -matrix[5] / level, matrix[2] / level
        fx, fy = self._law(c * sx + s * sy, c * sy - s * sx, load)
        return c * fx - s * fy, s * fx + c * fy

    def _rolling(self, spread: Triple, w: Triple, load: Loading) -> None:
        """Add the resistance to the contact point's velocity over the surface.

        A resistance F on it takes F . K (w x e) = w . (e x K F).
        """
        xx, xy, yy = spread
        x, y = _contour(spread, w)
        speed = hypot(x, y)
        dry = self._dry * load.normal / (speed + self._smoothing)
        viscous = self._loss.rolling_viscous * load.normal
        load.taken[2:4] = dry * speed * speed, viscous * speed * speed
        load.torque[0] += (dry + viscous) * (xy * x + yy * y)
        load.torque[1] -= (dry + viscous) * (xx * x + xy * y)

    def _air(self, n: Triple, v: Triple, w: Triple, load: Loading) -> None:
        """Add the drag of the air on a body of this axis."""
        along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
        axial = n[0] * w[0] + n[1] * w[1] + n[2] * w[2]
        tx, ty, tz = w[0] - axial * n[0], w[1] - axial * n[1], w[2] - axial * n[2]
        rate = sqrt(tx * tx + ty * ty + tz * tz)
        push, brake = -self._push * abs(along) * along, -self._brake * rate
        (fx, fy, fz), (p, q, s) = load.force, load.torque
        load.force[:] = fx + push * n[0], fy + push * n[1], fz + push * n[2]
        load.torque[:] = p + brake * tx, q + brake * ty, s + brake * tz
        load.taken[5] = -push * along - brake * rate * rate


def pressing(scenario: Scenario) -> Press:
    """How a penalty contact presses and lets friction act."""
    contact, law, weight = scenario.penalty_contact, scenario.friction, scenario.weight
    stiffness, damping, bilateral = contact.stiffness, contact.damping, contact.bilateral
    by_weight, follows, whole = law.load == "weight", law.follows_contact, FULL_GRIP * weight

    def press(depth: float, rise: float) -> tuple[float, float, float, float]:
        spring, part = stiffness * depth, 1.0
        normal = spring - damping * rise
        if not bilateral:
            # What is no number stays none.
            if depth <= 0.0:
                return 0.0, 0.0, 0.0, 0.0
            normal = max(normal, 0.0)
            part = float(normal > 0.0) if follows else min(1.0, normal / whole)
        # A contact that pulls is no load.
        return spring, normal, part, weight if by_weight else max(0.0, normal)

    return press


def _contour(spread: Triple, w: Triple) -> tuple[float, float]:
    """Velocity in m/s of the contact point over the surface, K (w x e)."""
    xx, xy, yy = spread
    return xx * w[1] - xy * w[0], xy * w[1] - yy * w[0]


def _ellipsoid(body: Body, half_thickness: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Parts of B and of its cofactors, in axes of the body.

    Each is a multiple of the identity, and entries xx, xy, yy and zz of the rest: Newton's
    iteration asks for rotation matrices off by rounding and more, of which the former knows none.
    """
    a, b, angle, third = body.radius, body.radius, 0.0, half_thickness
    if isinstance(body, EllipticDisk):
        b, angle = body.other_radius, body.long_axis
    elif isinstance(body, Sphere):
        third = body.radius
    x, y, narrowing, square = cos(angle), sin(angle), a * a - b * b, third * third
    xx, xy, yy = narrowing * y * y, -narrowing * x * y, narrowing * x * x
    flattening = a * a - square
    return (
        (a * a, -xx, -xy, -yy, -flattening),
        (a * a * square, -square * yy, square * xy, -square * xx, a * a * (b * b - square)),
    )


class _OwnLoads(Loads):
    """A body of one's own, whose lowest point is the one that it says."""

    def lowest(self, matrix: Matrix) -> Triple:
        return self._lowest(matrix, (0.0, 0.0, 1.0))

    def spread(self, matrix: Matrix, depth: float) -> Triple:  # noqa: ARG002 - as it says
        h = IMAGINARY * 1j
        x, y = (self._lowest(matrix, up) for up in ((h, 0.0, 1.0), (0.0, h, 1.0)))
        return -x[0].imag / IMAGINARY, -x[1].imag / IMAGINARY, -y[1].imag / IMAGINARY

    def _lowest(self, matrix: Matrix, up: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
        """Lowest point from the centre in m for a vertical in this direction."""
        rows = matrix[:3], matrix[3:6], matrix[6:]
        a, b, c = (_dot(up, column) for column in zip(*rows, strict=True))
        point = self._disk.lowest_point((a, b, c), self._contact.half_thickness)
        x, y, z = (_dot(row, point) for row in rows)
        return x, y, z


def loads_of(scenario: Scenario, slip_part: float) -> Loads:
    """What acts on a body on its penalty contact."""
    body = scenario.disk
    is_known = body.is_round_disk or isinstance(body, Sphere | EllipticDisk)
    return (Loads if is_known else _OwnLoads)(scenario, slip_part)


def _dot(a: Any, b: Any) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


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
