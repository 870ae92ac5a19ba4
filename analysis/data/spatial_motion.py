"""Motions through every attitude, flat ones too: what a simulation until rest returns."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from analysis.data import frames
from analysis.data.checks import Array, choice, increasing_times, number, real_array, settings
from analysis.data.dense import between_neighbours, interpolate
from analysis.data.dissipation import CAUSES
from analysis.data.endings import Ending
from analysis.data.files import whole_file
from analysis.data.phases import Phases, flat_and_rolling
from analysis.data.sampled import SampledMotion, stored_meta
from analysis.data.scenario import Scenario
from analysis.data.trajectory import SOURCES, Setting, Source, Trajectory

_COLUMNS = {
    "positions": 3,
    "quaternions": 4,
    "velocities": 3,
    "angular_velocities": 3,
    "contact_points": 3,
    "slip_speeds": 0,
    "contour_speeds": 0,
    "normal_force": 0,
    "energies": 3,
    "dissipated": len(CAUSES),
}
"""Sampled arrays and how many columns each has; none for 0."""

_SAME_TIME = 1e-12
"""In s; times of one sample differ by rounding."""

MOTION_COLUMNS = 1 + sum(max(1, columns) for columns in _COLUMNS.values())
"""Numbers in each sample, the time included."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialMotion(SampledMotion):
    """A motion of the disk in inertial coordinates, sampled in time, and what produced it.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Strictly increasing times in s.
    positions, velocities : ndarray, shape (n, 3)
        Of the geometric centre G in m and m/s.
    quaternions : ndarray, shape (n, 4)
        Attitude of the body frame, scalar part first, of unit length.
    angular_velocities : ndarray, shape (n, 3)
        In rad/s, inertial components.
    contact_points : ndarray, shape (n, 3)
        Lowest point of the disk in m.
    slip_speeds, contour_speeds : ndarray, shape (n,)
        Speed of the material at the contact point, and of the contact point along the rim, m/s.
    normal_force : ndarray, shape (n,)
        Contact force in N.
    energies : ndarray, shape (n, 3)
        Kinetic, gravitational (from the table) and elastic energy in J.
    dissipated : ndarray, shape (n, 6)
        Energy in J taken since the start by each of `CAUSES`.
    scenario : Scenario
        What was simulated, with its penalty contact.
    source : {"engine", "in-house"}
    rest_time : float, optional
        Time in s from which on the disk was at rest; None if it never was.
    error_estimate : float, optional
        Largest `deviation` from the true motion expected; None if it was not estimated.
    ending : Ending, optional
        Why it ends before the end asked for, if it does: "at rest", or the time limit.
    method, counts, versions : mapping
        As in `Trajectory`.

    Raises
    ------
    ValueError
        If shapes do not fit, a number is not finite, a quaternion is not of unit length or the
        rest time lies outside the samples.

    Examples
    --------
    >>> from analysis import Scenario, Start, simulate_to_rest
    >>> motion = simulate_to_rest(Scenario.rest(start=Start(spin=5.0)), 0.2)
    >>> bool(motion.cog_height.min() > 0.0)
    True
    >>> motion.to_dict()["taken_by_sliding"].shape == motion.times.shape
    True
    """

    ERROR_UNIT: ClassVar[str] = ""
    STORED_AS: ClassVar[str] = "spatial motion"
    STORED_ARRAYS: ClassVar[tuple[str, ...]] = ("times", *_COLUMNS, "spatial_meta")

    times: Array
    positions: Array
    quaternions: Array
    velocities: Array
    angular_velocities: Array
    contact_points: Array
    slip_speeds: Array
    contour_speeds: Array
    normal_force: Array
    energies: Array
    dissipated: Array
    scenario: Scenario
    source: Source
    rest_time: float | None = None
    error_estimate: float | None = None
    ending: Ending | None = None
    method: Mapping[str, Setting] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        times = increasing_times(self.times)
        for name, columns in {"times": 0, **_COLUMNS}.items():
            values = real_array(name, getattr(self, name))
            shape = (times.size, columns) if columns else (times.size,)
            if values.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {values.shape}")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        excess = float(np.max(np.abs(np.linalg.norm(self.quaternions, axis=1) - 1.0)))
        if excess > 1e-9:
            raise ValueError(f"quaternions must have unit length, got one off by {excess:.1e}")
        choice("source", self.source, SOURCES)
        for name in ("method", "counts", "versions"):
            object.__setattr__(self, name, settings(name, getattr(self, name)))
        if self.rest_time is not None:
            rest = number("rest_time", self.rest_time)
            if not times[0] <= rest <= times[-1]:
                raise ValueError(
                    f"rest_time must lie within the samples, from {times[0]:g} to {times[-1]:g} "
                    f"s, got {rest:g}"
                )
            object.__setattr__(self, "rest_time", rest)

    @property
    def rotations(self) -> Array:
        """Rotation matrices A_IB, shape (n, 3, 3)."""
        return frames.rotations(self.quaternions)

    @property
    def tilt(self) -> Array:
        """Inclination beta in rad from 0 to pi, both flat, shape (n,)."""
        return frames.tilts(self.rotations)

    @property
    def leaning(self) -> Array:
        """Angle in rad between the disk and the table, 0 flat on either face, shape (n,)."""
        tilt = self.tilt
        result: Array = np.minimum(tilt, np.pi - tilt)
        return result

    @property
    def cog_height(self) -> Array:
        """Height of the centre of gravity over the table in m, shape (n,)."""
        result: Array = self.positions[:, 2] + self.scenario.disk.eccentricity * self.cog_direction
        return result

    @property
    def cog_direction(self) -> Array:
        """Vertical part of the unit vector from G to S, 1 upside down, shape (n,)."""
        return self.rotations[:, 2, 0]

    @property
    def cog_direction_rate(self) -> Array:
        """Rate of `cog_direction` in 1/s, shape (n,)."""
        axis, angular = self.rotations[:, :, 0], self.angular_velocities
        result: Array = angular[:, 0] * axis[:, 1] - angular[:, 1] * axis[:, 0]
        return result

    @property
    def spin(self) -> Array:
        """Vertical angular velocity in rad/s, shape (n,)."""
        return self.angular_velocities[:, 2]

    @property
    def phases(self) -> Phases:
        """When each phase of the motion until rest begins."""
        flat, rolling = flat_and_rolling(
            self.scenario,
            self.times,
            leaning=self.leaning,
            slip_speeds=self.slip_speeds,
            contour_speeds=self.contour_speeds,
        )
        inversion = self.inversion
        return Phases(
            inversion=inversion.time,
            inversion_lost=inversion.lost,
            rolling=rolling,
            flat=flat,
            rest=self.rest_time,
        )

    def energy_taken(self, cause: str) -> Array:
        """Energy in J taken by this one of `CAUSES` over time, shape (n,)."""
        return self.dissipated[:, CAUSES.index(choice("cause", cause, CAUSES))]

    @property
    def energy_residual(self) -> Array:
        """Energy now and all that was taken, less the energy at the start, in J, shape (n,)."""
        total = self.energies.sum(axis=1) + self.dissipated.sum(axis=1)
        result: Array = total - total[0]
        return result

    def deviation(self, other: "SpatialMotion") -> float:
        """Largest difference from another motion over the samples that both have.

        It is that of the vertical's direction seen from the disk in rad, which beta and gamma
        make up, or that of an energy as a part of the energy at the start, whichever is larger:
        of all the energy left, and of that taken by any cause.

        Parameters
        ----------
        other : SpatialMotion
            Sampled at the same times, but for the endings.

        Raises
        ------
        ValueError
            If it is sampled at other times.
        """
        shorter = min(self.times.size, other.times.size)
        apart = np.abs(self.times[:shorter] - other.times[:shorter]) > _SAME_TIME
        count = int(np.argmax(apart)) if apart.any() else shorter
        if count < max(1, shorter - 1):
            raise ValueError(
                "other must be sampled at the same times, "
                f"got t = {other.times[count]:.6g} s for {self.times[count]:.6g} s"
            )
        one, two = (
            np.column_stack(
                (
                    motion.rotations[:count, 2] * motion.energies[0].sum(),
                    motion.energies[:count].sum(axis=1),
                    motion.dissipated[:count],
                )
            )
            for motion in (self, other)
        )
        difference = np.abs(one - two)
        turned = np.linalg.norm(difference[:, :3], axis=1)
        largest = max(float(np.max(turned)), float(np.max(difference[:, 3:])))
        return largest / float(self.energies[0].sum())

    def _arrays_at(self, wanted: Array, tolerance: float | None) -> tuple[dict[str, Any], float]:
        pose, error = self._between(wanted, tolerance)
        names = ("positions", "quaternions", "velocities", "angular_velocities")
        found: dict[str, Any] = dict(zip(names, pose, strict=True))
        for name in _COLUMNS:
            if name not in names:
                found[name] = between_neighbours(self.times, getattr(self, name), wanted)
        rest = self.rest_time
        within = rest is not None and wanted[0] <= rest <= wanted[-1]
        return found | {"rest_time": rest if within else None}, error

    def _between(
        self, wanted: Array, tolerance: float | None
    ) -> tuple[tuple[Array, Array, Array, Array], float]:
        """Position, quaternion, velocity and angular velocity between samples, and the error."""
        values = np.column_stack((self.positions, self.quaternions))
        turning = frames.quaternion_rates(self.quaternions, self.angular_velocities)
        rates = np.column_stack((self.velocities, turning))
        values, rates, error = interpolate(self.times, values, rates, wanted)
        # A quaternion off by d turns the disk by 2 d.
        turned = 2.0 * np.linalg.norm(error[:, 3:], axis=1)
        worst = self._check_between(wanted, turned, tolerance)
        length = np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
        quaternion = values[:, 3:] / length
        angular = frames.angular_velocities(quaternion, rates[:, 3:] / length)
        return (values[:, :3], quaternion, rates[:, :3], angular), worst

    def columns(self) -> dict[str, tuple[Array, str]]:
        """Every sampled quantity by name: its values, shape (n,), and its unit."""
        found = {"time": (self.times, "s")}
        for stem, values, parts, unit in (
            ("position", self.positions, "xyz", "m"),
            ("quaternion", self.quaternions, "wxyz", ""),
            ("velocity", self.velocities, "xyz", "m/s"),
            ("angular_velocity", self.angular_velocities, "xyz", "rad/s"),
            ("contact", self.contact_points, "xyz", "m"),
            ("taken_by", self.dissipated, CAUSES, "J"),
        ):
            for part, column in zip(parts, values.T, strict=True):
                found[f"{stem}_{part}"] = (column, unit)
        for name, column in zip(("kinetic", "potential", "elastic"), self.energies.T, strict=True):
            found[f"{name}_energy"] = (column, "J")
        found |= {
            "slip_speed": (self.slip_speeds, "m/s"),
            "contour_speed": (self.contour_speeds, "m/s"),
            "normal_force": (self.normal_force, "N"),
            "tilt": (self.tilt, "rad"),
            "cog_height": (self.cog_height, "m"),
        }
        return found

    def _state(self, wanted: Array, tolerance: float | None) -> tuple[Array, Array]:
        place, quaternion, velocity, angular = self._between(wanted, tolerance)[0]
        return frames.from_poses(place, frames.rotations(quaternion), velocity, angular)

    def to_trajectory(
        self, end: float | None = None, *, least_leaning: float = 1e-3
    ) -> Trajectory:
        """The same motion in the paper's coordinates, as one of Model 1, up to time `end`.

        It keeps the ending, unless `end` lies before. The error estimate grows to what an error
        of the vertical's direction may come to in gamma where the disk leans least.

        Parameters
        ----------
        end : float, optional
            In s; the last sample by default.
        least_leaning : float
            How close to flat in rad the disk may come; Euler angles end there.

        Raises
        ------
        ValueError
            If fewer than two samples lie before `end`, or the disk comes too close to flat.
        """
        count = int(np.searchsorted(self.times, np.inf if end is None else end, side="right"))
        leaning = self.leaning[:count]
        if np.any(leaning < least_leaning):
            first = self.times[np.argmax(leaning < least_leaning)]
            raise ValueError(
                f"end must lie before the disk lies flat (leaning below {least_leaning:g} rad) "
                f"at t = {first:g} s"
            )
        coordinates, rates = frames.from_poses(
            self.positions[:count],
            self.rotations[:count],
            self.velocities[:count],
            self.angular_velocities[:count],
        )
        frames.follow_turns(self.times[:count], coordinates, rates)
        estimate = self.error_estimate
        return Trajectory(
            times=self.times[:count],
            coordinates=coordinates,
            rates=rates,
            multipliers=self.normal_force[:count, None],
            scenario=self.scenario,
            source=self.source,
            error_estimate=None if estimate is None else estimate / float(np.sin(leaning).min()),
            ending=self.ending if count == self.times.size else None,
            method=self.method,
            counts=self.counts,
            versions=self.versions,
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the motion to an `.npz` file, whole or not at all, without pickle.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        arrays = {name: getattr(self, name) for name in ("times", *_COLUMNS)}
        with whole_file(path) as stream:
            np.savez(stream, **arrays, spatial_meta=np.array(self._meta(rest_time=self.rest_time)))

    @classmethod
    def from_arrays(cls, stored: Mapping[str, Any]) -> "SpatialMotion":
        """Motion from the arrays of a file; `load_run` reads one."""
        meta = stored_meta(stored["spatial_meta"], "rest_time")
        return cls(
            **{name: stored[name] for name in ("times", *_COLUMNS)},
            **meta,
        )
