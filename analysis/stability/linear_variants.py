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

from analysis.data.checks import Array
from analysis.data.disk import ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.data.scenario import Scenario
from analysis.data.table import Table
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Crossing, all_crossings
from analysis.stability.linear_full import FullLinearSystem, paper_numbers, printed_matrices
from analysis.stability.linearisation import ComplexArray
from analysis.stability.spectra import Branches, follow

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

    def matrices(spins: Array) -> Array:
        return FullLinearSystem.of(changed, spins, d).state_matrices

    def spectrum(spin: float) -> ComplexArray:
        return np.linalg.eigvals(matrices(np.array([spin]))[0]).astype(complex)

    followed = Branches(spins=_SPINS, values=follow(matrices(_SPINS)))
    found = all_crossings(followed, spectrum)
    hopf = (crossing for crossing in found if crossing.kind == "hopf")
    return tuple(sorted(hopf, key=lambda crossing: crossing.spin))


def variants() -> dict[str, tuple[Crossing, ...]]:
    """Hopf crossings from 20 to 36 rad/s of every variant, by its name."""
    result = {name: hopf_speeds(replace(_PAPER, disk=disk)) for name, disk in _disks().items()}
    for gradient in (2.0, 2.5, 2.83, 4.0, 30.0):
        result[f"friction gradient {gradient:g} s/m"] = hopf_speeds(
            with_gradient(_PAPER, gradient)
        )
    for gravity in (9.8, 9.80665, 10.0):
        result[f"gravity {gravity:g} m/s²"] = hopf_speeds(
            replace(_PAPER, table=Table(gravity=gravity))
        )
    for name, change in MATRIX_CHANGES.items():
        result[name] = hopf_speeds(change=change)
    return result


def reproduces(crossings: tuple[Crossing, ...]) -> bool:
    """Whether the first two crossings round to the printed speeds with the printed directions."""
    found = [(round(crossing.spin, 1), crossing.stable_side) for crossing in crossings]
    return found == [(PRINTED[0], "below"), (PRINTED[1], "above")]


def _disks() -> dict[str, Disk]:
    steel = STEEL_DISK
    shift = steel.mass * steel.eccentricity**2
    B, C = steel.inertia_y, steel.inertia_z
    heavy = 8000.0 / 7700.0
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
        "density 8000 kg/m³": replace(
            steel,
            mass=heavy * steel.mass,
            inertia_x=heavy * steel.inertia_x,
            inertia_y=heavy * B,
            inertia_z=heavy * C,
        ),
        "density 8000 kg/m³ for the mass alone": replace(steel, mass=heavy * steel.mass),
        "infinitely thin disk": Disk.ring(
            radius=0.045, hole_radius=0.015, hole_distance=0.02, thickness=1e-6, density=7.7e7
        ),
        "B about S": replace(steel, inertia_y=B - shift),
        "C about S": replace(steel, inertia_z=C - shift),
        "B and C about S": replace(steel, inertia_y=B - shift, inertia_z=C - shift),
        "B and C shifted the wrong way": replace(steel, inertia_y=B + shift, inertia_z=C + shift),
        "A and B exchanged": replace(steel, inertia_x=B, inertia_y=steel.inertia_x),
    }


def _abbreviation(D: float) -> Change:
    """With another number for the abbreviation D = A - B - C of Eq. (50)."""
    other = printed_matrices(**paper_numbers(_PAPER), D=D)["G_h"]
    return lambda printed: printed | {"G_h": other}


_A, _B, _C = STEEL_DISK.inertia_x, STEEL_DISK.inertia_y, STEEL_DISK.inertia_z

MATRIX_CHANGES: Mapping[str, Change] = MappingProxyType(
    {
        "(53) and (54) with the printed signs": lambda printed: (
            printed | {"D_C": -printed["D_C"], "B_C": -printed["B_C"]}
        ),
        "(53) with the printed sign": lambda printed: printed | {"D_C": -printed["D_C"]},
        "(54) with the printed sign": lambda printed: printed | {"B_C": -printed["B_C"]},
        "without B_C": lambda printed: printed | {"B_C": 0.0 * printed["B_C"]},
        "without the symmetric part of B_C": lambda printed: (
            printed | {"B_C": (printed["B_C"] - printed["B_C"].T) / 2}
        ),
        "without the skew part of B_C": lambda printed: (
            printed | {"B_C": (printed["B_C"] + printed["B_C"].T) / 2}
        ),
        "D = -(A - B - C)": _abbreviation(_B + _C - _A),
        "D = A - B + C": _abbreviation(_A - _B + _C),
        "D = A + B - C": _abbreviation(_A + _B - _C),
        "D = B - A - C": _abbreviation(_B - _A - _C),
        "D = -C": _abbreviation(-_C),
    }
)
"""Changes of the matrices by misprints or slips, by their names."""
