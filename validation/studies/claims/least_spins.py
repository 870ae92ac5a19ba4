"""The least spin from which each model inverts (Sect. 7), beside its critical speed (Sect. 6)."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from analysis import LEVELS, MODELS, FlatError, Level, Scenario, Start
from analysis.data.endings import FLAT
from analysis.data.inversion import STAYING
from analysis.data.trajectory import Source
from analysis.stability import linear_reduced
from analysis.stability.critical import critical_speeds
from validation.run import run
from validation.studies.claims.claim import Claim, grade, listed
from validation.study import Check, Row, Study, equal

END = 10.0
"""Time in s within which the disk has to be inverted."""

BRACKET = (29.0, 33.0)
"""Spins in rad/s between which the bisection looks."""

WIDTH = 0.04
"""Width in rad/s of what is left of the bracket."""

SCANNED = (20.0, 40.0, 100.0)
"""Further spins in rad/s: none below the bracket may invert, and all above have to."""

ENGINE_STEP = 2e-3
"""Step in s of the engine's runs."""


def outcome(level: Level, spin: float, source: Source = "in-house") -> str:
    """What becomes of the start of Table 3 with this spin in rad/s; "flat" if it lies flat."""
    times = np.linspace(0.0, END + STAYING, round(100 * (END + STAYING)) + 1)
    scenario = Scenario(constraints=MODELS[level], start=Start(spin=spin))
    try:
        if source == "engine":
            found = run(scenario, times, step=ENGINE_STEP)
        else:
            form = "reduced" if level == 4 else "index-1"
            found = run(scenario, times, source=source, formulation=form, local_tolerance=1e-6)
    except FlatError:
        return FLAT
    if found.ending is not None and found.ending.reason == FLAT:
        return FLAT
    return found.inversion.outcome


def inverts(result: str) -> bool:
    """Whether an outcome is an inversion, kept or lost later."""
    return result in ("inverted", "lost")


def search(level: Level) -> list[Row]:
    """Bisect the bracket for the spin from which the model inverts.

    Raises
    ------
    ArithmeticError
        If the ends of the bracket do not differ.
    """
    low, high = BRACKET
    results = {spin: outcome(level, spin) for spin in BRACKET}
    if inverts(results[low]) or not inverts(results[high]):
        raise ArithmeticError(f"Model {level}: no change between {low:g} and {high:g} rad/s")
    while high - low > WIDTH:
        middle = 0.5 * (low + high)
        results[middle] = outcome(level, middle)
        low, high = (low, middle) if inverts(results[middle]) else (middle, high)
    hopf = critical_speeds(
        Scenario(constraints=MODELS[level]), (20.0, 40.0), system="numeric"
    ).hopf
    return [
        {
            "critical": [each.spin for each in hopf if each.stable_side == "above"],
            "lost": [each.spin for each in hopf if each.stable_side == "below"],
            "below": low,
            "outcome_below": results[low],
            "above": high,
            "outcome_above": results[high],
            "scan": [outcome(level, spin) for spin in SCANNED],
            "engine_below": outcome(level, low, "engine"),
            "engine_above": outcome(level, high, "engine"),
        }
    ]


LEAST_SPINS = Study(
    name="least-spins",
    cases=lambda: {f"Model {level}": level for level in LEVELS},
    measure=search,
    sample=("Model 1", "Model 4"),
    confirm={"critical": 1e-6, "lost": 1e-6, "below": 1e-9, "above": 1e-9, "scan": None}
    | {
        f"{which}_{place}": None for which in ("outcome", "engine") for place in ("below", "above")
    },
    columns={
        "critical": "spins in rad/s at which a pair of eigenvalues becomes stable",
        "lost": "the same, unstable",
        "below": "spin in rad/s without inversion",
        "above": "spin in rad/s with inversion",
        "scan": f"outcomes at {', '.join(f'{spin:g}' for spin in SCANNED)} rad/s",
    },
)


def is_monotone(row: Row) -> bool:
    """Whether none of the spins scanned below inverts and all above do."""
    return all(
        inverts(result) == (spin > row["above"])
        for spin, result in zip(SCANNED, row["scan"], strict=True)
    )


def critical_speed() -> float:
    """That of the reduced system in closed form, in rad/s."""
    return linear_reduced.critical_speed(Scenario(constraints=MODELS[4])).spin


def claim(found: Sequence[Row]) -> Claim:
    """Section 7: inversion only from supercritical spins."""
    critical = critical_speed()
    own = [max(row["critical"]) for row in found]
    least = [row["above"] for row in found]
    over = [spin > critical for spin in least]
    over_own = all(spin > limit for spin, limit in zip(least, own, strict=True))
    monotone = all(map(is_monotone, found))
    return Claim(
        "Sect. 7",
        "the inversion occurs only for supercritical initial spins",
        f"the least spin from which Table 3's start is inverted within {END:g} s lies above "
        f"Ω_crit = {critical:.2f} rad/s and above the model's own critical speed in all models; "
        "partly: above Ω_crit in some; no: also if inversion comes and goes over the spin",
        f"least spins of Models 1 to 4: {listed(least)} rad/s; the models' own critical speeds: "
        f"{listed(own)} rad/s",
        grade(yes=all(over) and over_own and monotone, partly=any(over) and monotone),
    )


def table(found: Sequence[Row]) -> pd.DataFrame:
    """Least spins and critical speeds by model."""
    return pd.DataFrame(
        {
            "model": row["case"],
            "critical speed in rad/s": listed(row["critical"], ".4f"),
            "another pair unstable above": listed(row["lost"], ".4f") or "–",
            "no inversion at rad/s": row["below"],
            "outcome there": row["outcome_below"],
            "inversion at rad/s": row["above"],
            "outcome": row["outcome_above"],
            "at further spins in rad/s": ", ".join(
                f"{spin:g}: {result}" for spin, result in zip(SCANNED, row["scan"], strict=True)
            ),
        }
        for row in found
    )


def checks(found: Sequence[Row]) -> list[Check]:
    """Whether the engine has the same outcomes."""
    return [
        equal(
            f"least spins: outcome {place} the change, {row['case']}",
            row[f"engine_{place}"],
            row[f"outcome_{place}"],
            "stored",
        )
        for row in found
        for place in ("below", "above")
    ]
