"""The way between the co-rotating coordinates and the inertial frame."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from analysis.problem.checks import Array
from analysis.problem.elementary import Numbers, atan2, cos, hypot, sin

Flags = npt.NDArray[np.bool_]

_DOUBT = 0.5 * np.pi
"""How far off what is expected an angle may be in rad, if turns of it are to be told."""


class Poses(NamedTuple):
    """Poses and how they move: shapes (n, 3), (n, 3, 3), (n, 3), (n, 3); see `from_poses`."""

    positions: Array
    rotations: Array
    velocities: Array
    angular_velocities: Array


def turn_about_vertical(alpha: Array, vectors: Array) -> Array:
    """Inertial components of vectors given in the R-frame; `alpha` (...), `vectors` (..., 3).

    With -alpha it turns inertial components into those of the R-frame.
    """
    c, s = np.cos(alpha), np.sin(alpha)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack((c * x - s * y, s * x + c * y, z), axis=-1)


def poses(coordinates: Array) -> tuple[Array, Array]:
    """Inertial position of G in m, shape (..., 3), and rotation matrix A_IB, shape (..., 3, 3).

    Parameters
    ----------
    coordinates : ndarray, shape (..., 6)
        Co-rotating coordinates, Eq. (8).
    """
    alpha, beta, gamma = np.moveaxis(coordinates[..., 3:], -1, 0)
    sa, ca = np.sin(alpha), np.cos(alpha)
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    rotation = np.array(
        (
            (ca * cg - sa * cb * sg, -ca * sg - sa * cb * cg, sa * sb),
            (sa * cg + ca * cb * sg, -sa * sg + ca * cb * cg, -ca * sb),
            (sb * sg, sb * cg, cb),
        )
    )
    place = turn_about_vertical(alpha, coordinates[..., :3])
    return place, np.moveaxis(rotation, (0, 1), (-2, -1))


def twists(coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Inertial velocity of G in m/s and angular velocity in rad/s, each shape (..., 3)."""
    x, y, _, alpha, beta, _ = np.moveaxis(coordinates, -1, 0)
    xd, yd, zd, ad, bd, gd = np.moveaxis(rates, -1, 0)
    velocity = np.stack((xd - ad * y, yd + ad * x, zd), axis=-1)
    angular = np.stack((bd, -gd * np.sin(beta), ad + gd * np.cos(beta)), axis=-1)
    return turn_about_vertical(alpha, velocity), turn_about_vertical(alpha, angular)


def from_poses(
    position: Array, rotation: Array, velocity: Array, angular: Array
) -> tuple[Array, Array]:
    """Co-rotating coordinates and rates, each shape (n, 6), from inertial poses and twists.

    alpha and gamma come out in (-pi, pi]; beta must lie inside (0, pi).

    Parameters
    ----------
    position, velocity, angular : ndarray, shape (n, 3)
        Inertial position of G in m, its velocity in m/s and the angular velocity in rad/s.
    rotation : ndarray, shape (n, 3, 3)
        Rotation matrix A_IB.
    """
    rows = np.moveaxis(rotation, 0, -1)
    coordinates, rates = from_pose(position.T, rows, velocity.T, angular.T)
    return np.column_stack(coordinates), np.column_stack(rates)


def from_cog(values: Array, slopes: Array, eccentricity: float) -> tuple[Array, Array]:
    """Co-rotating coordinates and rates from those with the centre of gravity in place of G.

    Parameters
    ----------
    values, slopes : ndarray, shape (n, 6)
        Inertial position of the centre of gravity in m and alpha, beta and gamma in rad, and their
        rates.
    eccentricity : float
        In m.
    """
    (_, rotation), (_, angular), alpha = poses(values), twists(values, slopes), values[:, 3]
    offset = eccentricity * rotation[..., 0]
    place = turn_about_vertical(-alpha, values[:, :3] - offset)
    moving = turn_about_vertical(-alpha, slopes[:, :3] - np.cross(angular, offset))
    # The frame in which the place is told turns.
    moving[:, :2] -= slopes[:, 3:4] * place[:, 1::-1] * (-1.0, 1.0)
    return np.hstack((place, values[:, 3:])), np.hstack((moving, slopes[:, 3:]))


