"""In-house simulation: the index-1 systems and the reduced system, integrated with SciPy."""

from collections.abc import Callable
from dataclasses import dataclass
from math import sin
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from analysis import index1, reduced
from analysis.checks import Array, ToleranceError, choice, increasing_times, positive
from analysis.constraints import check_admissible
from analysis.disk import STEEL_DISK, Disk
from analysis.friction import SmoothCoulomb
from analysis.state import Level, State, consistent_start, multiplier_names, raise_flat
from analysis.trajectory import Setting, Trajectory, versions

Form = Literal["index-1", "reduced"]
FORMS: tuple[Form, ...] = get_args(Form)

Method = Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA"]
METHODS: tuple[Method, ...] = get_args(Method)

TIGHTEST_LOCAL_TOLERANCE = 3e-14
"""SciPy's solvers do not go below 100 machine precisions."""


@dataclass(frozen=True, slots=True)
class _Problem:
    """An initial value problem and the way back from its states to a trajectory."""

    right_hand_side: Callable[[float, Array], npt.ArrayLike]
    start: Array
    expand: Callable[[Array, Array], tuple[Array, Array]]
    angles: tuple[int, int]


def simulate(
    level: Level,
    times: npt.ArrayLike,
    *,
    disk: Disk = STEEL_DISK,
    friction: SmoothCoulomb | None = None,
    start: State | None = None,
    form: Form = "index-1",
    method: Method = "DOP853",
    tolerance: float | None = None,
    local_tolerance: float | None = None,
) -> Trajectory:
    """Simulate Model `level` with the in-house equations.

    Accuracy is asked for in one of two ways. With `tolerance`, the run is repeated with tighter
    local tolerances until two runs agree; the difference is returned as `error_estimate`. With
    `local_tolerance`, there is a single run without an estimate.

    Parameters
    ----------
    level : {1, 2, 3, 4}
        Model of Table 2.
    times : array_like, shape (n,)
        Strictly increasing times in s at which the motion is wanted; it starts at the first.
    disk : Disk
    friction : SmoothCoulomb, optional
        The paper's values by default.
    start : State, optional
        Must meet the constraints of the model; by default Table 3, made consistent.
    form : {"index-1", "reduced"}
        Index-1 system (80), (79) or (92), or the minimal coordinates (102) of Model 4.
    method : {"DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA"}
        SciPy method; Radau, BDF and LSODA are for stiff problems.
    tolerance : float, optional
        Largest error in beta and gamma in rad; 1e-8 if neither tolerance is given.
    local_tolerance : float, optional
        Relative tolerance of a single step; the absolute one is the same number in m and rad.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is out of range, or the start breaks a constraint.
    ToleranceError
        If `tolerance` cannot be met.
    ArithmeticError
        If the integration fails on the way.
    """
    times = increasing_times(times)
    friction = friction if friction is not None else SmoothCoulomb()
    start = start if start is not None else consistent_start(level, disk)
    choice("method", method, METHODS)
    check_admissible(level, disk, start)
    problem = _problem(level, disk, friction, start, choice("form", form, FORMS))
    if local_tolerance is not None:
        if tolerance is not None:
            raise ValueError("give either tolerance or local_tolerance, not both")
        local_tolerance = _check_local_tolerance("local_tolerance", local_tolerance)
        states, evaluations = _integrate(problem, times, method, local_tolerance)
        estimate = None
    else:
        tolerance = positive("tolerance", 1e-8 if tolerance is None else tolerance)
        states, evaluations, local_tolerance, estimate = _integrate_to(
            problem, times, method, tolerance
        )
    coordinates, rates = problem.expand(times, states)
    settings: dict[str, Setting] = {
        "form": form,
        "method": method,
        "tolerance": tolerance,
        "local_tolerance": local_tolerance,
    }
    return Trajectory(
        times=times,
        coordinates=coordinates,
        rates=rates,
        multipliers=_multipliers(level, disk, friction, coordinates, rates),
        level=level,
        disk=disk,
        friction=friction,
        source="in-house",
        method=settings,
        error_estimate=estimate,
        counts={"right_hand_sides": evaluations},
        versions=versions("numpy", "scipy"),
    )


