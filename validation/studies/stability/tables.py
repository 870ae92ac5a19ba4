"""Tables of the command line: critical speeds, and where spinning is stable."""

from collections.abc import Sequence
from dataclasses import replace

from analysis import LEVELS, MODELS, Motion, Scenario, Start
from analysis.stability.critical import CriticalSpeeds, Crossing
from analysis.stability.stable_spins import stable_spins
from validation.kit.tables import Table

_PAIRS = {
    "above": "two real eigenvalues become a pair",
    "below": "a pair becomes two real eigenvalues",
}


def critical_table(found: CriticalSpeeds) -> Table:
    """Critical speeds of one system; each row says what becomes of one eigenvalue or pair."""
    low, high = found.interval
    return Table(
        name=f"critical-{found.system}-{found.motion}",
        title=f"Single eigenvalues of {found.scenario.name}, {found.system} system, "
        f"{found.motion}, from {low:g} to {high:g} rad/s",
        columns=("as the spin rises", "spin in rad/s", "frequency in rad/s"),
        rows=[
            *((_change(each), each.spin, each.frequency) for each in found.crossings),
            *((_PAIRS[each.complex_side], each.spin, 0.0) for each in found.pair_changes),
        ],
        note=found.reason or "",
    )


def _change(crossing: Crossing) -> str:
    what = "pair" if crossing.kind == "hopf" else "real eigenvalue"
    return f"this {what} becomes {'stable' if crossing.stable_side == 'above' else 'unstable'}"


def stable_table(
    scenario: Scenario, interval: tuple[float, float], motion: Motion = "inverted"
) -> Table:
    """Spins at which a motion is stable as a whole: every eigenvalue decays.

    Parameters
    ----------
    scenario : Scenario
        Its own constraints and those of the four models, with its disk, friction and gravity.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s.
    motion : {"inverted", "noninverted"}
    """
    sets = [MODELS[level] for level in LEVELS]
    if scenario.model is None:
        sets.append(scenario.constraints)
    compared = [replace(scenario, constraints=each, start=Start()) for each in sets]
    return Table(
        name=f"stable-{motion}",
        title=f"Where {motion} spinning is stable, all eigenvalues of a model together, from "
        f"{interval[0]:g} to {interval[1]:g} rad/s",
        columns=("model", "stable spins in rad/s"),
        rows=[(each.name, stable_range(each, interval, motion)) for each in compared],
    )


def stable_range(
    scenario: Scenario, interval: tuple[float, float], motion: Motion = "inverted"
) -> str:
    """Spins at which a motion is stable as a whole, in words."""
    return in_words(stable_spins(scenario, interval, motion=motion))


def in_words(found: Sequence[tuple[float, float]]) -> str:
    """Intervals of the spin in words."""
    return ", ".join(f"{low:.6g} to {high:.6g}" for low, high in found) or "nowhere"
