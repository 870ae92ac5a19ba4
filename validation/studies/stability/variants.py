"""Attempts to reproduce the critical speeds of the full system printed in Sect. 3.2.

The paper prints Omega_crit1 = 27.1 and Omega_crit2 = 30.2 rad/s; its equations, with the signs
put right, give 26.87 and 30.10 rad/s. Each variant changes one thing that could have been chosen
otherwise or slipped in by mistake. None of them gives both printed numbers.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from analysis.data.disk import ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.data.scenario import Scenario
from analysis.data.table import Table
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Crossing, Spectra
from analysis.stability.printed import first_order, paper_numbers, printed_matrices

PRINTED = (27.1, 30.2)
"""Omega_crit1 and Omega_crit2 of the full system as printed, in rad/s."""

_SPINS = np.linspace(20.0, 36.0, 641)
_PAPER = Scenario()

Change = Callable[[dict[str, Any]], dict[str, Any]]
"""From `printed_matrices` to what to use."""


def hopf_speeds(scenario: Scenario = _PAPER, change: Change = dict) -> tuple[Crossing, ...]:
    """Hopf crossings from 20 to 36 rad/s of the full system with changed matrices.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table.
    change : callable
        See `Change`; none by default.
    """
    printed = printed_matrices(**paper_numbers(scenario))
    changed = change({name: np.array(each) for name, each in printed.items()})
    d = scenario.friction.gradient * scenario.weight
    found = Spectra(lambda spins: first_order(changed, spins, d), _SPINS).crossings()
    return tuple(crossing for crossing in found if crossing.kind == "hopf")


def variants() -> dict[str, tuple[Crossing, ...]]:
    """Hopf crossings from 20 to 36 rad/s of every variant, by its name."""
    scenarios = {name: replace(_PAPER, disk=disk) for name, disk in _disks().items()}
    for gradient in (2.0, 2.5, 2.83, 4.0, 30.0):
        scenarios[f"friction gradient {gradient:g} s/m"] = with_gradient(_PAPER, gradient)
    for gravity in (9.8, 9.80665, 10.0):
        scenarios[f"gravity {gravity:g} m/s²"] = replace(_PAPER, table=Table(gravity=gravity))
    found = {name: hopf_speeds(scenario) for name, scenario in scenarios.items()}
    return found | {name: hopf_speeds(change=change) for name, change in MATRIX_CHANGES.items()}


def reproduces(crossings: tuple[Crossing, ...]) -> bool:
    """Whether the first two crossings round to the printed speeds with the printed directions."""
    found = [(round(crossing.spin, 1), crossing.stable_side) for crossing in crossings]
    return found == [(PRINTED[0], "below"), (PRINTED[1], "above")]


def _disks() -> dict[str, Disk]:
    steel, heavy = STEEL_DISK, 8000.0 / 7700.0
    shift = steel.mass * steel.eccentricity**2
    across, about = steel.inertia_y, steel.inertia_z
    changes: dict[str, dict[str, float]] = {
        "density 8000 kg/m³": {
            name: heavy * getattr(steel, name)
            for name in ("mass", "inertia_x", "inertia_y", "inertia_z")
        },
        "density 8000 kg/m³ for the mass alone": {"mass": heavy * steel.mass},
        "B about S": {"inertia_y": across - shift},
        "C about S": {"inertia_z": about - shift},
        "B and C about S": {"inertia_y": across - shift, "inertia_z": about - shift},
        "B and C shifted the wrong way": {
            "inertia_y": across + shift,
            "inertia_z": about + shift,
        },
        "A and B exchanged": {"inertia_x": across, "inertia_y": steel.inertia_x},
    }
    return {
        "equations as they are": steel,
        "Table 1 as printed": ROUNDED_STEEL_DISK,
        "Table 1, rounded the other way": Disk(
            radius=0.045,
            mass=0.4355,
            eccentricity=2.55e-3,
            inertia_x=0.2485e-3,
            inertia_y=0.2265e-3,
            inertia_z=0.4675e-3,
        ),
        "infinitely thin disk": Disk.ring(
            radius=0.045, hole_radius=0.015, hole_distance=0.02, thickness=1e-6, density=7.7e7
        ),
        **{name: replace(steel, **change) for name, change in changes.items()},
    }


def _abbreviated(sign_x: float, sign_y: float, sign_z: float) -> Change:
    """With another sum of the moments of inertia for the abbreviation D = A - B - C of (50)."""
    disk = STEEL_DISK
    other = sign_x * disk.inertia_x + sign_y * disk.inertia_y + sign_z * disk.inertia_z
    changed = printed_matrices(**paper_numbers(_PAPER), D=other)["G_h"]
    return lambda printed: printed | {"G_h": changed}


def _negative(*names: str) -> Change:
    return lambda printed: printed | {name: -printed[name] for name in names}


def _part(sign: float) -> Change:
    """With the symmetric (1) or the skew part (-1) of B_C alone."""
    return lambda printed: printed | {"B_C": (printed["B_C"] + sign * printed["B_C"].T) / 2}


MATRIX_CHANGES: Mapping[str, Change] = MappingProxyType(
    {
        "(53) and (54) with the printed signs": _negative("D_C", "B_C"),
        "(53) with the printed sign": _negative("D_C"),
        "(54) with the printed sign": _negative("B_C"),
        "without B_C": lambda printed: printed | {"B_C": 0.0 * printed["B_C"]},
        "without the symmetric part of B_C": _part(-1.0),
        "without the skew part of B_C": _part(1.0),
        "D = -(A - B - C)": _abbreviated(-1.0, 1.0, 1.0),
        "D = A - B + C": _abbreviated(1.0, -1.0, 1.0),
        "D = A + B - C": _abbreviated(1.0, 1.0, -1.0),
        "D = B - A - C": _abbreviated(-1.0, 1.0, -1.0),
        "D = -C": _abbreviated(0.0, 0.0, -1.0),
    }
)
"""Changes of the matrices by misprints or slips, by their names."""
