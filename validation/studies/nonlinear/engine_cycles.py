"""The engine on the cycles, and the cycles of Models 1 and 2 at held spin."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, starmap
from typing import Any

import numpy as np

from analysis import MODELS, Scenario
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import cycle_at
from analysis.stability.critical import critical_speeds
from validation.kit.limits import holds
from validation.kit.tables import Table
from validation.studies.nonlinear.held_spin import HELD, HeldCycle, find, small_cycle
from validation.studies.nonlinear.tables import WORDS

SPINS = (30.2, 30.3, 30.5, 30.8)
"""Spins in rad/s at which the engine is put on the cycle of Model 4."""

FORMULATION = "floating"

AMPLITUDES = (0.1, 0.2, 0.4, 0.7, 1.0)
"""Amplitudes in rad of the cycles of Models 1 and 2."""

LARGE = (*AMPLITUDES, 1.3, 1.6, 1.9, 2.2, 2.5, 2.7, 2.74, 2.8, 2.9)
"""Those up to where the disk of Model 1 falls flat on its way."""

_STRAIGHT = 3
"""So many cycles must be known before the next one is extrapolated."""

REPEATED = 0.4
"""That of the one which the engine repeats."""

_LARGEST = 1e-6
_LARGEST_MULTIPLIER = 1e-5
_LIMITS = (_LARGEST, _LARGEST, _LARGEST_MULTIPLIER)


@dataclass(frozen=True, slots=True, kw_only=True)
class Witness:
    """A cycle of the reduced system and the one that the engine has at its spin."""

    cycle: Cycle
    engine: HeldCycle


def witness(spin: float) -> Witness:
    """Put Model 4 of the engine on the cycle of a spin in rad/s, and let it find its own."""
    scenario = Scenario(constraints=MODELS[4])
    cycle = cycle_at(scenario, spin)
    engine = find(scenario, beginning(cycle), source="engine", formulation=FORMULATION)
    return Witness(cycle=cycle, engine=engine)


def beginning(cycle: Cycle) -> dict[str, Any]:
    """Where to begin a search at a cycle of the reduced system."""
    return {
        "spin": cycle.spin,
        "amplitude": cycle.amplitude,
        "period": cycle.period,
        "start": cycle.states[0, 2:],
    }


def witness_table(found: Sequence[Witness]) -> Table:
    """Cycles and multipliers of the engine beside the in-house ones."""
    return Table.of(
        found,
        {
            "spin in rad/s": lambda each: each.cycle.spin,
            "amplitude in rad": lambda each: each.cycle.amplitude,
            "period in s": lambda each: each.cycle.period,
            "multiplier": lambda each: each.cycle.multiplier,
            "amplitude, engine less in-house": lambda each: _differences(each)[0],
            "period, engine less in-house": lambda each: _differences(each)[1],
            "multiplier, engine less in-house": lambda each: _differences(each)[2],
            "agree": lambda each: all(map(holds, map(abs, _differences(each)), _LIMITS)),
        },
        name="engine_cycles",
        title="Cycles of Model 4: engine against the reduced system",
        note=(
            f"Amplitude and period have to agree to {_LARGEST:g}, the multiplier, which the "
            f"engine has from displaced starts, to {_LARGEST_MULTIPLIER:g}."
        ),
    )


def _differences(each: Witness) -> list[float]:
    names = ("amplitude", "period", "multiplier")
    return [getattr(each.engine, name) - getattr(each.cycle, name) for name in names]


def held_family(name: str, amplitudes: Sequence[float] = AMPLITUDES) -> list[HeldCycle]:
    """Cycles of a model of `HELD` from its Hopf point of slow frequency on, in-house.

    Parameters
    ----------
    name : str
        One of `HELD`.
    amplitudes : sequence of float
        Rising, in rad.
    """
    scenario = Scenario(constraints=HELD[name])
    hopf = critical_speeds(scenario, (29.0, 31.5)).crossings[-1]
    start = small_cycle(scenario, hopf.spin, hopf.frequency, amplitudes[0])
    found: list[HeldCycle] = []
    for amplitude in amplitudes:
        guess = _further(amplitude, [as_start(each) for each in found] or [start])
        found.append(find(scenario, guess, source="in-house", fixed="amplitude"))
    return found


def _further(amplitude: float, known: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Where to begin at an amplitude: in proportion, or on the line through the last two."""
    last = known[-1]
    if len(known) < _STRAIGHT:
        larger = amplitude / last["amplitude"]
        return {**last, "amplitude": amplitude, "start": np.array(last["start"]) * larger}
    before = known[-2]
    part = (amplitude - last["amplitude"]) / (last["amplitude"] - before["amplitude"])
    return {name: last[name] + part * (last[name] - before[name]) for name in last}


