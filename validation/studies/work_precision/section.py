"""Error against work and run time of every formulation and integrator.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is counted
in evaluations and measured in processor time; what it is worth is its largest deviation from a
reference that two different methods agree on.
"""

from collections.abc import Sequence
from itertools import product
from math import inf
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis.problem.choices import FORMULATIONS
from mbs_models.integrators import EXPONENTS
from validation.display.figures import new_figure
from validation.display.tables import power
from validation.page.section import sig
from validation.studies.work_precision import measuring
from validation.studies.work_precision.measuring import CURVES, GOALS, REFERENCES, TITLES, USEFUL
from validation.study import Check, Content, Row, Rows, at_most, grade

TITLE = "Error against run time"

ORDER = 0.1
"""Largest difference of an observed order from the rule's own."""

STUDIES = (REFERENCES, CURVES)


def present(rows: Rows) -> Content:
    """Tables, diagrams and the lesson."""
    references, runs = rows[REFERENCES.name], prepared(rows[CURVES.name])
    # The smallest error that can be measured on each problem; others count as that.
    least = (measuring.SAFETY * references.groupby("case")["difference"].min()).to_dict()
    runs["error"] = runs["error"].clip(lower=runs["problem"].map(least))
    to_goals, fastest = asked(runs), ways(runs)
    numbers, found = _lesson(runs, to_goals), orders(runs, least)
    return Content(
        numbers=numbers,
        tables={
            "fastest": fastest[fastest["error at most"] == power(GOALS[1])],
            "ways": fastest,
            "tolerances": tolerances(to_goals),
            "references": references,
            "orders": found,
            "runs": rows[CURVES.name],
        },
        figures={"fronts": lambda: fronts(runs, least)},
        checks=_checks(to_goals, least, found),
    )


def _checks(to_goals: pd.DataFrame, least: dict[str, float], found: pd.DataFrame) -> list[Check]:
    """References judge the finest goal, runs to a tolerance keep it, rules have their orders."""
    kept = to_goals[~to_goals["failed"]].groupby(["problem", "formulation"])["ratio"].max()
    off = (found["observed"] - found["order"]).abs().groupby(found["scheme"]).max()
    values: dict[str, tuple[float, float]] = {
        **{f"floor of {problem}": (floor, GOALS[-1]) for problem, floor in least.items()},
        **{f"error over tolerance, {', '.join(key)}": (ratio, 1.0) for key, ratio in kept.items()},
        **{f"order of {scheme}": (apart, ORDER) for scheme, apart in off.items()},
    }
    return [at_most(f"work-precision: {name}", *value, "stored") for name, value in values.items()]


def _lesson(runs: pd.DataFrame, to_goals: pd.DataFrame) -> dict[str, Any]:
    """Numbers of the text beside the tables."""
    held = runs[runs["formulation"].isin(measuring.CONSTRAINED)]
    free = cheapest(runs[runs["formulation"] == "contact-tree"], ["problem"])
    best = cheapest(held, ["problem"])
    in_house = cheapest(runs[runs["formulation"] == "index-1"], ["problem"])
    failed = held[held["kind"] == "step"].groupby("scheme")["failed"].agg(["sum", "size"])
    careful = to_goals.groupby("setting", sort=False)[["ratio", "excess"]].median()
    ratios, effort = ((best[cost] / free[cost]).dropna() for cost in ("seconds", "work"))
    return {
        "topology": ratios,
        "effort": effort,
        "answer": grade(yes=(ratios > 1.0).all(), partly=(ratios > 1.0).any()),
        "won": {
            g: best.loc[best["goal"] == g, "formulation"].value_counts().to_dict() for g in GOALS
        },
        "failing": failed.T.to_dict("list"),
        "careful": careful.assign(ratio=1.0 / careful["ratio"]).T.to_dict("list"),
        "stiff": _stiff(runs),
        "in_house": in_house["scheme"].value_counts().to_dict(),
    }


def _stiff(runs: pd.DataFrame) -> dict[str, Any]:
    """The rungs of RK67 around its limit of stability on the stiff problem, and DOPRI5 there."""
    tree = runs[(runs["problem"] == "stiff") & (runs["formulation"] == "contact-tree")]
    rungs = tree[(tree["scheme"] == "RK67") & (tree["kind"] == "step")]
    good = rungs["error"] <= GOALS[-1]
    control = cheapest(tree[tree["scheme"] == "DOPRI5"], ["scheme"]).iloc[0]
    return {"unstable": rungs[~good].iloc[-1], "stable": rungs[good].iloc[0], "control": control}


# --- Tables -------------------------------------------------------------------------------------

LOOKS = {
    "contact-tree": ("contact tree", "#000000", "o"),
    "euler-tree": ("Euler tree", "#0072b2", "s"),
    "floating": ("floating, Euler parameters", "#d55e00", "^"),
    "floating-lie": ("floating, Lie group", "#cc79a7", "v"),
    "index-1": ("in-house, index 1 (Python)", "#009e73", "D"),
    "reduced": ("in-house, reduced (Python)", "#8a8a8a", "P"),
}
"""Name, colour and marker of each formulation; they differ in grey, too."""

CURVE = ["problem", "formulation", "scheme"]

_SIDES = {"engine": "in the engine", "in-house": "in-house"}


