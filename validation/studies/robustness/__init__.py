"""Hard cases: whether stiff and extreme motions keep their promise, and what fails says so."""

from typing import Any

import pandas as pd

from validation.kit.located import STRAIGHT
from validation.kit.references import SPACINGS
from validation.page.content import Content, Rows, Verdict
from validation.studies.robustness import checks, conservation, figures, penalty, refusals, steps
from validation.studies.robustness import ended as endings
from validation.studies.robustness import outcomes as judging
from validation.studies.robustness.conservation import CONSERVED, DRIFT, DRIFTING
from validation.studies.robustness.outcomes import CASES, GOOD, VERDICTS, cases
from validation.studies.robustness.penalty import PENALTY
from validation.studies.robustness.problems import TOLERANCE
from validation.studies.robustness.refusals import REFUSALS
from validation.studies.robustness.steps import STEPS

TITLE = "Hard cases"
STUDIES = (CASES, STEPS, DRIFT, CONSERVED, PENALTY, REFUSALS)


def present(rows: Rows) -> Content:
    """What there is to show, from the tables of `STUDIES`."""
    table, limits = rows["robustness"], rows["robustness-steps"]
    counts = by_axis(table)
    numbers = case_numbers(table)
    return Content(
        numbers={
            **numbers,
            **step_numbers(limits),
            **_beside(rows),
            "checks": checks,
            "judging": judging,
            "steps": steps,
            "penalty": penalty,
            "conservation": conservation,
            "refusals": refusals,
        },
        tables={
            "outcomes": _largest(table, counts),
            "causes": _causes(table),
            "cases": table.drop(columns="case").rename(columns=CASES.columns),
            "failures": table[~table["verdict"].isin(GOOD)][
                ["case", "way", "verdict", "cause", "reason"]
            ],
            "steps": limits.drop(columns="case"),
            "drift": _drift(rows["robustness-drift"]),
            "conserved": rows["robustness-conserved"].rename(columns=_CONSERVED),
            "penalty": rows["robustness-penalty"].drop(columns="case"),
            "refusals": rows["robustness-refusals"].drop(columns="seconds"),
        },
        figures={
            "outcomes": figures.matrix(counts).figure,  # type: ignore[dict-item]
            "steps": figures.steps(limits, steps.ACCURACY),
        },
        checks=list(checks.checks(rows)),
        verdicts=[_verdict(numbers)],
    )


def by_axis(table: pd.DataFrame) -> pd.DataFrame:
    """Number of cases by what is extreme about them, and by verdict."""
    counts = pd.crosstab(table["axis"], table["verdict"])
    # A crash would be a column of its own, and no crash is told as well.
    shown = [each for each in VERDICTS if each in counts or each == "crashed"]
    return counts.reindex(index=table["axis"].unique(), columns=shown, fill_value=0)


def _largest(table: pd.DataFrame, counts: pd.DataFrame) -> pd.DataFrame:
    """Counts by axis with the largest errors of each."""
    names = {
        "error": "largest error in rad",
        "drift": "drift / radius",
        "energy": "energy error, relative",
    }
    worst = table.groupby("axis")[list(names)].max().rename(columns=names)
    return counts.join(worst).rename_axis("what is extreme").reset_index()


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
    causes = table["cause"].value_counts().to_dict()
    late = table["cause"].isin(["too many steps", "Newton's iteration does not converge"])
    finest = table["case"].map(lambda name: cases()[name].scenario.friction.finest_speed)
    own = table[table["axis"] == endings.AXIS]
    told = table.dropna(subset=["error", "estimate"])
    return {
        "problems": table["case"].nunique(),
        "sampled": len(CASES.sample),
        "total": len(table),
        "counts": counts,
        "accurate": counts["accurate"],
        "ends": sum(counts[each] for each in GOOD[1:]),
        "without": sum(number for each, number in counts.items() if each not in GOOD),
        "broken": checks.broken(table),
        "causes": causes,
        "late": int(late.sum()),
        "stiff": int((late & (table["axis"] == "smoothing ε in m/s") & (finest <= 1e-4)).sum()),
        "asked": TOLERANCE,
        "tolerances": own["tolerance"],
        "all_tolerances": table["tolerance"],
        "own": len(own),
        "told": len(told),
        "unpromised": int((table["estimate"].isna() & table["error"].notna()).sum()),
        "beyond": int((told["error"] > told["estimate"] + told["doubt"]).sum()),
        "spacings": [1e3 * each for each in SPACINGS],
        "straight": STRAIGHT,
    }


def step_numbers(limits: pd.DataFrame) -> dict[str, Any]:
    """Stable steps over predicted ones, and how far accurate ones reach."""
    stable = limits[limits["kind"] == "stable"].dropna(subset="predicted")
    accurate = limits[(limits["kind"] == "accurate") & (limits["over"] == "stiffness")]
    explicit = accurate["integrator"].isin(steps.EXPLICIT)
    return {
        "apart": float((stable["step"] / stable["predicted"] - 1.0).abs().max()),
        "places": stable.groupby("over")["value"].agg(["min", "max"]).to_dict("index"),
        "explicit": accurate[explicit].set_index("value")["step"],
        "implicit": accurate[~explicit]["step"],
    }


def _beside(rows: Rows) -> dict[str, Any]:
    """Numbers of what is measured beside the cases."""
    drift = rows["robustness-drift"].set_index("case")
    growing = drift.loc[[name for name, each in DRIFTING.items() if each.grows]]
    bounded = drift.loc[[name for name, each in DRIFTING.items() if not each.grows]]
    requests = rows["robustness-refusals"]
    return {
        "end": drift["end"].max(),
        "growing": growing,
        "bounded": bounded,
        "free_end": conservation.FREE_END,
        "apart_from_ideal": rows["robustness-penalty"],
        "requests": len(requests),
        "refused": int(requests["at_once"].sum()),
    }


def _drift(table: pd.DataFrame) -> pd.DataFrame:
    names = {
        "case": "constraints met on",
        "position": "largest position residual in m",
        "allowed": "allowed in m",
        "at_end": "at the end in m",
        "growth": "second half over first",
        "velocity": "largest velocity residual in m/s",
        "energy": "energy residual / (weight · radius)",
    }
    return table[list(names)].rename(columns=names)


_CONSERVED = {
    "case": "formulation, integrator",
    "energy": "energy / (weight · radius)",
    "momentum": "horizontal momentum / (mass · rim speed)",
    "spin": "vertical angular momentum about the COG, relative",
    "allowed": "each allowed",
}


def _verdict(numbers: dict[str, Any]) -> Verdict:
    asked = numbers["all_tolerances"]
    return Verdict(
        statement="No stiff or extreme case crashes or breaks its promise of accuracy.",
        answer="no" if numbers["broken"] else "yes",
        numbers=f"Of {numbers['total']} cases asked for {asked.min():g} to {asked.max():g} rad, "
        f"{numbers['accurate']} are accurate and {numbers['ends']} end early, accurately; "
        f"{numbers['without']} give no accurate result, for reasons that are counted; "
        f"{numbers['broken'] or 'none'} crash or break the promise.",
        criterion="angles and the time of an ending within what was asked for, and its reason, "
        "beside two runs by other methods; said of these cases alone.",
        good=not numbers["broken"],
    )
