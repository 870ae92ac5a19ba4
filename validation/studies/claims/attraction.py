"""Whether inverted spinning attracts nearly all trajectories (Sections 1 and 3.2).

Random starts of Models 1 and 4 over the spin, and what becomes of each.
"""

from collections import Counter
from math import acos, pi
from typing import Literal, NamedTuple, get_args

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.stats import binomtest

from analysis import MODELS, FlatError, Level, Scenario, Start
from analysis.data.trajectory import Source
from validation.kit import figures
from validation.run import run as run_scenario
from validation.studies.claims.claim import Claim, grade
from validation.studies.claims.least_spins import critical_speed, inverts
from validation.study import Check, Row, Study, equal

Tilt = Literal["near upright", "any tilt"]
TILTS: tuple[Tilt, ...] = get_args(Tilt)

OUTCOMES = ("inverted", "lost", "not inverted", "not decided", "flat", "contact would pull")

LEVELS: tuple[Level, ...] = (1, 4)
"""Models that are tried."""

SPINS = (25.0, 31.0, 33.0, 36.0, 40.0, 50.0, 60.0, 80.0, 100.0)
"""Spins at the start in rad/s."""

STARTS = 100
"""Random starts at each spin,"""

BLOCK = 10
"""of which so many are a case."""

END = 10.0
"""End of each run in s."""

REPEATED = (31.0, 36.0, 50.0)
"""Spins in rad/s at which the engine repeats the first starts of Model 1, of any tilt,"""

AGAIN = 3
"""so many of each."""

NEARLY_ALL = 0.95
"""Part of the starts."""


class Starts(NamedTuple):
    """Random starts at a spin in rad/s, given by the number of the first one.

    Near upright, beta lies within 0.2 rad of pi / 2; otherwise every direction of the axis is
    equally likely, up to 0.1 rad from flat. gamma is anything in both. Starts of the same number
    and tilt have the same position at every spin and model.
    """

    level: Level
    tilt: Tilt
    spin: float
    first: int = 0
    number: int = BLOCK

    @property
    def label(self) -> str:
        """Its name among the cases."""
        last = self.first + self.number - 1
        return (
            f"Model {self.level}, {self.tilt}, {self.spin:g} rad/s, starts {self.first} to {last}"
        )

    def scenario(self, number: int) -> Scenario:
        """Upright or tilted, spinning about the vertical, without slip along the edge."""
        rng = np.random.default_rng((TILTS.index(self.tilt), number))
        gamma = rng.uniform(-pi, pi)
        if self.tilt == "near upright":
            beta = pi / 2 + rng.uniform(-0.2, 0.2)
        else:
            beta = acos(rng.uniform(-1.0, 1.0) * np.cos(0.1))
        start = Start(beta=beta, gamma=gamma, spin=self.spin)
        return Scenario(constraints=MODELS[self.level], start=start)


def outcome(scenario: Scenario, source: Source = "in-house") -> str:
    """What becomes of a start until `END`, one of `OUTCOMES`."""
    times = np.linspace(0.0, END, round(100 * END) + 1)
    try:
        if source == "engine":
            found = run_scenario(scenario, times, tolerance=1e-4)
        else:
            form = "reduced" if scenario.model == 4 else "index-1"
            found = run_scenario(
                scenario, times, source=source, formulation=form, local_tolerance=1e-6
            )
    except FlatError:
        return "flat"
    result = found.inversion.outcome if found.ending is None else found.ending.reason
    return OUTCOMES[OUTCOMES.index(result)]


def cases() -> dict[str, Starts]:
    """Blocks of starts of each model, tilt and spin."""
    found = [
        Starts(level, tilt, spin, first)
        for level in LEVELS
        for tilt in TILTS
        for spin in SPINS
        for first in range(0, STARTS, BLOCK)
    ]
    return {each.label: each for each in found}


def measure(starts: Starts, source: Source = "in-house") -> list[Row]:
    """Outcomes of some starts."""
    numbers = range(starts.first, starts.first + starts.number)
    found = [outcome(starts.scenario(number), source) for number in numbers]
    return [
        {"level": starts.level, "tilt": starts.tilt, "spin": starts.spin, "outcomes": found},
    ]


def measure_engine(starts: Starts) -> list[Row]:
    """The same in the engine."""
    return measure(starts, "engine")


RANDOM_STARTS = Study(
    name="random-starts",
    cases=cases,
    measure=measure,
    sample=[Starts(1, "any tilt", spin).label for spin in REPEATED],
    confirm={"outcomes": None},
    columns={"outcomes": f"of each start within {END:g} s, in the order of their numbers"},
)

