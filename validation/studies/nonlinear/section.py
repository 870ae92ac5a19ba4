"""The report's section on nonlinear dynamics: its jobs and what becomes of them."""

from typing import Any

import numpy as np

from analysis import DISKS, MODELS, Dissipation, Scenario, SmoothCoulomb
from analysis.nonlinear.family import bifurcations, cycle_family
from analysis.nonlinear.heteroclinic import (
    Connection,
    NoConnectionError,
    heteroclinic_connection,
    period_growth,
)
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.rotating import folds, rotating_family
from analysis.nonlinear.slow_manifold import distances, slow_cycle
from analysis.nonlinear.stationary import StationaryMotion, stationary_motions
from analysis.stability.linear_reduced import critical_speed
from validation.kit import figures as kit
from validation.kit.figures import Picture
from validation.kit.report import Job, Section
from validation.kit.tables import Table
from validation.studies.nonlinear import engine_cycles, figures, passage, portraits, tables
from validation.studies.nonlinear.held_spin import HELD as HELD_SETS

PAPER = Scenario(constraints=MODELS[4])

FRICTION = [(mu, eps) for mu in (0.1, 0.3) for eps in (0.003, 0.01, 0.03, 0.1)]
"""Friction coefficients and smoothing speeds in m/s of the two-parameter diagram."""

MANIFOLD = (0.1, 0.05, 0.025, 0.0125)
"""Smoothing speeds in m/s at which the distance from the slow manifold is measured."""

HELD = ("Model 1 at held spin", "Model 2 at held spin")

STATIONARY = [(name, spin) for name in HELD for spin in (28.0, 60.0)]
"""Models and spins in rad/s at which stationary motions are looked for."""

PASSAGES = {
    "Model 1": (Scenario(), 20.0),
    "to rest, sliding friction": (Scenario.rest(), 20.5),
    "to rest, rolling and pivoting": (
        Scenario.rest(dissipation=Dissipation(rolling_dry=1e-3, pivoting=5e-5)),
        11.9,
    ),
}
"""Scenarios of the passages and how long they run in s."""

REPEATED = "to rest, rolling and pivoting"
"""The passage that the engine repeats."""


def connection(mu: float, eps: float) -> Connection | None:
    """Connection of the paper's disk with other friction; None where there is none."""
    law = SmoothCoulomb(coefficient=mu, smoothing=eps)
    try:
        return heteroclinic_connection(Scenario(constraints=MODELS[4], friction=law))
    except NoConnectionError:
        return None


def stationary(name: str, spin: float) -> tuple[StationaryMotion, ...]:
    """Stationary motions of a model at held spin."""
    return stationary_motions(Scenario(constraints=HELD_SETS[name]), spin)


def disk_connection(disk: str) -> Connection:
    """Connection of a disk by name."""
    return heteroclinic_connection(Scenario(constraints=MODELS[4], disk=DISKS[disk]))


def jobs() -> list[Job]:
    """Jobs of this section, the long ones first."""
    return [
        Job("cycles", cycle_family, (PAPER,)),
        Job("rotating", rotating_family, (PAPER,)),
        *(Job(("held family", name), engine_cycles.held_family, (name,)) for name in HELD),
        *(
            Job(("engine cycle", spin), engine_cycles.witness, (spin,))
            for spin in engine_cycles.SPINS
        ),
        *(Job(("repeated cycle", name), engine_cycles.repeated, (name,)) for name in HELD),
        Job(("passage", REPEATED, "engine"), passage.follow, (*PASSAGES[REPEATED], "engine")),
        *(
            Job(("passage", name, "in-house"), passage.follow, (*each, "in-house"))
            for name, each in PASSAGES.items()
        ),
        *(Job(("slowed", each), passage.slowed, (each, "in-house")) for each in passage.LEVERS),
        *(Job(("stationary", *each), stationary, each) for each in STATIONARY),
        *(Job(("connection", *each), connection, each) for each in FRICTION),
        *(Job(("connection of a disk", name), disk_connection, (name,)) for name in DISKS),
        *(Job(("portrait", spin), portraits.portrait, (PAPER, spin)) for spin in portraits.SPINS),
    ]


def _diagrams(results: dict[Any, Any]) -> list[Picture]:
    """Bifurcation diagram; period and multipliers; portraits."""
    family, found = results["cycles"], results["connection of a disk", "steel"]
    slow = [slow_cycle(PAPER, amplitude) for amplitude in np.linspace(0.05, 3.1, 25).tolist()]
    engine = [results["engine cycle", spin].engine for spin in engine_cycles.SPINS]
    diagram = figures.bifurcation_diagram(
        family,
        connection=found.spin,
        slow=[(each.spin, each.amplitude) for each in slow],
        engine=[(each.spin, each.amplitude) for each in engine],
    )
    periods = figures.period_diagram(family, connection=found.spin)
    drawn = portraits.draw([results["portrait", spin] for spin in portraits.SPINS])
    return [
        kit.render(
            diagram.figure,
            name="bifurcation_diagram",
            title="Bifurcation diagram",
            caption="Periodic motions of Model 4 from the Hopf point to the heteroclinic "
            "connection; solid is stable, dashed unstable. The dotted curve is their limit for "
            "steep friction with the same μ, from a quadrature on the slow manifold.",
        ),
        kit.render(
            periods[0].figure,
            name="cycle_periods",
            title="Period and Floquet multipliers",
            caption="The period grows as the logarithm of the distance to the connection; the "
            "smaller multiplier is known by its logarithm alone.",
        ),
        kit.render(
            drawn[0].figure,
            name="phase_portraits",
            title="Phase portraits",
            caption="Five spins, on the cylinder of γ. The stable manifold is that of the flow on "
            "the slow manifold to first order, whose own connection lies at 30.198 rad/s.",
        ),
    ]


