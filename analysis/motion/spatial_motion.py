"""Motions through every attitude, flat ones too, and when each phase until rest began."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from analysis.motion import frames
from analysis.motion.frames import Flags, Poses
from analysis.motion.interpolation import interpolate, running_mean
from analysis.motion.quantities import filled, quantities
from analysis.motion.sampled import SampledMotion
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array, choice, instance, optional, positive, within
from analysis.problem.contact import CAUSES

ROLLING = 0.1
"""Rolling: the slip speed stays below this part of the contour speed."""

MEAN_TIME = 0.5
"""Time in s over which both speeds are averaged; nutation takes either to zero at instants."""

FLAT = 2.0
"""Flat: the tangent of the leaning is below so often half_thickness / radius, where the
spheroid's shape rules, or that at rest if it is larger."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phases:
    """Times in s at which the phases begin; None if one never does.

    The first two lie between samples, see `Inversion`; the others are those of samples.

    Parameters
    ----------
    inversion : float, optional
        The disk is inverted, as `Inversion` defines it.
    inversion_lost : float, optional
        Its centre of gravity comes below the geometric centre again.
    rolling : float, optional
        From here until flat, the mean slip speed over half a second is below a tenth of the mean
        contour speed.
    flat : float, optional
        From here on the tangent of the disk's leaning is below 2 half_thickness / radius, or
        twice that at rest, which is larger if the centre of gravity lies near the edge. One that
        rests leaning by pi/4 or more, such as a sphere, is never flat.
    rest : float, optional
        From here on it is at rest.
    """

    inversion: float | None
    inversion_lost: float | None
    rolling: float | None
    flat: float | None
    rest: float | None


def _from_here_on(times: Array, condition: Flags) -> float | None:
    """First time from which on the condition holds to the end."""
    if not condition[-1]:
        return None
    broken = np.flatnonzero(~condition)
    return float(times[broken[-1] + 1 if broken.size else 0])


_WITH_POSE = (
    *("times", "positions", "quaternions", "velocities", "angular_velocities"),
    "contact_points",
)

