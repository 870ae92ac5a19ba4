"""The inversion from Table 3: Figures 7 to 9, engine against in-house equations."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analysis import LEVELS, LOADS, MODELS, Level, Load, Scenario, SmoothCoulomb, Trajectory
from analysis.data.checks import Array
from analysis.data.inversion import DEFINITION
from analysis.data.trajectory import SOURCES
from validation.kit import figures, snapshots
from validation.kit.animation.player import player
from validation.kit.figures import Picture
from validation.kit.report import Job, Section
from validation.kit.tables import Table
from validation.run import run
from validation.studies.claims import motion
from validation.studies.claims.claim import listed

TOLERANCE = 1e-7
"""Tolerance of all runs behind the figures in rad."""


def run_pair(level: Level, load: Load, end: float) -> tuple[Trajectory, Trajectory]:
    """Engine and in-house run from Table 3 until `end`, sampled every 5 ms."""
    scenario = Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))
    times = np.linspace(0.0, end, round(end * 200) + 1)
    engine, inhouse = (
        run(scenario, times, source=source, tolerance=TOLERANCE) for source in SOURCES
    )
    return engine, inhouse


def draw(
    loads: Mapping[Load, tuple[Trajectory, Trajectory]],
    levels: Sequence[tuple[Trajectory, Trajectory]],
) -> list[Picture]:
    """Figures 7 to 9.

    Parameters
    ----------
    loads : mapping
        Engine and in-house run of Model 1 over 2 s by load law.
    levels : sequence
        Engine and in-house run of Models 1 to 4 over 4 s.
    """
    engine, inhouse = ([pair[index] for pair in levels] for index in (0, 1))
    return [_figure_7(loads), _figure_8(engine, inhouse), _figure_9(engine, inhouse)]


_LOOK = "Lines: engine; markers: in-house equations. "


def _figure_7(loads: Mapping[Load, tuple[Trajectory, Trajectory]]) -> Picture:
    figure, axes = figures.new_figure(3, height=8.0)
    figures.figure_7(
        {load: loads[load][0] for load in LOADS}, {load: loads[load][1] for load in LOADS}, axes
    )
    contact, weight = loads["contact"][0], loads["weight"][0]
    short = np.pi / 2 - motion.value_at(contact, contact.coordinate("gamma"), 0.5)
    force = np.max(np.abs(contact.normal_force / contact.scenario.weight - 1.0))
    change = np.max(np.abs(weight.coordinates - contact.coordinates)[:, 4:6])
    return figures.render(
        figure,
        name="paper-fig-7",
        paper="Fig. 7",
        title="Model 1 turns itself upside down",
        caption=_LOOK + "γ passes from below the centre (−π/2) to above it (π/2); after 0.5 s it "
        f"is {short:.2f} rad short of π/2 and then goes {motion.overshoot(contact):.2f} rad "
        f"beyond. The normal force stays within {100 * force:.0f} % of the weight; taking the "
        f"weight as the load of the friction law changes the angles by up to {change:.1e} rad.",
    )


def _figure_8(engine: Sequence[Trajectory], inhouse: Sequence[Trajectory]) -> Picture:
    figure, axes = figures.new_figure(2, height=6.5)
    figures.figure_8(engine, inhouse, axes)
    axes[1].set_xlim(0.0, 2.0)
    times = [run.inversion_time for run in engine]
    inverted = ["–" if time is None else f"{time:.2f}" for time in times]
    return figures.render(
        figure,
        name="paper-fig-8",
        paper="Fig. 8",
        title="Models 1 to 4",
        caption=_LOOK + f"The models are inverted after {', '.join(inverted)} s. Turning points "
        f"of β from 0.5 s to {engine[0].times[-1]:g} s: "
        f"{', '.join(str(motion.turning_points(run)) for run in engine)}; overshoot of γ: "
        f"{listed(map(motion.overshoot, engine))} rad.",
    )


def _figure_9(engine: Sequence[Trajectory], inhouse: Sequence[Trajectory]) -> Picture:
    figure, axes = figures.new_figure()
    figures.figure_9(engine, inhouse, axes)
    shares = [100 * motion.potential_share(run) for run in engine[:3]]
    return figures.render(
        figure,
        name="paper-fig-9",
        paper="Fig. 9",
        title="The spinning velocity falls while the centre of gravity rises",
        caption=_LOOK + "Model 4 holds it constant. Of the kinetic energy lost within 2 s, "
        f"{listed(shares, '.0f')} % went into height in Models 1 to 3, the rest into friction.",
    )


def agreement(levels: Sequence[tuple[Trajectory, Trajectory]]) -> Table:
    """Engine against in-house in the runs behind the figures."""
    return Table.of(
        levels,
        {
            "model": lambda pair: pair[0].scenario.name,
            "formulation": lambda pair: str(pair[0].method["formulation"]),
            "inverted after s": lambda pair: pair[0].inversion_time,
            "max difference of β, γ in rad": lambda pair: _apart(
                *(run.coordinates[:, 4:6] for run in pair)
            ),
            "of spin in rad/s": lambda pair: _apart(*(run.rate("alpha") for run in pair)),
            "of normal force in N": lambda pair: _apart(*(run.normal_force for run in pair)),
            "engine's own error estimate in rad": lambda pair: pair[0].error_estimate,
        },
        name="figure-agreement",
        title="Engine against in-house equations in the runs of the paper's Figures 8 and 9",
    )


def _apart(one: Array, other: Array) -> float:
    return float(np.max(np.abs(one - other)))


def jobs() -> list[Job]:
    """Runs behind Figures 7 to 9, which the claims look at as well."""
    wanted: list[tuple[Level, Load, float]] = [
        *((1, load, 2.0) for load in LOADS),
        *((level, "weight", 4.0) for level in LEVELS),
    ]
    return [Job(("run", *arguments), run_pair, arguments) for arguments in wanted]


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report from the results of `jobs`."""
    loads = {load: results["run", 1, load, 2.0] for load in LOADS}
    levels = [results["run", level, "weight", 4.0] for level in LEVELS]
    shown = loads["weight"][0]
    inverted = shown.inversion_time
    after = "more than 2 s" if inverted is None else f"{inverted:.2f} s"
    return Section(
        name="inversion",
        title="The inversion",
        paragraphs=[
            (
                "A disk whose centre of gravity lies off its centre is spun about an in-plane "
                "axis with the centre of gravity low (start of Table 3). Friction at the contact "
                f"turns it upside down, in Model 1 after {after}. {DEFINITION}"
            ),
            (
                "The engine's runs and the in-house equations share the description of the disk, "
                "the friction parameters and the start, and nothing of the mechanics."
            ),
        ],
        animations=[
            player(
                shown,
                name="inversion-animation",
                title="The inversion",
                caption="Table 3's start. Drag to turn the view.",
            )
        ],
        pictures=[
            snapshots.strip(shown, (0.0, 0.2, 0.3, 0.38, 0.45, 0.55, 0.8)),
            *draw(loads, levels),
        ],
        tables=[agreement(levels)],
    )
