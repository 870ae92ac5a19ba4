"""The methods of the work-precision study, each with its ladder of steps or tolerances."""

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import mbs_models
from analysis import Form, Trajectory
from analysis.data.trajectory import versions
from analysis.models.forms import pose
from mbs_models import Formulation, Integrator, Scene
from mbs_models.extrapolation import Ladder
from mbs_models.own_runs import run_over
from mbs_models.simulation import trajectory
from validation.studies.work_precision.problems import SPACING, TIMES, ProblemName, StandardProblem

HALVINGS = 8
"""Of the longest step, the sampling interval; ladders of steps end after so many: 25600 steps.

One more where the disk spins fast.
"""

DAMPED_HALVINGS = 7
"""The same for generalized-alpha, whose iterations take longest."""


@dataclass(frozen=True, slots=True, eq=False)
class TimedRun:
    """One run of a method: its samples, processor time of its integration alone, and its work."""

    values: Any
    seconds: float
    counts: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineMethod:
    """A formulation of the engine with an integrator.

    Parameters
    ----------
    formulation : str
    integrator : Integrator
    """

    formulation: Formulation
    integrator: Integrator

    @property
    def scheme(self) -> str:
        """Short name of the integrator."""
        radius = self.integrator.spectral_radius
        if self.integrator.name == "TrapezoidalIndex2":
            return "trapezoidal"
        return self.integrator.name if radius is None else f"generalized-α {radius:g}"

    @property
    def fixed_step(self) -> bool:
        """Whether it is a step that its ladder halves."""
        return not self.integrator.controls_step

    @property
    def judged_extrapolated(self) -> bool:
        """Whether its ladder may end once its extrapolated runs meet the finest goal.

        Implicit rules are of second order and would take minutes to meet it by themselves.
        """
        return self.integrator.implicit

    def ladder(self, problem: StandardProblem) -> list[float]:
        """Steps in s or local tolerances, from coarse to fine."""
        if not self.fixed_step:
            return [10.0**-digits for digits in range(3, 14)]
        damped = self.integrator.name == "GeneralizedAlpha"
        halvings = (DAMPED_HALVINGS if damped else HALVINGS) + (problem.name == "fast")
        return [SPACING * 0.5**k for k in range(1 + halvings)]

    def run(self, problem: StandardProblem, setting: float) -> TimedRun:
        """Build the scene and run it once.

        Raises
        ------
        ArithmeticError
            If the run does not reach its end.
        """
        integrator, step = self.integrator, setting
        if integrator.controls_step:
            integrator, step = Integrator(name=integrator.name, local_tolerance=setting), np.inf
        result = run_over(Scene(problem.scenario, self.formulation), TIMES, integrator, step)
        if result.ended is not None:
            raise ArithmeticError(f"{result.ended} at t = {result.times[-1]:.6g} s")
        return TimedRun(result, result.seconds, dict(result.counts))

    def run_to(self, problem: StandardProblem, tolerance: float) -> tuple[Trajectory, TimedRun]:
        """Let the library choose the steps; the time is that of the whole call.

        Raises
        ------
        ArithmeticError
            If the tolerance cannot be met.
        """
        begin = time.process_time()
        run = mbs_models.simulate(
            Scene(problem.scenario, self.formulation),
            TIMES,
            tolerance=tolerance,
            integrator=self.integrator,
        )
        seconds = time.process_time() - begin
        return run, TimedRun(None, seconds, dict(run.counts))

    def trajectory(self, problem: StandardProblem, run: TimedRun) -> Trajectory:
        """Trajectory of a run."""
        return trajectory(Scene(problem.scenario, self.formulation), self.integrator, run.values)

    def extrapolation(self, problem: StandardProblem) -> "Extrapolation":
        """Richardson's extrapolation of its runs, with their work added up."""
        decay = problem.scenario.slip_decay
        return Extrapolation(Ladder(self.formulation, self.integrator.name, decay))


class Extrapolation:
    """Extrapolates the runs of a ladder of halved steps as the tolerance-controlled runs do.

    Parameters
    ----------
    ladder : Ladder
        An empty one.
    """

    def __init__(self, ladder: Ladder) -> None:
        self._ladder = ladder
        self._seconds = 0.0
        self._counts: dict[str, int] = {}

    @property
    def estimate(self) -> float:
        """Smallest error that it has estimated for itself so far, in rad."""
        return self._ladder.best_estimate

    def add(self, run: TimedRun) -> TimedRun | None:
        """Extrapolated run up to this one, with all their work; None after the first."""
        self._seconds += run.seconds
        for name, count in run.counts.items():
            self._counts[name] = self._counts.get(name, 0) + count
        self._ladder.add(run.values.values, run.values.times, run.values.step)
        if not np.isfinite(self._ladder.estimate):
            return None
        values = replace(run.values, values=self._ladder.best)
        return TimedRun(values, self._seconds, dict(self._counts))


