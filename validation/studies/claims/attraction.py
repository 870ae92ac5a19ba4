"""Whether inverted spinning attracts nearly all trajectories (Sections 1 and 3.2).

Random starts of Models 1 and 4 over the spin, and what becomes of each.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from math import acos, pi
from typing import Any, Literal, get_args

import numpy as np

from analysis import MODELS, FlatError, Level, Scenario, Start
from analysis.data.trajectory import Source
from analysis.stability import linear_reduced
from validation.kit import figures
from validation.kit.figures import Picture
from validation.kit.report import Job
from validation.kit.tables import Cell, Table
from validation.run import run as run_scenario
from validation.studies.claims.claim import Claim, grade, listed

Tilt = Literal["near upright", "any tilt"]
TILTS: tuple[Tilt, ...] = get_args(Tilt)

Outcome = Literal["inverted", "lost", "not inverted", "not decided", "flat", "contact would pull"]
OUTCOMES: tuple[Outcome, ...] = get_args(Outcome)

LEVELS: tuple[Level, ...] = (1, 4)
"""Models that are tried."""

SPINS = (25.0, 31.0, 33.0, 36.0, 40.0, 50.0, 60.0, 80.0, 100.0)
"""Spins at the start in rad/s."""

STARTS = 100
"""Random starts at each spin."""

END = 10.0
"""End of each run in s."""

CONFIRMED = (31.0, 36.0, 50.0)
"""Spins in rad/s at which the engine repeats starts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomStart:
    """A random start, given by its number.

    Parameters
    ----------
    level : {1, 4}
    tilt : {"near upright", "any tilt"}
        beta within 0.2 rad of pi / 2; or every direction of the axis equally likely, up to
        0.1 rad from flat. gamma is anything in both.
    spin : float
        In rad/s.
    number : int
        Seed. Starts of the same number and tilt have the same position at every spin and model.
    """

    level: Level
    tilt: Tilt
    spin: float
    number: int

    @property
    def scenario(self) -> Scenario:
        """Upright or tilted, spinning about the vertical, without slip along the edge."""
        rng = np.random.default_rng((TILTS.index(self.tilt), self.number))
        gamma = rng.uniform(-pi, pi)
        if self.tilt == "near upright":
            beta = pi / 2 + rng.uniform(-0.2, 0.2)
        else:
            beta = acos(rng.uniform(-1.0, 1.0) * np.cos(0.1))
        start = Start(beta=beta, gamma=gamma, spin=self.spin)
        return Scenario(constraints=MODELS[self.level], start=start)


def outcome(start: RandomStart, source: Source = "in-house") -> Outcome:
    """What becomes of a start until `END`."""
    times = np.linspace(0.0, END, round(100 * END) + 1)
    try:
        if source == "engine":
            found = run_scenario(start.scenario, times, tolerance=1e-4)
        else:
            form = "reduced" if start.level == 4 else "index-1"
            found = run_scenario(
                start.scenario, times, source=source, formulation=form, local_tolerance=1e-6
            )
    except FlatError:
        return "flat"
    if found.ending is not None:
        return known_outcome(found.ending.reason)
    return found.inversion.outcome


def known_outcome(name: str) -> Outcome:
    """The one of `OUTCOMES` with this name; `KeyError` if there is none."""
    known: dict[str, Outcome] = {each: each for each in OUTCOMES}
    return known[name]


def outcomes(level: Level, tilt: Tilt, spin: float, number: int) -> list[Outcome]:
    """Outcomes of the first so many starts."""
    return [
        outcome(RandomStart(level=level, tilt=tilt, spin=spin, number=each))
        for each in range(number)
    ]


def jobs() -> list[Job]:
    """The starts of each model, tilt and spin."""
    return [
        Job(("random starts", level, tilt, spin), outcomes, (level, tilt, spin, STARTS))
        for level in LEVELS
        for tilt in TILTS
        for spin in SPINS
    ]


Results = dict[RandomStart, Outcome]


def collect(results: Mapping[Any, Any]) -> Results:
    """Outcome of every start, from the results of `jobs`."""
    return {
        RandomStart(level=level, tilt=tilt, spin=spin, number=number): known_outcome(each)
        for job in jobs()
        for _, level, tilt, spin in [job.key]
        for number, each in enumerate(results[job.key])
    }


def counts(results: Results) -> dict[tuple[Level, Tilt, float], Counter[Outcome]]:
    """How often each outcome is reached, by model, tilt and spin."""
    found: dict[tuple[Level, Tilt, float], Counter[Outcome]] = {}
    for start, result in results.items():
        found.setdefault((start.level, start.tilt, start.spin), Counter())[result] += 1
    return found