def from_pose(
    position: Numbers, rotation: Sequence[Numbers] | Array, velocity: Numbers, angular: Numbers
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The same of one pose, 6 numbers each, or of arrays, from 3 numbers each and rows of 3."""
    (_, _, ahead), (_, _, across), (sideways, along, up) = rotation
    leaning = hypot(sideways, along)
    alpha, beta, gamma = atan2(ahead, -across), atan2(leaning, up), atan2(sideways, along)
    sa, ca = sin(alpha), cos(alpha)
    (x, y, z), (u, v, w), (tilting, turning, rolling) = (
        (ca * a + sa * b, ca * b - sa * a, c) for a, b, c in (position, velocity, angular)
    )
    gamma_rate = -turning / leaning
    spin = rolling - gamma_rate * up
    # The frame in which the place is told turns.
    rates = u + spin * y, v - spin * x, w, spin, tilting, gamma_rate
    return (x, y, z, alpha, beta, gamma), rates


def follow_turns(times: Array, coordinates: Array, rates: Array, fall: float) -> Flags:
    """Make alpha and gamma continuous from their first values on, in place; where samples tell.

    Alpha is the direction in which the axis of the disk leans, and turns fast where that comes by
    the vertical. Between samples over which the axis cannot have gone round the vertical, at the
    faster of its two speeds and what gravity adds, alpha turns by less than half a turn. Else, as
    in a fast spin that is sampled coarsely, the mean rates predict it, unless the disk may lean
    much less in between. Gamma follows from the sum of both, on the other face from their
    difference, which is regular on a flat disk.

    Parameters
    ----------
    times : ndarray, shape (n,)
    coordinates, rates : ndarray, shape (n, 6)
    fall : float
        Acceleration in rad/s² of the axis by gravity, at most.

    Returns
    -------
    ndarray of bool, shape (n - 1,)
        Between which samples turns may have been lost.
    """
    spacing, (_, _, _, alpha, tilt, gamma) = np.diff(times), coordinates.T
    _, _, _, spin, tilting, rolling = rates.T
    by_spin, by_rolling = (0.5 * spacing * (each[1:] + each[:-1]) for each in (spin, rolling))
    reach = np.sin(tilt)
    way = _farthest(np.hypot(tilting, spin * reach), spacing, fall)
    near = way < reach[1:] + reach[:-1]
    steady = _farthest(np.abs(tilting), spacing, fall) < 0.5 * np.minimum(reach[1:], reach[:-1])
    expected = np.where(near, 0.0, by_spin)
    turned = _turn(alpha, expected)
    unseen: Flags = ~near & (~steady | (np.abs(turned - expected) > _DOUBT))
    face = np.where(tilt[1:] + tilt[:-1] < np.pi, 1.0, -1.0)
    expected = by_rolling + face * (by_spin - turned)
    unseen |= np.abs(_turn(gamma, expected) - expected) > _DOUBT
    return unseen


def _farthest(speed: Array, spacing: Array, fall: float) -> Array:
    """How far anything can have gone between samples with these speeds, shape (n - 1,)."""
    return spacing * np.maximum(speed[1:], speed[:-1]) + 0.5 * fall * spacing**2


def _turn(angle: Array, expected: Array) -> Array:
    """Add whole turns to an angle, shape (n,), so that it changes as expected; by what it does."""
    angle[1:] += 2 * np.pi * np.cumsum(np.round((expected - np.diff(angle)) / (2 * np.pi)))
    return np.diff(angle)


def quaternions(rotations: Array) -> Array:
    """Unit quaternions, scalar part first, shape (n, 4), of rotation matrices, shape (n, 3, 3).

    Signs are such that neighbours are close.
    """
    found: Array = Rotation.from_matrix(rotations).as_quat(scalar_first=True)
    turned = np.sum(found[1:] * found[:-1], axis=1) < 0.0
    found[1:][np.cumsum(turned) % 2 == 1] *= -1.0
    return found


def rotations(quaternions: Array) -> Array:
    """Rotation matrices, shape (n, 3, 3), of quaternions, scalar part first, shape (n, 4)."""
    return Rotation.from_quat(quaternions, scalar_first=True).as_matrix()


def quaternion_rates(quaternions: Array, angular: Array) -> Array:
    """Rates of unit quaternions, shape (n, 4), from inertial angular velocities, shape (n, 3)."""
    scalar, vector = quaternions[:, :1], quaternions[:, 1:]
    along = -np.sum(angular * vector, axis=1, keepdims=True)
    return 0.5 * np.hstack((along, scalar * angular + np.cross(angular, vector)))


def angular_velocities(quaternions: Array, rates: Array) -> Array:
    """Inertial angular velocities in rad/s, shape (n, 3), from quaternions and their rates."""
    scalar, vector = quaternions[:, :1], quaternions[:, 1:]
    turning = scalar * rates[:, 1:] - rates[:, :1] * vector
    return 2.0 * (turning - np.cross(rates[:, 1:], vector))


def tilts(rotations: Array) -> Array:
    """Inclination beta in rad from 0 to pi, both flat, of rotation matrices, shape (...)."""
    x, y, z = np.moveaxis(rotations[..., 2], -1, 0)
    return np.arctan2(np.hypot(x, y), z)
