"""The ways to rest: engine against in-house, what they depend on, and where the energy goes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import CAUSES, SpatialMotion
from analysis.data.checks import Array
from analysis.data.trajectory import SOURCES
from validation.kit.animation.player import player
from validation.kit.limits import largest
from validation.page.content import Content, Rows, Verdict
from validation.studies.rest import figures
from validation.studies.rest.runs import (
    BEGIN,
    CASES,
    COARSE,
    END,
    ENGINE_END,
    EVERY,
    FASTER,
    FRESH,
    IDEAL,
    PHASES,
    SHOWN,
    SLIDING,
    SPACING,
    STEPS,
    STUDY,
    VARIANTS,
    VISCOUS,
    WINDOWS,
    Case,
    fresh_cases,
    name_of,
)
from validation.study import Check, Row, at_most, equal

STUDIES = (STUDY, FRESH)

AGREEMENT = 1e-3
"""Largest difference in rad of the tilt between engine and in-house."""

SHIFT = 0.02
"""Largest shift in s of a phase between two runs,"""

SHIFTS = {"rim half as thick": 0.2}
"""and where it may be larger, by variant."""

SAME_TAKEN = 0.05
"""Largest relative difference of the energy that a cause takes."""

UNEXPLAINED = 1e-5
"""Largest part of the first energy that no cause has taken."""

RISE = 1e-9
"""Largest rise of the energy from one sample to the next in J."""

PROPORTION = 0.05
"""How far the effect of a change may be from growing in proportion to it, relative."""

# --- Comparing ----------------------------------------------------------------------------------


def shift(one: Row, other: Row) -> float:
    """Largest shift in s of a phase that either has; infinite if one has passed without it.

    What lies behind the end of a run is not asked for.
    """
    found: list[float | None] = []
    for phase in PHASES:
        begins = [one.get(phase), other.get(phase)]
        lacks = [bool(pd.isna(begin)) for begin in begins]
        if not any(lacks):
            found.append(abs(np.subtract(*begins)))
        elif not all(lacks):
            begin, end = (begins[1], one["end"]) if lacks[0] else (begins[0], other["end"])
            found += [] if begin > end else [None]
    return largest(found)


def apart(one: Row, other: Row) -> Array:
    """Differences of the tilt in rad over the samples that both have, shape (n,)."""
    count = min(len(one["tilt"]), len(other["tilt"]))
    result: Array = np.abs(np.subtract(one["tilt"][:count], other["tilt"][:count]))
    return result


def taken_apart(one: Row, other: Row) -> float:
    """Largest relative difference of what a cause takes."""
    a, b = np.array(one["taken"]), np.array(other["taken"])
    # What is on takes far more than a nanojoule, what is off nothing.
    return largest((np.maximum(np.abs(a - b) - RISE, 0.0) / np.maximum(np.abs(b), RISE)).tolist())


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Phases, what they depend on, where the energy went, and the whole story."""
    courses: dict[str, Row] = {
        row["case"]: row for study in STUDIES for row in rows[study.name].to_dict("records")
    }
    shown = spatial(courses[name_of(SHOWN, "in-house")])
    return Content(
        numbers=numbers(courses),
        tables={
            "phases": phase_table(courses),
            "variants": variant_table(courses),
            "budget": budget(courses),
            "losses": loss_table(courses),
        },
        figures={
            "story": figures.story(
                shown, courses[name_of(SHOWN, "engine")]["tilt"], EVERY * SPACING
            ),
            "path": figures.draw_path(shown),
            "dependence": dependence(courses, shown),
        },
        animations={
            "animation": player(
                shown,
                name="rest-animation",
                title="The whole way to rest",
                caption=f"In-house run with {SHOWN} besides sliding friction.",
            )
        },
        checks=checks(courses),
        verdicts=[verdict(courses)],
    )


def spatial(row: Row) -> SpatialMotion:
    """The whole motion of a row."""
    arrays: dict[str, Any] = {n: np.array(row[n]) for n in SpatialMotion.STORED_ARRAYS[:-1]}
    return SpatialMotion(
        scenario=Case(row["losses"]).scenario,
        source=row["source"],
        rest_time=row["rest"],
        **arrays,
    )


