"""Which starts invert: random ones over the spin, and Table 3's from a least spin on.

Of Sections 1, 3.2 and 7; the critical speeds are those of Sections 3 and 6.
"""

from bisect import bisect_left
from collections import Counter
from functools import cache
from itertools import product, starmap
from math import acos, nan, pi
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.stats import binomtest

from analysis import LEVELS, MODELS, FlatError, Level, Scenario, Start
from analysis.mechanics import paper
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT
from analysis.motion.inversion import OUTCOMES as DECIDED
from analysis.motion.inversion import STAYING
from analysis.problem.choices import Source
from analysis.stability.critical import critical_speeds
from validation.display import figures
from validation.run import run
from validation.study import Check, Row, Study, equal, grade

END = 10.0
"""Time in s within which the disk has to be inverted."""

OUTCOMES = (*DECIDED, FLAT, CONTACT_WOULD_PULL)


def outcome(scenario: Scenario, source: Source, end: float, **accuracy: Any) -> str:
    """What becomes of a start until an end in s, one of `OUTCOMES`; `ValueError` if none."""
    times = np.linspace(0.0, end, round(100 * end) + 1)
    if source == "in-house":
        formulation = "reduced" if scenario.model == 4 else "index-1"
        accuracy = {"formulation": formulation, "local_tolerance": 1e-6}
    try:
        found = run(scenario, times, source=source, **accuracy)
    except FlatError:
        return FLAT
    result = found.inversion.outcome if found.ending is None else found.ending.reason
    return OUTCOMES[OUTCOMES.index(result)]


def inverts(result: str) -> bool:
    """Whether an outcome is an inversion, kept or lost later."""
    return result in ("inverted", "lost")


def critical_speed() -> float:
    """That of the reduced system in closed form, Eq. (126), in rad/s."""
    return paper.critical_speed(Scenario(constraints=MODELS[4])).spin


# --- Random starts ------------------------------------------------------------------------------

Tilt = Literal["near upright", "any tilt"]
TILTS: tuple[Tilt, ...] = get_args(Tilt)

SPINS = (25.0, 31.0, 33.0, 36.0, 40.0, 50.0, 60.0, 80.0, 100.0)
"""Spins at the start in rad/s."""

NUMBER, BLOCK = 100, 10
"""Random starts of Models 1 and 4 at each spin, of which so many are a case."""

NEARLY_ALL, CONFIDENCE = 0.95, 0.95
"""Part of the starts, and the probability of its interval."""

INVERTED, STILL, UNKNOWN = "inverted in %", "still inverted in %", "not decided in %"
"""Shares of the starts: that invert, that have not been lost by `END`, and of which neither is
known, as the motion ends before."""

NEAR, FLATTEST = 0.2, 0.1
"""Largest tilt from upright of starts near it, and least from flat of all others, in rad."""


class Starts(NamedTuple):
    """Random starts at a spin in rad/s, given by the number of the first one.

    Near upright, beta lies within `NEAR` of pi / 2; otherwise every direction of the axis is
    equally likely, up to `FLATTEST` from flat. gamma is anything in both. Starts of the same
    number and tilt have the same position at every spin and model.
    """

    level: Level
    tilt: Tilt
    spin: float
    first: int = 0
    number: int = BLOCK
    source: Source = "in-house"

    @property
    def label(self) -> str:
        """Its name among the cases."""
        numbers = f"{self.first} to {self.first + self.number - 1}"
        return f"Model {self.level}, {self.tilt}, {self.spin:g} rad/s, starts {numbers}"

    def scenario(self, number: int) -> Scenario:
        """Upright or tilted, spinning about the vertical, without slip along the edge."""
        rng = np.random.default_rng((TILTS.index(self.tilt), number))
        gamma = rng.uniform(-pi, pi)
        if self.tilt == "near upright":
            beta = pi / 2 + rng.uniform(-NEAR, NEAR)
        else:
            beta = acos(rng.uniform(-1.0, 1.0) * np.cos(FLATTEST))
        start = Start(beta=beta, gamma=gamma, spin=self.spin)
        return Scenario(constraints=MODELS[self.level], start=start)


def cases() -> dict[str, Starts]:
    """Blocks of starts of each model, tilt and spin."""
    levels: tuple[Level, ...] = (1, 4)
    found = starmap(Starts, product(levels, TILTS, SPINS, range(0, NUMBER, BLOCK)))
    return {each.label: each for each in found}


