"""Maps of what becomes of the disk over two parameters, refined where it changes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import pi
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analysis import Scenario
from analysis.problem.checks import Array
from validation.maps import figures, problems
from validation.maps.panel import Panel, cell, mean_over_area, refine
from validation.maps.problems import DISTANCES, PROBLEMS, critical_points, panels, uncertainty
from validation.study import Check, Content, Row, Rows, Study, at_most, grade, relative
from validation.sweeps.case import run_chunk
from validation.sweeps.sweep import Sweep

TITLE = "Maps"

CELLS = 8
LEVELS = {"spin-friction": 2, "spin-eccentricity": 2, "tilting": 2, "basins": 2, "rest": 1}
"""Maps and how often their cells are halved; the one to rest takes longest."""

MAPS = ("spin-friction", "spin-eccentricity", "tilting")
"""That are shown beside each other."""

WITNESSES = 2
"""On the coarse grid of each panel; see `panels`."""

PAIRS = 40
"""Starts of the map to rest, beside which others are run."""

REPEATED = {
    "spin-friction": (257, 457),
    "spin-eccentricity": (255, 416),
    "tilting": (798, 536),
    "basins 1": (536, 275),
    "basins 2": (548, 213),
    "basins 3": (548, 142),
    "basins 4": (544, 528),
    "rest": (155, 120),
}
"""Cells of each panel that both sides run again: the middle ones of its two commonest outcomes."""

STEP = 2.5e-3
"""Step in s of the engine in repetitions of what runs in-house."""

NEAR = 0.3
"""Tilt from upright in rad within which the models are compared."""

BANDS = (0.1, NEAR, 0.5, 0.7)
"""Tilts from upright in rad up to which the models are compared."""

ABOVE = 3.0
"""Spin in rad/s by which the disk may have to be faster than the second critical speed."""

NEARLY_ALL = 95.0
"""Part in % of the starts of which the reduced system has to tell the end."""

SPEED_MAPS = {"spin-friction": 0.2, "spin-eccentricity": 1.5e-3}
"""Maps over the spin, and from where on along the other axis they are judged.