def checks(courses: Mapping[str, Row]) -> list[Check]:
    """Engine against in-house, what variants shift, and what no run may do."""
    found: list[Check] = []
    for losses in CASES:
        engine, inhouse = (courses[name_of(losses, source)] for source in SOURCES)
        name = f"rest, {losses}, engine against in-house"
        where: Any = "stored" if losses == SLIDING else "fresh"
        found += [
            at_most(f"{name}: tilt in rad", largest(apart(engine, inhouse)), AGREEMENT, where),
            at_most(f"{name}: phases in s", shift(engine, inhouse), SHIFT, where),
            at_most(f"{name}: energy taken", taken_apart(engine, inhouse), SAME_TAKEN, where),
            equal(f"{name}: face up", engine["face"], inhouse["face"], where),
        ]
    base, engine = (courses[name_of(SHOWN, source)] for source in ("in-house", "engine"))
    for variant in VARIANTS:
        row, limit = courses[variant], SHIFTS.get(variant, SHIFT)
        found.append(at_most(f"rest, {variant}: phases in s", shift(row, base), limit))
    begin, coarse = courses[BEGIN], courses[COARSE]
    found += [
        at_most("rest, engine: its first second, tilt in rad", largest(apart(begin, engine)),
                1e-8, "stored"),
        at_most("rest, engine: sixfold step, tilt in rad", largest(apart(coarse, engine)), 1e-3),
        at_most("rest, engine: sixfold step, phases in s", shift(coarse, engine), SHIFT),
        at_most("rest: a change a thousandth as large does as much less, relative error",
                abs(growth(courses) * FASTER[1] / FASTER[0] - 1.0), PROPORTION),
    ]  # fmt: skip
    fresh = fresh_cases()
    for name, row in courses.items():
        if name != IDEAL:
            found += _sane(name, row, "fresh" if name in fresh else "stored")
    return [
        *found,
        at_most("rest, ideal contact: inversion and its loss in s",
                shift(courses[IDEAL], courses[name_of(SLIDING, "in-house")]), SHIFT),
    ]  # fmt: skip


def _sane(name: str, row: Row, where: Any) -> list[Check]:
    name = f"rest, {name}"
    return [
        equal(f"{name}: complete", row["complete"], True, where),
        at_most(f"{name}: rise of the energy in J", row["rise"], RISE, where),
        at_most(f"{name}: contact pulls by N", -row["force"], 0.0, where),
        at_most(f"{name}: unexplained part", row["unexplained"] / row["energy"], UNEXPLAINED,
                where),
    ]  # fmt: skip


def growth(courses: Mapping[str, Row]) -> float:
    """How many times more the larger change of the spin does to the tilt than the smaller one."""
    base = courses[name_of(SHOWN, "in-house")]
    large, small = (np.max(apart(courses[f"spin {more:g} rad/s faster"], base)) for more in FASTER)
    return float(large / small)


def numbers(courses: Mapping[str, Row]) -> Row:
    """Those of the text."""
    base, engine = (courses[name_of(SHOWN, source)] for source in ("in-house", "engine"))
    change = apart(courses[f"spin {FASTER[0]:g} rad/s faster"], base)
    times = EVERY * SPACING * np.arange(change.size)
    contact = Case(SHOWN).scenario.penalty_contact
    sliding = courses[name_of(SLIDING, "in-house")]
    return {
        "shown": SHOWN,
        "base": base,
        "apart": largest(apart(engine, base)),
        "agreement": AGREEMENT,
        "faster": FASTER,
        "change_before": np.max(change[times < base["inversion_lost"]]),
        "change": np.max(change),
        "growth": growth(courses),
        "stiffness": contact.stiffness,
        "damping": contact.damping,
        "half_thickness": 1e3 * contact.half_thickness,
        "dry": CASES[SHOWN],
        "viscous": CASES[VISCOUS],
        "window": WINDOWS[-1],
        "late": {name: sliding[name][-1] for name in ("loss", "viscous_loss", "mean_energy")},
        "steps": [STEPS[SHOWN], STEPS[VISCOUS]],
        "ideal_lost": courses[IDEAL]["inversion_lost"],
        "sliding": sliding,
        "end": END,
        "engine_end": ENGINE_END,
        "spacing": SPACING,
    }