IN_ENGINE = Study(
    name="random-starts-engine",
    cases=lambda: {
        f"{spin:g} rad/s": Starts(1, "any tilt", spin, number=AGAIN) for spin in REPEATED
    },
    measure=measure_engine,
)


def shares(table: pd.DataFrame) -> pd.DataFrame:
    """How often each outcome is reached, and the share that inverts with its interval."""
    rows = []
    for (level, tilt, spin), group in table.groupby(["level", "tilt", "spin"], sort=False):
        count = Counter(result for results in group["outcomes"] for result in results)
        ups = sum(number for result, number in count.items() if inverts(result))
        low, high = binomtest(ups, count.total()).proportion_ci(0.95)
        found = {"model": f"Model {level}", "starts": tilt, "spin in rad/s": spin}
        found |= {"number": count.total(), "share inverted": ups / count.total()}
        rows.append(found | {"from": low, "to": high} | {each: count[each] for each in OUTCOMES})
    return pd.DataFrame(rows)


def claim(found: pd.DataFrame) -> Claim:
    """Sections 1 and 3.2: inverted spinning attracts nearly all trajectories.

    Parameters
    ----------
    found : DataFrame
        Of `shares`.
    """
    critical = critical_speed()
    fast = found[found["spin in rad/s"] > critical]
    ups = {
        key: group.set_index("spin in rad/s")
        for key, group in fast.groupby(["model", "starts"], sort=False)
    }
    upright, tilted = (ups["Model 1", tilt]["share inverted"] for tilt in TILTS)
    told = []
    for (model, tilt), group in ups.items():
        percent = ", ".join(f"{100 * each:.0f}" for each in group["share inverted"])
        told.append(f"{model}, {tilt}: {percent} %")
    spins = ", ".join(f"{spin:g}" for spin in upright.index)
    return Claim(
        "Sect. 1, 3.2",
        "inverted spinning of a fast disk attracts nearly all trajectories",
        f"at least {NEARLY_ALL:.0%} of random starts of Model 1 are inverted within {END:g} s, of "
        f"any tilt, at every spin tried above {critical:.2f} rad/s; partly: of those near "
        "upright, at some of these spins",
        f"at {spins} rad/s: {'; '.join(told)}",
        grade(yes=bool((tilted >= NEARLY_ALL).all()), partly=bool((upright >= NEARLY_ALL).any())),
    )


def confirmation(engine: pd.DataFrame, stored: pd.DataFrame) -> pd.DataFrame:
    """Outcomes of the starts that the engine repeats, beside the stored ones."""
    known = stored.set_index("case")["outcomes"]
    return pd.DataFrame(
        {"spin in rad/s": row.spin, "start": number, "engine": found, "in-house, stored": kept}
        for row in engine.itertuples()
        for number, (found, kept) in enumerate(
            zip(row.outcomes, known[Starts(1, "any tilt", row.spin).label], strict=False)
        )
    )


def checks(engine: pd.DataFrame, stored: pd.DataFrame) -> list[Check]:
    """Whether the engine has the same outcomes, and every start one."""
    found = confirmation(engine, stored)
    same = int((found["engine"] == found["in-house, stored"]).sum())
    number = int(stored["outcomes"].map(len).sum())
    wanted = len(LEVELS) * len(TILTS) * len(SPINS) * STARTS
    return [
        equal("random starts: same outcome in the engine", same, len(REPEATED) * AGAIN),
        equal("random starts: number", number, wanted, "stored"),
    ]


def draw(found: pd.DataFrame) -> Figure:
    """Share of the starts that are inverted over the spin, with intervals."""
    figure, axes = figures.new_figure(height=4.0)
    for index, ((model, tilt), group) in enumerate(found.groupby(["model", "starts"], sort=False)):
        share = 100 * group["share inverted"]
        axes.errorbar(
            group["spin in rad/s"],
            share,
            yerr=(share - 100 * group["from"], 100 * group["to"] - share),
            color=figures.COLOURS[index],
            linestyle=figures.STYLES[index],
            marker=figures.MARKERS[index],
            markersize=4,
            capsize=2.5,
            label=f"{model}, {tilt}",
        )
    axes.axvline(critical_speed(), color="#999999", linewidth=0.8, label="$Ω_{crit}$ (126)")
    axes.axhline(100 * NEARLY_ALL, color="#999999", linewidth=0.8, linestyle=":")
    axes.set(xlabel="spin at the start in rad/s", ylabel="inverted in %", ylim=(-3.0, 103.0))
    figures.legend_above(axes, columns=3)
    return figure
