"""Measuring one method on one problem: its ladder, and what is derived from it.

Nothing here looks at a clock to decide anything: ladders end by errors and by counted work, so
that every machine makes the same runs.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any, NamedTuple, cast

import numpy as np

import analysis
import mbs_models
from analysis import Trajectory
from analysis.problem.choices import ACCELERATED, FORMULATIONS, Source
from mbs_models import Integrator
from mbs_models.extrapolation import Ladder
from validation.kit.ways import Way
from validation.studies.work_precision.problems import (
    PROBLEMS,
    SPACING,
    TIMES,
    errors,
    reference,
)
from validation.study import Row

GOALS = (1e-3, 1e-6, 1e-9)
"""Errors to be reached, in rad."""

USEFUL = 0.1
"""Error from which on a run says nothing about the motion any more."""

VARIED = ("model-1", "model-3")
"""Problems on which all integrators are tried: one that slides, one that rolls."""

CONSTRAINED = ("euler-tree", "floating", "floating-lie")
"""Formulations that keep constraints."""

INTEGRATORS = {
    **{name: Integrator(name=name) for name in ("RK67", "RK44", "DOPRI5")},
    "trapezoidal": Integrator(name="TrapezoidalIndex2"),
    **{
        f"generalized-α {radius:g}": Integrator(name="GeneralizedAlpha", spectral_radius=radius)
        for radius in (1.0, 0.9, 0.6)
    },
    **{f"accelerations, {name}": Integrator(name=name) for name in ACCELERATED},
}
"""Of the engine, by the name of the scheme: its own, and SciPy's that step its accelerations."""

FINEST = {"RK45": 12, "DOP853": 13, "Radau": 11, "BDF": 12, "LSODA": 13}
"""Methods of SciPy, with the digits of their tightest local tolerance."""


class Curve(NamedTuple):
    """A formulation with an integrator on a problem."""

    problem: str
    formulation: str
    scheme: str

    @property
    def integrator(self) -> Integrator | None:
        """Of the engine; None in-house."""
        return None if self.formulation in FORMULATIONS else INTEGRATORS[self.scheme]

    @property
    def kind(self) -> str:
        """What its ladder makes finer: "step" or "local tolerance"."""
        fixed = self.integrator is not None and not self.integrator.controls_step
        return "step" if fixed else "local tolerance"

    def ladder(self) -> list[float]:
        """Steps in s or local tolerances, from coarse to fine."""
        if self.integrator is None:
            # Stability, not accuracy, gives explicit methods their steps there: all cost the same.
            bound = self.problem == "stiff" and self.scheme in {"RK45", "DOP853"}
            return [10.0**-k for k in range(3, FINEST[self.scheme] + 1, 3 if bound else 1)]
        if self.kind != "step":
            return [10.0**-k for k in range(3, 14)]
        damped = self.integrator.name == "GeneralizedAlpha"
        return [SPACING * 0.5**k for k in range(9 - damped + (self.problem == "fast"))]

    def run(self, setting: float, kind: str) -> tuple[Trajectory, float]:
        """One run, and processor time in s of its integration, to a tolerance of the whole call.

        Parameters
        ----------
        setting : float
        kind : {"step", "local tolerance", "tolerance"}
            Of the setting.

        Raises
        ------
        ArithmeticError
            If it fails.
        """
        integrator, how = self.integrator, {kind.replace(" ", "_"): setting}
        if integrator is not None and kind == "local tolerance":
            integrator, how = replace(integrator, local_tolerance=setting), {}
        source: Source = "in-house" if integrator is None else "engine"
        way = Way(source, cast("Any", self.formulation), cast("Any", integrator or self.scheme))
        begin = time.process_time()
        run = way.run(PROBLEMS[self.problem], TIMES, **how)
        if kind == "tolerance" or run.solver_seconds is None:
            return run, time.process_time() - begin
        return run, run.solver_seconds


def curves() -> dict[str, Curve]:
    """Every method on every problem that it can take."""
    found = [
        Curve(problem, formulation, scheme)
        for problem, scenario in PROBLEMS.items()
        for formulation in (*mbs_models.formulations(scenario), *analysis.formulations(scenario))
        for scheme in _schemes(problem, formulation)
    ]
    return {", ".join(curve): curve for curve in found}


def _schemes(problem: str, formulation: str) -> list[str]:
    if formulation in FORMULATIONS:
        return list(FINEST)
    varied, stiff = problem in VARIED, problem == "stiff"
    # On the Lie group alone the stiff one took a third of the time of the whole study.
    most = 0 if stiff and formulation == "floating-lie" else len(ACCELERATED) if stiff else 1
    stepped = [f"accelerations, {name}" for name in ACCELERATED[:most]]
    if formulation == "contact-tree":
        # There, the trapezoidal rule gives what it gives on the Euler tree.
        return ["RK67", "RK44", "DOPRI5", *(["trapezoidal"] if varied else []), *stepped]
    radii = ("1", "0.9", "0.6") if varied else ("0.9",)
    return ["trapezoidal", *(f"generalized-α {radius}" for radius in radii), *stepped]