def as_start(cycle: HeldCycle) -> dict[str, Any]:
    """Where to begin a search at a cycle that has been found."""
    return {name: getattr(cycle, name) for name in ("spin", "amplitude", "period", "start")}


def repeated(name: str) -> tuple[HeldCycle, HeldCycle]:
    """A cycle of a model of `HELD` on both sides, in-house first."""
    reach = [amplitude for amplitude in AMPLITUDES if amplitude <= REPEATED]
    inhouse = held_family(name, reach)[-1]
    scenario = replace(Scenario(), constraints=HELD[name])
    engine = find(
        scenario,
        as_start(inhouse),
        source="engine",
        fixed="amplitude",
        formulation=FORMULATION,
    )
    return inhouse, engine


def held_table(families: Sequence[tuple[str, Sequence[HeldCycle]]]) -> Table:
    """Cycles of Models 1 and 2 at held spin."""
    return Table(
        name="held_cycles",
        title="Cycles of the models with more freedom, at held spin",
        columns=(
            "model",
            "amplitude in rad",
            "spin in rad/s",
            "period in s",
            "largest real half multiplier",
            "size of the complex pair",
            "stable",
        ),
        rows=[
            (name, cycle.amplitude, cycle.spin, cycle.period, *split(cycle), WORDS[cycle.stable])
            for name, family in families
            for cycle in family
        ],
        note=(
            "Here the critical pair slips, and the kink of the friction law gives the spin a term "
            f"in the amplitude itself. {' '.join(starmap(_stability, families))} Model 3 at held "
            "spin is Model 4."
        ),
    )


def _stability(name: str, family: Sequence[HeldCycle]) -> str:
    """Sentence on which cycles are stable, and what makes the others unstable."""
    parts = []
    for word, stable in (("stable", True), ("unstable", False)):
        if found := [cycle for cycle in family if cycle.stable is stable]:
            parts.append(f"{word} at {_amplitudes(found)}")
    for pair in pairwise(family):
        # A multiplier of 1 over half a period on the way.
        sides = [np.prod(1.0 - cycle.half_multipliers).real for cycle in pair]
        if sides[0] * sides[1] < 0.0:
            parts.append(f"a fold between {_amplitudes(pair)}")
    if growing := [cycle for cycle in family if (split(cycle)[1] or 0.0) > 1.0]:
        parts.append(f"a complex pair outside of the unit circle at {_amplitudes(growing)}")
    return f"{name}: {'; '.join(parts)}."


def _amplitudes(cycles: Sequence[HeldCycle]) -> str:
    *others, last = (f"{cycle.amplitude:g}" for cycle in cycles)
    return f"{', '.join(others)} and {last} rad" if others else f"{last} rad"


def split(cycle: HeldCycle) -> tuple[float, float | None]:
    """Largest real multiplier over half a period, and size of the complex pair if there is one."""
    values = cycle.half_multipliers
    pair = np.abs(values.imag) > 1e-6
    real = values[~pair].real
    largest = float(real[np.argmax(np.abs(real))])
    return largest, float(np.max(np.abs(values[pair]))) if np.any(pair) else None


def repeated_table(pairs: Sequence[tuple[str, tuple[HeldCycle, HeldCycle]]]) -> Table:
    """Engine against in-house cycles of Models 1 and 2."""
    rows = []
    for name, (inhouse, engine) in pairs:
        spin, period = engine.spin - inhouse.spin, engine.period - inhouse.period
        multiplier = engine.multiplier - inhouse.multiplier
        agree = all(map(holds, map(abs, (spin, period, multiplier)), _LIMITS))
        rows.append((name, inhouse.amplitude, inhouse.spin, spin, period, multiplier, agree))
    return Table(
        name="repeated_cycles",
        title="Cycles at held spin: engine against in-house equations",
        columns=(
            "model",
            "amplitude in rad",
            "spin in rad/s",
            "spin, engine less in-house",
            "period, engine less in-house",
            "multiplier, engine less in-house",
            "agree",
        ),
        rows=rows,
    )