Below, other critical speeds come in, and 4 s are too short for friction to lift the disk.
"""


# --- Measuring -----------------------------------------------------------------------------------


class Case(NamedTuple):
    """A panel of a map, or some of its cells alone."""

    sweep: Sweep
    by_face: bool
    levels: int = 0
    numbers: Sequence[int] = ()


def whole() -> dict[str, Case]:
    """The panels by their names."""
    made = {}
    for name, levels in LEVELS.items():
        problem = PROBLEMS[name]
        size: Any = {"cells": CELLS, "levels": levels, "witnesses": WITNESSES}
        sweeps = panels(problem, Scenario(), end=problem.end, **size)
        for sweep in sweeps:
            label = f"{name} {sweep.scenario.model}" if problem.basins else name
            made[label] = Case(sweep, problem.by_face, levels)
    return made


def cases() -> dict[str, Case]:
    """Panels, cells of each that both sides run again, and random starts with some beside them."""
    known, rest = whole(), PROBLEMS["rest"]
    pairs = problems.shifted_sweeps(rest, Scenario(), number=PAIRS, end=rest.end)
    return {
        **known,
        **{_again(name): _both(known[name], numbers) for name, numbers in REPEATED.items()},
        **{
            _pairs(distance): Case(sweep, rest.by_face, numbers=range(PAIRS))
            for distance, sweep in zip((0.0, *DISTANCES), pairs, strict=True)
        },
    }


def _again(name: str) -> str:
    return f"{name}, again"


def _pairs(distance: float) -> str:
    return f"rest, starts {distance:g} widths away"


def _both(known: Case, numbers: Sequence[int]) -> Case:
    """The same with some cells, which both sides run."""
    plan, size = known.sweep.plan, known.sweep.design.size
    step = None if plan.source == "engine" else STEP
    plan = replace(plan, witnesses=size, witness_step=step)
    return Case(replace(known.sweep, plan=plan), known.by_face, numbers=numbers)


def measure(case: Case) -> list[Row]:
    """Cells with their places and outcomes, and what the other side says."""
    sweep, found = case.sweep, []

    def run(numbers: Iterable[int]) -> list[Row]:
        for number in numbers:
            (row,) = run_chunk(sweep, [number])
            found.append(cell(sweep, row, by_face=case.by_face) | sweep.design.values_of(number))
        return found

    if case.levels:
        refine(sweep.design.shape, case.levels, run)
    run(case.numbers)
    return sorted(found, key=lambda each: each["number"])


STUDY = Study(
    name="maps",
    cases=cases,
    measure=measure,
    sample=(*map(_again, REPEATED), _pairs(DISTANCES[0])),
    confirm={
        "number": None,
        "outcome": None,
        "seen": None,
        "alike": None,
        "time": relative("time", 1e-6),
        "difference": relative("difference", 0.1, 1e-7),
    },
    columns={
        "number": "of the cell on the finest grid, the axis to the right fastest",
        "outcome": "of the side that runs the map",
        "time": "of the inversion in s, where it lasts",
        "seen": "whether the other side was to run it, too",
        "alike": "whether it found the same outcome, or face that is up",
        "difference": "largest difference of β and γ between the sides in rad",
        "seconds": "processor time in s without the other side",
    },
)
STUDIES = (STUDY,)


# --- What is shown -------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Maps, what they say by criteria, and how the sides compare."""
    table = rows["maps"]
    found = _panels(table)
    basins = [each for name, each in found.items() if name.startswith("basins")]
    models = agreement(basins)
    near, far = (models.at["Model 4", band] for band in (NEAR, BANDS[-1]))
    fine = uncertainty([_of(table, _pairs(each))["outcome"] for each in (0.0, *DISTANCES)])
    return Content(
        numbers={
            "seconds": float(sum(each.cells["seconds"].sum() for each in found.values())),
            "agreement": models[BANDS[-1]],
            "near": near,
            "answer": grade(yes=far >= NEARLY_ALL, partly=near >= NEARLY_ALL),
            "fineness": fine,
        },
        tables={
            "claims": pd.DataFrame(_claims(found, fine)),
            "models": models.rename(columns="% within {:g} rad".format).reset_index(),
            "panels": pd.DataFrame({"map": name, **each.summary} for name, each in found.items()),
            "repeated": _repeated(table),
        },
        figures={
            "maps": lambda: figures.draw({PROBLEMS[name].title: found[name] for name in MAPS}),
            "basins": lambda: figures.draw({each.sweep.scenario.name: each for each in basins}),
            "rest": lambda: figures.draw({"": found["rest"]}),
        },
        checks=checks(table),
    )


def _panels(table: pd.DataFrame) -> dict[str, Panel]:
    return {
        name: Panel(sweep=case.sweep, cells=_of(table, name)) for name, case in whole().items()
    }


def _of(table: pd.DataFrame, label: str) -> pd.DataFrame:
    return table[table["case"] == label]


def agreement(basins: Sequence[Panel]) -> pd.DataFrame:
    """Parts of the starts in %, by model and tilt from upright, that end as in the first panel.

    What counts is whether the disk turns upside down, kept or lost again.
    """
    first, *others = (np.isin(each.outcomes, ("inverted", "lost")) for each in basins)
    tilts = np.abs(basins[0].values[0] - pi / 2)
    found = {
        each.sweep.scenario.name: [
            100.0 * mean_over_area((other == first)[tilts <= band + 1e-9]) for band in BANDS
        ]
        for each, other in zip(basins[1:], others, strict=True)
    }
    return pd.DataFrame.from_dict(found, "index", columns=BANDS).rename_axis("model")