def prepared(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs with names of their ways and their sides; failed ones have an infinite error."""
    words = {"extrapolated": ", extrapolated", "tolerance": ", to a tolerance"}
    return runs.fillna({"error": inf, "angle_error": inf}).assign(
        way=runs["scheme"] + runs["kind"].map(words).fillna(""),
        side=np.where(runs["formulation"].isin(FORMULATIONS), "in-house", "engine"),
        milliseconds=1e3 * runs["seconds"],
        failed=runs["failure"] != "",
    )


def cheapest(runs: pd.DataFrame, by: Sequence[str], cost: str = "seconds") -> pd.DataFrame:
    """The cheapest run of each group to each goal, indexed by both.

    Runs to a tolerance, which are not chosen with the reference at hand, are not among them.
    """
    chosen = runs[runs["kind"] != "tolerance"]
    paired = pd.DataFrame({"goal": GOALS}).merge(chosen, how="cross")
    met = paired[paired["error"] <= paired["goal"]]
    best = met.loc[met.groupby([*by, "goal"], sort=False)[cost].idxmin()]
    return best.set_index([*by, "goal"], drop=False)


def ways(runs: pd.DataFrame) -> pd.DataFrame:
    """Fastest way to each goal, in the engine and in-house; nothing where none reaches it."""
    best = cheapest(runs, ["problem", "side"])
    rows = []
    for problem, goal in product(TITLES, GOALS):
        row: Row = {"problem": TITLES[problem], "error at most": power(goal)}
        for side, head in _SIDES.items():
            if (problem, side, goal) in best.index:
                run = best.loc[(problem, side, goal)]
                row[head] = f"{run['formulation']}, {run['way']}"
                row[f"evaluations, {side}"] = int(run["work"])
                row[f"time in ms, {side}"] = float(sig(run["milliseconds"], 3))
        rows.append(row)
    return pd.DataFrame(rows)


def asked(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs to a tolerance, with how much better and dearer they are than they would have to be.

    `ratio` is the error of beta and gamma over the tolerance, `excess` the evaluations over those
    of the cheapest run of the same method that would do, which only a reference tells.
    """
    found = runs[runs["kind"] == "tolerance"]
    enough = cheapest(runs, CURVE, cost="work")["work"].rename("enough")
    found = found.join(enough, on=[*CURVE, "setting"])
    met = found["error"] <= found["setting"]
    return found.assign(
        ratio=(found["angle_error"] / found["setting"]).where(~found["failed"]),
        excess=(found["work"] / found["enough"]).where(met),
        worse=~met & ~found["failed"],
    )


def tolerances(to_goals: pd.DataFrame) -> pd.DataFrame:
    """What runs to a tolerance deliver and take, per formulation and integrator."""
    groups = to_goals.groupby(["formulation", "scheme"], sort=False)
    table = groups.agg(
        **{
            "runs": ("kind", "size"),
            "refused": ("failed", "sum"),
            "error of β and γ over tolerance, largest": ("ratio", "max"),
            "median": ("ratio", "median"),
            "position worse than that, runs": ("worse", "sum"),
            "evaluations over the least that would do, median": ("excess", "median"),
        }
    )
    return table.reset_index()


def orders(runs: pd.DataFrame, floor: dict[str, float]) -> pd.DataFrame:
    """Observed orders of the engine's rules of fixed steps, beside their own.

    That is the median slope between two rungs, over all problems, where the error is useful,
    can be measured and falls.
    """
    rungs = runs[runs["kind"] == "step"]
    coarse, fine = rungs.groupby(CURVE, sort=False)["error"].shift(), rungs["error"]
    converging = (coarse < USEFUL) & (fine < coarse) & (fine > rungs["problem"].map(floor))
    slopes = rungs[converging].assign(observed=np.log2(coarse[converging] / fine[converging]))
    groups = slopes.groupby(["formulation", "scheme"], sort=False)["observed"]
    table = groups.agg(**{"pairs of rungs": "size", "observed": "median"}).reset_index()
    orders = [EXPONENTS[measuring.INTEGRATORS[scheme].name][0] for scheme in table["scheme"]]
    return table.assign(order=orders)


# --- Diagram ------------------------------------------------------------------------------------

_LOWEST, _HIGHEST = 3e-12, 1.0


def fronts(runs: pd.DataFrame, floors: dict[str, float]) -> Figure:
    """What each formulation can do with the best of its integrators, one panel per problem."""
    figure, axes = new_figure(3, columns=3, width=10.5, height=10.4, share=False)
    *panels, spare = axes.flat
    for panel, (problem, title) in zip(panels, TITLES.items(), strict=True):
        found = runs[runs["problem"] == problem]
        for formulation, group in found.groupby("formulation", sort=False):
            _, colour, marker = LOOKS[formulation]
            best = front(group)
            look: Any = {"color": colour, "marker": marker, "markersize": 4.5, "linewidth": 1.2}
            panel.plot(best["milliseconds"], best["error"], **look)
        panel.set_title(title, fontsize=10, loc="left")
        panel.set(xscale="log", yscale="log", ylim=(_LOWEST, _HIGHEST))
        panel.set(xlabel="processor time in ms", ylabel="error: rad, or radii of the COG")
        panel.margins(x=0.12)
        panel.set_yticks([10.0**-digits for digits in range(0, 12, 3)])
        panel.axhspan(_LOWEST, floors[problem], color="#e6e6e6", zorder=0)
        for goal in GOALS:
            panel.axhline(goal, color="#777777", linewidth=0.8, linestyle=":")
    for name, colour, marker in LOOKS.values():
        spare.plot([], [], color=colour, marker=marker, markersize=5, label=name)
    spare.set_axis_off()
    spare.legend(loc="center", frameon=False)
    return figure


def front(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs that no other beats in both time and error, the fastest first.

    Of those too good to be measured, that is the first one.
    """
    ranked = runs[runs["kind"] != "tolerance"].sort_values(["seconds", "error"])
    best = ranked["error"].cummin().shift(fill_value=inf).clip(upper=USEFUL)
    return ranked[ranked["error"] < best]
