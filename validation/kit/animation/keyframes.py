"""Poses of the disk over time, as an animation needs them, from either kind of stored motion."""

from dataclasses import asdict, dataclass, replace

import numpy as np

from analysis import SpatialMotion, StoredRun, Trajectory
from analysis.motion import frames
from analysis.problem.body import Body
from analysis.problem.checks import Array, ToleranceError, within
from analysis.problem.limits import MOST_KEYFRAMES
from analysis.problem.names import ArgumentError

_TURN_BETWEEN = 0.2
"""Angle in rad the disk may turn between keyframes."""

_COARSEST = {Trajectory: 1e3, SpatialMotion: 3.0}
"""Error in rad that interpolation between samples may have, by an estimate ten times too large.

The angles of a trajectory tell how often the disk turns between two samples, quaternions do not.
"""

_ATTITUDE = slice(3, 7)

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
    def rotations(self) -> Array:
        """Rotation matrices, whose columns are the body axes, shape (n, 3, 3)."""
        return frames.rotations(self.table[:, _ATTITUDE])

    def at(self, times: Array) -> "Keyframes":
        """Keyframes at other times within the range, shape (m,).

        Linear in all values, with quaternions brought back to unit length, as in the player.
        """
        table = np.column_stack([np.interp(times, self.times, each) for each in self.table.T])
        table[:, _ATTITUDE] /= np.linalg.norm(table[:, _ATTITUDE], axis=1)[:, None]
        return replace(self, times=times, table=table)


def keyframes(
    motion: StoredRun, begin: float | None = None, end: float | None = None
) -> Keyframes:
    """Keyframes of a motion, dense enough for interpolation.

    Parameters
    ----------
    motion : Trajectory or SpatialMotion
        It may be sampled coarsely, as `resampled` interpolates it.
    begin, end : float, optional
        Part of it in s, by default all.

    Raises
    ------
    ValueError
        If the part is empty or reaches outside the motion, its samples are too far apart to tell
        the motion between them, or it needs more than `MOST_KEYFRAMES`.
    """
    first, last = motion.times[[0, -1]].tolist()
    begin = first if begin is None else within("begin", begin, first, last)
    end = last if end is None else within("end", end, first, last)
    if begin >= end:
        raise ArgumentError("begin", f"must lie before {end:g}, got {begin:g}")
    if isinstance(motion, SpatialMotion):
        phases, model = asdict(motion.phases), "on a unilateral contact"
        starts = {name.replace("_", " "): time for name, time in phases.items()}
    else:
        formulation = motion.method.get("formulation")
        model = f"{motion.scenario.name}, {formulation}" if formulation else motion.scenario.name
        starts = {"inversion": motion.inversion_time}
    marks = [(name, time) for name, time in starts.items() if time is not None]
    inside = motion.times[(motion.times > begin) & (motion.times < end)]
    times = _dense(motion, np.concatenate(([begin], inside, [end])))
    try:
        motion = motion.resampled(times, tolerance=_COARSEST[type(motion)])
    except ToleranceError as error:
        raise ValueError(f"the motion cannot be animated: {error}") from None
    positions, rotations, _, angular_velocities = motion.poses
    contact, spins = motion.contact_points[:, :2], angular_velocities[:, 2]
    return Keyframes(
        times=times,
        table=np.column_stack((positions, frames.quaternions(rotations), contact, spins)),
        disk=motion.scenario.disk,
        marks=tuple(mark for mark in marks if begin <= mark[1] <= end),
        source=f"{motion.source}, {model}",
    )


def _dense(motion: StoredRun, times: Array) -> Array:
    """Times with as many others between them as the fastest turning or rolling needs."""
    angles = np.max(np.diff(times)) * np.abs(motion.poses.angular_velocities)
    ways = np.abs(np.diff(motion.contact_points, axis=0)) / motion.scenario.disk.radius
    turn = max(float(np.max(angles)), float(np.max(ways)))
    if not turn / _TURN_BETWEEN * times.size < MOST_KEYFRAMES:
        raise ValueError(
            f"the disk turns by {turn:.3g} rad between two samples, which would take more than "
            f"{MOST_KEYFRAMES} keyframes"
        )
    parts = max(1, int(np.ceil(turn / _TURN_BETWEEN)))
    rows = np.arange(parts * (times.size - 1) + 1)
    return np.interp(rows / parts, np.arange(times.size), times)
