"""Engine against in-house equations: accelerations, trajectories, multipliers."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import log2

import numpy as np

import analysis
import mbs_models
from analysis import COORDINATES, STEEL_DISK, Level, Load, SmoothCoulomb, State, Trajectory
from analysis.models import index1
from mbs_models import Formulation, Scene
from validation.kit.tables import Table

ACCELERATION_LIMIT = 1e-8
"""Largest relative difference of accelerations that passes."""

ANGLE_LIMIT = 1e-7
"""Largest difference of beta and gamma in rad that passes."""

REFERENCE_TOLERANCE = 0.01 * ANGLE_LIMIT
"""Tolerance of the in-house runs in rad: two digits better than what is compared with them."""

TABLE_3_TIMES = np.linspace(0.0, 2.0, 201)
"""Times of the comparison from the start of Table 3 in s."""

Case = tuple[Level, Formulation, Load]


def cases() -> list[Case]:
    """Every level, formulation and load law that can be combined."""
    return [
        (level, formulation, load)
        for load in analysis.LOADS
        for level in analysis.LEVELS
        for formulation in mbs_models.formulations(level)
        if not (formulation == "contact-tree" and load == "contact")
    ]


def random_state(level: Level, rng: np.random.Generator) -> State:
    """State that meets the constraints of Model `level` and is random in all else."""
    gamma_rate = rng.uniform(-60.0, 60.0) if level <= 2 else None
    state = analysis.consistent_start(
        level,
        STEEL_DISK,
        beta=rng.uniform(0.2, np.pi - 0.2),
        gamma=rng.uniform(-np.pi, np.pi),
        spin=rng.uniform(-60.0, 60.0),
        beta_rate=rng.uniform(-20.0, 20.0),
        gamma_rate=gamma_rate,
    )
    coordinates, rates = list(state.coordinates), list(state.rates)
    coordinates[COORDINATES.index("alpha")] = rng.uniform(-np.pi, np.pi)
    if level == 1:
        coordinates[:2] = rng.uniform(-0.05, 0.05, 2)
        rates[:2] = rng.uniform(-1.0, 1.0, 2)
    return State(coordinates=tuple(coordinates), rates=tuple(rates))


@dataclass(frozen=True, slots=True, kw_only=True)
class AccelerationCheck:
    """Largest relative differences of accelerations and multipliers over random states."""

    case: Case
    states: int
    accelerations: float
    multipliers: float

    @property
    def passed(self) -> bool:
        """Whether both stay below `ACCELERATION_LIMIT`."""
        return max(self.accelerations, self.multipliers) <= ACCELERATION_LIMIT


def check_accelerations(case: Case, states: int = 1000, seed: int = 1) -> AccelerationCheck:
    """Compare engine and index-1 accelerations at random admissible states.

    Parameters
    ----------
    case : tuple
        Level, formulation and load law.
    states : int
        Number of states.
    seed : int
        Seed of the random states.
    """
    level, formulation, load = case
    friction = SmoothCoulomb(load=load)
    rng = np.random.default_rng(seed)
    worst = np.zeros(2)
    for _ in range(states):
        state = random_state(level, rng)
        scene = Scene(level=level, formulation=formulation, friction=friction, start=state)
        engine = mbs_models.acceleration(scene)
        inhouse = index1.accelerations(level, scene.disk, friction, state.coordinates, state.rates)
        # A random normal force may vanish, so multipliers are measured by the weight as well.
        scales = (np.max(np.abs(inhouse[0])), max(scene.disk.weight, *np.abs(inhouse[1])))
        differences = [
            np.max(np.abs(a - b)) / scale
            for a, b, scale in zip(engine, inhouse, scales, strict=True)
        ]
        worst = np.maximum(worst, differences)
    return AccelerationCheck(
        case=case, states=states, accelerations=float(worst[0]), multipliers=float(worst[1])
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class TrajectoryCheck:
    """Difference of an engine run from the in-house one, from Table 3 over 2 s.

    `angles` in rad, `normal_force` in N; `estimate` is the engine run's own error estimate, and
    `order` the observed order of two fixed-step runs beside the `expected` one.
    """

    case: Case
    integrator: str
    angles: float
    estimate: float
    normal_force: float
    order: float
    expected: int
    seconds: float

    @property
    def passed(self) -> bool:
        """Whether the angles agree to `ANGLE_LIMIT`."""
        return self.angles <= ANGLE_LIMIT


@cache
def reference(level: Level, load: Load) -> Trajectory:
    """In-house run from Table 3 over 2 s, two digits better than what is compared with it."""
    return analysis.simulate(
        level, TABLE_3_TIMES, friction=SmoothCoulomb(load=load), tolerance=REFERENCE_TOLERANCE
    )


def angle_error(trajectory: Trajectory, other: Trajectory) -> float:
    """Largest difference of beta and gamma in rad."""
    return float(np.max(np.abs(trajectory.coordinates - other.coordinates)[:, 4:6]))


def check_trajectory(case: Case) -> TrajectoryCheck:
    """Compare a tolerance-controlled engine run and two fixed-step runs with the in-house run."""
    level, formulation, load = case
    inhouse = reference(level, load)
    scene = Scene(level=level, formulation=formulation, friction=SmoothCoulomb(load=load))
    begin = time.perf_counter()
    engine = mbs_models.simulate(scene, TABLE_3_TIMES, tolerance=ANGLE_LIMIT)
    seconds = time.perf_counter() - begin
    explicit = formulation == "contact-tree"
    step = 5e-3 if explicit else 1.25e-3
    errors = [
        angle_error(mbs_models.simulate(scene, TABLE_3_TIMES, step=size), inhouse)
        for size in (step, step / 2)
    ]
    return TrajectoryCheck(
        case=case,
        integrator=str(engine.method["integrator"]),
        angles=angle_error(engine, inhouse),
        estimate=float(engine.error_estimate or np.nan),
        normal_force=float(np.max(np.abs(engine.normal_force - inhouse.normal_force))),
        order=log2(errors[0] / errors[1]),
        expected=6 if explicit else 2,
        seconds=seconds,
    )


def acceleration_table(checks: Sequence[AccelerationCheck]) -> Table:
    """Table of acceleration checks."""
    return Table(
        name="accelerations",
        title="Accelerations and multipliers at random admissible states",
        columns=(
            "model",
            "formulation",
            "load",
            "states",
            "max relative difference of accelerations",
            "of multipliers",
            f"at most {ACCELERATION_LIMIT:g}",
        ),
        rows=[
            [
                *check.case,
                check.states,
                check.accelerations,
                check.multipliers,
                check.passed,
            ]
            for check in checks
        ],
    )


def trajectory_table(checks: Sequence[TrajectoryCheck]) -> Table:
    """Table of trajectory checks."""
    return Table(
        name="trajectories",
        title="Trajectories from Table 3 over 2 s",
        columns=(
            "model",
            "formulation",
            "load",
            "integrator",
            "max difference of β, γ in rad",
            "engine's error estimate in rad",
            "max difference of normal force in N",
            "observed order",
            "expected order",
            "run time in s",
            f"at most {ANGLE_LIMIT:g} rad",
        ),
        rows=[
            [
                *check.case,
                check.integrator,
                check.angles,
                check.estimate,
                check.normal_force,
                round(check.order, 2),
                check.expected,
                round(check.seconds, 3),
                check.passed,
            ]
            for check in checks
        ],
        note="Run time: one tolerance-controlled run with all its halvings, while both cores were "
        "busy. The contact tree is integrated with a Runge-Kutta method of order 6, the others "
        "with the trapezoidal rule.",
    )