SAME_TIME = 1e-12
"""In s; times of one sample differ by rounding."""


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
    rest_time: float | None = None

    def __post_init__(self) -> None:
        self._check()
        excess = float(np.max(np.abs(np.linalg.norm(self.quaternions, axis=1) - 1.0)))
        if excess > 1e-9:
            raise ValueError(f"quaternions must have unit length, got one off by {excess:.1e}")
        rest = optional(within, "rest_time", self.rest_time, *self.times[[0, -1]].tolist())
        object.__setattr__(self, "rest_time", rest)

    @property
    def rotations(self) -> Array:
        """Rotation matrices A_IB, shape (n, 3, 3)."""
        return frames.rotations(self.quaternions)

    @property
    def poses(self) -> Poses:
        """Pose and twist at every sample."""
        return Poses(self.positions, self.rotations, self.velocities, self.angular_velocities)

    @property
    def phases(self) -> Phases:
        """When each phase of the motion until rest begins."""
        times, leaning, inversion = self.times, self.leaning, self.inversion
        contact, disk = self.scenario.penalty_contact, self.scenario.disk
        lean, limit = contact.resting_lean(disk), 0.0
        if lean < np.pi / 4:
            limit = FLAT * max(contact.half_thickness / disk.radius, np.tan(lean))
        flat = _from_here_on(times, np.tan(leaning) < limit)
        upto = times <= (np.inf if flat is None else flat)
        speeds = self.slip_speeds, self.contour_speeds
        slip, contour = (running_mean(times, each, MEAN_TIME) for each in speeds)
        return Phases(
            inversion=inversion.time,
            inversion_lost=inversion.lost,
            rolling=_from_here_on(times[upto], (slip < ROLLING * contour)[upto]),
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
        return total - total[0]

    @property
    def starting_energy(self) -> float:
        """Energy at the start in J, that of gravity by the height above the table alone.

        On a table that leans, the place has an energy of its own, of any size.
        """
        kinetic, _, elastic = self.energies[0].tolist()
        return float(kinetic + self.scenario.weight * self.cog_height[0] + elastic)

    def deviation(self, other: "SpatialMotion") -> float:
        """Largest difference from another motion over the samples that both have.

        It is that of the vertical's direction seen from the disk in rad, which beta and gamma
        make up, or that of an energy as a part of `starting_energy`, whichever is larger: of all
        the energy left, and of that taken by any cause.

        Parameters
        ----------
        other : SpatialMotion
            Sampled at the same times, but for the endings.

        Raises
        ------
        ValueError
            If it is sampled at other times.
        """
        instance("other", other, SpatialMotion)
        shorter = min(self.times.size, other.times.size)
        apart = np.abs(self.times[:shorter] - other.times[:shorter]) > SAME_TIME
        count = int(np.argmax(apart)) if apart.any() else shorter
        if count < max(1, shorter - 1):
            raise ValueError(
                "other must be sampled at the same times, "
                f"got t = {other.times[count]:.6g} s for {self.times[count]:.6g} s"
            )
        one, two = (
            np.column_stack(
                (
                    motion.rotations[:count, 2] * motion.starting_energy,
                    motion.energies[:count].sum(axis=1),
                    motion.dissipated[:count],
                )
            )
            for motion in (self, other)
        )
        difference = np.abs(one - two)
        turned = np.linalg.norm(difference[:, :3], axis=1)
        largest = max(float(np.max(turned)), float(np.max(difference[:, 3:])))
        return largest / self.starting_energy

    def _between(self, wanted: Array) -> tuple[dict[str, Any], Array, Array]:
        values = np.column_stack((self.positions, self.quaternions))
        turning = frames.quaternion_rates(self.quaternions, self.angular_velocities)
        rates = np.column_stack((self.velocities, turning))
        values, rates, error = interpolate(self.times, values, rates, wanted)
        # A quaternion off by d turns the disk by 2 d.
        turned: Array = 2.0 * np.linalg.norm(error[:, 3:], axis=1)
        length = np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
        quaternion = values[:, 3:] / length
        found = {
            "positions": values[:, :3],
            "contact_points": self._touching(values[:, :3], frames.rotations(quaternion)),
            "quaternions": quaternion,
            "velocities": rates[:, :3],
            "angular_velocities": frames.angular_velocities(quaternion, rates[:, 3:] / length),
        }
        return found, turned, error[:, :3]

    def _beside(self, wanted: Array) -> dict[str, Any]:
        rest = self.rest_time
        within = rest is not None and wanted[0] <= rest <= wanted[-1]
        found: dict[str, Any] = {"rest_time": rest if within else None}
        for name in filled(SpatialMotion):
            if name not in _WITH_POSE:
                # Impacts make these jump.
                found[name] = np.apply_along_axis(
                    lambda values: np.interp(wanted, self.times, values), 0, getattr(self, name)
                )
        return found

    @staticmethod
    def _state_of(arrays: Mapping[str, Array]) -> tuple[Array, Array]:
        return frames.from_poses(
            arrays["positions"],
            frames.rotations(arrays["quaternions"]),
            arrays["velocities"],
            arrays["angular_velocities"],
        )

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
            How close to flat in rad the disk may come, positive; Euler angles end there.

        Raises
        ------
        ValueError
            If fewer than two samples lie before `end`, or the disk comes too close to flat, or
            so close between two samples that alpha and gamma may turn unseen.
        """
        least_leaning = positive("least_leaning", least_leaning)
        end = within("end", self.times[-1] if end is None else end, float(self.times[1]))
        count = int(np.searchsorted(self.times, end, side="right"))
        leaning = self.leaning[:count]
        if np.any(leaning < least_leaning):
            first = self.times[np.argmax(leaning < least_leaning)]
            raise ValueError(
                f"end must lie before the disk lies flat (leaning below {least_leaning:g} rad) "
                f"at t = {first:g} s"
            )
        coordinates, rates = frames.from_poses(*(each[:count] for each in self.poses))
        unseen = frames.follow_turns(self.times[:count], coordinates, rates, self.scenario.fall)
        if np.any(unseen):
            raise ValueError(
                "end must lie before alpha and gamma may turn unseen between two samples, after "
                f"t = {self.times[np.argmax(unseen)]:g} s; closer ones tell how far"
            )
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


MOTION_COLUMNS = sum(len(quantities(SpatialMotion)[name]) for name in filled(SpatialMotion))
"""Numbers in each sample, the time included."""