def _plane(results: dict[Any, Any]) -> Picture:
    curves = {
        mu: [
            (eps, found.spin)
            for each, eps in FRICTION
            if each == mu and (found := results["connection", mu, eps]) is not None
        ]
        for mu in sorted({mu for mu, _ in FRICTION})
    }
    limits = {
        mu: figures.limit(Scenario(constraints=MODELS[4], friction=SmoothCoulomb(coefficient=mu)))
        for mu in curves
    }
    axes = figures.plane(critical_speed(PAPER).spin, curves, limits)
    return kit.render(
        axes.figure,
        name="spin_and_smoothing",
        title="Spin and smoothing: where there are cycles",
        caption="The Hopf curve depends on no friction at all. Cycles lie between it and the "
        "heteroclinic curve of their μ, which starts in the first-order prediction (diamonds).",
    )


def section(results: dict[Any, Any]) -> Section:
    """Section of the report from the results of `jobs`."""
    family = results["cycles"]
    normal, small = hopf_type(PAPER), tables.small_cycles(family)
    growth = fitted_growth(
        [cycle.spin for cycle in small], [cycle.amplitude for cycle in small], normal.spin
    )
    passages = [(name, results["passage", name, "in-house"]) for name in PASSAGES]
    law = passage.delay_law([results["slowed", lever] for lever in passage.LEVERS])
    story = figures.passage_diagram(passages)
    return Section(
        name="nonlinear",
        title="Nonlinear dynamics",
        paragraphs=[
            (
                "Below the critical speed inverted spinning is unstable in the reduced system, "
                "but the disk does not fall at once: it swings about the inverted position in a "
                "stable periodic motion, whose amplitude grows with falling spin until it ends in "
                "a heteroclinic connection of noninverted spinning with itself."
            ),
            (
                "A disk whose spin decays by itself is lost later than at any critical speed: "
                "the slow deviation shrinks until the spin passes the Hopf point, and has to grow "
                "back as it has shrunk."
            ),
        ],
        pictures=[
            *_diagrams(results),
            _plane(results),
            kit.render(
                figures.rotation_diagram(results["rotating"]).figure,
                name="rotating_motions",
                title="Rotating motions beyond the connection",
                caption="Below the heteroclinic spin γ turns round while the disk keeps tilted, "
                "down to a fold; the unstable ones beyond it bound what an inverted disk bears.",
            ),
            kit.render(
                story[0].figure,
                name="passage",
                title="Passage through the critical speed",
                caption="Mean spin, and the deviation of γ freed of the fast oscillation. Thin "
                "lines follow the growth rate of the slow pair alone.",
            ),
            kit.render(
                figures.delay_diagram(law).figure,
                name="delay",
                title="Delay over the rate of decay",
                caption="Disks that start at the Hopf point with the same deviation.",
            ),
        ],
        tables=[
            *_engine_tables(results),
            *_cycle_tables(results, normal, growth),
            *[
                tables.manifold_table(
                    distances(
                        [
                            Scenario(constraints=MODELS[4], friction=SmoothCoulomb(smoothing=eps))
                            for eps in MANIFOLD
                        ],
                        30.5,
                    )
                ),
                tables.time_scale_table(PAPER, (20.0, 25.0, normal.spin, 35.0, 40.0)),
                passage.passage_table(
                    [*passages, (REPEATED, results["passage", REPEATED, "engine"])]
                ),
                passage.law_table(law),
                tables.stationary_table(
                    [(name, results["stationary", name, spin]) for name, spin in STATIONARY]
                ),
            ],
        ],
    )


def _engine_tables(results: dict[Any, Any]) -> list[Table]:
    return [
        engine_cycles.witness_table(
            [results["engine cycle", spin] for spin in engine_cycles.SPINS]
        ),
        engine_cycles.repeated_table([(name, results["repeated cycle", name]) for name in HELD]),
        engine_cycles.held_table([(name, results["held family", name]) for name in HELD]),
    ]


def _cycle_tables(results: dict[Any, Any], normal: Any, growth: Any) -> list[Table]:
    family = results["cycles"]
    steel = results["connection of a disk", "steel"]
    rounded = results["connection of a disk", "steel-rounded"]
    printed = Scenario(constraints=MODELS[4], disk=DISKS["steel-rounded"])
    rows = []
    for mu, eps in FRICTION:
        law = SmoothCoulomb(coefficient=mu, smoothing=eps)
        slow = tables.prediction(Scenario(constraints=MODELS[4], friction=law))
        found = results["connection", mu, eps]
        rows.append(
            (mu, eps, None if found is None else found.spin, None if slow is None else slow.spin)
        )
    return [
        tables.cycle_table(family.cycles),
        tables.hopf_table(normal, growth),
        tables.bifurcation_table(bifurcations(family), family.cycles),
        tables.rotation_table(results["rotating"], folds(results["rotating"])),
        tables.connection_table(
            steel, tables.prediction(PAPER), period_growth(family.cycles, steel)
        ),
        tables.connection_table(rounded, tables.prediction(printed), None, "as printed"),
        tables.dependence_table(rows),
    ]
