"""Hard cases: whether stiff and extreme motions keep their promise, and what fails says so."""

from typing import Any

import pandas as pd

from validation.kit import located, references
from validation.page.content import Content, Rows, Verdict
from validation.page.section import power
from validation.studies.robustness import checks, conservation, ended, outcomes, steps
from validation.studies.robustness.conservation import CONSERVATION, DRIFTING, FREE
from validation.studies.robustness.outcomes import (
    CASES,
    CHOSEN,
    GOOD,
    UNFINISHED,
    VERDICTS,
    cases,
)
from validation.studies.robustness.penalty import PENALTY
from validation.studies.robustness.problems import TOLERANCE
from validation.studies.robustness.steps import STEPS

TITLE = "Hard cases"
STUDIES = (CASES, CHOSEN, STEPS, CONSERVATION, PENALTY)

VERY_STIFF = 1e-4
"""Finest speed of friction in m/s from which on most runs take too many steps."""

STEPS_APART = "step over predicted less 1"
"""Column."""

_CHOSEN = ["case", "verdict", "cause", "error", "doubt", "estimate", "seconds"]
_DRIFT = ["case", "position", "allowed", "at_end", "growth", "velocity", "energy"]
_CONSERVED = ["case", "energy", "momentum", "spin", "allowed"]


def present(rows: Rows) -> Content:
    """What there is to show, from the tables of `STUDIES`."""
    table, limits = rows["robustness"], _compared(rows["robustness-steps"])
    long = rows["robustness-conservation"].set_index("case", drop=False)
    penalty = rows["robustness-penalty"]
    counts, numbers, chosen = by_axis(table), case_numbers(table), rows["robustness-chosen"]
    wrong = table[~table["verdict"].isin(GOOD)]
    return Content(
        numbers={
            **numbers,
            "chosen": chosen,
            "left": int((~chosen["verdict"].isin(GOOD)).sum()),
            "chosen_broken": checks.broken(chosen),
            "sampled_chosen": len(CHOSEN.sample),
            "apart": float(limits[STEPS_APART].abs().max()),
            "places": limits.groupby("over")["value"].agg(["min", "max"]).to_dict("index"),
            **{each.__name__.rpartition(".")[2]: each for each in _SETTINGS},
            "growing": long[long.index.str.startswith("acceleration level")],
            "held": long.loc[[name for name, each in DRIFTING.items() if each.held]],
            "minimal": long[long.index.str.startswith("minimal coordinates")],
            "penalty": penalty,
        },
        tables={
            "outcomes": counts.rename_axis("what is extreme").reset_index(),
            "causes": _causes(table),
            "cases": table.drop(columns="case").rename(columns=CASES.columns),
            "failures": wrong[["case", "way", "verdict", "cause", "reason"]],
            "chosen": _hardest(chosen),
            "steps": limits.drop(columns="case"),
            "drift": long.loc[list(DRIFTING), _DRIFT].rename(columns=CONSERVATION.columns),
            "conserved": long.loc[list(FREE), _CONSERVED].rename(columns=CONSERVATION.columns),
            "penalty": penalty.drop(columns="case"),
        },
        checks=list(checks.checks(rows)),
        verdicts=[_verdict(numbers)],
    )


_SETTINGS = (checks, conservation, located, outcomes, references, steps)
"""Modules whose limits the text names."""


def by_axis(table: pd.DataFrame) -> pd.DataFrame:
    """Number of cases by what is extreme about them, and by verdict."""
    counts = pd.crosstab(table["axis"], table["verdict"])
    # That none crashed has to be seen as well.
    shown = [each for each in VERDICTS if each in counts or each == "crashed"]
    return counts.reindex(index=table["axis"].unique(), columns=shown, fill_value=0)


def _hardest(chosen: pd.DataFrame) -> pd.DataFrame:
    """Motions as chosen, those without an accurate result first, then by their error."""
    order = chosen.assign(right=chosen["verdict"].isin(GOOD)).sort_values(
        ["right", "error"], ascending=[True, False], ignore_index=True
    )
    return order[_CHOSEN].rename(columns={"case": "motion", **CASES.columns})


def _causes(table: pd.DataFrame) -> pd.DataFrame:
    """Number of cases without an accurate result, by cause, and where they lie."""
    found = table[table["cause"] != ""].groupby(["verdict", "cause"])["axis"]
    where = found.agg(
        lambda axes: ", ".join(f"{axis} ({n})" for axis, n in axes.value_counts().items())
    )
    told = pd.DataFrame({"cases": found.size(), "what is extreme (cases)": where})
    return told.sort_values("cases", ascending=False, kind="stable").reset_index()


def case_numbers(table: pd.DataFrame) -> dict[str, Any]:
    """Numbers of the hard cases that the text, the verdict and the manual state."""
    counts = {verdict: int((table["verdict"] == verdict).sum()) for verdict in VERDICTS}
    late = table["cause"].isin(UNFINISHED)
    finest = table["case"].map(lambda name: cases()[name].scenario.friction.finest_speed)
    told = table.dropna(subset=["error", "estimate"])
    return {
        "problems": table["case"].nunique(),
        "sampled": len(CASES.sample),
        "total": len(table),
        "counts": counts,
        "ends": sum(counts[each] for each in GOOD[1:]),
        "without": int((~table["verdict"].isin(GOOD)).sum()),
        "broken": checks.broken(table),
        "causes": table["cause"].value_counts().to_dict(),
        "late": int(late.sum()),
        "very_stiff": VERY_STIFF,
        "stiff": int((late & (finest <= VERY_STIFF)).sum()),
        "asked": TOLERANCE,
        "tolerances": table["tolerance"],
        "ended": int((table["axis"] == ended.AXIS).sum()),
        "told": len(told),
        "beyond": int((told["error"] > told["estimate"] + told["doubt"]).sum()),
        "untold": int((table["estimate"].isna() & table["error"].notna()).sum()),
    }


def _compared(limits: pd.DataFrame) -> pd.DataFrame:
    """Stable steps beside predicted ones, where there are some."""
    found = limits.dropna(subset="predicted")
    return found.assign(**{STEPS_APART: found["step"] / found["predicted"] - 1.0})


def _verdict(numbers: dict[str, Any]) -> Verdict:
    asked, broken = numbers["tolerances"], numbers["broken"]
    return Verdict(
        statement="No stiff or extreme case crashes or breaks its promise of accuracy.",
        answer="no" if broken else "yes",
        numbers=f"Of {numbers['total']} cases asked for {power(asked.min())} to "
        f"{power(asked.max())} rad, {numbers['counts']['accurate']} are accurate and "
        f"{numbers['ends']} end early, accurately; {numbers['without']} give no "
        f"accurate result, for reasons that are counted; "
        f"{broken or 'none'} crashed or broke the promise.",
        criterion="angles and the time of an ending within what was asked for, and its reason, "
        "beside two runs by other methods; said of these cases alone.",
        good=not broken,
    )
