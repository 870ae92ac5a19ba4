"""Centred disks against the textbook, and the creep that sliding friction alone leaves."""

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from analysis import CENTRED_DISK as DISK
from analysis import PenaltyContact, Scenario, SmoothCoulomb, SpatialMotion, Start
from analysis.data.trajectory import SOURCES, Source
from analysis.rest.final_stage import precession
from analysis.rest.stationary_rolling import (
    axial_spin,
    euler_disk_energy,
    euler_disk_precession,
    rolling_start,
    upright_rolling_spin,
)
from mbs_models import Scene
from mbs_models.rest_run import largest_step
from validation.kit.report import Job
from validation.kit.tables import Table
from validation.run import run_to_rest

STICKY = SmoothCoulomb(coefficient=2.0, smoothing=5e-3, load="contact")
"""Friction in which a rolling disk hardly slips."""

EULER_BETA = 0.2
"""Inclination of Euler's disk in rad."""

ROLLING = (0.8, 20.0)
"""Inclination in rad and precession in rad/s of a disk that rolls with spin about its axis."""

ON_TABLE = Scenario.rest(
    disk=DISK, friction=STICKY, contact=PenaltyContact.rounded(DISK, half_thickness=2e-5)
)


def starts() -> dict[str, tuple[Start, float]]:
    """Starts by name, and for how long in s to run them."""
    beta, rate = ROLLING
    upright = upright_rolling_spin(ON_TABLE)
    euler = rolling_start(DISK, EULER_BETA, euler_disk_precession(ON_TABLE, EULER_BETA), 0.0)
    rolling = rolling_start(DISK, beta, rate, axial_spin(ON_TABLE, beta, rate))
    return {
        "Euler's disk": (euler, 1.0),
        "rolling": (rolling, 0.3),
        "upright, faster": (_upright(1.05 * upright), 2.5),
        "upright, slower": (_upright(0.95 * upright), 2.5),
    }


def _upright(spin: float) -> Start:
    """Disk that rolls upright along a line, slightly pushed to a side."""
    return Start(gamma=0.0, spin=0.0, x_rate=-DISK.radius * spin, beta_rate=1e-3, gamma_rate=spin)


def run(name: str, source: Source) -> SpatialMotion:
    """Run one of `starts` in the engine or with the in-house equations."""
    start, end = starts()[name]
    scenario = replace(ON_TABLE, start=start)
    if source == "in-house":
        return run_to_rest(scenario, end, source=source, spacing=1e-2, local_tolerance=1e-10)
    step = 0.6 * largest_step(Scene(scenario))
    return run_to_rest(scenario, end, step=step, spacing=1e-2)


def jobs() -> list[Job]:
    """Runs behind the table of the textbook."""
    return [
        Job(("rest rolling", name, source), run, (name, source))
        for name in starts()
        for source in SOURCES
    ]


def textbook(results: Mapping[Any, Any]) -> Table:
    """What the textbook says of a centred disk, and what both simulations give."""

    def found(name: str, quantity: Any) -> list[float]:
        return [float(quantity(results["rest rolling", name, source])) for source in SOURCES]

    def farthest(motion: SpatialMotion) -> float:
        return float(np.max(np.abs(motion.tilt - pi / 2)))

    rows: list[tuple[str, float | None, list[float]]] = [
        (
            "Euler's disk, Ω in rad/s",
            euler_disk_precession(ON_TABLE, EULER_BETA),
            found("Euler's disk", lambda m: np.mean(precession(m))),
        ),
        (
            "Euler's disk, energy in J",
            euler_disk_energy(ON_TABLE, EULER_BETA),
            found("Euler's disk", lambda m: np.mean(m.energies[:, :2].sum(axis=1))),
        ),
        (
            "Euler's disk, contact force in N",
            ON_TABLE.weight,
            found("Euler's disk", lambda m: np.mean(m.normal_force)),
        ),
        ("rolling, β in rad", ROLLING[0], found("rolling", lambda m: np.mean(m.tilt))),
        ("rolling, Ω in rad/s", ROLLING[1], found("rolling", lambda m: np.mean(precession(m)))),
        ("upright, 5 % faster: largest lean in rad", None, found("upright, faster", farthest)),
        ("upright, 5 % slower: largest lean in rad", None, found("upright, slower", farthest)),
    ]
    return Table(
        name="rest-textbook",
        title="A centred disk rolls as the textbook says",
        columns=("quantity", "textbook", *SOURCES, "largest relative difference"),
        rows=[
            (
                quantity,
                exact,
                *values,
                None if exact is None else max(abs(value / exact - 1.0) for value in values),
            )
            for quantity, exact, values in rows
        ],
        note="Means over 1 s (Euler's disk) and over a turn (rolling), on friction so steep that "
        "the disk hardly slips. Rolling: "
        "A Ω² sin β cos β − (C + m r²) Ω ω₃ sin β = m g r cos β gives the spin ω₃ for "
        f"β = {ROLLING[0]:g} rad and Ω = {ROLLING[1]:g} rad/s. Upright: stable above "
        f"{upright_rolling_spin(ON_TABLE):.2f} rad/s, pushed with 1e-3 rad/s over 2.5 s.",
    )
