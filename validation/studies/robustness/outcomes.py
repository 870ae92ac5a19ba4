"""Hard cases, each run to its end and classified from measured error, drift and energy."""

import time
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np
import pandas as pd

import analysis
import mbs_models
from analysis import Method, Trajectory
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT
from mbs_models import Scene
from validation.comparison.differences import deviation, ending_error, energy_error
from validation.comparison.references import STIFF, Reference, reference
from validation.comparison.ways import StepLimit, Way, WorkLimitError
from validation.studies.robustness.problems import Problem, problems
from validation.study import Row, Study, load

IN_HOUSE: tuple[Method, ...] = ("DOP853", "Radau")
"""Methods of the in-house equations, of which stiff friction is left to the last one."""

GOOD = ("accurate", "ends: contact would pull", "ends: condition met", "ends: lies flat")
"""Verdicts on what is as it should be."""

BAD = ("inaccurate", "reference in doubt", "diverged", "not finished in the limit", "crashed")

STEPS = {"engine": 50_000, "in-house": 20_000}
"""Most steps of a run per second, all its passes together, by source; see `StepLimit`."""

TIME_LIMIT = 600.0
"""Time in s after which the runs of a problem are ended, many times what their steps take."""

DOUBT = 0.1
"""Largest doubt of a reference, in parts of the tolerance, that leaves a verdict possible."""

SLACK = 10.0
"""Times the angles' allowed error in rad that drift over radius and relative energy error may be.

Speeds and forces are not what a tolerance promises, and converge more slowly in some methods.
"""

FEW = 3
"""Samples up to which a run is repeated, to see whether it gives the same bits; but for those
of which the ending is looked at, which are many."""

Known = Reference | ArithmeticError
"""The reference of a problem, or why there is none."""

COLUMNS = {
    "way": "formulation and integrator",
    "tolerance": "error asked for in rad, and of the time of an ending in s",
    "verdict": "verdict",
    "error": "largest error of β and γ in rad, and of the time of an ending in s",
    "doubt": "difference of both references in rad or s",
    "estimate": "the run's own estimate of its error in rad",
    "drift": "drift / radius",
    "energy": "energy error, relative",
    "repeatable": "whether a second run gives the same bits",
    "seconds": "time in s by the clock",
    "reason": "what the run said",
}


def ways(problem: Problem) -> list[Way]:
    """Ways that apply to a problem."""
    if problem.cover == "chosen":
        return [Way("engine")]
    scenario, found = problem.scenario, []
    most = None if problem.cover == "all" else 1
    formulations = mbs_models.formulations(scenario)
    for formulation in formulations[: 1 if problem.cover == "fastest" else None]:
        integrators = mbs_models.integrators(Scene(scenario, formulation))
        found += [Way("engine", formulation, each) for each in integrators[:most]]
    methods = IN_HOUSE[-1:] if scenario.friction.finest_speed < STIFF else IN_HOUSE[:most]
    return found + [
        Way("in-house", formulation, method)
        for formulation in analysis.formulations(scenario)
        for method in methods
    ]


# --- Running ------------------------------------------------------------------------------------


def measure(problem: Problem) -> list[Row]:
    """What becomes of a problem in each of its ways."""
    known: Known
    try:
        known = reference(problem.scenario, problem.times, stop_when=problem.stop_when)
    except ArithmeticError as error:
        known = error
    return [outcome(problem, way, known) for way in ways(problem)]


def outcome(problem: Problem, way: Way, known: Known) -> Row:
    """Run a problem in one way, and classify what becomes of it."""
    found: Row = {"way": way.name, "tolerance": problem.tolerance, "reason": ""}
    begin = time.perf_counter()
    try:
        run = simulate(problem, way)
    except (ArithmeticError, ValueError) as error:
        # What is asked for can be run: a refusal is a crash.
        verdict = "diverged" if isinstance(error, ArithmeticError) else "crashed"
        if isinstance(error, WorkLimitError):
            verdict = "not finished in the limit"
        found |= {"verdict": verdict, "reason": _line(error)}
        return found | {"seconds": time.perf_counter() - begin}
    found["seconds"] = time.perf_counter() - begin
    if problem.samples <= FEW and problem.stop_when is None:
        again, names = simulate(problem, way), ("coordinates", "rates", "multipliers")
        pairs = ((getattr(run, name), getattr(again, name)) for name in names)
        found["repeatable"] = all(np.array_equal(*both) for both in pairs)
    return found | classified(problem, run, known)


