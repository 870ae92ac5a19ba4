"""Tables of cycles, of the Hopf point, of the heteroclinic connection and the slow manifold."""

from collections.abc import Sequence
from math import log

from analysis import Scenario
from analysis.nonlinear.asymmetric import AsymmetricCycle, AsymmetricFamily, Change
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import Bifurcation, CycleFamily
from analysis.nonlinear.heteroclinic import Connection, PeriodGrowth
from analysis.nonlinear.hopf import Growth, HopfType
from analysis.nonlinear.rotating import Rotation, RotationFamily
from analysis.nonlinear.slow_manifold import Distances, SlowOrbit, slow_connection, time_scales
from analysis.nonlinear.stationary import STARTS, StationaryMotion
from validation.kit.tables import Table

WORDS = {True: "stable", False: "unstable", None: "undecided"}
"""A verdict's cell would be a check; this one is a property."""

_LN_10 = log(10.0)

_SMALL = 1.05
"""Largest amplitude in rad of the cycles from which the growth is fitted."""


def cycle_table(cycles: Sequence[Cycle]) -> Table:
    """Cycles with their multipliers."""
    return Table.of(
        cycles,
        {
            "amplitude in rad": lambda each: each.amplitude,
            "spin in rad/s": lambda each: each.spin,
            "period in s": lambda each: each.period,
            "multiplier": lambda each: each.multiplier,
            "over half a period": lambda each: each.half_multiplier,
            "log10 of the other": lambda each: each.log_strong / _LN_10,
            "stable": lambda each: WORDS[each.stable],
        },
        name="cycles",
        title="Periodic motions of the reduced system",
        note="The amplitude is the largest deviation of γ from π/2; the third multiplier is 1.",
    )


def bifurcation_table(found: Sequence[Bifurcation], cycles: Sequence[Cycle] = ()) -> Table:
    """Where the stability of cycles changes.

    Parameters
    ----------
    found : sequence of Bifurcation
    cycles : sequence of Cycle
        The family, from which the range of the larger multiplier over half a period is told.
    """
    note = "" if found else "There are none: stability does not change along the family."
    if cycles:
        values = [cycle.half_multiplier for cycle in cycles]
        note += (
            f" The larger multiplier over half a period, with the mirror image, lies between "
            f"{min(values):.4g} and {max(values):.4g}; at 1 cycles fold, at -1 they lose their "
            "symmetry."
        )
    return Table(
        name="bifurcations",
        title="Bifurcations along the family",
        columns=("kind", "amplitude in rad", "spin in rad/s", "period in s"),
        rows=[(b.kind, b.cycle.amplitude, b.cycle.spin, b.cycle.period) for b in found],
        note=note.lstrip(),
    )


def rotation_table(family: RotationFamily, turns: Sequence[Rotation]) -> Table:
    """Rotating motions, and where their spin turns back."""
    note = "The tilt is β − π/2 where γ passes noninverted spinning."
    note += "".join(
        f" They fold at a tilt of {each.tilt:.6g} rad and {each.spin:.9g} rad/s." for each in turns
    )
    if family.reason is not None:
        note += f" The family ends early: {family.reason}."
    return Table.of(
        family.rotations,
        {
            "tilt in rad": lambda each: each.tilt,
            "spin in rad/s": lambda each: each.spin,
            "period in s": lambda each: each.period,
            "largest tilt in rad": lambda each: each.largest_tilt,
            "multiplier": lambda each: each.multiplier,
            "log10 of the other": lambda each: each.log_strong / _LN_10,
            "stable": lambda each: WORDS[each.stable],
        },
        name="rotations",
        title="Rotating motions of the reduced system, from the connection at "
        f"{family.connection.spin:.9g} rad/s on",
        note=note,
    )


def asymmetric_table(
    family: AsymmetricFamily, found: Sequence[tuple[Change, AsymmetricCycle]]
) -> Table:
    """Cycles without mirror symmetry, and where their stability changes."""
    born = family.bifurcation.cycle
    words = {"fold": "They fold", "period-doubling": "Their period doubles"}
    note = "Deviations of γ from π/2."
    note += "".join(
        f" {words[kind]} at {each.amplitude:.6g} and {each.lowest:.6g} rad and {each.spin:.9g} "
        "rad/s."
        for kind, each in found
    )
    if family.reason is not None:
        note += f" The family ends early: {family.reason}."
    return Table.of(
        family.cycles,
        {
            "largest deviation in rad": lambda each: each.amplitude,
            "least one in rad": lambda each: each.lowest,
            "spin in rad/s": lambda each: each.spin,
            "period in s": lambda each: each.period,
            "multiplier": lambda each: each.multiplier,
            "log10 of the other": lambda each: each.log_strong / _LN_10,
            "stable": lambda each: WORDS[each.stable],
        },
        name="asymmetric",
        title="Cycles without mirror symmetry of the reduced system, from "
        f"{born.amplitude:.6g} rad and {born.spin:.9g} rad/s on",
        note=note,
    )


def small_cycles(family: CycleFamily) -> list[Cycle]:
    """The cycles from which the growth near the Hopf point is fitted."""
    return [cycle for cycle in family.cycles if cycle.amplitude < _SMALL]


