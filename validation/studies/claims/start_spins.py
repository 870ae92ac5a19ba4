"""The least spin from which each model inverts (Sect. 7), beside its critical speed (Sect. 6)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis import MODELS, FlatError, Level, Scenario, Start
from analysis.data.endings import FLAT
from analysis.data.inversion import STAYING
from analysis.data.trajectory import Source
from analysis.stability import linear_reduced
from analysis.stability.critical import critical_speeds
from validation.kit.tables import Table
from validation.run import run
from validation.studies.claims.claim import Claim, grade, listed

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
    """What becomes of the start of Table 3 with this spin; "flat" if the disk lies flat.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    spin : float
        Spin at the start in rad/s.
    source : {"engine", "in-house"}
    """
    times = np.linspace(0.0, END + STAYING, round(100 * (END + STAYING)) + 1)
    scenario = Scenario(constraints=MODELS[level], start=Start(spin=spin))
    try:
        if source == "engine":
            found = run(scenario, times, step=ENGINE_STEP)
        else:
            form = "reduced" if level == 4 else "index-1"
            found = run(scenario, times, source=source, formulation=form, local_tolerance=1e-6)
    except FlatError:
        return "flat"
    if found.ending is not None and found.ending.reason == FLAT:
        return FLAT
    return found.inversion.outcome


def inverts(result: str) -> bool:
    """Whether an outcome is an inversion, kept or lost later."""
    return result in ("inverted", "lost")


@dataclass(frozen=True, slots=True, kw_only=True)
class LeastSpin:
    """Between which spins the inversion from Table 3's start begins.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    below, above : float
        Spins in rad/s without and with inversion.
    outcomes : tuple of 2 str
        In-house, at `below` and `above`.
    engine : tuple of 2 str
        The same in the engine.
    scan : tuple of str
        In-house, at the spins of `SCANNED`.
    critical, lost : tuple of float
        Spins in rad/s at which a pair of the model's own linearisation gains or loses stability.
    """

    level: Level
    below: float
    above: float
    outcomes: tuple[str, str]
    engine: tuple[str, str]
    scan: tuple[str, ...]
    critical: tuple[float, ...]
    lost: tuple[float, ...]

    @property
    def monotone(self) -> bool:
        """Whether none of the spins scanned below inverts and all above do."""
        return all(
            inverts(result) == (spin > self.above)
            for spin, result in zip(SCANNED, self.scan, strict=True)
        )

    @property
    def confirmed(self) -> bool:
        """Whether the engine's outcomes are the in-house ones."""
        return self.engine == self.outcomes


def find_least_spin(level: Level) -> LeastSpin:
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
    scenario = Scenario(constraints=MODELS[level])
    found = critical_speeds(scenario, (20.0, 40.0), system="numeric")
    return LeastSpin(
        level=level,
        below=low,
        above=high,
        outcomes=(results[low], results[high]),
        engine=(outcome(level, low, "engine"), outcome(level, high, "engine")),
        scan=tuple(outcome(level, spin) for spin in SCANNED),
        critical=tuple(each.spin for each in found.hopf if each.stable_side == "above"),
        lost=tuple(each.spin for each in found.hopf if each.stable_side == "below"),
    )


def claim(found: Sequence[LeastSpin]) -> Claim:
    """Section 7: inversion only from supercritical spins."""
    critical = linear_reduced.critical_speed(Scenario(constraints=MODELS[4])).spin
    least = [each.above for each in found]
    own = [each.above > max(each.critical) for each in found]
    paper = [spin > critical for spin in least]
    monotone = all(each.monotone for each in found)
    return Claim(
        place="Sect. 7",
        statement="the inversion occurs only for supercritical initial spins",
        criterion=f"the least spin from which Table 3's start is inverted within {END:g} s lies "
        f"above Ω_crit = {critical:.2f} rad/s and above the model's own critical speed in all "
        "models; partly: above Ω_crit in some; no: also if inversion comes and goes over the spin",
        measured=f"least spins of Models 1 to 4: {listed(least)} rad/s; the models' own critical "
        f"speeds: {listed(max(each.critical) for each in found)} rad/s",
        verdict=grade(yes=all(paper) and all(own) and monotone, partly=any(paper) and monotone),
    )


def table(found: Sequence[LeastSpin]) -> Table:
    """Least spins and critical speeds by model."""
    closed = linear_reduced.critical_speed(Scenario(constraints=MODELS[4])).spin
    return Table.of(
        found,
        {
            "model": lambda each: f"Model {each.level}",
            "critical speed in rad/s": lambda each: listed(each.critical, ".4f"),
            "another pair unstable above": lambda each: listed(each.lost, ".4f") or "–",
            "no inversion at rad/s": lambda each: each.below,
            "outcome there": lambda each: each.outcomes[0],
            "inversion at rad/s": lambda each: each.above,
            "outcome": lambda each: each.outcomes[1],
            "outcome at further spins in rad/s": lambda each: ", ".join(
                f"{spin:g}: {result}" for spin, result in zip(SCANNED, each.scan, strict=True)
            ),
            "engine has the same two outcomes": lambda each: each.confirmed,
        },
        name="start-spins",
        title="Critical speeds of inverted spinning, and least spins from which Table 3 inverts",
        note="Critical: above it the slow pair of the model's linearisation has a negative real "
        f"part. The closed form of the reduced system, Eq. (126), is {closed:.4f} rad/s. "
        f"Inverted: within {END:g} s; lost: below the centre again before {END + STAYING:g} s; "
        "not decided: up at the end, for too short a time. In-house to a local tolerance of 1e-6; "
        f"engine with steps of {ENGINE_STEP:g} s.",
    )
