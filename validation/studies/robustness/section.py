"""Hard cases: whether stiff and extreme motions keep their promise, and what fails says so."""

from collections.abc import Iterator
from typing import Any

import pandas as pd

from validation.comparison import references  # noqa: F401 # the text names their limits
from validation.studies.robustness import conservation, outcomes, penalty, steps
from validation.studies.robustness.outcomes import BAD, CASES, CHOSEN, GOOD, explained
from validation.studies.robustness.problems import ENDED, TOLERANCE, problems  # noqa: F401
from validation.study import Check, Content, Rows, Study, at_most, grade

TITLE = "Hard cases"
_BESIDE = (steps, conservation, penalty)
STUDIES = (CASES, CHOSEN, *(each.STUDY for each in _BESIDE))

VERY_STIFF = 1e-4
"""Finest speed of friction in m/s from which on most runs take too many steps."""


def present(rows: Rows) -> Content:
    """What there is to show, from the tables of `STUDIES`."""
    table, chosen = (explained(rows[study.name]) for study in (CASES, CHOSEN))
    numbers, left = case_numbers(table), int((~chosen["right"]).sum())
    content = Content(
        numbers={
            **numbers,
            "left": left,
            "chosen_broken": int(chosen["broken"].sum()),
            "answer": grade(yes=not numbers["broken"]),
        },
        tables={
            "outcomes": _by_axis(table),
            "causes": _causes(table),
            "cases": table.drop(columns=["axis", "right"]).rename(columns=CASES.columns),
            "failures": table[~table["right"]][["case", "way", "verdict", "cause", "reason"]],
            "chosen": _hardest(chosen),
        },
        checks=[
            *_checks("cases", CASES, table),
            *_checks("cases as chosen", CHOSEN, chosen),
            at_most("cases as chosen: without an accurate result", left, 0, "stored"),
        ],
    )
    for each in _BESIDE:
        content |= each.present(rows[each.STUDY.name])
    return content


def _checks(name: str, study: Study, table: pd.DataFrame) -> Iterator[Check]:
    """That all cases are there, kept their promises, and are called what they are."""
    wanted = {
        (label, way.name) for label, each in study.cases().items() for way in outcomes.ways(each)
    }
    other = wanted ^ set(zip(table["case"], table["way"], strict=True))
    called_right = table[table["right"]].to_dict("records")
    wrong = sum(not all(outcomes.within(row)) for row in called_right)
    yield at_most(f"{name}: missing or too many", len(other), 0, "stored")
    yield at_most(f"{name}: crashed or promise broken", int(table["broken"].sum()), 0, "stored")
    yield at_most(f"{name}: called right against their numbers", wrong, 0, "stored")


def _by_axis(table: pd.DataFrame) -> pd.DataFrame:
    """Number of cases by what is extreme about them, and by verdict."""
    counts = pd.crosstab(table["axis"], table["verdict"])
    # That none crashed has to be seen as well.
    shown = [each for each in (*GOOD, *BAD) if each in counts or each == "crashed"]
    counts = counts.reindex(index=table["axis"].unique(), columns=shown, fill_value=0)
    return counts.rename_axis("what is extreme").reset_index()


def _hardest(chosen: pd.DataFrame) -> pd.DataFrame:
    """Motions as chosen, those without an accurate result first, then by their error."""
    order = chosen.sort_values(["right", "error"], ascending=[True, False], ignore_index=True)
    shown = order[["case", "verdict", "cause", "error", "doubt", "estimate", "seconds"]]
    return shown.rename(
        columns={"case": "motion", "cause": "why there is no accurate result", **CASES.columns}
    )


def _causes(table: pd.DataFrame) -> pd.DataFrame:
    """Number of cases without an accurate result, by cause, and where they lie."""
    found = table[table["cause"] != ""].groupby(["verdict", "cause"])["axis"]
    where = found.agg(
        lambda axes: ", ".join(f"{axis} ({n})" for axis, n in axes.value_counts().items())
    )
    causes = pd.DataFrame({"cases": found.size(), "what is extreme (cases)": where})
    return causes.sort_values("cases", ascending=False, kind="stable").reset_index()


def case_numbers(table: pd.DataFrame) -> dict[str, Any]:
    """Numbers of the hard cases, explained, that the text and the manual state."""
    accurate = int((table["verdict"] == "accurate").sum())
    late = table["cause"].isin(outcomes.UNFINISHED)
    finest = table["case"].map(lambda name: problems()[name].scenario.friction.finest_speed)
    estimated = table.dropna(subset=["error", "estimate"])
    return {
        "problems": table["case"].nunique(),
        "total": len(table),
        "accurate": accurate,
        "ends": int(table["right"].sum()) - accurate,
        "without": int((~table["right"]).sum()),
        "broken": int(table["broken"].sum()),
        "again": int(table["repeatable"].notna().sum()),
        "late": int(late.sum()),
        "stiff": int((late & (finest <= VERY_STIFF)).sum()),
        "tolerances": table["tolerance"],
        "ended": int((table["axis"] == ENDED).sum()),
        "told": len(estimated),
        "beyond": int((estimated["error"] > estimated["estimate"] + estimated["doubt"]).sum()),
        "untold": int((table["estimate"].isna() & table["error"].notna()).sum()),
    }
