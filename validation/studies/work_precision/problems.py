"""Initial value problems of error against run time, their references and their errors."""

from functools import cache
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import MODELS, Scenario, SmoothCoulomb, Start, Trajectory
from validation.study import Row

SPACING = 0.02
"""Time between samples, and so the longest step, in s."""

TIMES = np.linspace(0.0, 2.0, 101)
"""Times in s at which every run is sampled and compared."""

SAFETY = 100.0
"""Errors below this many times the references' disagreement are not told apart from it."""

_PROBLEMS: dict[str, tuple[str, dict[str, Any]]] = {
    **{f"model-{n}": (f"Model {n}", {"constraints": held}) for n, held in MODELS.items()},
    "contact-load": (
        "Model 1, friction knows the contact force",
        {"friction": SmoothCoulomb(load="contact")},
    ),
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
    """Difference of a run by another family of methods from the reference, or of two."""
    scenario, others = PROBLEMS[problem], []
    if "contact-tree" in mbs_models.formulations(scenario):
        step = SPACING / _SUBSTEPS.get(problem, 64)
        scene = mbs_models.Scene(scenario, "contact-tree")
        run = mbs_models.simulate(scene, TIMES, step=step, integrator="RK67")
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
