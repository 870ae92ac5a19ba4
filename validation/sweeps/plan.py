"""How each case of a sweep is run."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis import METHODS, REST_METHODS, Scenario, SpatialMotion, Trajectory
from analysis.data.checks import choice, positive, within
from analysis.data.endings import check_condition_name
from analysis.data.limits import LONGEST_MOTION, Effort, check_storage
from analysis.data.names import ArgumentError
from analysis.data.trajectory import SOURCES, Source
from analysis.models.forms import default_form, pose
from analysis.models.request import TIGHTEST_LOCAL_TOLERANCE
from validation.run import rest_effort, run, run_effort, run_to_rest
from validation.sweeps.outcomes import series_named

Motion = Trajectory | SpatialMotion


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How each case is run; the names are those of `validation.run`.

    Parameters
    ----------
    source : {"engine", "in-house"}
    formulation, method, step : optional
        Of that side.
    local_tolerance : float, optional
        Of a single run, of which no error is estimated; the engine takes DOPRI5 then, which needs
        a scene without constraints.
    tolerance : float, optional
        1e-6 if no other accuracy is given.
    end : float
        Of each motion in s.
    spacing : float
        Between samples in s; outcomes are judged at samples.
    stop_when : str, optional
        One of `CONDITIONS`, or `module:function`.
    to_rest : bool
        Run until the disk lies still, or until `end`.
    witnesses : int
        Number of cases, spread over the sweep, that the other side runs as well.
    witness_tolerance, witness_step : float, optional
        Of that other side, which otherwise runs to the tolerance; the step is the engine's.
    keep : tuple of str
        Series that are kept of each motion, at its samples: of `SERIES` or, to rest, of
        `REST_SERIES`; names of `GROUPS` stand for several.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    source: Source = "in-house"
    formulation: str | None = None
    method: str | None = None
    tolerance: float | None = None
    local_tolerance: float | None = None
    step: float | None = None
    end: float = 4.0
    spacing: float = 5e-3
    stop_when: str | None = None
    to_rest: bool = False
    witnesses: int = 0
    witness_tolerance: float | None = None
    witness_step: float | None = None
    keep: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        choice("source", self.source, SOURCES)
        end = within("end", positive("end", self.end), 0.0, LONGEST_MOTION)
        spacing = positive("spacing", self.spacing)
        if not spacing < end:
            raise ValueError(f"spacing must be less than end = {end:g} s, got {spacing:g}")
        check_storage("spacing", end / spacing, 20)
        if self.stop_when is not None:
            check_condition_name(self.stop_when)
        if self.to_rest and self.formulation:
            raise ValueError("formulation does not go together with a run to rest")
        object.__setattr__(self, "keep", series_named(self.keep, to_rest=self.to_rest))
        self._check_accuracy()
        if type(self.witnesses) is not int or self.witnesses < 0:
            raise ValueError(f"witnesses must be a number of cases, got {self.witnesses!r}")
        if self.tolerance is self.local_tolerance is self.step is None:
            object.__setattr__(self, "tolerance", 1e-3 if self.to_rest else 1e-6)

    def _check_accuracy(self) -> None:
        of_engine = ("method", "witness_step")
        foreign: tuple[str, ...] = of_engine if self.source == "engine" else ("step",)
        if self.source == "engine" and self.to_rest:
            foreign = (*foreign, "local_tolerance")
        for name in foreign:
            if getattr(self, name) is not None:
                raise ArgumentError(name, f"must be left out for source {self.source!r}")
        if self.method is not None:
            choice("method", self.method, REST_METHODS if self.to_rest else METHODS)
        for name in ("tolerance", "step", "witness_tolerance", "witness_step"):
            if (value := getattr(self, name)) is not None:
                positive(name, value)
        if self.local_tolerance is not None:
            within("local_tolerance", self.local_tolerance, TIGHTEST_LOCAL_TOLERANCE, 0.1)

    @property
    def runs_in_batches(self) -> bool:
        """Whether cases run faster together."""
        return self.method == "taylor" and not self.to_rest

    @property
    def series_bytes(self) -> int:
        """Largest size of the series of a case."""
        return 8 * self.times.size * (1 + len(self.keep)) if self.keep else 0

    @property
    def times(self) -> Any:
        """Times of the samples in s."""
        return np.linspace(0.0, self.end, max(2, round(self.end / self.spacing) + 1))

    def motion(self, scenario: Scenario, *, time_limit: float | None) -> Motion:
        """Motion of a case."""
        how = {
            "source": self.source,
            "tolerance": self.tolerance,
            "step": self.step,
            "method": self.method,
            "time_limit": time_limit,
            "local_tolerance": self.local_tolerance,
        }
        return self._motion(scenario, how, self.formulation)

    def witness(self, scenario: Scenario, *, time_limit: float | None) -> Motion:
        """Motion of the same case from the other side."""
        return self._motion(scenario, {"time_limit": time_limit, **self._of_witness}, None)

    @property
    def _of_witness(self) -> dict[str, Any]:
        """How the other side runs a case."""
        how = {"source": SOURCES[self.source == SOURCES[0]], "step": self.witness_step}
        if self.witness_step is None:
            tolerance = self.witness_tolerance or self.tolerance
            how["tolerance"] = tolerance or (1e-3 if self.to_rest else 1e-6)
        return how

    def _motion(self, scenario: Scenario, how: dict[str, Any], formulation: str | None) -> Motion:
        how["stop_when"] = self.stop_when or ()
        if self.to_rest:
            return run_to_rest(scenario, self.end, spacing=self.spacing, **how)
        return run(scenario, self.times, formulation=formulation, **how)

    def witness_effort(self, scenario: Scenario) -> Effort:
        """What a case will take on the other side; `ValueError` if it cannot be run there."""
        how = self._of_witness
        if self.to_rest:
            return rest_effort(scenario, self.end, source=how["source"], step=how["step"])
        return run_effort(scenario, self.times, **how)

    def effort(self, scenario: Scenario) -> Effort:
        """What a case will take; `ValueError` if the plan cannot be carried out."""
        if self.to_rest:
            return rest_effort(scenario, self.end, source=self.source, step=self.step)
        if self.source == "in-house":
            form: Any = self.formulation or default_form(scenario)
            pose(scenario, form, {})
        return run_effort(
            scenario,
            self.times,
            source=self.source,
            formulation=self.formulation,
            tolerance=self.tolerance,
            step=self.step,
            method=self.method,
            local_tolerance=self.local_tolerance,
        )
