"""Poses of the disk over time, as an animation needs them, from either kind of stored motion."""

from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analysis import SpatialMotion, StoredRun, Trajectory
from analysis.data import frames
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.limits import MOST_KEYFRAMES

_TURN_BETWEEN = 0.25
"""Angle in rad the disk may turn between keyframes taken from co-rotating coordinates."""

_LARGEST_TURN = 0.9 * np.pi
"""Beyond this angle in rad between samples, a quaternion no longer tells the way round."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Keyframes:
    """Poses of the disk at some times; between them, `at` interpolates.

    Parameters
    ----------
    times : ndarray, shape (n,)
        In s, strictly increasing.
    positions : ndarray, shape (n, 3)
        Of the geometric centre G in m, inertial.
    quaternions : ndarray, shape (n, 4)
        Attitude of the body frame, scalar part first, of unit length.
    contact_points : ndarray, shape (n, 2)
        Where the disk touches the table, in m.
    spins : ndarray, shape (n,)
        Vertical angular velocity in rad/s; unlike the rate of alpha it exists in every attitude.
    disk : Body
    marks : sequence of (str, float)
        Names of phases and the times in s at which they begin.
    source : str
        Who simulated what, in a few words.
    """

    times: Array
    positions: Array
    quaternions: Array
    contact_points: Array
    spins: Array
    disk: Body
    marks: tuple[tuple[str, float], ...]
    source: str

    @property
    def rotations(self) -> Array:
        """Rotation matrices, whose columns are the body axes, shape (n, 3, 3)."""
        return frames.rotations(self.quaternions)

    @property
    def tilt(self) -> Array:
        """Inclination beta in rad, shape (n,)."""
        return frames.tilts(self.rotations)

    @property
    def gamma(self) -> Array:
        """Rotation angle gamma in rad from -pi to pi, shape (n,); without meaning if flat."""
        result: Array = np.arctan2(self.rotations[:, 2, 0], self.rotations[:, 2, 1])
        return result

    @property
    def cog_height(self) -> Array:
        """Height of the centre of gravity in m, shape (n,)."""
        result: Array = self.positions[:, 2] + self.disk.eccentricity * self.rotations[:, 2, 0]
        return result

    def at(self, times: Array) -> "Keyframes":
        """Keyframes at other times within the range, shape (m,).

        Linear in all values, the shorter way round in the quaternions, which are brought back to
        unit length; the player does the same.
        """
        before = np.searchsorted(self.times, times, side="right") - 1
        before = np.clip(before, 0, self.times.size - 2)
        part = (times - self.times[before]) / np.diff(self.times)[before]

        def mix(values: Array) -> Array:
            first, second = values[before], values[before + 1]
            weight = part.reshape(-1, *[1] * (values.ndim - 1))
            result: Array = first + weight * (second - first)
            return result

        first, second = self.quaternions[before], self.quaternions[before + 1]
        second = np.where(np.sum(first * second, axis=1)[:, None] < 0.0, -second, second)
        mixed = first + part[:, None] * (second - first)
        return replace(
            self,
            times=times,
            positions=mix(self.positions),
            quaternions=mixed / np.linalg.norm(mixed, axis=1)[:, None],
            contact_points=mix(self.contact_points),
            spins=mix(self.spins),
        )

    def between(self, begin: float | None = None, end: float | None = None) -> "Keyframes":
        """Those from `begin` to `end` in s, by default the first and the last.

        Raises
        ------
        ValueError
            If the range is empty or reaches outside the data.
        """
        first, last = float(self.times[0]), float(self.times[-1])
        begin, end = first if begin is None else begin, last if end is None else end
        for name, value in (("begin", begin), ("end", end)):
            if not first <= value <= last:
                raise ValueError(
                    f"{name} must lie within the data, from {first:g} to {last:g} s, got {value:g}"
                )
        if begin >= end:
            raise ValueError(f"begin must lie before end, got {begin:g} and {end:g}")
        inside = self.times[(self.times > begin) & (self.times < end)]
        cut = self.at(np.concatenate(([begin], inside, [end])))
        marks = tuple((name, time) for name, time in self.marks if begin <= time <= end)
        return replace(cut, marks=marks)


def keyframes(motion: StoredRun) -> Keyframes:
    """Keyframes of a motion, dense enough for interpolation.

    A trajectory may be sampled coarsely: its unwrapped angles and their rates tell how often the
    disk turned between two samples.

    Raises
    ------
    ValueError
        If the disk of a spatial motion turns by about half a turn between samples, or a
        trajectory needs more than `MOST_KEYFRAMES`.
    """
    return _from_spatial(motion) if isinstance(motion, SpatialMotion) else _from_angles(motion)


def _from_angles(trajectory: Trajectory) -> Keyframes:
    turns = np.sum(np.abs(np.diff(trajectory.coordinates[:, 3:], axis=0)), axis=1)
    parts = max(1, int(np.ceil(np.max(turns) / _TURN_BETWEEN)))
    samples = trajectory.times
    if parts * samples.size > MOST_KEYFRAMES:
        raise ValueError(
            f"the disk turns by {np.max(turns):.3g} rad between two samples, which would take "
            f"{parts * samples.size} keyframes; at most {MOST_KEYFRAMES} are made"
        )
    inner = samples[:-1, None] + np.diff(samples)[:, None] * np.arange(parts) / parts
    times = np.append(inner.ravel(), samples[-1])
    spline = CubicHermiteSpline(samples, trajectory.coordinates, trajectory.rates)
    coordinates, rates = spline(times), spline(times, 1)
    positions, rotations = frames.poses(coordinates)
    disk, contact = trajectory.scenario.disk, trajectory.scenario.contact
    half = 0.0 if contact is None else contact.half_thickness
    formulation = trajectory.method.get("formulation") or trajectory.method.get("form")
    inverted = trajectory.inversion_time
    marks = () if inverted is None else (("inversion", inverted),)
    return Keyframes(
        times=times,
        positions=positions,
        quaternions=frames.quaternions(rotations),
        contact_points=disk.lowest_points(positions, rotations, half)[:, :2],
        spins=frames.twists(coordinates, rates)[1][:, 2],
        disk=disk,
        marks=marks,
        source=f"{trajectory.source}, {trajectory.scenario.name}"
        + (f", {formulation}" if formulation else ""),
    )


def _from_spatial(motion: SpatialMotion) -> Keyframes:
    speed = np.linalg.norm(motion.angular_velocities, axis=1)
    turns = np.diff(motion.times) * np.maximum(speed[1:], speed[:-1])
    if np.max(turns) > _LARGEST_TURN:
        raise ValueError(
            f"the samples are too far apart to be animated: the disk turns by {np.max(turns):.2g} "
            f"rad between two of them at t = {motion.times[np.argmax(turns)]:g} s"
        )
    found = motion.phases
    starts = (
        (field.name.replace("_", " "), getattr(found, field.name)) for field in fields(found)
    )
    return Keyframes(
        times=motion.times,
        positions=motion.positions,
        quaternions=motion.quaternions,
        contact_points=motion.contact_points[:, :2],
        spins=motion.spin,
        disk=motion.scenario.disk,
        marks=tuple((name, time) for name, time in starts if time is not None),
        source=f"{motion.source}, on a unilateral contact",
    )
