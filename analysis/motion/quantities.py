"""What can be told of a motion: each quantity once, with its unit and how it is read off.

`FILLED` has the arrays that a run fills in, and the classes below what follows from these. What
`FILLED` or `READ_OFF` names columns of goes into everything that leaves a motion: its columns,
files of numbers, tables, pictures, and the series that a sweep keeps. All of it holds for one
motion, shape (n,) of samples, and for many, shape (m, n).
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np

from analysis.motion import frames
from analysis.motion.frames import Poses
from analysis.problem.checks import Array
from analysis.problem.contact import CAUSES
from analysis.problem.quantities import HELD
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES

Columns = Mapping[str, str]
"""Units of the columns of a quantity by their names; a quantity of one column has shape (n,)."""

_LENGTHS = {name: "m" if name in "xyz" else "rad" for name in COORDINATES}


def _named(stem: str, parts: tuple[str, ...] | str, unit: str) -> Columns:
    return {f"{stem}_{part}": unit for part in parts}


FILLED: Mapping[str, Columns] = {
    "times": {"time": "s"},
    "coordinates": _LENGTHS,
    "rates": {f"{name}_rate": f"{unit}/s" for name, unit in _LENGTHS.items()},
    "multipliers": {name: held.unit for held in HELD.values() for name in held.demands},
    "positions": _named("position", "xyz", "m"),
    "quaternions": _named("quaternion", "wxyz", ""),
    "velocities": _named("velocity", "xyz", "m/s"),
    "angular_velocities": _named("angular_velocity", "xyz", "rad/s"),
    "contact_points": _named("contact", "xyz", "m"),
    "dissipated": _named("taken_by", CAUSES, "J"),
    "energies": {f"{kind}_energy": "J" for kind in ("kinetic", "potential", "elastic")},
    "slip_speeds": {"slip_speed": "m/s"},
    "contour_speeds": {"contour_speed": "m/s"},
    "normal_force": {"normal_force": "N"},
}
"""Arrays of a motion, of which every kind has some; forces alone where a constraint has them."""

READ_OFF: dict[str, Columns] = {
    "tilt": {"tilt": "rad"},
    "cog_height": {"cog_height": "m"},
    "contact_speed": {"contact_speed": "m/s"},
    "contact_points": FILLED["contact_points"],
}
"""What every motion tells beside by an attribute that reads it off; others are that alone."""

_TINY = 1e-30
"""Step into the complex plane, far below the last digit of what is differentiated."""


class Quantities(ABC):
    """Quantities of any motion, read off its poses and twists."""

    __slots__ = ()

    times: Array
    scenario: Scenario

    @property
    @abstractmethod
    def poses(self) -> Poses:
        """Pose and twist at every sample."""

    @property
    def _eccentricity(self) -> Array | float:
        """In m; shape (m, 1) of many motions."""
        return self.scenario.disk.eccentricity

    def _lowest(self, up: Any) -> Any:
        return lowest(self.scenario, up)

    def _touching(self, positions: Array, rotations: Array) -> Array:
        """Lowest points of the body in poses, inertial, in m, shape (n, 3)."""
        seen = self._lowest(rotations[..., 2, :])
        return positions + np.einsum("...ij,...j->...i", rotations, seen)

    @property
    def cog_direction(self) -> Array:
        """Height of the centre of gravity above G over the eccentricity, -1 to 1, shape (n,)."""
        return self.poses.rotations[..., 2, 0]

    @property
    def cog_direction_rate(self) -> Array:
        """Rate of `cog_direction` in 1/s, shape (n,)."""
        axis, angular = self.poses.rotations[..., 0], self.poses.angular_velocities
        return angular[..., 0] * axis[..., 1] - angular[..., 1] * axis[..., 0]

    @property
    def face(self) -> Array:
        """Vertical part of the unit vector normal to the disk, shape (n,)."""
        return self.poses.rotations[..., 2, 2]

    @property
    def spin(self) -> Array:
        """Vertical angular velocity in rad/s, shape (n,)."""
        return self.poses.angular_velocities[..., 2]

    @property
    def tilt(self) -> Array:
        """Inclination beta in rad from 0 to pi, both flat, shape (n,)."""
        return frames.tilts(self.poses.rotations)

    @property
    def leaning(self) -> Array:
        """Angle in rad between the disk and the table, 0 flat on either face, shape (n,)."""
        tilt = self.tilt
        return np.minimum(tilt, np.pi - tilt)

    @property
    def cog_height(self) -> Array:
        """Height of the centre of gravity over the table in m, shape (n,)."""
        return self.poses.positions[..., 2] + self._eccentricity * self.cog_direction

    @property
    def cog_positions(self) -> Array:
        """Inertial position of the centre of gravity in m, shape (n, 3)."""
        positions, rotations, *_ = self.poses
        return positions + np.asarray(self._eccentricity)[..., None] * rotations[..., 0]

    @property
    def cog_velocities(self) -> Array:
        """Inertial velocity of the centre of gravity in m/s, shape (n, 3)."""
        positions, _, velocities, angular = self.poses
        return velocities + np.cross(angular, self.cog_positions - positions)

    @property
    def contact_speed(self) -> Array:
        """Speed with which the contact point moves along the table in m/s, shape (n,)."""
        _, rotations, velocities, angular = self.poses
        up, turning = rotations[..., 2, :], np.einsum("...ij,...i->...j", rotations, angular)
        # The derivative along the motion is the imaginary part, to the last digit.
        seen = self._lowest(up + _TINY * 1j * np.cross(up, turning))
        moved = np.cross(turning, seen.real) + seen.imag / _TINY
        along = velocities + np.einsum("...ij,...j->...i", rotations, moved)
        return np.hypot(along[..., 0], along[..., 1])


class InCoordinates(Quantities):
    """Quantities of motions in the paper's coordinates."""

    __slots__ = ()

    coordinates: Any
    rates: Any
    multipliers: Any

    @property
    def poses(self) -> Poses:
        """Pose and twist at every sample."""
        return Poses(*frames.poses(self.coordinates), *frames.twists(self.coordinates, self.rates))

    @property
    def cog_direction(self) -> Array:
        """Height of the centre of gravity above G over the eccentricity, -1 to 1, shape (n,)."""
        return np.sin(self.coordinates[..., 4]) * np.sin(self.coordinates[..., 5])

    @property
    def cog_direction_rate(self) -> Array:
        """Rate of `cog_direction` in 1/s, shape (n,)."""
        beta, gamma = self.coordinates[..., 4], self.coordinates[..., 5]
        found: Array = np.cos(beta) * np.sin(gamma) * self.rates[..., 4]
        found += np.sin(beta) * np.cos(gamma) * self.rates[..., 5]
        return found

    @property
    def face(self) -> Array:
        """Vertical part of the unit vector normal to the disk, shape (n,)."""
        return np.cos(self.coordinates[..., 4])

    @property
    def spin(self) -> Array:
        """Rate of alpha in rad/s, shape (n,)."""
        return self.rates[..., 3]

    @property
    def normal_force(self) -> Array:
        """Normal contact force lambda_N in N, shape (n,)."""
        return self.multipliers[..., 0]

    @property
    def contact_points(self) -> Array:
        """Lowest point of the disk, inertial, in m, shape (n, 3)."""
        positions, rotations, *_ = self.poses
        return self._touching(positions, rotations)


@cache
def filled(kind: type) -> tuple[str, ...]:
    """Those of `FILLED` that a kind of motion has as its fields."""
    held = {field.name for field in fields(kind)}
    return tuple(name for name in FILLED if name in held)


@cache
def quantities(kind: type) -> dict[str, Columns]:
    """Columns of every quantity of a kind of motion that has some, by its attribute."""
    return {name: FILLED[name] for name in filled(kind)} | READ_OFF


def lowest(scenario: Scenario, up: Any) -> Any:
    """Lowest point of the body seen from G in m, in axes of the body, shape (..., 3).

    Parameters
    ----------
    scenario : Scenario
    up : ndarray, shape (..., 3)
        The vertical in axes of the body; complex for the derivative along a motion.
    """
    points = scenario.disk.lowest_point(np.moveaxis(up, -1, 0), scenario.half_thickness)
    return np.stack(np.broadcast_arrays(*points), axis=-1)
