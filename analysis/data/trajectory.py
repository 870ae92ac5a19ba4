"""Trajectories: what every simulation of the study returns, whoever made it."""

import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from analysis.data import frames
from analysis.data.checks import (
    Array,
    choice,
    increasing_times,
    not_negative,
    number,
    real_array,
    settings,
)
from analysis.data.constraint_set import multiplier_names
from analysis.data.dense import interpolate, interpolate_values
from analysis.data.endings import Ending
from analysis.data.files import whole_file
from analysis.data.inversion import direction_rates
from analysis.data.sampled import SampledMotion, stored_meta
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES, State

Source = Literal["engine", "in-house"]
SOURCES: tuple[Source, ...] = get_args(Source)
Setting = str | float | int | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Trajectory(SampledMotion):
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
    STORED_AS: ClassVar[str] = "trajectory"
    STORED_ARRAYS: ClassVar[tuple[str, ...]] = (
        "t", "q", "u", "normal_force", "multipliers", "meta",
    )  # fmt: skip

    times: Array
    coordinates: Array
    rates: Array
    multipliers: Array
    scenario: Scenario
    source: Source
    method: Mapping[str, Setting]
    error_estimate: float | None = None
    counts: Mapping[str, int] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    ending: Ending | None = None
    pulling: tuple[tuple[float, float], ...] = ()
    solver_seconds: float | None = None

    def __post_init__(self) -> None:
        choice("source", self.source, SOURCES)
        times = increasing_times(self.times)
        times.setflags(write=False)
        object.__setattr__(self, "times", times)
        shapes = {
            "coordinates": (times.size, 6),
            "rates": (times.size, 6),
            "multipliers": (times.size, len(multiplier_names(self.scenario.constraints))),
        }
        for name, shape in shapes.items():
            values = real_array(name, getattr(self, name))
            if values.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {values.shape}")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        for name in ("method", "counts", "versions"):
            object.__setattr__(self, name, settings(name, getattr(self, name)))
        if self.error_estimate is not None:
            estimate = not_negative("error_estimate", self.error_estimate)
            object.__setattr__(self, "error_estimate", estimate)
        for interval in self.pulling:
            first, last = (number("pulling", time) for time in interval)
            if first > last:
                raise ValueError(f"pulling must hold rising times, got {first:g} before {last:g}")

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

    @property
    def normal_force(self) -> Array:
        """Normal contact force lambda_N over time in N, shape (n,)."""
        return self.multipliers[:, 0]

    @property
    def cog_direction(self) -> Array:
        """Height of the centre of gravity above G over the eccentricity, -1 to 1, shape (n,)."""
        result: Array = np.sin(self.coordinate("beta")) * np.sin(self.coordinate("gamma"))
        return result

    @property
    def cog_direction_rate(self) -> Array:
        """Rate of `cog_direction` in 1/s, shape (n,)."""
        return direction_rates(self.coordinates, self.rates)

    @property
    def cog_height(self) -> Array:
        """Height of the centre of gravity over the table in m, shape (n,)."""
        result: Array = self.coordinate("z") + self.scenario.disk.eccentricity * self.cog_direction
        return result

    @property
    def contact_points(self) -> Array:
        """Lowest point of the disk, inertial, in m, shape (n, 3)."""
        contact = self.scenario.contact
        half = 0.0 if contact is None else contact.half_thickness
        return self.scenario.disk.lowest_points(*frames.poses(self.coordinates), half)

    def state(self, index: int) -> State:
        """State at one sample."""
        return State(
            coordinates=tuple(self.coordinates[index].tolist()),
            rates=tuple(self.rates[index].tolist()),
        )

    def _arrays_at(self, wanted: Array, tolerance: float | None) -> tuple[dict[str, Any], float]:
        coordinates, rates, error = self._between(wanted, tolerance)
        multipliers = interpolate_values(self.times, self.multipliers, wanted)
        return {"coordinates": coordinates, "rates": rates, "multipliers": multipliers}, error

    def _between(self, wanted: Array, tolerance: float | None) -> tuple[Array, Array, float]:
        coordinates, rates, error = interpolate(self.times, self.coordinates, self.rates, wanted)
        worst = self._check_between(wanted, np.max(error[:, 4:], axis=1), tolerance)
        return coordinates, rates, worst

    def columns(self) -> dict[str, tuple[Array, str]]:
        """Every sampled quantity by name: its values, shape (n,), and its unit."""
        lengths = dict.fromkeys(COORDINATES, "rad") | dict.fromkeys("xyz", "m")
        found = {"time": (self.times, "s")}
        found |= {name: (self.coordinate(name), lengths[name]) for name in COORDINATES}
        found |= {f"{name}_rate": (self.rate(name), f"{lengths[name]}/s") for name in COORDINATES}
        for name in multiplier_names(self.scenario.constraints):
            found[name] = (self.multiplier(name), "N m" if name == "spin_torque" else "N")
        found["cog_height"] = (self.cog_height, "m")
        for axis, values in zip("xyz", self.contact_points.T, strict=True):
            found[f"contact_{axis}"] = (values, "m")
        return found

    def _state(self, wanted: Array, tolerance: float | None) -> tuple[Array, Array]:
        coordinates, rates, _ = self._between(wanted, tolerance)
        return coordinates, rates

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the trajectory to an `.npz` file, whole or not at all, without pickle.

        The file holds `t` (n,), `q` and `u` (n, 6), `normal_force` (n,), `multipliers` (n, k)
        and `meta`, a JSON string with everything else.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        with whole_file(path) as stream:
            np.savez(
                stream,
                t=self.times,
                q=self.coordinates,
                u=self.rates,
                normal_force=self.normal_force,
                multipliers=self.multipliers,
                meta=np.array(self._meta(pulling=self.pulling)),
            )

    @classmethod
    def from_arrays(cls, stored: Mapping[str, Any]) -> "Trajectory":
        """Trajectory from the arrays of a file; `load_run` reads one."""
        meta = stored_meta(stored["meta"], "pulling")
        force, multipliers = stored["normal_force"], stored["multipliers"]
        if not np.array_equal(force, multipliers[..., 0]):
            raise ValueError(
                f"normal_force must be the first of the multipliers, shape {multipliers.shape}, "
                f"got shape {force.shape}"
            )
        return cls(
            times=stored["t"],
            coordinates=stored["q"],
            rates=stored["u"],
            multipliers=multipliers,
            pulling=tuple((first, last) for first, last in meta.pop("pulling")),
            **meta,
        )


def versions(*packages: str) -> dict[str, str]:
    """Versions of Python and of these packages."""
    return {"python": _python_version()} | {name: _version(name) for name in packages}


# Reading one takes as long as the shortest runs.
_version = cache(version)
_python_version = cache(platform.python_version)


def _column(name: str) -> int:
    return COORDINATES.index(choice("coordinate", name, COORDINATES))
