"""Tables of periodic motions, of their birth and of their end.

A motion is told by a row: what `PeriodicMotion.as_row` says, or what a study has kept of it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from analysis import Scenario
from analysis.mechanics.paper import critical_speed
from analysis.nonlinear.heteroclinic import Connection, NoConnectionError, heteroclinic_connection
from analysis.nonlinear.hopf import Growth, HopfType
from analysis.nonlinear.motions import KINDS, Event, Kind, PeriodicMotion
from analysis.nonlinear.slow_manifold import SlowOrbit, slow_connection
from validation.display.tables import Table

Motion = Mapping[str, Any]
"""A periodic motion by the names of what is told of it."""

WORDS = {True: "stable", False: "unstable", None: "undecided"}

HEADS = {
    "amplitude": "amplitude in rad",
    "lowest": "least deviation in rad",
    "tilt": "tilt in rad",
    "largest_tilt": "largest tilt in rad",
    "spin": "spin in rad/s",
    "period": "period in s",
    "half_multiplier": "multiplier over half a period",
    "multiplier": "multiplier",
    "imaginary": "its imaginary part",
    "complex_multiplier": "size of the complex pair",
    "log10_strong": "log10 of the other multiplier",
    "stable": "stable",
}
"""Headings of what is told of a periodic motion."""

SADDLE = {
    "growing": "growing eigenvalue of the saddle in 1/s",
    "slow": "slow decaying one in 1/s",
    "strong": "fast decaying one in 1/s",
    "saddle_index": "saddle index",
}
"""Headings of what is told of a connection beside its spin."""

_TITLES: dict[Kind, str] = {
    "symmetric": "Periodic motions of the reduced system",
    "asymmetric": "Cycles without mirror symmetry of the reduced system",
    "rotating": "Rotating motions of the reduced system",
}
_NOTES: dict[Kind, str] = {
    "symmetric": "The amplitude is the largest deviation of γ from π/2; the third multiplier is "
    "1.",
    "asymmetric": "Deviations of γ from π/2.",
    "rotating": "The tilt is β − π/2 where γ passes noninverted spinning.",
}
_CHANGES = {
    "fold": "they fold",
    "symmetry-breaking": "they lose their symmetry",
    "period-doubling": "their period doubles",
}


def motion_table(
    rows: Sequence[Motion], kind: Kind = "symmetric", first: tuple[str, str] | None = None
) -> Table:
    """Table of periodic motions of a kind.

    Parameters
    ----------
    rows : sequence of Motion
    kind : {"symmetric", "asymmetric", "rotating"}
    first : tuple of 2 str, optional
        Name and heading of what else is told of each, in front.
    """
    pair = ("imaginary",) if any(row.get("imaginary") for row in rows) else ()
    names = (*KINDS[kind].columns, "spin", "period", "multiplier", *pair, "log10_strong", "stable")
    heads = dict([first] if first else [])
    return Table(
        title=_TITLES[kind],
        columns=[*heads.values(), *(HEADS[name] for name in names)],
        rows=[
            [WORDS[row[name]] if name == "stable" else row[name] for name in (*heads, *names)]
            for row in rows
        ],
        note=_NOTES[kind],
    )


def event_table(found: Sequence[Event], motions: Sequence[PeriodicMotion]) -> Table:
    """Where the stability of a family changes, and the range of its multiplier."""
    ends = motions[0].ends
    values = [each.larger for each in motions]
    over = " over half a period, with the mirror image," if ends.mirrored else ""
    stretch = over or ", of a complex pair its real part,"
    meaning = ", ".join(f"at {at:g} {_CHANGES[change]}" for change, at in ends.changes.items())
    if not ends.mirrored:
        meaning += "; where a complex pair passes the unit circle, a torus branches off"
    none = "" if found else "There are none: stability does not change along the family. "
    return Table(
        title="Bifurcations along the family",
        columns=("kind", HEADS[ends.columns[0]], "spin in rad/s", "period in s"),
        rows=[(each, at.value, at.spin, at.period) for each, at, _ in found],
        note=f"{none}The larger multiplier{stretch} lies between {min(values):.4g} and "
        f"{max(values):.4g}; {meaning}.",
    )


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
        rows.append((f"{term}, fitted, in rad/s", growth.curvature, growth.curvature_error))
        rows.append(("power of the amplitude, fitted", growth.exponent, growth.exponent_error))
    return Table(
        title=f"The Hopf bifurcation of inverted spinning is {normal.kind}",
        columns=("quantity", "value", "standard error"),
        rows=rows,
        note="The critical pair does not slip, so the normal form takes the friction law by its "
        "gradient alone, and holds for the paper's law in spite of its kink.",
    )


def connection_table(found: Connection, slow: SlowOrbit | None) -> Table:
    """The heteroclinic connection beside its first-order prediction."""
    rows: list[tuple[str, float]] = [
        ("spin in rad/s", found.spin),
        ("spin less lower side of the bracket in rad/s", found.spin - found.below),
        ("upper side of the bracket less spin in rad/s", found.above - found.spin),
        *((head, getattr(found, name)) for name, head in SADDLE.items()),
        ("imaginary part of the decaying ones in 1/s", found.winding),
    ]
    if slow is not None:
        rows += [
            ("first-order prediction of the spin in rad/s", slow.spin),
            ("spin less prediction in rad/s", found.spin - slow.spin),
            ("largest friction over weight on it", slow.friction),
        ]
    return Table(
        title=f"The heteroclinic connection, at {found.spin:.9f} rad/s",
        columns=("quantity", "value"),
        rows=rows,
        note="Cycles near the connection are stable where the saddle index exceeds 1."
        + ("" if slow else " Friction is too weak for a first-order prediction."),
    )


def prediction(scenario: Scenario) -> SlowOrbit | None:
    """First-order prediction of the connection; None where friction is too weak for it."""
    try:
        return slow_connection(scenario)
    except ArithmeticError:
        return None


def ends(scenario: Scenario) -> dict[str, Any]:
    """Where the cycles of a scenario begin and end, and why not where they do not."""
    slow, connection, reason = prediction(scenario), None, None
    try:
        connection = connection_row(heteroclinic_connection(scenario))
    except NoConnectionError as error:
        reason = str(error)
    return {
        "hopf": critical_speed(scenario).spin,
        "connection": connection,
        "prediction": None if slow is None else slow.spin,
        "reason": reason,
    }


def connection_row(found: Connection) -> dict[str, float]:
    """What files tell of a connection, as plain data by names."""
    return {**asdict(found), "saddle_index": found.saddle_index}