def simulate(problem: Problem, way: Way) -> Trajectory:
    """Simulate a problem to its tolerance, with so many steps as it may take."""
    # Step control has a local tolerance of its own and promises nothing more.
    tolerance = None if way.integrator == "DOPRI5" else problem.tolerance
    with StepLimit(STEPS[way.source], problem.end) as count:
        how: Any = {"stop_when": problem.stop_when or (), "progress": count}
        return way.run(problem.scenario, problem.times, tolerance=tolerance, **how)


def _line(error: Exception) -> str:
    return " ".join(str(error).split())


# --- Judging ------------------------------------------------------------------------------------


def classified(problem: Problem, run: Trajectory, known: Known) -> Row:
    """Classify a result by its deviation from the reference.

    `accurate`: the error is within what was asked for and the doubt of the reference, that doubt
    is at most `DOUBT` of the former, and drift and energy are within `SLACK` times that. `ends:
    …`: so it is, up to where it ends, and the reference ends there for the same reason.
    `inaccurate`: it is beyond that. `reference in doubt`: no reference is good enough.
    """
    found: Row = {"tolerance": problem.tolerance, "estimate": run.error_estimate}
    if isinstance(known, ArithmeticError):
        reason = f"the reference fails: {_line(known)}"
        return found | {"verdict": "reference in doubt", "reason": reason}
    truth = known.beside(run)
    late = ending_error(run, truth)
    found |= {
        "error": max(deviation(run, truth), late),
        "doubt": known.doubt,
        "energy": energy_error(run, truth),
    }
    if run.scenario.contact is None:
        residual, _ = analysis.constraint_drift(run)
        found["drift"] = float(np.max(residual)) / run.scenario.disk.radius
    if run.ending or truth.ending:
        one, other = (each.ending or "does not end early" for each in (run, truth))
        same = late <= problem.tolerance
        found["reason"] = str(one) if same else f"{one}; reference: {other}"
    return found | {"verdict": _verdict(run, found)}


def _verdict(run: Trajectory, found: Row) -> str:
    known, right, kept = within(found)
    if right and not known:
        return "reference in doubt"
    pulls = run.scenario.contact is None and not np.all(run.normal_force[:-1] >= 0.0)
    if pulls or not (known and right and kept):
        return "inaccurate"
    if run.ending is None:
        return "accurate"
    kinds = {CONTACT_WOULD_PULL: "ends: contact would pull", FLAT: "ends: lies flat"}
    return kinds.get(run.ending.reason, "ends: condition met")


def within(row: Row) -> tuple[bool, bool, bool]:
    """What the numbers of a run, as they were measured or are stored, are good enough for.

    Returns
    -------
    known : bool
        Whether the reference is good enough.
    right : bool
        Whether the angles are within what was asked for, and where and why it ends.
    kept : bool
        Whether drift and energy are.
    """
    # What the references leave open cannot be held against the run.
    allowed = row["tolerance"] + row["doubt"]
    kept = row["energy"] <= SLACK * allowed and not row.get("drift", nan) > SLACK * allowed
    known = row["doubt"] <= DOUBT * row["tolerance"]
    return bool(known), bool(row["error"] <= allowed), bool(kept)


def is_broken(row: Row) -> bool:
    """Whether a run crashed, broke its promise or, run again, gave other bits.

    The promise is about the angles, and about where and why the run ends. A run without an error
    estimate, such as one with step control, promises nothing.

    Parameters
    ----------
    row : dict
        As it was measured or is stored; what does not apply is not there or not a number.
    """
    if row["verdict"] == "crashed" or row.get("repeatable") is False:
        return True
    promises = pd.notna(row.get("estimate")) and pd.notna(row.get("error"))
    return promises and row["verdict"] != "reference in doubt" and not within(row)[1]


