"""Constraint drift over a long run, and what must stay the same without friction."""

from dataclasses import dataclass

import numpy as np

import analysis
from analysis import MODELS, Form, Method, Scenario, SmoothCoulomb, Trajectory
from analysis.data.checks import Array
from analysis.data.frames import poses, twists
from mbs_models import Formulation, IntegratorName
from validation.studies.robustness.cases import Way

SAMPLES_PER_SECOND = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class Runner:
    """A way to integrate a scenario over a long time, with the step or tolerance it takes.

    Parameters
    ----------
    label : str
        With the level on which the constraints are met.
    scenario : Scenario
    way : Way
    accuracy : float
        Step in s of the engine, local tolerance of the in-house side.
    """

    label: str
    scenario: Scenario
    way: Way
    accuracy: float


ROLLING = Scenario(constraints=MODELS[3])

RUNNERS = (
    Runner(
        label="acceleration level (index 1), tolerance 1e-6",
        scenario=ROLLING,
        way=Way(source="in-house", formulation="index-1", integrator="RK45"),
        accuracy=1e-6,
    ),
    Runner(
        label="acceleration level (index 1), tolerance 1e-10",
        scenario=ROLLING,
        way=Way(source="in-house", formulation="index-1", integrator="DOP853"),
        accuracy=1e-10,
    ),
    Runner(
        label="velocity level (index 2), engine, Euler tree, 1 ms",
        scenario=ROLLING,
        way=Way(source="engine", formulation="euler-tree", integrator="TrapezoidalIndex2"),
        accuracy=1e-3,
    ),
    Runner(
        label="velocity level (index 2), engine, floating, 1 ms",
        scenario=ROLLING,
        way=Way(source="engine", formulation="floating", integrator="TrapezoidalIndex2"),
        accuracy=1e-3,
    ),
    Runner(
        label="generalized α (position level but the contact), engine, Euler tree, 1 ms",
        scenario=ROLLING,
        way=Way(source="engine", formulation="euler-tree", integrator="GeneralizedAlpha"),
        accuracy=1e-3,
    ),
    Runner(
        label="minimal coordinates, engine, contact tree, 5 ms (Model 1)",
        scenario=Scenario(),
        way=Way(source="engine", formulation="contact-tree", integrator="RK44"),
        accuracy=5e-3,
    ),
    Runner(
        label="minimal coordinates, in-house reduced, 1e-6 (Model 4)",
        scenario=Scenario(constraints=MODELS[4]),
        way=Way(source="in-house", formulation="reduced", integrator="RK45"),
        accuracy=1e-6,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drift:
    """What a long run does to its constraints and its energy.

    Parameters
    ----------
    runner : Runner
    times : ndarray, shape (n,)
    position, velocity : ndarray, shape (n,)
        Constraint residuals in m and m/s.
    energy : ndarray, shape (n,)
        Residual of the energy balance as a part of weight times radius.
    failure : str
        Why there is nothing, or empty.
    """

    runner: Runner
    times: Array
    position: Array
    velocity: Array
    energy: Array
    failure: str = ""


def simulate(runner: Runner, end: float) -> Trajectory:
    """Run a runner's scenario up to `end` in s."""
    times = np.linspace(0.0, end, round(SAMPLES_PER_SECOND * end) + 1)
    accuracy = "step" if runner.way.source == "engine" else "local_tolerance"
    return runner.way.run(runner.scenario, times, **{accuracy: runner.accuracy})


def drift(runner: Runner, end: float) -> Drift:
    """Constraint and energy residuals of a run with friction from Table 3."""
    try:
        run = simulate(runner, end)
    except ArithmeticError as error:
        none = np.empty(0)
        return Drift(
            runner=runner, times=none, position=none, velocity=none, energy=none,
            failure=str(error),
        )  # fmt: skip
    position, velocity = analysis.constraint_drift(run)
    scale = run.scenario.weight * run.scenario.disk.radius
    return Drift(
        runner=runner,
        times=run.times,
        position=position,
        velocity=velocity,
        energy=analysis.energy_residual(run) / scale,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Conserved:
    """Largest changes of what a frictionless run conserves, relative to their scales.

    Parameters
    ----------
    name : str
    energy : float
        Of weight times radius.
    momentum : float
        Horizontal momentum, of mass times rim speed.
    spin : float
        Vertical angular momentum about the COG, of its start.
    failure : str
        Why there is nothing, or empty.
    """

    name: str
    energy: float = float("nan")
    momentum: float = float("nan")
    spin: float = float("nan")
    failure: str = ""


def conserved(
    formulation: Formulation | Form, integrator: IntegratorName | Method, end: float
) -> Conserved:
    """Run Model 1 without friction and watch its four constants of motion.

    The table's force is vertical then. So it changes neither the horizontal momentum nor, having
    no moment about the vertical through the COG, the vertical angular momentum; and it does no
    work.
    """
    engine = formulation != "index-1"
    way = Way(
        source="engine" if engine else "in-house", formulation=formulation, integrator=integrator
    )
    runner = Runner(
        label="",
        scenario=Scenario(friction=SmoothCoulomb(coefficient=0.0)),
        way=way,
        accuracy=1e-3 if engine else 1e-9,
    )
    try:
        run = simulate(runner, end)
    except ArithmeticError as error:
        return Conserved(name=way.name, failure=str(error))
    disk = run.scenario.disk
    kinetic, potential = analysis.energies(run.scenario, run.coordinates, run.rates)
    momentum, spin = _momenta(run)
    speed = disk.radius * abs(run.rates[0, 3])
    return Conserved(
        name=way.name,
        energy=_change(kinetic + potential) / (run.scenario.weight * disk.radius),
        momentum=max(_change(momentum[:, k]) for k in (0, 1)) / (disk.mass * speed),
        spin=_change(spin) / abs(float(spin[0])),
    )


def _momenta(run: Trajectory) -> tuple[Array, Array]:
    """Momentum, shape (n, 3), and vertical angular momentum about the COG, shape (n,)."""
    _, rotation = poses(run.coordinates)
    velocity, angular = twists(run.coordinates, run.rates)
    arm = rotation[:, :, 0] * run.scenario.disk.eccentricity
    momentum = run.scenario.disk.mass * (velocity + np.cross(angular, arm))
    local = np.einsum("nji,nj->ni", rotation, angular)
    moments = np.array(run.scenario.disk.inertia_about_cog)
    spin: Array = np.einsum("ni,ni->n", rotation[:, 2, :], moments * local)
    return momentum, spin


def _change(values: Array) -> float:
    return float(np.max(np.abs(values - values[0])))


CONSERVED: tuple[tuple[Formulation | Form, IntegratorName | Method], ...] = (
    ("contact-tree", "RK67"),
    ("contact-tree", "RK44"),
    ("contact-tree", "TrapezoidalIndex2"),
    ("euler-tree", "TrapezoidalIndex2"),
    ("euler-tree", "GeneralizedAlpha"),
    ("floating", "TrapezoidalIndex2"),
    ("floating-lie", "TrapezoidalIndex2"),
    ("index-1", "DOP853"),
)
