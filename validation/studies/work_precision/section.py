"""Error against work and run time of every formulation and integrator.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is counted
in evaluations and measured in processor time; what it is worth is its largest deviation from a
reference that two different methods agree on.
"""

from functools import cache
from typing import Any

import pandas as pd

from validation.page.content import Content, Rows, Verdict
from validation.page.section import power, span
from validation.studies.work_precision import figures, problems, tables
from validation.studies.work_precision.measuring import CONSTRAINED, GOALS, curves, measure
from validation.study import Check, Row, Study, at_most, load, relative

TITLE = "Error against run time"


REFERENCES = Study(
    name="work-precision-references",
    cases=lambda: {name: name for name in problems.PROBLEMS},
    measure=problems.measure_reference,
    keys=("other",),
    confirm={"difference": 1e-11},
    sample=("model-1", "model-3"),
    columns={
        "other": "compared with",
        "setting": "step or tolerance",
        "difference": "largest difference in rad",
        "floor": "errors count from",
    },
)


@cache
def _floors() -> dict[str, float]:
    return tables.floors(load(REFERENCES).assign(problem=lambda table: table["case"]))


def _near_floor(stored: Row) -> float:
    """Allowed difference of errors: 5 % and what the references leave open."""
    return float(0.05 * stored["error"] + _floors()[stored["problem"]])


CURVES = Study(
    name="work-precision",
    cases=curves,
    measure=measure,
    keys=("kind", "setting"),
    confirm={"work": relative("work", 0.01), "error": _near_floor, "end": None},
    sample=(
        "model-1, contact-tree, RK67",
        "model-1, contact-tree, RK44",
        "model-1, index-1, DOP853",
        "model-3, floating, trapezoidal",
        "stiff, contact-tree, DOPRI5",
    ),
    timed=("seconds",),
    columns={
        "kind": "what is asked for: a step, a tolerance of each step, of the whole run, or steps "
        "down to one, extrapolated",
        "setting": "step in s or tolerance",
        "seconds": "processor time in s of the integration; to a tolerance, of the whole call",
        "work": "evaluations of the right-hand side, one per Newton iteration",
        "error": "largest difference of β, γ in rad and of the centre of gravity over the radius",
        "end": "why the ladder has no finer rungs",
    },
)
STUDIES = (REFERENCES, CURVES)


def present(rows: Rows) -> Content:
    """Tables, diagrams and the lesson."""
    references = rows[REFERENCES.name].assign(problem=lambda table: table["case"])
    runs, floors = tables.prepared(rows[CURVES.name]), tables.floors(references)
    asked = tables.asked(runs)
    numbers, fastest = _lesson(runs, asked), tables.ways(runs)
    return Content(
        numbers=numbers,
        tables={
            "fastest": fastest[fastest["error at most"] == power(GOALS[1])],
            "ways": fastest,
            "tolerances": tables.tolerances(runs),
            "references": references[["problem", "other", "setting", "difference"]]
            .assign(floor=references["problem"].map(floors))
            .rename(columns=REFERENCES.columns),
            "orders": tables.orders(runs, floors),
            "runs": rows[CURVES.name],
        },
        figures={"fronts": figures.fronts(runs, floors)},
        checks=_checks(asked, floors),
        verdicts=[_verdict(numbers["topology"])],
    )


def _checks(asked: pd.DataFrame, floors: dict[str, float]) -> list[Check]:
    """That the references can judge the finest goal, and runs to a tolerance keep it."""
    found = [
        at_most(f"work-precision: floor of {problem}", floor, GOALS[-1], "stored")
        for problem, floor in floors.items()
    ]
    kept = asked[~asked["failed"]]
    for (problem, formulation), group in kept.groupby(["problem", "formulation"]):
        name = f"work-precision: error over tolerance, {problem}, {formulation}"
        found.append(at_most(name, float(group["over"].max()), 1.0, "stored"))
    return found


def _lesson(runs: pd.DataFrame, asked: pd.DataFrame) -> dict[str, Any]:
    """Numbers of the text beside the tables."""
    held = runs[runs["formulation"].isin(CONSTRAINED)]
    free = tables.cheapest(runs[runs["formulation"] == "contact-tree"], ["problem"])["seconds"]
    best = tables.cheapest(held, ["problem"])
    own = tables.cheapest(runs[runs["formulation"] == "index-1"], ["problem"])
    ladders = held[held["kind"] == "step"]
    return {
        "topology": (best["seconds"] / free).dropna(),
        "won": {g: tables.ranked(best.loc[best["goal"] == g, "formulation"]) for g in GOALS},
        "failing": {
            scheme: (int(group["failed"].sum()), len(group))
            for scheme, group in ladders.groupby("scheme")
        },
        "careful": {
            setting: (1.0 / group["over"].median(), group["excess"].median())
            for setting, group in asked.groupby("setting", sort=False)
        },
        "stiff": _stiff(runs),
        "own": tables.ranked(own["scheme"]),
    }


def _stiff(runs: pd.DataFrame) -> dict[str, Any]:
    """The rungs of RK67 around its limit of stability on the stiff problem, and DOPRI5 there."""
    tree = runs[(runs["problem"] == "stiff") & (runs["formulation"] == "contact-tree")]
    rungs = tree[(tree["scheme"] == "RK67") & (tree["kind"] == "step")]
    good = (rungs["error"] <= GOALS[-1]).to_numpy()
    first = int(good.argmax()) if good.any() else len(rungs) - 1
    control = tables.cheapest(tree[tree["scheme"] == "DOPRI5"], ["scheme"]).iloc[0]
    return {"unstable": rungs.iloc[first - 1], "stable": rungs.iloc[first], "control": control}


def _verdict(ratios: "pd.Series[float]") -> Verdict:
    """Whether closing the contact by topology is the fastest way in the engine, for all goals."""
    faster = int((ratios > 1.0).sum())
    answer = "yes" if faster == len(ratios) else "partly" if faster else "no"
    return Verdict(
        statement="Closing the contact by topology is the engine's fastest way to run Model 1.",
        answer=answer,
        numbers=f"The fastest formulation that keeps a constraint takes {span(ratios)} times as "
        f"long, in {faster} of {len(ratios)} cases of problem and goal more.",
        criterion="yes if it is so for every problem and every goal that both reach.",
        good=answer == "yes",
    )
