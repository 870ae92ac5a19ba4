"""Tables of cycles, of their birth and of their end.

Rows of a study that have the names of a motion's attributes do as well as the motion.
"""

from collections.abc import Iterable, Sequence
from math import log
from typing import Any

from analysis import Scenario
from analysis.nonlinear.asymmetric import AsymmetricCycle, AsymmetricFamily, Change
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import Bifurcation, CycleFamily
from analysis.nonlinear.heteroclinic import Connection, PeriodGrowth
from analysis.nonlinear.hopf import Growth, HopfType
from analysis.nonlinear.rotating import Rotation, RotationFamily
from analysis.nonlinear.slow_manifold import SlowOrbit, slow_connection
from validation.kit.tables import Table

WORDS = {True: "stable", False: "unstable", None: "undecided"}

_SMALL = 1.05
"""Largest amplitude in rad of the cycles from which the growth is fitted."""


HEADS = {
    "amplitude": "amplitude in rad",
    "lowest": "least deviation in rad",
    "tilt": "tilt in rad",
    "largest_tilt": "largest tilt in rad",
    "spin": "spin in rad/s",
    "period": "period in s",
    "half_multiplier": "multiplier over half a period",
    "multiplier": "multiplier",
    "complex_multiplier": "size of the complex pair",
    "log_strong": "log10 of the other",
    "stable": "stable",
}
"""Headings of what is told of a periodic motion."""


def motion_table(motions: Iterable[Any], *own: str, **told: Any) -> Table:
    """Table of periodic motions, with attributes of their own in front."""
    names = (*own, "spin", "period", "multiplier", "log_strong", "stable")
    rows = [[_cell(each, name) for name in names] for each in motions]
    return Table(columns=[HEADS[name] for name in names], rows=rows, **told)


def _cell(motion: Any, name: str) -> Any:
    value = getattr(motion, name)
    if name == "log_strong":
        return value / log(10.0)
    return WORDS[value] if name == "stable" else value


def cycle_table(cycles: Iterable[Cycle]) -> Table:
    """Cycles with their multipliers."""
    return motion_table(
        cycles,
        "amplitude",
        "half_multiplier",
        name="cycles",
        title="Periodic motions of the reduced system",
        note="The amplitude is the largest deviation of γ from π/2; the third multiplier is 1.",
    )


def bifurcation_table(found: Sequence[Bifurcation], cycles: Sequence[Cycle]) -> Table:
    """Where the stability of cycles changes, and the range of their multiplier.

    Parameters
    ----------
    found : sequence of Bifurcation
    cycles : sequence of Cycle
        The family.
    """
    values = [cycle.half_multiplier for cycle in cycles]
    note = "" if found else "There are none: stability does not change along the family. "
    return Table(
        name="bifurcations",
        title="Bifurcations along the family",
        columns=("kind", "amplitude in rad", "spin in rad/s", "period in s"),
        rows=[(b.kind, b.cycle.amplitude, b.cycle.spin, b.cycle.period) for b in found],
        note=f"{note}The larger multiplier over half a period, with the mirror image, lies "
        f"between {min(values):.4g} and {max(values):.4g}; at 1 cycles fold, at -1 they lose "
        "their symmetry.",
    )


def rotation_table(family: RotationFamily, turns: Sequence[Rotation]) -> Table:
    """Rotating motions, and where their spin turns back."""
    notes = ["The tilt is β − π/2 where γ passes noninverted spinning."]
    notes += [
        f"They fold at a tilt of {each.tilt:.6g} rad and {each.spin:.9g} rad/s." for each in turns
    ]
    return motion_table(
        family.rotations,
        "tilt",
        "largest_tilt",
        name="rotations",
        title="Rotating motions of the reduced system, from the connection at "
        f"{family.connection.spin:.9g} rad/s on",
        note=_noted(notes, family.reason),
    )