def verdict(courses: Mapping[str, Row]) -> Verdict:
    """Whether the disk comes to lie flat, and with what."""
    flat = {losses: courses[name_of(losses, "in-house")]["flat"] for losses in CASES}
    lies = [losses for losses, time in flat.items() if not pd.isna(time)]
    answer = "yes" if SLIDING in lies else "partly" if lies else "not shown"
    told = [
        f"with {losses} it is flat after {flat[losses]:.1f} s"
        if losses in lies
        else f"by {losses} it leans by {courses[name_of(losses, 'in-house')]['lean'][-1]:.2f} rad "
        f"on average over the last {WINDOWS[-1][1] - WINDOWS[-1][0]:g} of {END:g} s"
        for losses in CASES
    ]
    return Verdict(
        statement="On a slow timescale the disk comes to lie flat on the table.",
        answer=answer,
        numbers="; ".join(told)
        + ". The coefficients of rolling and pivoting are chosen here, not the paper's.",
        criterion=f"flat to the end within {END:g} s by sliding friction alone, as the paper "
        "models it; partly: with further losses.",
        good=answer == "yes",
    )


# --- Tables -------------------------------------------------------------------------------------


def phase_table(courses: Mapping[str, Row]) -> pd.DataFrame:
    """When each phase began, by losses and source, and how far the two sources agree."""
    found = []
    for losses in CASES:
        engine, inhouse = (courses[name_of(losses, source)] for source in SOURCES)
        found += [{"dissipation": losses} | _phases(row) for row in (engine, inhouse)]
        found[-1] |= {"tilt apart in rad": largest(apart(engine, inhouse)),
                      "phases apart in s": shift(engine, inhouse)}  # fmt: skip
    ideal = {"dissipation": SLIDING} | _phases(courses[IDEAL] | {"face": None})
    return pd.DataFrame([*found[:2], ideal, *found[2:]])


def _phases(row: Row) -> Row:
    told = {phase.replace("_", " "): row.get(phase) for phase in PHASES}
    return {"source": row["source"]} | told | {"face up": row["face"]}


def variant_table(courses: Mapping[str, Row]) -> pd.DataFrame:
    """How the phases move with stiffness, rim, side and start."""
    base, engine = (courses[name_of(SHOWN, source)] for source in ("in-house", "engine"))
    named = {"in the engine": engine, **{name: courses[name] for name in VARIANTS}}
    return pd.DataFrame(
        [
            {"variant": "as it is, in-house"} | _phases(base),
            *(
                {"variant": name}
                | _phases(row)
                | {"largest shift": shift(row, base), "at most": SHIFTS.get(name, SHIFT)}
                for name, row in named.items()
            ),
        ]
    ).drop(columns="source")


def budget(courses: Mapping[str, Row]) -> pd.DataFrame:
    """Where each joule went, and whether energy and contact force keep to their signs."""
    pairs = [(losses, courses[name_of(losses, source)]) for losses in CASES for source in SOURCES]
    used = np.any([row["taken"] for _, row in pairs], axis=0)
    return pd.DataFrame(
        [
            {"dissipation": losses, "source": row["source"], "at first": row["energy"]}
            | {
                figures.CAUSE_NAMES[cause]: value
                for cause, value, some in zip(CAUSES, row["taken"], used, strict=True)
                if some
            }
            | {
                "left": row["left"],
                "unexplained": row["unexplained"],
                "largest rise": row["rise"],
                "least contact force in N": row["force"],
            }
            for losses, row in pairs
        ]
    )


def loss_table(courses: Mapping[str, Row]) -> pd.DataFrame:
    """How slowly the disk loses energy by sliding alone."""
    row = courses[name_of(SLIDING, "in-house")]
    columns: dict[str, Any] = {
        "time in s": [f"{begin:g} to {end:g}" for begin, end in WINDOWS],
        "mean lean in rad": row["lean"],
        "mean slip speed in m/s": row["slip"],
        "energy in J": row["mean_energy"],
        "loss in W": row["loss"],
        "loss by μ λ_N s² / ε in W": row["viscous_loss"],
    }
    return pd.DataFrame(columns)


def dependence(courses: Mapping[str, Row], shown: SpatialMotion) -> Figure:
    """How far the tilt of variants departs from that of the in-house run."""
    base = courses[name_of(SHOWN, "in-house")]
    named: dict[str, Sequence[float]] = {
        "in the engine": apart(courses[name_of(SHOWN, "engine")], base).tolist(),
        **{name: apart(courses[name], base).tolist() for name in VARIANTS},
    }
    return figures.draw_dependence(named, EVERY * SPACING, shown.phases)
