"""What the runs say: cheapest ways, orders, prices, failures."""

from collections.abc import Sequence
from itertools import pairwise, product
from math import inf, log
from statistics import median
from typing import Any

import numpy as np
import pandas as pd

from validation.page.section import power, sig
from validation.studies.work_precision.measuring import GOALS, IN_HOUSE, USEFUL
from validation.studies.work_precision.problems import SAFETY, TIMES, TITLES
from validation.study import Row

NAMES = {
    "contact-tree": "contact tree",
    "euler-tree": "Euler tree",
    "floating": "floating, Euler parameters",
    "floating-lie": "floating, Lie group",
    "index-1": "in-house, index 1 (Python)",
    "reduced": "in-house, reduced (Python)",
}

CURVE = ["problem", "formulation", "scheme"]

_SIDES = {"engine": "in the engine", "in-house": "in-house"}

_LEAST_RATIO = 1.4
"""Of steps or evaluations between two rungs from which an order can be told."""

_LEAST_RUNGS = 4
"""Rungs in the asymptotic range from which an order can be told."""

_SETTLED = 0.6
"""Largest spread of the slopes between those rungs."""


def prepared(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs with names of their ways and their sides; failed ones have an infinite error."""
    words = {"extrapolated": ", extrapolated", "tolerance": ", to a tolerance"}
    return runs.fillna({"error": inf, "angle_error": inf}).assign(
        way=runs["scheme"] + runs["kind"].map(words).fillna(""),
        side=np.where(runs["formulation"].isin(IN_HOUSE), "in-house", "engine"),
        milliseconds=1e3 * runs["seconds"],
        failed=runs["failure"] != "",
    )


def floors(references: pd.DataFrame) -> dict[str, float]:
    """Smallest error that can be measured on each problem."""
    least = references.groupby("problem")["difference"].min()
    return {str(problem): SAFETY * float(value) for problem, value in least.items()}


def cheapest(runs: pd.DataFrame, by: Sequence[str], cost: str = "seconds") -> pd.DataFrame:
    """The cheapest run of each group to each goal, indexed by both.

    Runs to a tolerance, which are not chosen with the reference at hand, are not among them.
    """
    chosen = runs[runs["kind"] != "tolerance"]
    met = pd.concat(
        [chosen[chosen["error"] <= goal].assign(goal=goal) for goal in GOALS], ignore_index=True
    )
    best = met.loc[met.groupby([*by, "goal"], sort=False)[cost].idxmin()]
    return best.set_index([*by, "goal"], drop=False)


def shortfall(runs: pd.DataFrame) -> str:
    """Why no run meets a goal; "not reached" only where every ladder went to its end."""
    best = runs["error"].min()
    found = f", best {best:.0e}" if best <= USEFUL else ""
    open_ended = runs[runs["end"].isin(["work", "goal"])]
    if open_ended.empty:
        return f"not reached{found}"
    finest = open_ended.loc[open_ended["kind"] == "step", "setting"].min()
    steps = round(TIMES[-1] / finest)
    return (
        f"fails up to {steps} steps" if best == inf else f"not tried beyond {steps} steps{found}"
    )


def ways(runs: pd.DataFrame) -> pd.DataFrame:
    """Fastest way to each goal, in the engine and in-house, or why there is none."""
    best = cheapest(runs, ["problem", "side"])
    groups = dict(tuple(runs.groupby(["problem", "side"])))
    rows = []
    for problem, goal in product(TITLES, GOALS):
        row: Row = {"problem": TITLES[problem], "error at most": power(goal)}
        for side, head in _SIDES.items():
            if (problem, side, goal) in best.index:
                run = best.loc[(problem, side, goal)]
                row[head] = f"{run['formulation']}, {run['way']}"
                row[f"evaluations, {side}"] = int(run["work"])
                row[f"time in ms, {side}"] = float(sig(run["milliseconds"], 3))
            else:
                row[head] = shortfall(groups[problem, side])
        rows.append(row)
    return pd.DataFrame(rows)


def asked(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs to a tolerance, with how much better and dearer they are than they would have to be.

    `over` is the error of beta and gamma over the tolerance, `excess` the evaluations over those
    of the cheapest run of the same method that would do, which only a reference tells.
    """
    found = runs[runs["kind"] == "tolerance"]
    enough = cheapest(runs, CURVE, cost="work")["work"].rename("enough")
    found = found.join(enough, on=[*CURVE, "setting"])
    met = found["error"] <= found["setting"]
    return found.assign(
        over=(found["angle_error"] / found["setting"]).where(~found["failed"]),
        excess=(found["work"] / found["enough"]).where(met),
        worse=~met & ~found["failed"],
    )


def tolerances(runs: pd.DataFrame) -> pd.DataFrame:
    """What runs to a tolerance deliver and take, per formulation and integrator."""
    groups = asked(runs).groupby(["formulation", "scheme"], sort=False)
    table = groups.agg(
        **{
            "runs": ("kind", "size"),
            "refused": ("failed", "sum"),
            "error of β and γ over tolerance, largest": ("over", "max"),
            "median": ("over", "median"),
            "position worse than that, runs": ("worse", "sum"),
            "evaluations over the least that would do, median": ("excess", "median"),
        }
    )
    return table.reset_index()


def orders(runs: pd.DataFrame, floor: dict[str, float]) -> pd.DataFrame:
    """Observed order of each method, or why it has none, with a column for each problem."""
    shown = runs[runs["kind"].isin(["step", "local tolerance"])]
    groups: Any = shown.groupby(CURVE, sort=False)
    found = pd.Series({key: observed_order(group, floor[key[0]]) for key, group in groups})
    methods = list(dict.fromkeys((form, scheme) for _, form, scheme in found.index))
    table = found.unstack(0).reindex(index=methods, columns=list(TITLES)).fillna("")
    table.index = pd.Index([", ".join(method) for method in methods], name="method")
    return table.rename(columns=TITLES).reset_index()


def observed_order(runs: pd.DataFrame, floor: float) -> float | str:
    """Median slope of the error against the number of steps, with its sign turned.

    Evaluations of the right-hand side stand for the steps of methods that control them. Counted
    are the finest consecutive rungs whose errors lie between what can be measured and what is
    useful and fall from each to the next; there must be 4 of them, and the slopes between the
    last ones must agree to 0.6.

    Parameters
    ----------
    runs : DataFrame
        Of one method on one problem, from coarse to fine.
    floor : float
        Smallest error that can be measured.
    """
    slopes: list[list[float]] = [[]]
    for coarse, fine in pairwise(runs.to_dict("records")):
        by_step = coarse["kind"] == "step"
        finer = coarse["setting"] / fine["setting"] if by_step else fine["work"] / coarse["work"]
        if floor < fine["error"] < coarse["error"] < USEFUL and finer > _LEAST_RATIO:
            slopes[-1].append(log(coarse["error"] / fine["error"]) / log(finer))
        elif slopes[-1]:
            slopes.append([])
    last = max(slopes, key=len)[1 - _LEAST_RUNGS :]
    if len(last) < _LEAST_RUNGS - 1:
        return "– few rungs"
    if max(last) - min(last) > _SETTLED:
        return f"– unsettled, {min(last):.1f} to {max(last):.1f}"
    return round(median(last), 2)


def ranked(names: "pd.Series[str]") -> dict[str, int]:
    """How often each name comes, the most frequent first."""
    counts = names.value_counts()
    return {str(n): int(counts[n]) for n in sorted(counts.index, key=lambda n: (-counts[n], n))}