def asymmetric_table(
    family: AsymmetricFamily, found: Sequence[tuple[Change, AsymmetricCycle]]
) -> Table:
    """Cycles without mirror symmetry, and where their stability changes."""
    born = family.bifurcation.cycle
    words = {"fold": "They fold", "period-doubling": "Their period doubles"}
    notes = ["Deviations of γ from π/2."]
    notes += [
        f"{words[kind]} at {each.amplitude:.6g} and {each.lowest:.6g} rad and {each.spin:.9g} "
        "rad/s."
        for kind, each in found
    ]
    return motion_table(
        family.cycles,
        "amplitude",
        "lowest",
        name="asymmetric",
        title="Cycles without mirror symmetry of the reduced system, from "
        f"{born.amplitude:.6g} rad and {born.spin:.9g} rad/s on",
        note=_noted(notes, family.reason),
    )


def _noted(notes: Iterable[str], reason: str | None) -> str:
    return " ".join(notes) + ("" if reason is None else f" The family ends early: {reason}.")


def small_cycles(family: CycleFamily) -> list[Cycle]:
    """The cycles from which the growth near the Hopf point is fitted."""
    return [cycle for cycle in family.cycles if cycle.amplitude < _SMALL]


def hopf_table(normal: HopfType, growth: Growth | None) -> Table:
    """Type of the Hopf bifurcation from the normal form, and from a fit to cycles."""
    term = "(Ω − Ω_crit)/amplitude²"
    rows: list[tuple[str, float, float | None]] = [
        ("spin in rad/s", normal.spin, None),
        ("frequency in rad/s", normal.frequency, None),
        ("first Lyapunov coefficient", normal.lyapunov, None),
        (f"{term}, normal form, in rad/s", normal.curvature, None),
    ]
    if growth is not None:
        exponent = "power of the amplitude, fitted", growth.exponent, growth.exponent_error
        fitted = f"{term}, fitted, in rad/s", growth.curvature, growth.curvature_error
        rows += [fitted, exponent]
    return Table(
        name="hopf",
        title=f"The Hopf bifurcation of inverted spinning is {normal.kind}",
        columns=("quantity", "value", "standard error"),
        rows=rows,
        note="The critical pair does not slip, so the normal form takes the friction law by its "
        "gradient alone, and holds for the paper's law in spite of its kink.",
    )


def connection_table(
    found: Connection, slow: SlowOrbit | None, growth: PeriodGrowth | None
) -> Table:
    """The heteroclinic connection beside its first-order prediction and the periods near it."""
    rows: list[tuple[str, float]] = [
        ("spin in rad/s", found.spin),
        ("spin less lower side of the bracket in rad/s", found.spin - found.below),
        ("upper side of the bracket less spin in rad/s", found.above - found.spin),
        ("growing eigenvalue of the saddle in 1/s", found.growing),
        ("slow decaying one in 1/s", found.slow),
        ("fast decaying one in 1/s", found.strong),
        ("saddle index", found.saddle_index),
    ]
    if slow is not None:
        rows += [
            ("first-order prediction of the spin in rad/s", slow.spin),
            ("spin less prediction in rad/s", found.spin - slow.spin),
            ("largest friction over weight on it", slow.friction),
        ]
    if growth is not None:
        rows += [
            ("period over ln |Ω − Ω_het| in s", growth.by_spin),
            ("  −2/growing eigenvalue in s", growth.predicted_by_spin),
            ("period over ln(π − amplitude) in s", growth.by_amplitude),
            ("  −2 (1/growing + 1/|slow|) in s", growth.predicted_by_amplitude),
        ]
    return Table(
        name="heteroclinic",
        title=f"The heteroclinic connection, where the cycles end, at {found.spin:.9f} rad/s",
        columns=("quantity", "value"),
        rows=rows,
        note="Cycles near the connection are stable where the saddle index exceeds 1.",
    )


def prediction(scenario: Scenario) -> SlowOrbit | None:
    """First-order prediction of the connection; None where friction is too weak for it."""
    try:
        return slow_connection(scenario)
    except ArithmeticError:
        return None