_NO_CONVERGENCE = "Newton's iteration does not converge"
UNFINISHED = ("too many steps", _NO_CONVERGENCE)
"""Causes for which another way may do better."""

_CAUSES = {
    "reference in doubt": "no reference is good enough",
    "not finished in the limit": UNFINISHED[0],
    "Newton's iteration did not converge": _NO_CONVERGENCE,
}
"""Words of a verdict or message, and the cause they stand for; others stand for themselves."""


def cause(row: Row) -> str:
    """Why a case is not accurate; empty if it is."""
    verdict = str(row["verdict"])
    if verdict in GOOD:
        return ""
    if verdict == "inaccurate":
        _, right, _ = within(row)
        return "angles accurate, energy or constraint not" if right else "wrong angles or ending"
    said = str(row["reason"]) if verdict == "diverged" else verdict
    return next((meant for words, meant in _CAUSES.items() if words in said), said)


# --- The studies --------------------------------------------------------------------------------

SAMPLE = (
    "smoothing ε in m/s: 1, Model 1",
    "smoothing ε in m/s: 1e-2, Model 1",
    "contact stiffness in N/m: 1e4, Model 1",
    "start above the table: 5 mm, undamped, Model 1",
    "just touching at the start: 100 N s/m, Model 1",
    "spin in rad/s: 0, Model 1",
    "spin in rad/s: -40, Model 1",
    "contact load: spin, μ: 300 rad/s, 0.3, Model 1",
    "tilt β in rad: π − 0.01, Model 1",
    "eccentricity in m: 1e-9, Model 1",
    "inertia about the COG: lamina, Model 1",
    "radius of the disk in m: 0.001, Model 1",
    "ellipse: other semi-axis over r: 0.5, Model 1",
    "friction μ: 0, Model 1",
    "start: inverted, below critical spin, Model 1",
    "sampling, duration: 2 samples, 0.5 s, Model 1",
    "sampling, duration: 2 samples, rolling fast, Model 1",
    "inclination of the table: 2°, Model 1",
    "constraint set: contact + no-slip-along",
    "constraint set: contact + no-slip-along + no-slip-across",
    "constraint set: contact + fixed-cog + constant-spin",
    "ended by a condition, or a pull: pull 139 rad/s 1e-8, Model 1",
    "ended by a condition, or a pull: pull 140 rad/s 1e-3, Model 1",
    "ended by a condition, or a pull: inverted 36.35 rad/s 1e-3, Model 1",
)
"""Problems that are measured again for each report: some of each axis."""

CASES = Study(
    name="robustness",
    cases=problems,
    measure=measure,
    sample=SAMPLE,
    confirm={
        "way": None,
        "verdict": None,
        "repeatable": None,
        "error": lambda stored: DOUBT * float(stored["tolerance"]),
    },
    limit=TIME_LIMIT,
    columns=COLUMNS,
)


def explained(table: pd.DataFrame) -> pd.DataFrame:
    """A table of cases with what is extreme, causes of failure, and what is broken and right."""
    rows = table.to_dict("records")
    return table.assign(
        axis=table["case"].str.rpartition(": ")[0],
        cause=[cause(row) for row in rows],
        broken=[is_broken(row) for row in rows],
        right=table["verdict"].isin(GOOD),
    )


def unfinished() -> dict[str, Problem]:
    """Problems in which a way of the engine's own does not finish, left to the library."""
    table = explained(load(CASES))
    names = table.loc[table["cause"].isin(UNFINISHED), "case"].unique()
    return {name: replace(problems()[name], cover="chosen") for name in names}


CHOSEN = replace(
    CASES,
    name="robustness-chosen",
    cases=unfinished,
    # They are run once.
    confirm={name: limit for name, limit in CASES.confirm.items() if name != "repeatable"},
    sample=(
        "smoothing ε in m/s: 1e-5, Model 1",
        "inertia about the COG: rod along y, Model 1",
        "smoothing ε in m/s: 1e-4, Model 3",
    ),
)
"""The same with the formulation and integrator that the library chooses."""