def _problem(
    level: Level, disk: Disk, friction: SmoothCoulomb, start: State, form: Form
) -> _Problem:
    if form == "index-1":

        def full(_: float, state: Array) -> Array:
            values = state.tolist()
            z, u = values[:6], values[6:]
            acceleration, _multiplier = index1.accelerations(level, disk, friction, z, u)
            return np.concatenate((u, acceleration))

        def split(_: Array, states: Array) -> tuple[Array, Array]:
            return states[:, :6], states[:, 6:]

        return _Problem(full, start.vector, split, (4, 5))
    if level != 4:
        raise ValueError(f"form 'reduced' exists for Model 4 alone, got level {level}")
    if friction.load != "weight":
        raise ValueError(f"form 'reduced' takes the load 'weight' alone, got {friction.load!r}")
    spin, alpha = start.rates[3], start.coordinates[3]

    def minimal(_: float, state: Array) -> tuple[float, float, float]:
        return reduced.right_hand_side(disk, friction, spin, state.tolist())

    def expand(times: Array, states: Array) -> tuple[Array, Array]:
        return reduced.expand(disk, spin, alpha + spin * (times - times[0]), states)

    minimal_start = np.array((*start.coordinates[4:6], start.rates[4]))
    return _Problem(minimal, minimal_start, expand, (0, 1))


def _integrate(
    problem: _Problem, times: Array, method: Method, local_tolerance: float
) -> tuple[Array, int]:
    tilt = problem.angles[0]

    def flat(_: float, state: Array) -> float:
        return sin(state[tilt])

    # Beyond a flat disk the equations go on without meaning, and get stuck at the next one.
    flat.terminal = True  # type: ignore[attr-defined]
    result = solve_ivp(
        problem.right_hand_side,
        (times[0], times[-1]),
        problem.start,
        method=method,
        t_eval=times,
        rtol=local_tolerance,
        atol=local_tolerance,
        events=flat,
    )
    if result.status == 1:
        raise_flat(float(result.t_events[0][0]))
    if not result.success:
        reached = f"after t = {result.t[-1]:g} s" if result.t.size else "at the start"
        raise ArithmeticError(f"{method} stopped {reached}: {result.message}")
    return result.y.T, int(result.nfev)


def _integrate_to(
    problem: _Problem, times: Array, method: Method, tolerance: float
) -> tuple[Array, int, float, float]:
    """Tighten the local tolerance until two runs agree to `tolerance` in beta and gamma."""
    angles = list(problem.angles)
    # Two runs of nearly the same local tolerance would agree without being right.
    local = max(min(tolerance / 3.0, 1e-3), 10.0 * TIGHTEST_LOCAL_TOLERANCE)
    coarse, evaluations = _integrate(problem, times, method, _floor(local))
    difference = np.inf
    while local >= 3.0 * TIGHTEST_LOCAL_TOLERANCE:
        local /= 10.0
        fine, count = _integrate(problem, times, method, _floor(local))
        evaluations += count
        difference = float(np.max(np.abs(fine - coarse)[:, angles]))
        if difference <= tolerance:
            return fine, evaluations, _floor(local), difference
        coarse = fine
    raise ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {method}: the two tightest runs "
        f"differ by {difference:.1e} rad"
    )


def _floor(local_tolerance: float) -> float:
    return max(local_tolerance, TIGHTEST_LOCAL_TOLERANCE)


def _check_local_tolerance(name: str, value: float) -> float:
    value = positive(name, value)
    if not TIGHTEST_LOCAL_TOLERANCE <= value < 1.0:
        raise ValueError(f"{name} must lie in [{TIGHTEST_LOCAL_TOLERANCE:g}, 1), got {value:g}")
    return value


def _multipliers(
    level: Level, disk: Disk, friction: SmoothCoulomb, coordinates: Array, rates: Array
) -> Array:
    """Constraint forces at every sample, shape (n, k)."""
    result = np.empty((len(coordinates), len(multiplier_names(level))))
    pairs = zip(coordinates.tolist(), rates.tolist(), strict=True)
    for row, (z, u) in enumerate(pairs):
        result[row] = index1.accelerations(level, disk, friction, z, u)[1]
    return result
