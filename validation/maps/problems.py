"""The maps: what each shows, over which axes, and how its cases are run."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from typing import Any

import numpy as np

from analysis import MODELS, Scenario
from analysis.data.changes import changed
from analysis.data.checks import Array
from analysis.data.outcomes import DONE, Row
from analysis.stability.critical import critical_speeds
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan
from validation.sweeps.sweep import Sweep

THEORY_SAMPLES = 31
"""Places along the vertical axis at which critical speeds are worked out."""

ENGINE_STEP = 5e-3
"""Step in s of the engine in maps of Model 1."""

Classify = Callable[[Scenario, Row], str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A map: two axes, and what becomes of the disk on them.

    Parameters
    ----------
    title : str
    axes : tuple of 2 pairs
        Horizontal and vertical one: field, first and last value.
    labels : tuple of 2 str
        With units.
    end : float
        Of each motion in s, unless another is asked for.
    basins : bool
        Whether Models 1 to 4 are beside each other.
    to_rest : bool
        Whether it asks which face is up in the end, instead of the inversion.
    """

    title: str
    axes: tuple[tuple[str, Any, Any], tuple[str, Any, Any]]
    labels: tuple[str, str]
    end: float = 4.0
    basins: bool = False
    to_rest: bool = False


_TILT = ("start.beta", pi / 2 - 0.7, pi / 2 + 0.7)
_TURN = ("start.gamma", -pi / 2, pi / 2)
_SPIN = "spinning speed at the start in rad/s"

PROBLEMS = {
    "spin-friction": Problem(
        title="Inversion over spin and friction",
        axes=(("start.spin", 20.0, 60.0), ("friction.coefficient", 0.02, 0.6)),
        labels=(_SPIN, "friction coefficient μ"),
    ),
    "spin-eccentricity": Problem(
        title="Inversion over spin and eccentricity",
        axes=(("start.spin", 20.0, 60.0), ("disk.eccentricity", 2.5e-4, 6e-3)),
        labels=(_SPIN, "eccentricity in m"),
    ),
    "attitude": Problem(
        title="Inversion over the attitude at the start",
        axes=(_TURN, _TILT),
        labels=("γ at the start in rad", "β at the start in rad"),
    ),
    "tilting": Problem(
        title="Inversion over tilt and tilting rate at the start",
        axes=(("start.beta_rate", -15.0, 15.0), _TILT),
        labels=("rate of β at the start in rad/s", "β at the start in rad"),
    ),
    "basins": Problem(
        title="Starts that end in inverted spinning, by model",
        axes=(_TURN, _TILT),
        labels=("γ at the start in rad", "β at the start in rad"),
        basins=True,
    ),
    "rest": Problem(
        title="Which face is up at rest",
        axes=(("start.spin", 24.0, 36.0), ("start.beta", pi / 2 - 0.4, pi / 2 + 0.4)),
        labels=(_SPIN, "β at the start in rad"),
        end=20.0,
        to_rest=True,
    ),
}
"""By the names of the command."""


def sweep_of(problem: Problem, scenario: Scenario, *, count: int, plan: Plan) -> Sweep:
    """Sweep over the axes of a map, the vertical one first.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    count : int
        Of values along each axis.
    plan : Plan
    """
    axes = tuple(
        Axis(field=field, first=first, last=last, count=count)
        for field, first, last in reversed(problem.axes)
    )
    return Sweep(scenario=scenario, design=Design(axes=axes), plan=plan)


def quickest_plan(
    scenario: Scenario, end: float, witnesses: int, *, compiled: bool = False
) -> Plan:
    """Way to run the cases of a map in the least time; its witnesses see to the error.

    Compiled, an ideal contact runs with Taylor's method to 1e-6 rad in batches; its witnesses,
    which would take most of the time, run to 1e-3 rad, those of Model 1 at a step of 5 ms.
    Otherwise Model 1 runs on the engine's contact tree at that step, to some 1e-7 rad; Model 4 as
    the reduced system; everything else with the in-house equations.
    """
    how: dict[str, Any] = {"end": end, "witnesses": witnesses}
    if scenario.contact is not None:
        return Plan(to_rest=True, spacing=1e-2, local_tolerance=1e-6, **how)
    if scenario.model == 1 and not compiled:
        return Plan(source="engine", step=ENGINE_STEP, **how)
    is_reduced = (
        scenario.model == 4 and scenario.friction.load == "weight" and scenario.table.is_horizontal
    )
    form = "reduced" if is_reduced else None
    if compiled:
        of_tree = {"witness_step": ENGINE_STEP}
        how |= of_tree if scenario.model == 1 else {"witness_tolerance": 1e-3}
        return Plan(formulation=form, method="taylor", tolerance=1e-6, **how)
    return Plan(formulation=form, local_tolerance=1e-6, **how)


def models_beside(scenario: Scenario) -> list[Scenario]:
    """The scenario with the constraints of Models 1 to 4."""
    return [replace(scenario, constraints=constraints) for constraints in MODELS.values()]


def inversion_class(_: Scenario, row: Row) -> str:
    """What became of the inversion in a case."""
    if row["status"] == "refused":
        return "refused"
    if row["status"] != DONE:
        return "failed"
    if row["inversion"] in ("inverted", "lost", "not decided"):
        return str(row["inversion"])
    return {"contact would pull": "pulls", "flat": "flat"}.get(str(row["ending"]), "not inverted")


def face_class(scenario: Scenario, row: Row) -> str:
    """Which face of a case is up at rest, as soon as that cannot change any more.

    The disk passes from one face to the other through standing on its rim, where its potential
    energy is m g (r - e) at least. With less energy than that it stays on its side, however long
    it takes to come to rest there.
    """
    if row["status"] != DONE:
        return "failed"
    disk = scenario.disk
    barrier = scenario.weight * (disk.radius - disk.eccentricity)
    is_decided = float(row["energy_end"] or np.inf) < barrier or row["ending"] == "flat"
    if not is_decided:
        return "not decided"
    return "upper face" if float(row["face_end"] or 0.0) > 0.0 else "lower face"


def classify(problem: Problem) -> Classify:
    """How the cases of a map are told apart."""
    return face_class if problem.to_rest else inversion_class


@cache
def critical_points(problem: Problem, scenario: Scenario) -> Array:
    """Critical spins of inverted spinning along the vertical axis, shape (n, 2).

    Empty for a map that has no spin along its horizontal axis.
    """
    (field, first, last), (other, low, high) = problem.axes
    if field != "start.spin" or problem.to_rest or not scenario.table.is_horizontal:
        return np.empty((0, 2))
    points = []
    for value in np.linspace(low, high, THEORY_SAMPLES).tolist():
        at = changed(scenario, {other: value})
        points += [
            (crossing.spin, value) for crossing in critical_speeds(at, (first, last)).crossings
        ]
    return np.array(points).reshape(-1, 2)