def above_critical(panel: Panel, least: float) -> Array:
    """How far the least spin that inverts lies above the second critical one, in rad/s.

    Parameters
    ----------
    panel : Panel
        Over the spin, horizontally.
    least : float
        Of the quantity along the vertical axis.

    Returns
    -------
    ndarray, shape (n,)
        By the values along the vertical axis.
    """
    points = pd.DataFrame(critical_points(panel.sweep)["hopf"], columns=["spin", "height"])
    known = points[points["height"] >= least].groupby("height")["spin"]
    second = known.agg(lambda spins: spins.nsmallest(2).iloc[1])
    values, spins = panel.values
    inverted = panel.outcomes[values >= least] == "inverted"
    critical = np.interp(values[values >= least], second.index, second)
    apart = spins[np.argmax(inverted, axis=1)] - critical
    return apart[inverted.any(axis=1)]


def _claims(found: Mapping[str, Panel], fine: problems.Uncertainty | None) -> Iterator[Row]:
    """What the maps say, by which criterion, and whether it holds."""
    for name, least in SPEED_MAPS.items():
        apart = above_critical(found[name], least)
        low, high = apart.min(), apart.max()
        where = f"from {least:g} on ({found[name].sweep.design.axes[0].label})"
        yield {
            "map": name,
            "statement": "the least spin at the start that inverts lies little above that from "
            "which the slow pair of inverted spinning is stable",
            "criterion": f"0 to {ABOVE:g} rad/s above it, {where}; partly: nowhere below",
            "found": f"{low:.1f} to {high:.1f} rad/s more",
            "verdict": grade(yes=low >= 0.0 and high <= ABOVE, partly=low >= 0.0),
        }
    is_fractal = fine is not None and fine.exponent + 2.0 * fine.error < 1.0
    yield {
        "map": "rest",
        "statement": "the starts that come to rest on either face have a fractal boundary",
        "criterion": "the exponent is below 1 by more than 2 standard deviations; otherwise it is "
        "not shown",
        "found": f"{fine.exponent:.2f} ± {fine.error:.2f}" if fine else "no exponent",
        "verdict": "yes" if is_fractal else "not shown",
    }


def _repeated(table: pd.DataFrame) -> pd.DataFrame:
    """Cells that both sides have run again, beside what their map says."""
    known = table.set_index(["case", "number"])["outcome"]
    again = pd.concat([_of(table, _again(name)).assign(map=name) for name in REPEATED])
    places = [name for name in again if "." in name]
    outcomes = [known.get((row.map, row.number)) for row in again.itertuples()]
    return again.assign(**{"outcome of the map": outcomes})[
        ["map", *places, "outcome of the map", "outcome", "alike", "difference"]
    ].rename(columns={"difference": "difference in rad", "alike": "the other side, too"})


def checks(table: pd.DataFrame) -> list[Check]:
    """What has to hold of the stored cells."""
    seen, again = table[table["seen"]], _repeated(table)
    outcomes = again.groupby("map")["outcome"].nunique()
    counts = {
        "runs that failed": (table["outcome"] == "failed").sum(),
        "cells seen by both sides that end differently": (~seen["alike"]).sum(),
        "panels without such cells": sum(each.seen.empty for each in _panels(table).values()),
        "repeated cells that end otherwise than in their map": (
            again["outcome of the map"] != again["outcome"]
        ).sum(),
        "panels without two outcomes repeated": len(REPEATED) - (outcomes == 2).sum(),
        "cells that are not where their numbers are": _misplaced(table),
    }
    return [
        at_most(f"maps: {name}", float(count), 0.0, "stored") for name, count in counts.items()
    ]


def _misplaced(table: pd.DataFrame) -> int:
    """Number of rows whose values are not those of their case today."""
    wrong = 0
    for name, case in cases().items():
        cells = _of(table, name)
        here = pd.DataFrame(map(case.sweep.design.values_of, cells["number"]))
        wrong += (~np.isclose(cells[here.columns], here, rtol=1e-9)).any(axis=1).sum()
    return wrong