def share(count: Counter[Outcome]) -> float:
    """Part of the starts that are inverted, kept or lost later."""
    return (count["inverted"] + count["lost"]) / count.total()


def claim(results: Results) -> Claim:
    """Sections 1 and 3.2: inverted spinning attracts nearly all trajectories."""
    critical = linear_reduced.critical_speed(Scenario(constraints=MODELS[4])).spin
    criterion = (
        f"at every spin above {critical:.2f} rad/s at least 95 % of random starts of Model 1, of "
        f"any tilt, are inverted within {END:g} s; partly: of those near upright"
    )
    shares = {
        (level, tilt, spin): share(count)
        for (level, tilt, spin), count in counts(results).items()
        if spin > critical
    }
    upright, tilted = (
        min(value for (level, each, _), value in shares.items() if (level, each) == (1, tilt))
        for tilt in TILTS
    )
    told = "; ".join(
        f"Model {level}, {tilt}: "
        + listed([100 * shares[key] for key in shares if key[:2] == (level, tilt)], ".0f")
        + " %"
        for level in LEVELS
        for tilt in TILTS
    )
    spins = ", ".join(f"{spin:g}" for spin in SPINS if spin > critical)
    return Claim(
        place="Sect. 1, 3.2",
        statement="inverted spinning of a fast disk attracts nearly all trajectories",
        criterion=criterion,
        measured=f"at {spins} rad/s: {told}",
        verdict=grade(yes=tilted >= 0.95, partly=upright >= 0.95),
    )


def table(results: Results) -> Table:
    """Outcomes by model, tilt and spin."""
    rows: list[list[Cell]] = [
        [f"Model {level}", tilt, spin, count.total(), share(count), *(count[o] for o in OUTCOMES)]
        for (level, tilt, spin), count in counts(results).items()
    ]
    return Table(
        name="attraction",
        title="What becomes of random starts",
        columns=("model", "starts", "spin in rad/s", "number", "share inverted", *OUTCOMES),
        rows=rows,
        note=f"Runs of {END:g} s, in-house to a local tolerance of 1e-6. Near upright: β within "
        "0.2 rad of π/2, any γ. Any tilt: every direction of the axis equally likely, up to 0.1 "
        "rad from flat. The share counts what is lost later as inverted.",
    )


def repeated() -> list[RandomStart]:
    """Starts that the engine repeats."""
    return [
        RandomStart(level=1, tilt="any tilt", spin=spin, number=number)
        for spin in CONFIRMED
        for number in range(3)
    ]


def confirm(start: RandomStart) -> tuple[Outcome, Outcome]:
    """Outcomes of a start in the engine and in-house."""
    return outcome(start, "engine"), outcome(start)


def confirmation(results: dict[RandomStart, tuple[Outcome, Outcome]], stored: Results) -> Table:
    """Outcomes in the engine and in-house, and what is stored."""
    rows: list[list[Cell]] = []
    for start, (engine, inhouse) in results.items():
        kept = stored[start]
        agrees = engine == inhouse == kept
        rows.append([start.spin, start.number, engine, inhouse, kept, agrees])
    return Table(
        name="attraction-engine",
        title="Random starts of Model 1, any tilt, repeated in the engine",
        columns=("spin in rad/s", "start", "engine", "in-house", "stored", "the same"),
        rows=rows,
    )


def draw(results: Results) -> Picture:
    """Share of the starts that are inverted over the spin."""
    figure, axes = figures.new_figure(height=3.8)
    found = counts(results)
    for index, (level, tilt) in enumerate((level, tilt) for level in LEVELS for tilt in TILTS):
        spins = [spin for each, kind, spin in found if (each, kind) == (level, tilt)]
        axes.plot(
            spins,
            [100 * share(found[level, tilt, spin]) for spin in spins],
            color=figures.COLOURS[index],
            linestyle=figures.STYLES[index],
            marker=figures.MARKERS[index],
            label=f"Model {level}, {tilt}",
        )
    critical = linear_reduced.critical_speed(Scenario(constraints=MODELS[4])).spin
    axes.axvline(critical, color="#999999", linewidth=0.8, label="$Ω_{crit}$")
    axes.set(xlabel="spin at the start in rad/s", ylabel="inverted in %", ylim=(-3.0, 103.0))
    figures.legend_above(axes, columns=3)
    return figures.render(
        figure,
        name="attraction",
        title="How many random starts are inverted",
        caption=f"Part of {min(count.total() for count in found.values())} random starts at each "
        f"spin that are inverted within {END:g} s, also if they lose it later.",
    )
