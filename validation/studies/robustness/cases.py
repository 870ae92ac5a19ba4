"""The hard cases: motions at the ends of what the parameters allow, and ways to compute them."""

import warnings
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

import mbs_models
from analysis import Form, Method, Scenario, Trajectory
from analysis.data.checks import Array
from mbs_models import Formulation, IntegratorName, Scene
from validation.run import run

TOLERANCE = 1e-6
"""Accuracy asked for in rad where a problem says nothing else."""

STIFF = 1e-3
"""Finest speed of friction in m/s below which explicit in-house methods are not tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HardProblem:
    """A motion to be computed.

    Parameters
    ----------
    axis : str
        What is extreme about it.
    label : str
        How extreme.
    scenario : Scenario
    end : float
        In s.
    samples : int
    cover : {"all", "first", "fastest"}
        Whether all integrators of each formulation are tried, the first of each, or that of the
        first formulation alone, for motions that are too long for the others.
    """

    axis: str
    label: str
    scenario: Scenario
    end: float = 0.5
    samples: int = 101
    cover: Literal["all", "first", "fastest"] = "first"

    @property
    def tolerance(self) -> float:
        """Accuracy asked for in rad, and of the time of an ending in s."""
        return TOLERANCE

    @property
    def stop_when(self) -> tuple[str, ...]:
        """What ends the motion besides a contact that would have to pull."""
        return ()

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return np.linspace(0.0, self.end, self.samples)


@dataclass(frozen=True, slots=True, kw_only=True)
class EndedProblem(HardProblem):
    """A motion of which is looked at how it ends; its reference finds the ending by itself.

    Parameters
    ----------
    tolerance, stop_when
        See the properties of `HardProblem`, from which come the others.
    """

    tolerance: float = TOLERANCE
    stop_when: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A way to compute a motion: formulation and integrator, or in-house form and method."""

    source: Literal["engine", "in-house"]
    formulation: Formulation | Form
    integrator: IntegratorName | Method

    @property
    def name(self) -> str:
        """Formulation and integrator."""
        return f"{self.formulation}, {self.integrator}"

    def run(self, scenario: Scenario, times: Array, **how: Any) -> Trajectory:
        """Run a scenario this way; the further arguments are those of `validation.run.run`.

        SciPy's warnings are left out: LSODA warns where it gives up, which is an error as well.
        """
        how.setdefault("integrator" if self.source == "engine" else "method", self.integrator)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return run(scenario, times, source=self.source, formulation=self.formulation, **how)


def ways(problem: HardProblem, *, quick: bool) -> list[Way]:
    """Ways that apply to a problem; in the quick version with their first integrator alone.

    On a penalty contact those of the engine: the formulations are compared with each other.
    """
    scenario = problem.scenario
    formulations = mbs_models.formulations(scenario)
    if problem.cover == "fastest":
        formulations = formulations[:1]
    most = None if problem.cover == "all" and not quick else 1
    engine = [
        Way(source="engine", formulation=formulation, integrator=integrator)
        for formulation in formulations
        for integrator in mbs_models.integrators(
            formulation, constrained=Scene(scenario, formulation).has_constraints
        )[:most]
    ]
    if scenario.contact is not None:
        return engine
    methods: tuple[Method, ...] = ("DOP853", "Radau")
    if scenario.friction.finest_speed < STIFF:
        methods = ("Radau",)
    forms: tuple[Form, ...] = ("index-1",)
    by_weight = scenario.friction.load == "weight"
    if scenario.model == 4 and by_weight and scenario.table.is_horizontal:
        forms = ("index-1", "reduced")
    in_house = [
        Way(source="in-house", formulation=form, integrator=method)
        for form in forms
        for method in methods[:most]
    ]
    return engine + in_house
