"""The initial value problems of the work-precision study, their references and their errors."""

from dataclasses import asdict, dataclass
from functools import cache
from typing import Literal

import numpy as np

import analysis
import mbs_models
from analysis import MODELS, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data import frames
from analysis.data.checks import Array
from mbs_models import Scene

TIMES = np.linspace(0.0, 2.0, 101)
"""Times in s at which every run is sampled and compared."""

SPACING = 0.02
"""Time between them, and so the longest step, in s."""

REFERENCE_TOLERANCE = 3e-14
"""Local tolerance of the reference, the tightest there is."""

_SUBSTEPS = {"stiff": 256, "fast": 256}
_USUAL_SUBSTEPS = 64
"""Steps of RK67 between two samples: fewer truncate, more round."""

SAFETY = 100.0
"""Errors below this many times the references' disagreement are not told apart from it."""

ProblemName = Literal[
    "model-1", "model-2", "model-3", "model-4", "contact-load", "stiff", "undamped", "fast"
]


@dataclass(frozen=True, slots=True, kw_only=True)
class StandardProblem:
    """A motion over 2 s from Table 3, with one thing changed.

    Parameters
    ----------
    name : str
    title : str
    scenario : Scenario
    """

    name: ProblemName
    title: str
    scenario: Scenario


_ALL = (
    StandardProblem(name="model-1", title="Model 1", scenario=Scenario()),
    StandardProblem(name="model-2", title="Model 2", scenario=Scenario(constraints=MODELS[2])),
    StandardProblem(name="model-3", title="Model 3", scenario=Scenario(constraints=MODELS[3])),
    StandardProblem(name="model-4", title="Model 4", scenario=Scenario(constraints=MODELS[4])),
    StandardProblem(
        name="contact-load",
        title="Model 1, friction knows the contact force",
        scenario=Scenario(friction=SmoothCoulomb(load="contact")),
    ),
    StandardProblem(
        name="stiff",
        title="Model 1, stiff: ε = 1e-3 m/s",
        scenario=Scenario(friction=SmoothCoulomb(smoothing=1e-3)),
    ),
    StandardProblem(
        name="undamped",
        title="Model 1, undamped: μ = 0",
        scenario=Scenario(friction=SmoothCoulomb(coefficient=0.0)),
    ),
    StandardProblem(
        name="fast",
        title="Model 1, fast: spin 100 rad/s",
        scenario=Scenario(start=Start(spin=100.0)),
    ),
)

PROBLEMS: dict[ProblemName, StandardProblem] = {problem.name: problem for problem in _ALL}


@dataclass(frozen=True, slots=True, kw_only=True)
class Errors:
    """By how much a run differs from another, and breaks what it should keep.

    Parameters
    ----------
    error : float
        Largest of the differences of beta and gamma in rad and of the centre of gravity's
        position over the disk's radius, over the whole motion.
    end : float
        The same at the end.
    beta, gamma : float
        In rad; angles that differ by whole turns are the same.
    cog : float
        Inertial position of the centre of gravity in m.
    energy : float
        Kinetic plus potential energy in J.
    normal_force : float
        In N.
    position_drift, velocity_drift : float
        Constraint residuals in m and m/s.
    """

    error: float
    end: float
    beta: float
    gamma: float
    cog: float
    energy: float
    normal_force: float
    position_drift: float
    velocity_drift: float

    def row(self) -> list[float]:
        """All of them, in the order above."""
        return list(asdict(self).values())


def compare(run: Trajectory, other: Trajectory) -> Errors:
    """Errors of `run` against `other`, sampled at the same times.

    Raises
    ------
    ValueError
        If the times differ.
    """
    if not np.array_equal(run.times, other.times):
        raise ValueError("times must be the same for both runs")
    angles = _wrap((run.coordinates - other.coordinates)[:, 4:6])
    place = np.linalg.norm(_cog(run) - _cog(other), axis=1)
    difference = np.maximum(np.max(np.abs(angles), axis=1), place / run.scenario.disk.radius)
    energy = _energy(run) - _energy(other)
    position, velocity = analysis.constraint_drift(run)
    return Errors(
        error=float(np.max(difference)),
        end=float(difference[-1]),
        beta=float(np.max(np.abs(angles[:, 0]))),
        gamma=float(np.max(np.abs(angles[:, 1]))),
        cog=float(np.max(place)),
        energy=float(np.max(np.abs(energy))),
        normal_force=float(np.max(np.abs(run.normal_force - other.normal_force))),
        position_drift=float(np.max(position)),
        velocity_drift=float(np.max(velocity)),
    )


def _wrap(angles: Array) -> Array:
    wrapped: Array = angles - 2 * np.pi * np.round(angles / (2 * np.pi))
    return wrapped


def _cog(run: Trajectory) -> Array:
    """Inertial position of the centre of gravity in m, shape (n, 3)."""
    position, rotation = frames.poses(run.coordinates)
    place: Array = position + run.scenario.disk.eccentricity * rotation[:, :, 0]
    return place


def _energy(run: Trajectory) -> Array:
    kinetic, potential = analysis.energies(run.scenario, run.coordinates, run.rates)
    return kinetic + potential


@cache
def reference(name: ProblemName) -> Trajectory:
    """In-house run with DOP853 that everything is compared with; made once per process.

    Raises
    ------
    ArithmeticError
        If the contact would have to pull: from there on there is no motion to compare with.
    """
    scenario = PROBLEMS[name].scenario
    run = analysis.simulate(scenario, TIMES, local_tolerance=REFERENCE_TOLERANCE)
    if run.ending is not None:
        raise ArithmeticError(f"problem {name!r}: {run.ending.reason} at {run.ending.time:g} s")
    return run


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """Differences of other methods from the reference of a problem.

    Parameters
    ----------
    problem : str
    others : dict
        From a description of the other method to its `Errors.error`.
    """

    problem: ProblemName
    others: dict[str, float]

    @property
    def best(self) -> float:
        """Smallest difference: what two different methods agree to."""
        return min(self.others.values())

    @property
    def floor(self) -> float:
        """Smallest error that can be measured."""
        return SAFETY * self.best


def agreement(name: ProblemName, quick: bool = False) -> Agreement:
    """Compare the reference of a problem with a run of another family of methods, or two.

    Parameters
    ----------
    name : str
    quick : bool
        Be content with one.
    """
    scenario, truth = PROBLEMS[name].scenario, reference(name)
    others: dict[str, float] = {}
    if "contact-tree" in mbs_models.formulations(scenario):
        step = SPACING / _SUBSTEPS.get(name, _USUAL_SUBSTEPS)
        scene = Scene(scenario, "contact-tree")
        run = mbs_models.simulate(scene, TIMES, step=step, integrator="RK67")
        others[f"engine, contact tree, RK67, step {step:.1e} s"] = compare(run, truth).error
    # On quickly turning or stiff motions Radau takes minutes to say the same.
    if not others or not (quick or name in {"stiff", "undamped", "fast"}):
        run = analysis.simulate(scenario, TIMES, method="Radau", local_tolerance=1e-12)
        others["in-house, Radau, local tolerance 1e-12"] = compare(run, truth).error
    return Agreement(problem=name, others=others)
