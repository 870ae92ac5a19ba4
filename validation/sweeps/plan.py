"""How each case of a sweep is run."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis import METHODS, REST_METHODS, Scenario, SpatialMotion, StoredRun, Trajectory
from analysis.motion.endings import check_condition_name, each_condition
from analysis.motion.quantities import quantities
from analysis.problem.checks import Array, choice, positive, several, switch, whole, within
from analysis.problem.choices import SOURCES
from analysis.problem.limits import LONGEST_MOTION, Effort, check_storage
from analysis.problem.names import ArgumentError
from analysis.simulation.formulations import default_formulation, pose
from analysis.simulation.request import TIGHTEST_LOCAL_TOLERANCE
from validation.parser.runs import ACCURACIES, END, OPTIONS, CaseOptions
from validation.run import rest_effort, run, run_effort, run_to_rest

TIME = "time"
"""The series that goes with all others: times of the samples in s."""

_GRACE = 10.0
"""Processor time in s beyond three time limits for a case that does not look at its own."""

_TOGETHER = ("coordinates", "rates")
"""Names for several series of a trajectory."""


def series_known(*, to_rest: bool) -> dict[str, tuple[str, ...]]:
    """Series that can be kept of a motion, by names that stand for one of them or for several.

    What a scenario does not have, such as a torque, is empty.
    """
    held = quantities(SpatialMotion if to_rest else Trajectory)
    found = {name: tuple(held[name]) for name in _TOGETHER if name in held}
    each = (name for columns in held.values() for name in columns if name != TIME)
    return found | {name: (name,) for name in each}


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan(CaseOptions):
    """How each case is run, checked as a whole: the options of a run, and these.

    Parameters
    ----------
    tolerance : float, optional
        1e-6, or 1e-3 to rest, if no other accuracy is given.
    time_limit : float
        Processor time of each run in s.
    end : float
        Of each motion in s.
    spacing : float
        Between samples in s; outcomes are judged at samples.
    to_rest : bool
        Run until the disk lies still, or until `end`.
    witnesses : int
        Number of cases, spread over the sweep, that the other side runs as well.
    witness_tolerance, witness_step : float, optional
        Of that other side, which otherwise runs to the tolerance; the step is the engine's.
    keep : tuple of str
        Series that are kept of each motion, at its samples: names that its `columns()` has, or
        "coordinates" or "rates".

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    def __post_init__(self) -> None:
        CaseOptions.__post_init__(self)
        # What is told is stored, in numbers of Python's own.
        clean: dict[str, Any] = {
            name: switch(name, getattr(self, name)) for name in ("allow_pulling", "to_rest")
        }
        end = within("end", positive("end", self.end), 0.0, LONGEST_MOTION)
        spacing = positive("spacing", self.spacing)
        if not spacing < end:
            fault = f"must have spacing < end, got {spacing:g} s and {end:g} s"
            raise ArgumentError("spacing" if end == END else "end", fault)
        check_storage("spacing", end / spacing, 20)
        numbers = (*ACCURACIES, "witness_tolerance", "witness_step", "time_limit")
        clean |= {name: positive(name, value) for name, value in self.given(*numbers).items()}
        clean |= {"end": end, "spacing": spacing}
        if self.local_tolerance is not None:
            within("local_tolerance", self.local_tolerance, TIGHTEST_LOCAL_TOLERANCE, 0.1)
        if self.method is not None:
            choice("method", self.method, REST_METHODS if self.to_rest else METHODS)
        if self.stop_when is not None:
            ends = tuple(check_condition_name(each) for each in each_condition(self.stop_when))
            clean["stop_when"] = ends[0] if len(ends) == 1 else ends
        if self.source == "engine" and self.witness_step is not None:
            raise ArgumentError("witness_step", "must be left out for source 'engine'")
        clean["witnesses"] = whole("witnesses", self.witnesses, least=0)
        known = series_known(to_rest=self.to_rest)
        names = [choice("keep", name, known) for name in several("keep", self.keep, "names")]
        clean["keep"] = tuple(dict.fromkeys(each for name in names for each in known[name]))
        if not self.given(*ACCURACIES):
            clean["tolerance"] = 1e-3 if self.to_rest else 1e-6
        for name, value in clean.items():
            object.__setattr__(self, name, value)

    @property
    def runs_in_batches(self) -> bool:
        """Whether cases run faster together."""
        return self.method == "taylor" and not self.to_rest

    @property
    def hanging(self) -> float:
        """Processor time in s after which a run that does not look at its time limit is ended."""
        return 3.0 * self.time_limit + _GRACE

    @property
    def times(self) -> Array:
        """Times of the samples in s."""
        return np.linspace(0.0, self.end, round(self.end / self.spacing) + 1)

    @property
    def witness(self) -> "Plan":
        """How the other side runs a case."""
        how = self.given("stop_when", "allow_pulling", "time_limit", "end", "spacing", "to_rest")
        if self.witness_step is None:
            how["tolerance"] = self.witness_tolerance or self.tolerance
        return Plan(source=SOURCES[self.source == SOURCES[0]], step=self.witness_step, **how)

    def motion(self, scenario: Scenario) -> StoredRun:
        """Motion of a case."""
        how = self.given(*OPTIONS)
        if self.to_rest:
            return run_to_rest(scenario, self.end, spacing=self.spacing, **how)
        return run(scenario, self.times, **how)

    def effort(self, scenario: Scenario) -> Effort:
        """What a case will take; `ValueError` if the plan cannot be carried out."""
        how = self.given(*OPTIONS)
        if self.to_rest:
            return rest_effort(scenario, self.end, **how)
        if self.source == "in-house":
            formulation: Any = self.formulation or default_formulation(scenario)
            pose(scenario, formulation, {})
        return run_effort(scenario, self.times, **how)
