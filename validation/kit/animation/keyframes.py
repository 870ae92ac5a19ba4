"""Poses of the disk over time, as an animation needs them, from either kind of stored motion."""

from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analysis import SpatialMotion, StoredRun, Trajectory
from analysis.data import frames
from analysis.data.body import Body
from analysis.data.checks import Array, within
from analysis.data.limits import MOST_KEYFRAMES
from analysis.data.names import ArgumentError

_TURN_BETWEEN = 0.25
"""Angle in rad the disk may turn between keyframes taken from co-rotating coordinates."""

_ATTITUDE = slice(3, 7)

_LARGEST_TURN = 0.9 * np.pi
"""Beyond this angle in rad between samples, a quaternion no longer tells the way round."""


COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz", "contactX", "contactY", "spin")
"""Of `Keyframes.table`, as the player calls them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Keyframes:
    """Poses of the disk at some times; between them, `at` interpolates.

    Parameters
    ----------
    times : ndarray, shape (n,)
        In s, strictly increasing.
    table : ndarray, shape (n, 10)
        Position of the geometric centre G in m, inertial; attitude of the body frame as a
        quaternion of unit length, scalar part first, of the sign that is nearer to the one
        before; where the disk touches the table in m; vertical angular velocity in rad/s, which
        unlike the rate of alpha exists in every attitude.
    disk : Body
    marks : sequence of (str, float)
        Names of phases and the times in s at which they begin.
    source : str
        Who simulated what, in a few words.
    """

    times: Array
    table: Array
    disk: Body
    marks: tuple[tuple[str, float], ...]
    source: str

    @property
    def positions(self) -> Array:
        """Of the geometric centre in m, shape (n, 3)."""
        return self.table[:, :3]

    @property
    def contact_points(self) -> Array:
        """In m, shape (n, 2)."""
        return self.table[:, 7:9]

    @property
    def spins(self) -> Array:
        """Vertical angular velocity in rad/s, shape (n,)."""
        return self.table[:, 9]

    @property
    def rotations(self) -> Array:
        """Rotation matrices, whose columns are the body axes, shape (n, 3, 3)."""
        return frames.rotations(self.table[:, _ATTITUDE])

    @property
    def cog_height(self) -> Array:
        """Height of the centre of gravity in m, shape (n,)."""
        result: Array = self.positions[:, 2] + self.disk.eccentricity * self.rotations[:, 2, 0]
        return result

    def at(self, times: Array) -> "Keyframes":
        """Keyframes at other times within the range, shape (m,).

        Linear in all values, with quaternions brought back to unit length, as in the player.
        """
        row = np.clip(np.searchsorted(self.times, times, "right") - 1, 0, self.times.size - 2)
        begin, end = self.times[row], self.times[row + 1]
        part = ((times - begin) / (end - begin))[:, None]
        table = self.table[row] + part * (self.table[row + 1] - self.table[row])
        table[:, _ATTITUDE] /= np.linalg.norm(table[:, _ATTITUDE], axis=1)[:, None]
        return replace(self, times=times, table=table)

    def between(self, begin: float | None = None, end: float | None = None) -> "Keyframes":
        """Those from `begin` to `end` in s, by default the first and the last.

        Raises
        ------
        ValueError
            If the range is empty or reaches outside the data.
        """
        first, last = float(self.times[0]), float(self.times[-1])
        begin = first if begin is None else within("begin", begin, first, last)
        end = last if end is None else within("end", end, first, last)
        if begin >= end:
            raise ArgumentError("begin", f"must lie before {end:g}, got {begin:g}")
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
    if isinstance(motion, SpatialMotion):
        _check_turns(motion)
        found, told = motion.phases, "on a unilateral contact"
        starts = {each.name.replace("_", " "): getattr(found, each.name) for each in fields(found)}
    else:
        form = motion.method.get("formulation") or motion.method.get("form")
        told = f"{motion.scenario.name}, {form}" if form else motion.scenario.name
        starts = {"inversion": motion.inversion_time}
        motion = _dense(motion)
    positions, rotations, _, angular_velocities = motion.poses
    contact, spins = motion.contact_points[:, :2], angular_velocities[:, 2]
    return Keyframes(
        times=motion.times,
        table=np.column_stack((positions, _continuous(rotations), contact, spins)),
        disk=motion.scenario.disk,
        marks=tuple((name, time) for name, time in starts.items() if time is not None),
        source=f"{motion.source}, {told}",
    )


def _dense(trajectory: Trajectory) -> Trajectory:
    """Trajectory whose angles change little from sample to sample; its forces are left out."""
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
    forces = np.zeros((times.size, trajectory.multipliers.shape[1]))
    made = {"coordinates": spline(times), "rates": spline(times, 1), "multipliers": forces}
    return replace(trajectory, times=times, **made)


def _check_turns(motion: SpatialMotion) -> None:
    speed = np.linalg.norm(motion.angular_velocities, axis=1)
    turns = np.diff(motion.times) * np.maximum(speed[1:], speed[:-1])
    if np.max(turns) > _LARGEST_TURN:
        raise ValueError(
            f"the samples are too far apart to be animated: the disk turns by {np.max(turns):.2g} "
            f"rad between two of them at t = {motion.times[np.argmax(turns)]:g} s"
        )


def _continuous(rotations: Array) -> Array:
    """Quaternions, each of the sign nearer to the one before, shape (n, 4)."""
    quaternions = frames.quaternions(rotations)
    turned = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0
    signs = np.cumprod(np.append(1.0, np.where(turned, -1.0, 1.0)))
    result: Array = signs[:, None] * quaternions
    return result
