"""The maps: what each shows, over which axes, how its cases are run, and how fine it is.

Source of the uncertainty exponent: C. Grebogi, S. W. McDonald, E. Ott and J. A. Yorke, Final state
sensitivity: an obstruction to predictability, Physics Letters A 99 (1983).
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import pi
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

import analysis
import mbs_models
from analysis import MODELS, Scenario
from analysis.problem.checks import Array, whole, within
from analysis.problem.scenario import require_level
from analysis.problem.variations import changed
from analysis.stability.critical import critical_speeds
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan
from validation.sweeps.sweep import Sweep

THEORY_SAMPLES = 31
"""Places along the vertical axis at which critical speeds are worked out."""

DISTANCES = (0.04, 0.04 / 4, 0.04 / 16, 0.04 / 64)
"""Between the two starts of a pair, as parts of the width of a map."""

RESAMPLINGS = 200
"""Of the pairs, for the error of the exponent."""

_STEEPEST = 50.0
"""Slope beyond which no exponent of counted pairs lies."""


class Problem(NamedTuple):
    """A map: two axes, and what becomes of the disk on them.

    Parameters
    ----------
    title : str
    right, up : Axis
        Horizontal and vertical one.
    end : float
        Of each motion in s, unless another is asked for.
    basins : bool
        Whether Models 1 to 4 are beside each other.
    by_face : bool
        Whether its cases are told apart by the face that is up in the end, not by the inversion.
    """

    title: str
    right: Axis
    up: Axis
    end: float = 4.0
    basins: bool = False
    by_face: bool = False


_TILT = Axis(field="start.beta", first=pi / 2 - 0.7, last=pi / 2 + 0.7)
_TURN = Axis(field="start.gamma", first=-pi / 2, last=pi / 2)
_SPIN = Axis(field="start.spin", first=20.0, last=60.0)
_TILTING = Axis(field="start.beta_rate", first=-15.0, last=15.0)
_FRICTION = Axis(field="friction.coefficient", first=0.02, last=0.6)
_ECCENTRICITY = Axis(field="disk.eccentricity", first=2.5e-4, last=6e-3)
_NEAR_CRITICAL = Axis(field="start.spin", first=24.0, last=36.0)
_NEAR_UPRIGHT = Axis(field="start.beta", first=pi / 2 - 0.4, last=pi / 2 + 0.4)

PROBLEMS = {
    "spin-friction": Problem("Inversion over spin and friction", _SPIN, _FRICTION),
    "spin-eccentricity": Problem("Inversion over spin and eccentricity", _SPIN, _ECCENTRICITY),
    "attitude": Problem("Inversion over the attitude at the start", _TURN, _TILT),
    "tilting": Problem("Inversion over tilt and tilting rate at the start", _TILTING, _TILT),
    "basins": Problem("Starts that end in inverted spinning, by model", _TURN, _TILT, basins=True),
    "rest": Problem("Which face is up at rest", _NEAR_CRITICAL, _NEAR_UPRIGHT, 20.0, by_face=True),
}
"""By the names of the command."""


def panels(
    problem: Problem,
    scenario: Scenario,
    *,
    cells: int,
    levels: int,
    witnesses: int,
    **how: Any,
) -> list[Sweep]:
    """Sweeps over the finest grids of a map, its vertical axis first.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    cells : int
        Of the coarse grid along each axis.
    levels : int
        How often cells are halved where outcomes change.
    witnesses : int
        Cases of the coarse grid that the other side runs as well, evenly spread, and as large a
        part of the others.
    **how
        As in `quickest_plan`.

    Raises
    ------
    ValueError
        If a number is out of range, or a map that is decided by the energy has a leaning table,
        which brings more and more of it.
    """
    if problem.by_face:
        require_level(scenario, "a map of the face that is up")
    within("cells", cells, 1, 10_000)
    within("levels", levels, 0, 12)
    whole("witnesses", witnesses, least=0)
    count = cells * 2**levels + 1
    witnesses = round(witnesses * count**2 / (cells + 1) ** 2)
    axes = tuple(replace(axis, count=count) for axis in (problem.up, problem.right))
    models = MODELS.values() if problem.basins else [scenario.constraints]
    sweeps = []
    for constraints in models:
        each = replace(scenario, constraints=constraints)
        plan = quickest_plan(each, witnesses, **how)
        sweeps.append(Sweep(scenario=each, design=Design(axes=axes), plan=plan))
    return sweeps


def quickest_plan(
    scenario: Scenario, witnesses: int, *, compiled: bool = False, **limits: float
) -> Plan:
    """Way to run the cases of a map in the least time; its witnesses see to the error.

    Compiled, an ideal contact runs with Taylor's method to 1e-6 rad in batches; its witnesses,
    which would take most of the time, run to 1e-3 rad. Otherwise Model 1 runs in the engine where
    its contact tree takes it, Model 4 as the reduced system, everything else with the in-house
    equations. Each runs until `end` and within a `time_limit`, both in s, as a `Plan` has them.
    """
    how: dict[str, Any] = {"witnesses": witnesses, **limits}
    if scenario.contact is not None:
        return Plan(to_rest=True, spacing=1e-2, local_tolerance=1e-6, **how)
    formulation = "reduced" if "reduced" in analysis.formulations(scenario) else None
    if compiled:
        how |= {"method": "taylor", "tolerance": 1e-6, "witness_tolerance": 1e-3}
        return Plan(formulation=formulation, **how)
    how["local_tolerance"] = 1e-6
    if "contact-tree" in mbs_models.formulations(scenario):
        return Plan(source="engine", formulation="contact-tree", **how)
    return Plan(formulation=formulation, **how)


def critical_points(sweep: Sweep) -> dict[str, Array]:
    """Critical spins of inverted spinning along the vertical axis by kind, shape (n, 2) each.

    Empty for a map that has no spin along its horizontal axis, or a start along the other, and
    where no stationary spinning is linearised, as of other bodies or on a leaning table.
    """
    (up, heights), (right, spins) = ((axis.field, axis.grid) for axis in sweep.design.axes)
    points: dict[str, list[tuple[float, float]]] = {"hopf": [], "static": []}
    if right == "start.spin" and not up.startswith("start."):
        for value in np.linspace(heights[0], heights[-1], THEORY_SAMPLES).tolist():
            with suppress(ValueError):
                found = critical_speeds(
                    changed(sweep.scenario, {up: value}), (spins[0], spins[-1])
                )
                for crossing in found.crossings:
                    points[crossing.kind].append((crossing.spin, value))
    return {kind: np.array(each).reshape(-1, 2) for kind, each in points.items()}


# --- The uncertainty exponent of its boundaries --------------------------------------------------


class Uncertainty(NamedTuple):
    """Part f of the starts whose class an error of the start changes, f ~ distance**exponent.

    Parameters
    ----------
    parts : ndarray, shape (n,)
        Of pairs of starts so far apart, those of different class.
    exponent : float
        1 for smooth boundaries, less for fractal ones, and for such as are finer than the
        distances.
    error : float
        Standard deviation of the exponent over resampled pairs.
    """

    parts: Array
    exponent: float
    error: float


def shifted_sweeps(
    problem: Problem, scenario: Scenario, *, number: int, **how: Any
) -> list[Sweep]:
    """Sweeps over random starts of a map, and over the same ones at each of `DISTANCES`.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    number : int
        Of starts; for 0 there are no sweeps.
    **how
        As in `quickest_plan`.
    """
    plan = quickest_plan(scenario, 0, **how)
    first, last = (float(problem.right.draw(part)) for part in (0.0, 1.0))
    sweeps = []
    for distance in (0.0, *DISTANCES) if number else ():
        # The same random numbers between shifted ends are the same starts, shifted.
        shift = distance * (last - first)
        shifted = replace(problem.right, first=first + shift, last=last + shift)
        design = Design(axes=(shifted, problem.up), layout="random", number=number)
        sweeps.append(Sweep(scenario=scenario, design=design, plan=plan))
    return sweeps


def uncertainty(
    outcomes: npt.ArrayLike, distances: Sequence[float] = DISTANCES
) -> Uncertainty | None:
    """Uncertainty exponent from pairs of starts.

    Parameters
    ----------
    outcomes : array_like of str, shape (1 + n, k)
        Of k starts, and of those beside them at n distances. Starts of which one outcome is not
        decided are left out.
    distances : sequence of float

    Returns
    -------
    Uncertainty or None
        None if fewer than two distances have pairs that differ.
    """
    found = np.asarray(outcomes)
    found = found[:, ~np.any(np.isin(found, ("not decided", "failed")), axis=0)]
    differs, apart = found[1:] != found[0], np.array(distances)
    counts, pairs = differs.sum(axis=1), differs.shape[1]
    if np.count_nonzero(counts) < 2:
        return None
    random = np.random.default_rng(0)
    resampled = (
        differs[:, random.integers(pairs, size=pairs)].sum(axis=1) for _ in range(RESAMPLINGS)
    )
    slopes = [_slope(apart, each) for each in resampled if np.count_nonzero(each) > 1]
    return Uncertainty(
        parts=counts / pairs, exponent=_slope(apart, counts), error=float(np.std(slopes))
    )


def _slope(distances: Array, counts: npt.NDArray[np.int_]) -> float:
    """Slope of log(count) over log(distance) of greatest likelihood, for Poisson's distribution.

    A line through the logarithms could make nothing of a count of 0.
    """
    logs = np.log(distances)
    mean = np.average(logs, weights=counts)

    def excess(slope: float) -> float:
        return float(np.average(logs, weights=distances**slope) - mean)

    return float(brentq(excess, -_STEEPEST, _STEEPEST))