def hopf_table(normal: HopfType, growth: Growth | None) -> Table:
    """Type of the Hopf bifurcation from both approaches."""
    rows: list[tuple[str, float, float | None]] = [
        ("spin in rad/s", normal.spin, None),
        ("frequency in rad/s", normal.frequency, None),
        ("first Lyapunov coefficient", normal.lyapunov, None),
        ("(Ω − Ω_crit)/amplitude², normal form, in rad/s", normal.curvature, None),
    ]
    if growth is not None:
        rows += [
            (
                "(Ω − Ω_crit)/amplitude², fitted, in rad/s",
                growth.curvature,
                growth.curvature_error,
            ),
            ("power of the amplitude, fitted", growth.exponent, growth.exponent_error),
        ]
    return Table(
        name="hopf",
        title=f"The Hopf bifurcation of inverted spinning is {normal.kind}",
        columns=("quantity", "value", "standard error"),
        rows=rows,
        note=(
            "The critical pair does not slip, so the normal form takes the friction law by its "
            "gradient alone, and holds for the paper's law in spite of its kink."
        ),
    )


def connection_table(
    found: Connection,
    slow: SlowOrbit | None,
    growth: PeriodGrowth | None,
    disk: str = "",
) -> Table:
    """The heteroclinic connection beside its first-order prediction; of a disk, if named."""
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
        name=f"heteroclinic_{disk}".rstrip("_").replace(" ", "_"),
        title="The heteroclinic connection, where the cycles end, "
        f"{f'of the disk {disk}, ' if disk else ''}at {found.spin:.9f} rad/s",
        columns=("quantity", "value"),
        rows=rows,
        note="Cycles near the connection are stable where the saddle index exceeds 1.",
    )


def dependence_table(rows: Sequence[tuple[float, float, float | None, float | None]]) -> Table:
    """Spin of the connection over friction.

    Parameters
    ----------
    rows : sequence of (mu, epsilon, spin, prediction)
        None where there is none.
    """
    return Table(
        name="heteroclinic_dependence",
        title="Spin of the heteroclinic connection over friction",
        columns=(
            "μ",
            "ε in m/s",
            "spin in rad/s",
            "first-order prediction in rad/s",
            "difference over (ε/μ)² in s/m²",
        ),
        rows=[
            (
                mu,
                smoothing,
                spin,
                slow,
                None if spin is None or slow is None else (spin - slow) * (mu / smoothing) ** 2,
            )
            for mu, smoothing, spin, slow in rows
        ],
        note=(
            "The prediction depends on μ alone; what it lacks is of second order in ε/μ, since "
            "the slow flow is reversible and odd orders only change the stability. With μ = 0.1, "
            "of which the orbit takes two thirds, ε would have to be smaller still to show that."
        ),
    )


def manifold_table(found: Distances) -> Table:
    """Distance of motions from the slow manifold, and its order."""
    surface, corrected = found.orders.tolist()
    return Table(
        name="slow_manifold",
        title="Distance of motions from the slow manifold",
        columns=(
            "ε/μ in m/s",
            "β' off the surface without slip in rad/s",
            "off the corrected one in rad/s",
        ),
        rows=[
            (ratio, *each)
            for ratio, each in zip(found.ratios.tolist(), found.distances.tolist(), strict=True)
        ],
        note=f"Fitted orders in ε/μ: {surface:.3f} and {corrected:.3f}; expected are 1 and 2.",
    )


def time_scale_table(scenario: Scenario, spins: Sequence[float]) -> Table:
    """How far the time scales lie apart, which the paper writes as λ₃ ≪ Re λ₁,₂."""
    return Table(
        name="time_scales",
        title="Time scales at inverted spinning",
        columns=(
            "spin in rad/s",
            "λ₃ in 1/s",
            "limit for small ε in 1/s",
            "|λ₁,₂| in 1/s",
            "Re λ₁,₂ in 1/s",
            "−λ₃/|λ₁,₂|",
        ),
        rows=[
            (spin, found.fast, found.limit, found.slow, found.growth, found.separation)
            for spin, found in ((spin, time_scales(scenario, spin)) for spin in spins)
        ],
    )


def stationary_table(found: Sequence[tuple[str, Sequence[StationaryMotion]]]) -> Table:
    """Stationary motions that searches have found, with their stability.

    Parameters
    ----------
    found : sequence of (name, motions)
    """
    names = {1: "inverted spinning", -1: "noninverted spinning"}
    return Table(
        name="stationary_motions",
        title="Stationary motions of an eccentric disk",
        columns=("model", "spin in rad/s", "motion", "largest growth in 1/s"),
        rows=[
            (
                name,
                each.spin,
                "tilted" if each.is_tilted else names[1 if each.gamma > 0.0 else -1],
                each.growth,
            )
            for name, motions in found
            for each in motions
        ],
        note=f"All that is found from {STARTS} random attitudes and places in each case.",
    )


def prediction(scenario: Scenario) -> SlowOrbit | None:
    """First-order prediction of the connection; None where friction is too weak for it."""
    try:
        return slow_connection(scenario)
    except ArithmeticError:
        return None
