"""Centred disks against the textbook, and their last moments against power laws."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import pi
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analysis import CENTRED_DISK as DISK
from analysis import Dissipation, PenaltyContact, Scenario, SmoothCoulomb, SpatialMotion, Start
from analysis.problem.choices import SOURCES
from analysis.stability.stationary_rolling import (
    axial_spin,
    euler_disk_energy,
    euler_disk_precession,
    fit_power_law,
    precession,
    rolling_start,
    time_to_flat,
    upright_rolling_spin,
)
from mbs_models.rest import largest_step
from validation.comparison.limits import largest
from validation.run import run_to_rest
from validation.study import Check, Content, Row, Study, at_most

RIM = PenaltyContact.rounded(DISK, half_thickness=2e-5)
STICKY = SmoothCoulomb(coefficient=2.0, smoothing=5e-3, load="contact")
ON_TABLE = Scenario.rest(disk=DISK, friction=STICKY, contact=RIM)
"""Friction in which a rolling disk hardly slips."""

EULER_BETA = 0.2
"""Inclination of Euler's disk in rad."""

ROLLING = (0.8, 20.0)
"""Inclination in rad and precession in rad/s of a disk that rolls with spin about its axis."""

UPRIGHT = {"upright, 5 % faster": 1.05, "upright, 5 % slower": 0.95}
"""Spins of a disk that rolls upright, in those from which on that is stable."""

LEAN = 1e-2
"""Lean in rad that a disk rolling upright stays below if it is stable, and exceeds if not."""

STAYS = f"within {LEAN:g} rad of upright"
"""1 if it is so all the time, else 0."""

CLOSE, SAME = 1e-2, 1e-3
"""Largest relative differences from a closed form, and between both sides."""

FLAT_START = 0.1
"""Inclination in rad at which the last moments begin."""

FIT = (0.08, 0.02)
"""Inclinations in rad between which the laws are fitted: small, and far above the rim's shape."""

STAGES = {
    "viscous rolling": (Dissipation(rolling_viscous=2e-4), 1 / 2, -1 / 4),
    "dry rolling": (Dissipation(rolling_dry=1e-3), 2 / 3, -1 / 3),
}
"""Losses, and the exponents of the time to go that theory gives for β and Ω."""


QUANTITIES: dict[str, Callable[[SpatialMotion], Any]] = {
    "Ω in rad/s": lambda motion: np.mean(precession(motion)),
    "energy in J": lambda motion: np.mean(motion.energies[:, :2].sum(axis=1)),
    "contact force in N": lambda motion: np.mean(motion.normal_force),
    "β in rad": lambda motion: np.mean(motion.tilt),
    STAYS: lambda motion: np.max(np.abs(motion.tilt - pi / 2)) < LEAN,
}


class Rolling(NamedTuple):
    """A disk that rolls: how it starts, until when in s, and its closed forms by quantity."""

    start: Start
    end: float
    exact: dict[str, float]


def cases() -> dict[str, Rolling | str]:
    """What rolls, and by name what comes to lie flat."""
    euler = euler_disk_precession(ON_TABLE, EULER_BETA)
    rolling = rolling_start(DISK, *ROLLING, axial_spin(ON_TABLE, *ROLLING))
    of_euler = {
        "Ω in rad/s": euler,
        "energy in J": euler_disk_energy(ON_TABLE, EULER_BETA),
        "contact force in N": ON_TABLE.weight,
    }
    found: dict[str, Rolling | str] = {
        "Euler's disk": Rolling(rolling_start(DISK, EULER_BETA, euler, 0.0), 1.0, of_euler),
        "rolling": Rolling(rolling, 0.3, {"β in rad": ROLLING[0], "Ω in rad/s": ROLLING[1]}),
    }
    for name, part in UPRIGHT.items():
        # Along a line, slightly pushed to a side.
        spin = part * upright_rolling_spin(ON_TABLE)
        push = {"x_rate": -DISK.radius * spin, "beta_rate": 1e-3, "gamma_rate": spin}
        start = Start(gamma=0.0, spin=0.0, **push)
        found[name] = Rolling(start, 2.5, {STAYS: float(part > 1.0)})
    return found | {name: name for name in STAGES}


