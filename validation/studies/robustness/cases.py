"""The hard cases: motions at the ends of what the parameters allow, and ways to compute them."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

import mbs_models
from analysis import STEEL_DISK, Disk, Form, Level, Method, PenaltyContact, SmoothCoulomb
from analysis.data.checks import Array
from analysis.data.state import State
from mbs_models import Formulation, IntegratorName, Scene

TOLERANCE = 1e-6
"""Accuracy asked for in rad."""

STIFF = 1e-3
"""Smoothing in m/s below which explicit in-house methods are not tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A motion to be computed.

    Parameters
    ----------
    axis : str
        What is extreme about it.
    label : str
        How extreme.
    level : {1, 2, 3, 4}
    disk : Disk
    friction : SmoothCoulomb
    contact : PenaltyContact, optional
        The ideal contact if there is none. The engine alone has the other.
    start : State
    end : float
        In s.
    samples : int
    cover : {"all", "first", "fastest"}
        Whether all integrators of each formulation are tried, the first of each, or that of the
        first formulation alone, for motions that are too long for the others.
    """

    axis: str
    label: str
    level: Level
    start: State
    disk: Disk = STEEL_DISK
    friction: SmoothCoulomb = field(default_factory=SmoothCoulomb)
    contact: PenaltyContact | None = None
    end: float = 0.5
    samples: int = 101
    cover: Literal["all", "first", "fastest"] = "first"

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return np.linspace(0.0, self.end, self.samples)


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


def ways(problem: Problem, *, quick: bool) -> list[Way]:
    """Ways that apply to a problem; in the quick version with their first integrator alone."""
    by_contact = problem.friction.load == "contact"
    formulations = [
        each
        for each in mbs_models.formulations(problem.level)
        if each != "contact-tree" or (problem.contact is None and not by_contact)
    ][: 1 if problem.cover == "fastest" else None]
    most = None if problem.cover == "all" and not quick else 1
    engine = [
        Way(source="engine", formulation=formulation, integrator=integrator)
        for formulation in formulations
        for integrator in mbs_models.integrators(
            formulation, constrained=scene(problem, formulation).has_constraints
        )[:most]
    ]
    if problem.contact is not None:
        return engine
    methods: tuple[Method, ...] = ("DOP853", "Radau")
    if problem.friction.smoothing < STIFF:
        methods = ("Radau",)
    forms: tuple[Form, ...] = ("index-1",)
    if problem.level == 4 and not by_contact:
        forms = ("index-1", "reduced")
    in_house = [
        Way(source="in-house", formulation=form, integrator=method)
        for form in forms
        for method in methods[:most]
    ]
    return engine + in_house


def scene(problem: Problem, formulation: Formulation) -> Scene:
    """Scene of a problem in one of the engine's formulations."""
    return Scene(
        level=problem.level,
        formulation=formulation,
        disk=problem.disk,
        friction=problem.friction,
        contact=problem.contact,
        start=problem.start,
    )
