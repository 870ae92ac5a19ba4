"""What is measured: cycles and their end, the engine's cycles, and passages."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from analysis import MODELS, ROUNDED_STEEL_DISK, Dissipation, Scenario, SmoothCoulomb
from analysis.nonlinear.families import cycle_at, cycle_family, rotating_family
from analysis.nonlinear.following import Family, events
from analysis.nonlinear.heteroclinic import heteroclinic_connection, period_growth
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.slow_manifold import slow_cycle
from validation.nonlinear import passage
from validation.nonlinear.tables import ends
from validation.studies.nonlinear.held_spin import AMPLITUDE, HELD, beginning, family, find
from validation.study import Row, Study

PAPER = Scenario(constraints=MODELS[4])

HELD_NAMES = ("Model 1 at held spin", "Model 2 at held spin")

SWINGING, ROTATING = "cycles of Model 4", "rotating motions of Model 4"
SLOW = "cycles on the slow manifold"


# --- Families -----------------------------------------------------------------------------------

AMPLITUDES = (0.1, 0.2, 0.4, 0.7, 1.0)
"""Amplitudes in rad of the cycles of Models 1 and 2."""


def families() -> dict[str, Callable[[], Iterable[Row]]]:
    """The cycles and rotating motions of Model 4, and the cycles of Models 1 and 2."""
    held = {name: partial(family, name, AMPLITUDES) for name in HELD_NAMES}
    return {SWINGING: _swinging, ROTATING: _rotating, SLOW: _slow, **held}


def follow_family(follow: Callable[[], Iterable[Row]]) -> list[Row]:
    """Periodic motions of a family, whole or not at all; fits and folds by their kinds."""
    return [{"kind": "motion", **row} for row in follow()]


def _swinging() -> Iterator[Row]:
    found = cycle_family(PAPER)
    yield from _whole(found)
    normal = hopf_type(PAPER)
    growth = fitted_growth(found.motions, normal.spin)
    fitted = {} if growth is None else growth._asdict()
    yield {
        "kind": "birth",
        "type": normal.kind,
        "curvature": normal.curvature,
        **{f"fitted_{name}": value for name, value in fitted.items()},
    }
    connection = heteroclinic_connection(PAPER)
    off = abs(found.motions[-1].spin - connection.spin)
    yield {"kind": "end", "off": off, **period_growth(found.motions, connection)}


def _rotating() -> list[Row]:
    found = rotating_family(PAPER)
    return _whole(found) + [{"kind": kind, **each.as_row()} for kind, each, _ in events(found)]


def _slow() -> list[Row]:
    amplitudes = np.linspace(0.05, 3.1, 25).tolist()
    cycles = [slow_cycle(PAPER, amplitude) for amplitude in amplitudes]
    return [{"amplitude": each.amplitude, "spin": each.spin} for each in cycles]


def _whole(found: Family) -> list[Row]:
    if found.reason is not None:
        raise ArithmeticError(f"the family ends early: {found.reason}")
    return [each.as_row() for each in found.motions]


FAMILIES = Study(name="families", cases=families, measure=follow_family)

# --- The engine's cycles ------------------------------------------------------------------------


def repeated() -> dict[str, tuple[str, float]]:
    """Three spins in rad/s of Model 4, and an amplitude in rad of Models 1 and 2 at held spin."""
    cycles = {f"Model 4, {spin:g} rad/s": ("Model 4", spin) for spin in (30.2, 30.5, 30.8)}
    return cycles | {
        f"{name}, {AMPLITUDES[1]:g} rad": (name, AMPLITUDES[1]) for name in HELD_NAMES
    }


def find_on_both(case: tuple[str, float]) -> Iterator[Row]:
    """A cycle in-house, and what the engine finds when it is put on it."""
    name, value = case
    scenario = Scenario(constraints=HELD[name])
    if name in HELD_NAMES:
        here = family(name, [each for each in AMPLITUDES if each <= value])[-1]
        there = find(scenario, here["unknowns"], source="engine", fixed=AMPLITUDE)
    else:
        cycle = cycle_at(scenario, value)
        here, there = cycle.as_row(), find(scenario, beginning(cycle), source="engine")
    names = ("spin", "amplitude", "period", "multiplier")
    for source, found in (("in-house", here), ("engine", there)):
        yield {"source": source, **{name: found[name] for name in names}}


ENGINE = Study(name="engine-cycles", cases=repeated, measure=find_on_both)

# --- The connection -----------------------------------------------------------------------------

OF_PAPER = "μ = 0.3, ε = 0.1 m/s"
"""The case of the paper's friction."""


def disks_and_friction() -> dict[str, Scenario]:
    """The paper's disk with other friction, and the one with the printed numbers."""
    steel = {}
    for mu, eps in product((0.1, 0.3), (0.01, 0.03, 0.1)):
        law = SmoothCoulomb(coefficient=mu, smoothing=eps)
        steel[f"μ = {mu:g}, ε = {eps:g} m/s"] = replace(PAPER, friction=law)
    return {**steel, "disk of Table 1": replace(PAPER, disk=ROUNDED_STEEL_DISK)}


def connect(scenario: Scenario) -> list[Row]:
    """The heteroclinic connection, and its first-order prediction."""
    found = ends(scenario)
    row = {"predicted": found["prediction"], **(found["connection"] or {})}
    if found["connection"] is not None:
        row["bracket"] = row["above"] - row["below"]
    return [row]


CONNECTIONS = Study(name="connections", cases=disks_and_friction, measure=connect)

# --- Passages -----------------------------------------------------------------------------------

DISSIPATED = "to rest, rolling and pivoting"

SLOWED = "slowed by pivoting friction"

EVERY = 25
"""Every so many samples of a passage are kept."""


def passages() -> dict[str, Callable[[], passage.Passage]]:
    """Three scenarios, one of them on both sides, and levers of the friction that slows a disk.

    Times are in s, levers in m.
    """
    dissipated = Scenario.rest(dissipation=Dissipation(rolling_dry=1e-3, pivoting=5e-5))
    return {
        "Model 1": partial(passage.follow, Scenario(), 20.0, "in-house"),
        "to rest, sliding friction": partial(passage.follow, Scenario.rest(), 20.5, "in-house"),
        DISSIPATED: partial(passage.follow, dissipated, 11.9, "in-house"),
        f"{DISSIPATED}, engine": partial(passage.follow, dissipated, 11.9, "engine"),
        **{
            f"{SLOWED}, {lever:g} m": partial(passage.slowed, lever)
            for lever in (2e-5, 4e-5, 8e-5)
        },
    }


def pass_through(follow: Callable[[], passage.Passage]) -> list[Row]:
    """When and at which spin the inversion is lost, and the way there."""
    found = follow()
    last = found["times"].size - 1
    kept = np.unique((*range(0, last, EVERY), int(np.argmin(found["spins"])), last))
    curves = {name: found[name][kept] for name in ("times", "spins", "deviations", "linear")}
    return [{**found, **curves}]


PASSAGES = Study(name="passages", cases=passages, measure=pass_through)
