"""What is measured: problems with their references, and methods on them along a ladder.

Nothing here looks at a clock to decide anything: ladders end by errors and by counted work, so
that every machine makes the same runs.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import inf
from typing import Any, NamedTuple, cast

import numpy as np

import analysis
import mbs_models
from analysis import MODELS, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.problem.choices import ACCELERATED, FORMULATIONS, Source
from mbs_models import Integrator, Scene
from mbs_models.extrapolation import Ladder
from validation.comparison.ways import Way
from validation.study import Row, Study, relative

# --- Problems -----------------------------------------------------------------------------------

SPACING = 0.02
"""Time between samples, and so the longest step, in s."""

TIMES = np.linspace(0.0, 2.0, 101)
"""Times in s at which every run is sampled and compared."""

SAFETY = 100.0
"""Errors below this many times the references' disagreement are not told apart from it."""

_PROBLEMS: dict[str, tuple[str, dict[str, Any]]] = {
    **{f"model-{n}": (f"Model {n}", {"constraints": held}) for n, held in MODELS.items()},
    "contact-load": ("Model 1, load λ_N", {"friction": SmoothCoulomb(load="contact")}),
    "stiff": ("Model 1, stiff: ε = 1e-3 m/s", {"friction": SmoothCoulomb(smoothing=1e-3)}),
    "undamped": ("Model 1, undamped: μ = 0", {"friction": SmoothCoulomb(coefficient=0.0)}),
    "fast": ("Model 1, fast: spin 100 rad/s", {"start": Start(spin=100.0)}),
}
TITLES = {name: title for name, (title, _) in _PROBLEMS.items()}
PROBLEMS = {name: Scenario(**changes) for name, (_, changes) in _PROBLEMS.items()}
"""Motions over 2 s from Table 3, each with one thing changed."""

_REFERENCE_TOLERANCE = 3e-14
"""Local tolerance of the references, the tightest there is."""

_SUBSTEPS = {"stiff": 256, "fast": 256}
"""Steps of RK67 between two samples, 64 of the others: fewer truncate, more round."""

_SLOW = ("stiff", "undamped", "fast")
"""Problems on which Radau takes minutes to say what the engine says."""


@cache
def reference(problem: str) -> Trajectory:
    """In-house run with DOP853 that everything is compared with; made once per process."""
    return analysis.simulate(PROBLEMS[problem], TIMES, local_tolerance=_REFERENCE_TOLERANCE)


def measure_reference(problem: str) -> list[Row]:
    """Difference of a run by another method or on the other side from the reference, or of two."""
    scenario, others = PROBLEMS[problem], []
    if "contact-tree" in mbs_models.formulations(scenario):
        step = SPACING / _SUBSTEPS.get(problem, 64)
        run = Way("engine", "contact-tree", "RK67").run(scenario, TIMES, step=step)
        others.append(("engine, contact tree, RK67", step, run))
    if not others or problem not in _SLOW:
        run = analysis.simulate(scenario, TIMES, method="Radau", local_tolerance=1e-12)
        others.append(("in-house, Radau", 1e-12, run))
    truth = reference(problem)
    return [
        {"other": other, "setting": setting, "difference": errors(run, truth)["error"]}
        for other, setting, run in others
    ]


def errors(run: Trajectory, truth: Trajectory) -> Row:
    """By how much a run differs from another.

    Returns
    -------
    dict
        The largest over the motion of: `error`, the differences of beta and gamma in rad and of
        the centre of gravity's position over the radius; `angle_error`, the former alone.

    Raises
    ------
    ArithmeticError
        If it does not reach its end, or a number is not finite.
    """
    if run.ending is not None:
        raise ArithmeticError(f"{run.ending.reason} at t = {run.ending.time:.6g} s")
    angles = (run.coordinates - truth.coordinates)[:, 4:6]
    angle = float(np.max(np.abs(angles - 2 * np.pi * np.round(angles / (2 * np.pi)))))
    apart = np.linalg.norm(run.cog_positions - truth.cog_positions, axis=1)
    error = float(np.max((angle, np.max(apart) / run.scenario.disk.radius)))
    if not np.isfinite(angle + error):
        raise ArithmeticError("the result is not finite")
    return {"error": error, "angle_error": angle}


REFERENCES = Study(
    name="work-precision-references",
    cases=lambda: {name: name for name in PROBLEMS},
    measure=measure_reference,
    confirm={"other": None, "difference": 1e-11},
    sample=("model-1", "model-3"),
    columns={
        "other": "compared with",
        "setting": "step or tolerance",
        "difference": "largest difference in rad",
    },
)

# --- Methods ------------------------------------------------------------------------------------

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
        return INTEGRATORS.get(self.scheme)

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
        source: Source = "in-house" if self.integrator is None else "engine"
        scheme: Any = self.integrator or self.scheme
        way = Way(source, cast("Any", self.formulation), scheme)
        begin = time.process_time()
        run = way.run(PROBLEMS[self.problem], TIMES, **{kind.replace(" ", "_"): setting})
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
    scene = Scene(PROBLEMS[curve.problem], cast("Any", curve.formulation))
    ladder = Ladder(scene, INTEGRATORS[curve.scheme])
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
        return {**row, "failure": " ".join(str(error).split())}, None
    work = run.counts.get("right_hand_sides") or run.counts.get("newton_iterations", 0)
    return {**row, "seconds": seconds, "work": work, "steps": run.counts.get("steps", 0)}, run


CURVES = Study(
    name="work-precision",
    cases=curves,
    measure=measure,
    confirm={
        "kind": None,
        "setting": relative("setting", 1e-6),
        "work": relative("work", 0.01),
        # Smaller errors are known to a part of the finest goal alone.
        "error": relative("error", 0.05, 0.05 * GOALS[-1]),
        "end": None,
    },
    sample=(
        "model-1, contact-tree, RK67",
        "model-1, contact-tree, RK44",
        "model-1, index-1, DOP853",
        "model-3, floating, trapezoidal",
        "stiff, contact-tree, DOPRI5",
    ),
    columns={
        "kind": "what is asked for: a step, a tolerance of each step, of the whole run, or steps "
        "down to one, extrapolated",
        "setting": "step in s or tolerance",
        "seconds": "processor time in s of the integration; to a tolerance, of the whole call",
        "work": "evaluations of the right-hand side, one per Newton iteration",
        "error": "largest difference of β, γ in rad and of the centre of gravity over the radius",
        "end": "why the ladder has no finer rungs",
    },
)
