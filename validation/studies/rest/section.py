"""The way to rest: both sides, what it depends on, where the energy goes, and what is beside."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import RestCriterion, SpatialMotion  # noqa: F401 # the text names the criterion
from analysis.motion.quantities import filled
from analysis.problem.checks import Array
from validation.comparison.limits import largest
from validation.display.figures import COLOURS, draw_story, legend_above
from validation.studies.rest import closed_forms, creep, runs, starts
from validation.studies.rest.runs import ENGINE, INHOUSE, PHASES, SHOWN, SLIDING, TAKEN, VARIANTS
from validation.study import Check, Content, Row, Rows, at_most, grade

TITLE = "To rest"

_RUNS = (runs.STUDY, runs.FRESH)
_BESIDE = (creep, closed_forms, starts)
STUDIES = (*_RUNS, *(each.STUDY for each in _BESIDE))

RISE = 1e-9
"""Largest rise of the energy from one sample to the next in J."""

UNEXPLAINED = 1e-5
"""Largest part of the first energy that no cause has taken."""

PROPORTION = 0.05
"""How far the effect of a change may be from growing in proportion to it, relative."""

SHIFT = 0.02
"""Largest shift in s of a phase between two runs, if no other is named."""

BOTH_SIDES = {"tilt in rad": 1e-3, "phases in s": SHIFT, "energy taken": 0.05, "face": 0.0}
"""Largest differences between engine and in-house."""

COMPARED: dict[str, tuple[str, dict[str, float]]] = {
    **{ENGINE[losses]: (INHOUSE[losses], BOTH_SIDES) for losses in runs.CASES},
    runs.COARSE: (ENGINE[SHOWN], {"tilt in rad": 1e-3, "phases in s": SHIFT}),
    runs.IDEAL: (INHOUSE[SLIDING], {"phases in s": SHIFT}),
    **{name: (INHOUSE[SHOWN], {"phases in s": SHIFT}) for name in VARIANTS},
    "rim half as thick": (INHOUSE[SHOWN], {"phases in s": 0.2}),
    **{name: (INHOUSE[SHOWN], {"face": 0.0}) for name in runs.SMOOTHED},
}
"""What each run is compared with, and by how much it may differ."""

_DOT = 20
"""Every so many samples of the engine's tilt are drawn."""


def shift(one: Row, other: Row) -> float:
    """Largest shift in s of a phase that either has; infinite if one has passed without it.

    What lies behind the end of a run is not asked for.
    """
    begins, others = (
        np.array([row.get(phase) for phase in PHASES], float) for row in (one, other)
    )
    passed = (np.isnan(begins) & (others <= one["end"])) | (
        np.isnan(others) & (begins <= other["end"])
    )
    found = np.where(passed, np.inf, np.abs(begins - others))
    return largest(found[~np.isnan(found)])


def apart(one: Row, other: Row) -> Array:
    """Differences of the tilt in rad over the samples that both have, shape (n,)."""
    count = min(len(one["tilt"]), len(other["tilt"]))
    return np.abs(np.subtract(one["tilt"][:count], other["tilt"][:count]))


def taken_apart(one: Row, other: Row) -> float:
    """Largest relative difference of what a cause takes."""
    a, b = (np.array([row[name] for name in TAKEN]) for row in (one, other))
    # What is on takes far more than a nanojoule, what is off nothing.
    return largest((np.maximum(np.abs(a - b) - RISE, 0.0) / np.maximum(np.abs(b), RISE)).tolist())


DIFFERENCES: dict[str, Callable[[Row, Row], float]] = {
    "tilt in rad": lambda one, other: largest(apart(one, other).tolist()),
    "phases in s": shift,
    "energy taken": taken_apart,
    "face": lambda one, other: float(one["face"] != other["face"]),
}


