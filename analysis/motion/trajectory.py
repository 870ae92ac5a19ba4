"""Trajectories: what every simulation returns, whoever made it."""

import platform
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from typing import Any, ClassVar

import numpy as np

from analysis.motion.frames import from_cog
from analysis.motion.interpolation import interpolate
from analysis.motion.quantities import InCoordinates
from analysis.motion.sampled import SampledMotion, Setting
from analysis.problem.checks import Array, choice, not_negative, optional, real_array, whole
from analysis.problem.constraints import multiplier_names
from analysis.problem.names import ArgumentError
from analysis.problem.start import COORDINATES, State


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Trajectory(InCoordinates, SampledMotion):
    """A motion of the disk, sampled in time, and what produced it.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Strictly increasing times in s.
    coordinates, rates : ndarray, shape (n, 6)
        Co-rotating coordinates, Eq. (8), in m and rad, and their time derivatives; alpha and
        gamma are unwrapped.
    multipliers : ndarray, shape (n, k)
        Constraint forces in the order of `multiplier_names(scenario.constraints)`, in N and N m.
    scenario : Scenario
        What was simulated.
    source : {"engine", "in-house"}
    method : mapping
        Formulation, integrator, step, tolerances: whatever is needed to run it again.
    error_estimate : float, optional
        Largest error expected in beta and gamma in rad; None if it was not estimated.
    counts : mapping
        Work done, such as right-hand-side evaluations or steps.
    versions : mapping
        Versions of the software that made it.
    ending : Ending, optional
        Why it ends before the last time asked for, if it does.
    pulling : tuple of pairs of floats
        Times in s between which an ideal contact pulls, if it was let.
    solver_seconds : float, optional
        Processor time in s of the integration that it comes from, without the preparations and
        the runs to a tolerance before it; None for one from a file.

    Raises
    ------
    ValueError
        If shapes do not fit or a number is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, simulate
    >>> run = simulate(Scenario(), np.linspace(0.0, 1.0, 201))
    >>> bool(run.cog_height.max() > run.scenario.disk.radius)
    True
    >>> round(run.at(0.5023).coordinates[4], 6)
    1.761266
    >>> run.to_dict()["normal_force"].shape
    (201,)
    """

    ERROR_UNIT: ClassVar[str] = " rad"

    coordinates: Array
    rates: Array
    multipliers: Array
    method: Mapping[str, Setting]
    pulling: tuple[tuple[float, float], ...] = ()
    solver_seconds: float | None = None

    def __post_init__(self) -> None:
        self._check()
        pulling = real_array("pulling", self.pulling)
        if pulling.size and pulling.shape[1:] != (2,):
            fault = f"must hold first and last times, got {self.pulling!r}"
            raise ArgumentError("pulling", fault)
        for first, last in pulling:
            if first > last:
                raise ValueError(f"pulling must hold rising times, got {first:g} before {last:g}")
        object.__setattr__(self, "pulling", tuple(map(tuple, pulling.tolist())))
        optional(not_negative, "solver_seconds", self.solver_seconds)

    def coordinate(self, name: str) -> Array:
        """Coordinate of this name (one of `COORDINATES`) over time, shape (n,)."""
        return self.coordinates[:, _column(name)]

    def rate(self, name: str) -> Array:
        """Rate of the coordinate of this name (one of `COORDINATES`) over time, shape (n,)."""
        return self.rates[:, _column(name)]

    def multiplier(self, name: str) -> Array:
        """Constraint force of this name over time, shape (n,).

        Raises
        ------
        ValueError
            If the scenario has no such constraint.
        """
        names = multiplier_names(self.scenario.constraints)
        return self.multipliers[:, names.index(choice("multiplier", name, names))]

    def state(self, index: int) -> State:
        """State at one sample, counted from the start or, negative, from the end."""
        size = self.times.size
        index = whole("index", index, -size, size - 1)
        return State(coordinates=tuple(self.coordinates[index]), rates=tuple(self.rates[index]))

    def _between(self, wanted: Array) -> tuple[dict[str, Any], Array, Array]:
        # The frame of the coordinates turns, however steady the motion is; that of this does not.
        values = np.column_stack((self.cog_positions, self.coordinates[:, 3:]))
        slopes = np.column_stack((self.cog_velocities, self.rates[:, 3:]))
        values, slopes, error = interpolate(self.times, values, slopes, wanted)
        coordinates, rates = from_cog(values, slopes, self.scenario.disk.eccentricity)
        found = {"coordinates": coordinates, "rates": rates}
        return found, error[:, 4:].max(axis=1), error[:, :3]

    def _beside(self, wanted: Array) -> dict[str, Any]:
        order: Any = min(2, self.times.size - 1)
        slopes = np.gradient(self.multipliers, self.times, axis=0, edge_order=order)
        multipliers, *_ = interpolate(self.times, self.multipliers, slopes, wanted, nodes=2)
        first, last = wanted[[0, -1]].tolist()
        pulling = (
            (max(since, first), min(until, last))
            for since, until in self.pulling
            if since < last and until > first
        )
        return {"multipliers": multipliers, "pulling": tuple(pulling)}

    @staticmethod
    def _state_of(arrays: Mapping[str, Array]) -> tuple[Array, Array]:
        return arrays["coordinates"], arrays["rates"]


def versions(*packages: str) -> dict[str, str]:
    """Versions of Python and of these packages."""
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


# Reading one takes as long as the shortest runs.
_version = cache(version)


def _column(name: str) -> int:
    return COORDINATES.index(choice("coordinate", name, COORDINATES))
