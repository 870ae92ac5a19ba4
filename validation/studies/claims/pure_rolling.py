"""Whether a disk that rolls without slip inverts (Sect. 4.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from analysis import ConstraintSet, Inversion, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from validation.kit import figures
from validation.kit.figures import Picture
from validation.kit.tables import Cell, Table
from validation.run import run
from validation.studies.claims.claim import Claim, grade, listed

SPINS = (20.0, 30.0, 40.0, 60.0, 80.0, 100.0)
"""Spins at the start in rad/s."""

COEFFICIENTS = (0.3, 3.0, 30.0, 300.0, 3000.0, inf)
"""Friction coefficients with the paper's smoothing, on the way to the limit of no slip."""

PURE_ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")

ENGINE_STEP = 2e-3
"""Step in s of the engine's runs."""

LOCAL_TOLERANCE = 1e-8
"""Of a step of the in-house runs."""

TIMES = np.linspace(0.0, 5.0, 1001)
"""Times of all runs in s."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rolling:
    """A run from Table 3 without slip.

    `direction` is the height of the centre of gravity over the geometric centre as a part of its
    largest, shape (n,), over `TIMES`.
    """

    spin: float
    direction: Array
    inversion: Inversion

    @property
    def longest(self) -> float:
        """Longest time in s for which the centre of gravity stays above the geometric centre."""
        change = np.diff(np.concatenate(([0], self.direction > 0.0, [0])).astype(int))
        begins, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
        return float(np.max(ends - begins, initial=0) * (TIMES[1] - TIMES[0]))


def roll(spin: float) -> Rolling:
    """Roll without slip from Table 3's position with this spin."""
    scenario = Scenario(constraints=PURE_ROLLING, start=Start(spin=spin))
    found = run(scenario, TIMES, source="in-house", local_tolerance=LOCAL_TOLERANCE)
    return Rolling(
        spin=spin,
        direction=found.cog_direction,
        inversion=found.inversion,
    )


def slip(coefficient: float) -> tuple[Trajectory, Trajectory]:
    """From Table 3 with this friction coefficient, or without slip, engine and in-house."""
    if coefficient == inf:
        scenario, method = Scenario(constraints=PURE_ROLLING), "DOP853"
    else:
        scenario = Scenario(friction=SmoothCoulomb(coefficient=coefficient))
        method = "LSODA"
    return (
        run(scenario, TIMES, formulation="euler-tree", step=ENGINE_STEP),
        run(
            scenario,
            TIMES,
            source="in-house",
            method=method,
            local_tolerance=LOCAL_TOLERANCE,
        ),
    )


def claim(rolled: Sequence[Rolling]) -> Claim:
    """Section 4.3: pure rolling does not lead to the inversion."""
    outcomes = [each.inversion.outcome for each in rolled]
    return Claim(
        place="Sect. 4.3",
        statement="pure rolling (v_C = 0) does not lead to the inversion",
        criterion="no start of Table 3 with spins of "
        f"{', '.join(f'{each.spin:g}' for each in rolled)} rad/s is inverted within "
        f"{TIMES[-1]:g} s; partly: some",
        measured=f"{sum(outcome == 'not inverted' for outcome in outcomes)} of {len(rolled)} are "
        f"not inverted; the centre of gravity rises to {listed(_highest(rolled))} of its height "
        f"and stays above the geometric centre for at most "
        f"{max(each.longest for each in rolled):.2f} s",
        verdict=grade(
            yes=all(outcome == "not inverted" for outcome in outcomes),
            partly="not inverted" in outcomes,
        ),
    )


def table(results: Mapping[Any, Any]) -> Table:
    """On the way to pure rolling: the same start with more and more friction."""
    rows: list[list[Cell]] = []
    for coefficient in COEFFICIENTS:
        engine, inhouse = results["slip", coefficient]
        rows.append(
            [
                "pure rolling" if coefficient == inf else f"μ = {coefficient:g}",
                None if coefficient == inf else engine.scenario.friction.gradient,
                float(np.max(engine.cog_direction)),
                float(np.max(inhouse.cog_direction)),
                engine.inversion.outcome,
                inhouse.inversion.outcome,
            ]
        )
    return Table(
        name="pure-rolling",
        title="From the paper's friction to pure rolling, Table 3's start",
        columns=(
            "friction",
            "μ/ε in s/m",
            "highest place of the COG, engine",
            "in-house",
            "outcome, engine",
            "in-house",
        ),
        rows=rows,
        note="Highest place: part of the eccentricity above the geometric centre. In pure "
        "rolling both components of the slip are constraints. Engine: steps of "
        f"{1e3 * ENGINE_STEP:g} ms.",
    )


def draw(results: Mapping[Any, Any]) -> Picture:
    """Where the centre of gravity goes, with the paper's friction and without slip."""
    figure, axes = figures.new_figure(height=3.6)
    engine, _ = results["slip", COEFFICIENTS[0]]
    limit: Rolling = results["pure rolling", 40.0]
    shown = TIMES <= 2.0
    for index, (values, label) in enumerate(
        ((engine.cog_direction, "Model 1, μ = 0.3 (engine)"), (limit.direction, "pure rolling"))
    ):
        axes.plot(
            TIMES[shown],
            values[shown],
            color=figures.COLOURS[index],
            linestyle=figures.STYLES[index],
            label=label,
        )
    axes.axhline(0.9, color="#999999", linewidth=0.8)
    axes.annotate("0.9", (0.0, 0.9), va="bottom", fontsize=9)
    axes.set(xlabel="time in s", ylabel="height of the COG over\nthe centre / eccentricity")
    figures.legend_above(axes)
    return figures.render(
        figure,
        name="pure-rolling",
        title="Rolling without slip swings up and falls back",
        caption=f"Start of Table 3. Without slip the centre of gravity reaches "
        f"{np.max(limit.direction):.2f} of its height and is below the geometric centre again "
        f"within {limit.longest:.2f} s.",
    )


def _highest(rolled: Sequence[Rolling]) -> list[float]:
    return [float(np.max(each.direction)) for each in rolled]