def differences(courses: Mapping[str, Row]) -> pd.DataFrame:
    """How far each run is from what it is compared with, as far as that is limited."""
    found = {
        name: {"compared with": other}
        | {what: DIFFERENCES[what](courses[name], courses[other]) for what in limits}
        for name, (other, limits) in COMPARED.items()
    }
    return pd.DataFrame.from_dict(found, orient="index")


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Phases, what they depend on, where the energy went, and the whole story."""
    table = pd.concat([rows[study.name] for study in _RUNS]).set_index("case")
    courses: dict[str, Row] = table.to_dict("index")
    base = courses[INHOUSE[SHOWN]]
    title, caption = "The whole way to rest", f"In-house: sliding, {SHOWN}."
    content = Content(
        numbers=numbers(courses),
        tables={"phases": phases(table, differences(courses)), "budget": budget(table)},
        figures={"story": lambda: story(base, courses[ENGINE[SHOWN]]["tilt"])},
        animations={"animation": lambda: _motion(base).animate(title=title, caption=caption)},
        checks=[*checks(courses)],
    )
    for each in _BESIDE:
        content |= each.present(rows[each.STUDY.name])
    return content


def _motion(row: Row) -> SpatialMotion:
    arrays: dict[str, Any] = {name: np.array(row[name]) for name in filled(SpatialMotion)}
    scenario, rest_time = runs.Case(SHOWN).scenario, row["rest"]
    return SpatialMotion(scenario=scenario, source="in-house", rest_time=rest_time, **arrays)


def story(row: Row, tilt: Sequence[float]) -> Figure:
    """The whole story over time, with the tilt of the engine's run."""
    figure = draw_story(_motion(row))
    dots = np.arange(0, len(tilt), _DOT)
    look: Any = {"color": COLOURS[2], "linestyle": "", "marker": ".", "markersize": 4}
    panel = figure.axes[0]
    panel.lines[0].set_label("in-house")
    panel.plot(runs.EVERY * runs.SPACING * dots, np.array(tilt)[dots], label="engine", **look)
    legend_above(panel, size=8)
    return figure


def checks(courses: Mapping[str, Row]) -> Iterator[Check]:
    """Each run against another, and what none may do."""
    fresh, apart_by = runs.fresh_cases(), differences(courses)
    for name, (other, limits) in COMPARED.items():
        where: Any = "fresh" if {name, other} & fresh.keys() else "stored"
        for what, limit in limits.items():
            label = f"rest, {name}: {what} apart from {other}"
            yield at_most(label, apart_by.at[name, what], limit, where)
    for name, row in courses.items():
        if name != runs.IDEAL:
            where = "fresh" if name in fresh else "stored"
            lost = row["unexplained"] / row["energy"]
            yield at_most(f"rest, {name}: rise of the energy in J", row["rise"], RISE, where)
            yield at_most(f"rest, {name}: contact pulls by N", -row["force"], 0.0, where)
            yield at_most(f"rest, {name}: unexplained part", lost, UNEXPLAINED, where)
    more, less = runs.FASTER.values()
    uneven = abs(numbers(courses)["growth"] * less / more - 1.0)
    yield at_most("rest, spin: effect out of proportion", uneven, PROPORTION)


def numbers(courses: Mapping[str, Row]) -> Row:
    """Those of the text."""
    base, apart_by = courses[INHOUSE[SHOWN]], differences(courses)
    large, small = (apart(courses[name], base) for name in runs.FASTER)
    times = runs.EVERY * runs.SPACING * np.arange(large.size)
    flat = {losses: courses[name]["flat"] for losses, name in INHOUSE.items()}
    lies = {losses: time for losses, time in flat.items() if not pd.isna(time)}
    return {
        "lies": lies,
        "answer": grade(yes=SLIDING in lies, partly=bool(lies)) if lies else "not shown",
        "base": base,
        "apart": apart_by.at[ENGINE[SHOWN], "tilt in rad"],
        "change_before": np.max(large[times < base["inversion_lost"]]),
        "change": np.max(large),
        "growth": float(np.max(large) / np.max(small)),
        "shifts": apart_by.loc[[*VARIANTS, ENGINE[SHOWN]], "phases in s"].dropna().tolist(),
        "smoothed": {name: courses[name] for name in runs.SMOOTHED},
        "ideal": courses[runs.IDEAL],
        "sliding": courses[INHOUSE[SLIDING]],
    }


def phases(table: pd.DataFrame, apart_by: pd.DataFrame) -> pd.DataFrame:
    """When each phase began, and how far runs are apart from what they are compared with."""
    order = [each for losses in runs.CASES for each in (INHOUSE[losses], ENGINE[losses])]
    headings = {"tilt in rad": "tilt apart in rad", "phases in s": "phases apart in s"}
    found = table.loc[[*order, runs.IDEAL, *VARIANTS, runs.COARSE], [*PHASES, "face"]]
    found = found.rename(columns={"face": "face up at the end"})
    beside = apart_by[["compared with", *headings]].rename(columns=headings)
    found = found.join(beside).reset_index(names="run")
    return found.rename(columns=lambda name: name.replace("_", " "))


def budget(table: pd.DataFrame) -> pd.DataFrame:
    """Where each joule went, and whether energy and contact force keep to their signs."""
    names = [each for losses in runs.CASES for each in (ENGINE[losses], INHOUSE[losses])]
    used = [name for name in TAKEN if table.loc[names, name].any()]
    headings = {"energy": "at first", "rise": "largest rise", "force": "least contact force in N"}
    headings |= {name: name.removeprefix("taken_by_").replace("_", " ") for name in used}
    columns = ["energy", *used, "left", "unexplained", "rise", "force"]
    return table.loc[names, columns].rename(columns=headings).reset_index(names="run")