REPEATED = [Starts(1, "any tilt", spin) for spin in (31.0, 36.0, 50.0)]
AGAIN = 3
"""Blocks of which the engine repeats so many starts each."""


def measure(starts: Starts) -> list[Row]:
    """Outcomes of some starts."""
    numbers = range(starts.first, starts.first + starts.number)
    found = [
        outcome(starts.scenario(each), starts.source, END, tolerance=1e-4) for each in numbers
    ]
    return [{"level": starts.level, "tilt": starts.tilt, "spin": starts.spin, "outcomes": found}]


RANDOM_STARTS = Study(
    name="random-starts",
    cases=cases,
    measure=measure,
    sample=[each.label for each in REPEATED],
    confirm={"outcomes": None},
    columns={"outcomes": f"of each start within {END:g} s, in the order of their numbers"},
)

IN_ENGINE = Study(
    name="random-starts-engine",
    cases=lambda: {each.label: each._replace(number=AGAIN, source="engine") for each in REPEATED},
    measure=measure,
)


def shares(table: pd.DataFrame) -> pd.DataFrame:
    """How often each outcome is reached, and the share that inverts with its interval."""
    rows = []
    for (level, tilt, spin), group in table.groupby(["level", "tilt", "spin"], sort=False):
        count = Counter(group["outcomes"].sum())
        ups = sum(number for result, number in count.items() if inverts(result))
        low, high = binomtest(ups, count.total()).proportion_ci(CONFIDENCE)
        ended = count["not decided"] + count[CONTACT_WOULD_PULL]
        percent = 100.0 / count.total()
        found = {"model": f"Model {level}", "starts": tilt, "spin": spin, "number": count.total()}
        found |= {INVERTED: percent * ups, "from": 100.0 * low, "to": 100.0 * high}
        found |= {STILL: percent * count["inverted"], UNKNOWN: percent * ended}
        rows.append(found | {each: count[each] for each in OUTCOMES})
    return pd.DataFrame(rows)


def judge_attraction(found: pd.DataFrame) -> Row:
    """Sections 1 and 3.2, from `shares`."""
    fast = found[found["spin"] > critical_speed()]
    fast = fast.assign(nearly_all=fast[INVERTED] >= 100 * NEARLY_ALL)
    upright, tilted = (fast[(fast["starts"] == t) & (fast["model"] == "Model 1")] for t in TILTS)
    verdict = grade(yes=tilted.nearly_all.all(), partly=upright.nearly_all.any())
    return {"fast": fast, "upright": upright, "tilted": tilted, "verdict": verdict}


def draw(found: pd.DataFrame) -> Figure:
    """Share of the starts that are inverted over the spin, with intervals."""
    figure, axes = figures.new_figure(height=4.0)
    groups = found.groupby(["model", "starts"], sort=False)
    for ((model, tilt), group), look in zip(groups, figures.MARKED, strict=False):
        share, label, thin = group[INVERTED], f"{model}, {tilt}", {"linewidth": 0.8}
        bars = (share - group["from"], group["to"] - share)
        axes.errorbar(group["spin"], share, bars, markersize=4, capsize=2.5, label=label, **look)
        if (group[STILL] < share).any():
            axes.plot(group["spin"], group[STILL], **look | thin | {"markerfacecolor": "white"})
    axes.axvline(critical_speed(), color="#999999", linewidth=0.8, label="$Ω_{crit}$ (126)")
    axes.axhline(100 * NEARLY_ALL, color="#999999", linewidth=0.8, linestyle=":")
    axes.set(xlabel="spin at the start in rad/s", ylabel="inverted in %", ylim=(-3.0, 103.0))
    figures.legend_above(axes, columns=2)
    return figure


# --- Least spins --------------------------------------------------------------------------------

BRACKET, WIDTH = (29.0, 33.0), 1.0 / 32.0
"""Spins in rad/s between which a bisection looks, and the width of what is left."""

SWINGS, LAST = 60.0, 5.0
"""End in s of a run that shows whether the disk swings on, and the last time that is looked at."""

SCANNED = {f"at {spin:g} rad/s": spin for spin in (20.0, 40.0, 100.0)}
"""Further spins in rad/s: none below the bracket may invert, and all above have to."""