def measure(case: Rolling | str) -> Iterator[Row]:
    """Quantities and their closed forms (`exact`): of what rolls on both sides, else in-house."""
    if isinstance(case, str):
        yield from _last_moments(case)
        return
    scenario = replace(ON_TABLE, start=case.start)
    step = 0.6 * largest_step(scenario)
    controls: dict[Any, Any] = {"engine": {"step": step}, "in-house": {"local_tolerance": 1e-10}}
    for source in SOURCES:
        motion = run_to_rest(scenario, case.end, source=source, spacing=1e-2, **controls[source])
        for quantity, exact in case.exact.items():
            value = float(QUANTITIES[quantity](motion))
            yield {"source": source, "quantity": quantity, "exact": exact, "value": value}


def _last_moments(case: str) -> Iterator[Row]:
    """Power laws of inclination and precession, fitted with one end."""
    losses, tilting, turning = STAGES[case]
    scenario = Scenario.rest(disk=DISK, contact=RIM, dissipation=losses)
    rate = euler_disk_precession(scenario, FLAT_START)
    scenario = replace(scenario, start=rolling_start(DISK, FLAT_START, rate, 0.0))
    flat = time_to_flat(scenario, FLAT_START)
    motion = run_to_rest(scenario, 1.1 * flat, source="in-house", local_tolerance=1e-10)
    times, leaning = motion.times, motion.leaning
    part = slice(int(np.argmax(leaning < FIT[0])), int(np.argmax(leaning < FIT[1])))
    law = fit_power_law(times[part], leaning[part])
    turn = fit_power_law(times[part], precession(motion)[part], law.end)
    fit = {"source": "in-house", "error": law.error, "decades": law.decades}
    yield {"quantity": "exponent of β", "exact": tilting, "value": law.exponent} | fit
    yield {"quantity": "exponent of Ω", "exact": turning, "value": turn.exponent} | fit
    yield {"quantity": "flat after s", "exact": flat, "value": law.end} | fit


STUDY = Study(name="rest-closed", cases=cases, measure=measure)


# --- What is shown ------------------------------------------------------------------------------


def present(table: pd.DataFrame) -> Content:
    """Closed forms beside what both sides give."""
    keys = ["case", "quantity", "exact"]
    sides = table.set_index([*keys, "source"])["value"].unstack()
    # As told: where a side is missing, pandas 2 mixes up what it does not sort.
    found = sides.reindex(table.set_index(keys).index.unique()).reset_index()
    apart = found[list(SOURCES)].sub(found["exact"], axis=0).abs().max(axis=1)
    relative = {"largest relative difference": apart / found["exact"].abs()}
    return Content(
        numbers={
            "upright_spin": upright_rolling_spin(ON_TABLE),
            "laws": table[table["quantity"] == "exponent of β"].set_index("case"),
        },
        tables={"closed": found.assign(**relative)},
        checks=list(checks(found)),
    )


def checks(found: pd.DataFrame) -> Iterator[Check]:
    """Whether each side that was run has the closed form and both have the same."""
    for row in found.to_dict("records"):
        name, size = f"rest, {row['case']}, {row['quantity']}", abs(row["exact"])
        # The last moments are run in-house alone.
        values = [row[source] for source in (SOURCES[1:] if row["case"] in STAGES else SOURCES)]
        apart = largest(abs(each - row["exact"]) for each in values)
        yield at_most(f"{name}: difference", apart, CLOSE * size)
        if len(values) > 1:
            apart = abs(values[0] - values[1])
            yield at_most(f"{name}: engine against in-house", apart, SAME * size)