def extrapolated(curve: Curve, runs: Sequence[tuple[float, Trajectory]]) -> Trajectory | None:
    """Runs, each of half the step of the one before, extrapolated as runs to a tolerance are.

    Parameters
    ----------
    curve : Curve
        Of the engine, with fixed steps.
    runs : sequence of (float, Trajectory)
        Steps in s and what they give.

    Returns
    -------
    Trajectory or None
        None if nothing tells its error yet.
    """
    rule, decay = INTEGRATORS[curve.scheme].name, PROBLEMS[curve.problem].slip_decay
    ladder = Ladder(cast("Any", curve.formulation), rule, decay)
    for step, run in runs:
        ladder.add(np.hstack((run.coordinates, run.rates, run.multipliers)), run.times, step)
    return replace(run, coordinates=ladder.best[:, :6]) if ladder.estimate < inf else None


def measure(curve: Curve) -> list[Row]:
    """Rows of a method, with the lesser time of two sweeps: no disturbance meets both."""
    rows, again = _sweep(curve), _sweep(curve)
    for row, other in zip(rows, again, strict=True):
        if not row["failure"]:
            row["seconds"] = min(row["seconds"], other["seconds"])
    return rows


def _sweep(curve: Curve) -> list[Row]:
    """Run a method along its ladder, extrapolated and to tolerances beside it."""
    rows, end = _ladder(curve)
    best = min((row["error"] for row in rows if not row["failure"]), default=inf)
    # The engine's step control, and in-house runs, are asked for the error of a step alone.
    asked = curve.kind == "step" or curve.scheme.startswith("accelerations")
    goals = [goal for goal in GOALS if asked and best <= goal]
    rows += [_attempt(curve, goal, "tolerance")[0] for goal in goals]
    return [{**row, "end": end} for row in rows]


def _ladder(curve: Curve) -> tuple[list[Row], str]:
    """Rows of the rungs, then of extrapolated ones; why it ends."""
    rungs: list[Row] = []
    better: list[Row] = []
    rung_errors: list[float] = []
    unbroken: list[tuple[Row, Trajectory]] = []
    fixed_step = curve.kind == "step"
    for setting in curve.ladder():
        row, run = _attempt(curve, setting, curve.kind)
        rungs.append(row)
        rung_errors.append(inf if run is None else row["error"])
        # The extrapolation needs unbroken halving.
        unbroken = [] if run is None else [*unbroken, (row, run)]
        parts = [(part["setting"], each) for part, each in unbroken]
        if parts and fixed_step and (whole := extrapolated(curve, parts)) is not None:
            costs = {name: sum(part[name] for part, _ in unbroken) for name in _COSTS}
            found = errors(whole, reference(curve.problem))
            better.append({**row, **found, **costs, "kind": "extrapolated"})
            # Implicit rules are of second order and would take minutes to get there alone.
            if INTEGRATORS[curve.scheme].implicit:
                rung_errors[-1] = min(rung_errors[-1], found["error"])
        if (end := ladder_end(rung_errors)) is not None:
            break
    return [*rungs, *better], end or ("work" if fixed_step else "finest")


def ladder_end(rung_errors: Sequence[float]) -> str | None:
    """Why a ladder needs no finer rung, or None if it does.

    Parameters
    ----------
    rung_errors : sequence of float
        Errors of its rungs, from coarse to fine; infinite for failed ones.
    """
    if rung_errors[-1] <= GOALS[-1]:
        return "goal"
    found_useful = min(rung_errors[:-2], default=inf) < USEFUL
    return "failure" if found_useful and min(rung_errors[-2:]) == inf else None


_COSTS = ("seconds", "work", "steps")


def _attempt(curve: Curve, setting: float, kind: str) -> tuple[Row, Trajectory | None]:
    """Row of one run, and the run; None if it failed, which is a result with its reason."""
    row: Row = {**curve._asdict(), "kind": kind, "setting": setting, "failure": ""}
    try:
        run, seconds = curve.run(setting, kind)
        row |= errors(run, reference(curve.problem))
    except ArithmeticError as error:
        nothing = dict.fromkeys((*_COSTS, "error", "angle_error"))
        return {**row, **nothing, "failure": " ".join(str(error).split())}, None
    work = run.counts.get("right_hand_sides") or run.counts.get("newton_iterations", 0)
    return {**row, "seconds": seconds, "work": work, "steps": run.counts.get("steps", 0)}, run