OWN, BELOW, ABOVE = "critical speed in rad/s", "no inversion at rad/s", "inversion at rad/s"
LOST, SWING = "another pair unstable above", "swing of γ there in rad"
"""Columns with numbers,"""

ENDS = {"outcome there": "engine", "outcome": "engine above"}
"""and those with outcomes in-house and in the engine, below and above."""


def search(level: Level) -> list[Row]:
    """Bisect the bracket for the spin from which the model inverts.

    Raises
    ------
    ArithmeticError
        If the ends of the bracket do not differ.
    """

    @cache
    def found(spin: float, source: Source = "in-house") -> str:
        scenario = Scenario(constraints=MODELS[level], start=Start(spin=spin))
        return outcome(scenario, source, END + STAYING, step=2e-3)

    spins = np.arange(BRACKET[0], BRACKET[1] + WIDTH, WIDTH).tolist()
    if inverts(found(spins[0])) or not inverts(found(spins[-1])):
        raise ArithmeticError(
            "Model {}: no change between {:g} and {:g} rad/s".format(level, *BRACKET)
        )
    least = bisect_left(spins[:-1], True, key=lambda spin: inverts(found(spin)))
    low, high = spins[least - 1 : least + 1]
    hopf = critical_speeds(
        Scenario(constraints=MODELS[level]), (20.0, 40.0), system="numeric"
    ).hopf
    gained, lost = (
        [each.spin for each in hopf if each.stable_side == side] for side in ("above", "below")
    )
    row: Row = {OWN: max(gained, default=nan), LOST: min(lost, default=None)}
    for column, spin, (here, there) in zip((BELOW, ABOVE), (low, high), ENDS.items(), strict=True):
        row |= {column: spin, here: found(spin), there: found(spin, "engine")}
    row[SWING] = _swing(level, high) if found(high) == "inverted" else None
    return [row | {name: found(spin) for name, spin in SCANNED.items()}]


def _swing(level: Level, spin: float) -> float:
    """Largest deviation of gamma from pi/2 in rad at the end of a long run from a spin."""
    times = np.linspace(0.0, SWINGS, round(100 * SWINGS) + 1)
    scenario = Scenario(constraints=MODELS[level], start=Start(spin=spin))
    motion = run(scenario, times, source="in-house", local_tolerance=1e-8)
    last = motion.coordinate("gamma")[motion.times >= SWINGS - LAST]
    return float(np.max(np.abs(last - pi / 2), initial=0.0))


LEAST_SPINS = Study(
    name="least-spins",
    cases=lambda: {f"Model {level}": level for level in LEVELS},
    measure=search,
    sample=("Model 1", "Model 4"),
    confirm={OWN: 1e-6, LOST: 1e-6, BELOW: 1e-9, ABOVE: 1e-9, SWING: 1e-4}
    | dict.fromkeys((*ENDS, *ENDS.values(), *SCANNED)),
)


def judge_least_spins(table: pd.DataFrame) -> Row:
    """Section 7: inversion only from supercritical spins."""
    above_closed, above_model = table[ABOVE] > critical_speed(), table[ABOVE] > table[OWN]
    ordered = all(
        (table[name].map(inverts) == (spin > table[ABOVE])).all() for name, spin in SCANNED.items()
    )
    yes = bool(above_closed.all() and above_model.all() and ordered)
    verdict = grade(yes=yes, partly=bool(above_closed.any() and ordered))
    swing = table[SWING].iloc[-1]
    return {"least": table[ABOVE], "own": table[OWN], "swing": swing, "verdict": verdict}


def checks(least: pd.DataFrame, engine: pd.DataFrame, stored: pd.DataFrame) -> list[Check]:
    """Whether the engine finds what is stored."""
    found = []
    for place, there in ENDS.items():
        same = int((least[place] == least[there]).sum())
        found.append(equal(f"least spins: engine, {place}", same, len(LEVELS), "stored"))
    keys = ["case", "level", "tilt", "spin"]
    again = engine.merge(stored, on=keys, suffixes=(" again", "")).to_dict("records")
    found.append(equal("random starts: repeated in the engine", len(again), len(REPEATED)))
    for row in again:
        name = f"random starts: engine, {row['case']}"
        found.append(equal(name, row["outcomes again"], row["outcomes"][:AGAIN]))
    return found