@dataclass(frozen=True, slots=True, kw_only=True)
class InHouseMethod:
    """In-house equations with a method of SciPy as it is.

    It goes across a reversal of slip, where the library ends a step.

    Parameters
    ----------
    form : {"index-1", "reduced"}
    scheme : str
        Name of the method.
    """

    form: Form
    scheme: str

    @property
    def formulation(self) -> str:
        """Name of the form."""
        return self.form

    @property
    def fixed_step(self) -> bool:
        """Whether it is a step that its ladder halves."""
        return False

    @property
    def judged_extrapolated(self) -> bool:
        """Whether its runs are extrapolated: no."""
        return False

    def ladder(self, problem: StandardProblem) -> list[float]:
        """Local tolerances, from coarse to fine."""
        finest = {"RK45": 12, "DOP853": 13, "Radau": 11, "BDF": 12, "LSODA": 13}[self.scheme]
        # Stability, not accuracy, gives explicit methods their steps there: all cost the same.
        bound = problem.name == "stiff" and self.scheme in {"RK45", "DOP853"}
        return [10.0**-digits for digits in range(3, finest + 1, 3 if bound else 1)]

    def run(self, problem: StandardProblem, setting: float) -> TimedRun:
        """Integrate once.

        Raises
        ------
        ArithmeticError
            If the integration does not reach its end.
        """
        posed = pose(problem.scenario, self.form).problem
        begin = time.process_time()
        # Radau and BDF let the difference step of coordinates that matter to nothing overflow.
        with np.errstate(over="ignore", invalid="ignore"):
            result = solve_ivp(
                posed.right_hand_side,
                (TIMES[0], TIMES[-1]),
                posed.start,
                method=self.scheme,
                t_eval=TIMES,
                rtol=setting,
                atol=setting,
                max_step=posed.longest_step,
            )
        seconds = time.process_time() - begin
        if not result.success:
            raise ArithmeticError(f"stopped at t = {result.t[-1]:g} s: {result.message}")
        counts = {"right_hand_sides": int(result.nfev), "jacobians": int(result.njev)}
        return TimedRun(result.y.T, seconds, counts)

    def trajectory(self, problem: StandardProblem, run: TimedRun) -> Trajectory:
        """Trajectory of a run; adds the constraint forces, outside of its time."""
        posed = pose(problem.scenario, self.form)
        coordinates, rates, multipliers = posed.expand(TIMES, run.values)
        return Trajectory(
            times=TIMES,
            coordinates=coordinates,
            rates=rates,
            multipliers=multipliers,
            scenario=problem.scenario,
            source="in-house",
            method={"form": self.form, "method": self.scheme},
            versions=versions("numpy", "scipy"),
        )


Method = EngineMethod | InHouseMethod


def label(method: Method) -> str:
    """Formulation and integrator, in words."""
    return f"{method.formulation}, {method.scheme}"


_QUICK_USUAL = frozenset(
    (
        "contact-tree, RK67",
        "contact-tree, RK44",
        "euler-tree, trapezoidal",
        "floating, trapezoidal",
        "floating-lie, trapezoidal",
        "index-1, DOP853",
    )
)

_QUICK: dict[ProblemName, frozenset[str]] = {
    "model-1": _QUICK_USUAL,
    "model-3": _QUICK_USUAL,
    "stiff": frozenset({"contact-tree, RK67"}),
}
"""Labels of the methods of the quick selection."""

QUICK_PROBLEMS = tuple(_QUICK)
"""Problems of the quick selection."""

_VARIED = ("model-1", "model-3")
"""Problems on which all integrators are tried: one that slides, one that rolls."""

_SCIPY = ("RK45", "DOP853", "Radau", "BDF", "LSODA")


def methods(problem: StandardProblem, quick: bool) -> list[Method]:
    """Every method that can take a problem, or those of the quick selection."""
    available: list[Method] = [
        EngineMethod(formulation=formulation, integrator=integrator)
        for formulation in mbs_models.formulations(problem.scenario)
        for integrator in _integrators(problem, formulation)
    ]
    forms: tuple[Form, ...] = (
        ("index-1", "reduced") if problem.scenario.model == 4 else ("index-1",)
    )
    available += [InHouseMethod(form=form, scheme=scheme) for form in forms for scheme in _SCIPY]
    if not quick:
        return available
    chosen = _QUICK.get(problem.name, frozenset())
    return [method for method in available if label(method) in chosen]


def _integrators(problem: StandardProblem, formulation: Formulation) -> list[Integrator]:
    trapezoidal = Integrator(name="TrapezoidalIndex2")
    if formulation == "contact-tree":
        explicit = [Integrator(name="RK67"), Integrator(name="RK44"), Integrator(name="DOPRI5")]
        # There, the trapezoidal rule gives what it gives on the Euler tree.
        return [*explicit, trapezoidal] if problem.name in _VARIED else explicit
    radii = (1.0, 0.9, 0.6) if problem.name in _VARIED else (0.9,)
    damped = Integrator(name="GeneralizedAlpha")
    return [trapezoidal, *(replace(damped, spectral_radius=radius) for radius in radii)]
