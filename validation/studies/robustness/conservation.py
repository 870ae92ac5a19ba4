"""What long runs must keep: their constraints, their energy balance, and constants of motion."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd

import analysis
from analysis import MODELS, STEEL_DISK, Level, Scenario, SmoothCoulomb, Trajectory
from analysis.problem.checks import Array
from validation.comparison.ways import Way
from validation.study import Content, Row, Study, at_most

SAMPLES_PER_SECOND = 200

END, FREE_END = 5.0, 2.0
"""In s, with friction and without."""

ENERGY = 1e-4
"""Largest residual of the energy balance over weight times radius."""

GROWTH = 1.5
"""Largest drift in the second half of the time over that in the first that does not grow."""

KEPT = ("energy", "momentum", "spin")
"""Columns of what does not change without friction.

The table's force is vertical then. So it changes neither the horizontal momentum nor, having no
moment about the vertical through the COG, the vertical angular momentum; and it does no work.
"""


class LongRun(NamedTuple):
    """A way to integrate a model from Table 3 over a long time.

    Parameters
    ----------
    model : {1, 2, 3, 4}
    way : Way
    accuracy : float
        Step in s of the engine, local tolerance of the in-house side.
    limits : dict
        Most that columns may be; without friction if `KEPT` is among them.
    """

    model: Level
    way: Way
    accuracy: float
    limits: dict[str, float]


def drifting(model: Level, way: Way, accuracy: float, drift: float, **limits: float) -> LongRun:
    """A run with friction, which may drift by this part of the radius."""
    limits |= {"position": drift * STEEL_DISK.radius, "energy": ENERGY}
    return LongRun(model, way, accuracy, limits)


DOP853 = Way("in-house", "index-1", "DOP853")
RK44, RK67, TRAPEZOIDAL = (
    Way("engine", "contact-tree", each) for each in ("RK44", "RK67", "TrapezoidalIndex2")
)
TREE, FLOATING, LIE = (
    Way("engine", each, "TrapezoidalIndex2") for each in ("euler-tree", "floating", "floating-lie")
)
ALPHA = Way("engine", "euler-tree", "GeneralizedAlpha")

HELD = {
    "velocity level (index 2), engine, Euler tree, 1 ms": TREE,
    "velocity level (index 2), engine, floating, 1 ms": FLOATING,
    "generalized α (position level but the contact), engine, Euler tree, 1 ms": ALPHA,
}
"""Ways that hold a constraint on velocity level, so that its drift must not go on growing."""

DRIFTING = {
    "acceleration level (index 1), tolerance 1e-6": drifting(
        3, Way("in-house", "index-1", "RK45"), 1e-6, 1e-5
    ),
    "acceleration level (index 1), tolerance 1e-10": drifting(3, DOP853, 1e-10, 1e-9),
    **{name: drifting(3, way, 1e-3, 1e-5, growth=GROWTH) for name, way in HELD.items()},
    "minimal coordinates, engine, contact tree, 5 ms (Model 1)": drifting(1, RK44, 5e-3, 1e-14),
    "minimal coordinates, in-house reduced, 1e-6 (Model 4)": drifting(
        4, Way("in-house", "reduced", "RK45"), 1e-6, 1e-14
    ),
}
"""With friction, by the level on which the constraints are met."""

_FREE = {RK67: 1e-9, RK44: 1e-6, **dict.fromkeys((TRAPEZOIDAL, TREE, ALPHA, FLOATING, LIE), 1e-3)}
FREE = {
    **{way.name: LongRun(1, way, 1e-3, dict.fromkeys(KEPT, each)) for way, each in _FREE.items()},
    DOP853.name: LongRun(1, DOP853, 1e-9, dict.fromkeys(KEPT, 1e-8)),
}
"""Without friction, by way."""


def measure(long: LongRun) -> Iterator[Row]:
    """Residuals of constraints and energy, and changes of what there is no friction to change."""
    free = KEPT[-1] in long.limits
    friction = SmoothCoulomb(coefficient=0.0) if free else SmoothCoulomb()
    scenario = Scenario(constraints=MODELS[long.model], friction=friction)
    end = FREE_END if free else END
    times = np.linspace(0.0, end, round(SAMPLES_PER_SECOND * end) + 1)
    accuracy = "step" if long.way.source == "engine" else "local_tolerance"
    run = long.way.run(scenario, times, **{accuracy: long.accuracy})
    disk, half = scenario.disk, times <= 0.5 * end
    position, velocity = analysis.constraint_drift(run)
    residual = analysis.energy_residual(run)
    momentum, spin = _momenta(run)
    rim = disk.mass * disk.radius * abs(run.rates[0, 3])
    yield {
        "position": np.max(position),
        "growth": np.max(position[~half]) / max(np.max(position[half]), 1e-300),
        "velocity": np.max(velocity),
        "energy": np.max(np.abs(residual)) / (scenario.weight * disk.radius),
        "momentum": np.max(np.abs(momentum - momentum[0])[:, :2]) / rim,
        "spin": np.max(np.abs(spin / spin[0] - 1.0)),
    }


def _momenta(run: Trajectory) -> tuple[Array, Array]:
    """Momentum, shape (n, 3), and vertical angular momentum about the COG, shape (n,)."""
    disk, (_, rotation, _, angular) = run.scenario.disk, run.poses
    moments = np.array(disk.inertia_about_cog)
    spin: Array = np.einsum("nj,j,nij,ni->n", rotation[:, 2, :], moments, rotation, angular)
    return disk.mass * run.cog_velocities, spin


COLUMNS = {
    "case": "way",
    "position": "largest position residual in m",
    "growth": "second half of the time over first",
    "velocity": "largest velocity residual in m/s",
    "energy": "energy residual / (weight · radius)",
    "momentum": "horizontal momentum / (mass · rim speed)",
    "spin": "vertical angular momentum about the COG, relative",
}
STUDY = Study(name="robustness-conservation", cases=lambda: DRIFTING | FREE, measure=measure)

_DRIFT = ["case", "position", "allowed", "growth", "velocity", "energy"]


def present(table: pd.DataFrame) -> Content:
    """How far constraints drift, and what changes that should not."""
    rows, runs = table.set_index("case", drop=False), DRIFTING | FREE
    drift, free = (
        rows.loc[list(part)].assign(allowed=[long.limits[name] for long in part.values()])
        for part, name in ((DRIFTING, "position"), (FREE, "energy"))
    )
    checks = [
        at_most(f"long run, {name}: {column}", rows.at[name, column], limit)
        for name, long in runs.items()
        for column, limit in long.limits.items()
    ]
    return Content(
        numbers={
            "growing": drift[drift.index.str.startswith("acceleration level")],
            "held": drift.loc[list(HELD)],
            "minimal": drift[drift.index.str.startswith("minimal coordinates")],
        },
        tables={
            "drift": drift[_DRIFT].rename(columns=COLUMNS),
            "conserved": free[["case", *KEPT, "allowed"]].rename(columns=COLUMNS),
        },
        checks=checks,
    )
