"""Attempts to reproduce the critical speeds of the full system printed in Sect. 3.2.

The paper prints Omega_crit1 = 27.1 and Omega_crit2 = 30.2 rad/s; its equations, with the signs
put right, give 26.87 and 30.10 rad/s. Each variant changes what could have been chosen otherwise
or slipped in by mistake: one thing, but for `ROUNDED_STEEP`. None of them gives both printed
numbers.
"""

from collections.abc import Callable, Mapping

import numpy as np

from analysis.mechanics.paper import first_order, paper_numbers, printed_matrices
from analysis.problem.checks import Array
from analysis.problem.disk import ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.problem.friction import SmoothCoulomb
from analysis.problem.scenario import Scenario
from analysis.stability.critical import Crossing, Spectra

PRINTED = (27.1, 30.2)
"""Omega_crit1 and Omega_crit2 of the full system as printed, in rad/s."""

_SPINS = np.linspace(20.0, 36.0, 641)
_PAPER = paper_numbers(Scenario())
_GRADIENT, _GRAVITY = 3.0, 9.81

SMALL = 0.01
"""Smoothing ε in m/s by which λ₇ and λ₈ come out as printed."""

STEEP = f"ε = {SMALL:g} m/s"
ROUNDED_STEEP = f"Table 1, {STEEP}"

Change = Callable[[dict[str, Array]], dict[str, Array]]
"""From `printed_matrices` to what to use."""


def hopf_speeds(
    numbers: Mapping[str, float] = _PAPER, change: Change = dict, gradient: float = _GRADIENT
) -> tuple[Crossing, ...]:
    """Hopf crossings from 20 to 36 rad/s of the full system with changed matrices.

    Parameters
    ----------
    numbers : mapping
        See `paper_numbers`.
    change : callable
        See `Change`; none by default.
    gradient : float
        Of friction in s/m.
    """
    changed = change(printed_matrices(numbers))
    d = gradient * numbers["mg"]
    found = Spectra(lambda spins: first_order(changed, spins, d), _SPINS).crossings()
    return tuple(crossing for crossing in found if crossing.kind == "hopf")


def variants() -> dict[str, tuple[Crossing, ...]]:
    """Hopf crossings from 20 to 36 rad/s of every variant, by its name."""
    disks = _disks()
    found = {name: hopf_speeds(_PAPER | numbers) for name, numbers in disks.items()}
    for gradient in (2.0, 2.5, 2.83, 4.0):
        found[f"friction gradient {gradient:g} s/m"] = hopf_speeds(gradient=gradient)
    steep = SmoothCoulomb(smoothing=SMALL).gradient
    found[STEEP] = hopf_speeds(gradient=steep)
    found[ROUNDED_STEEP] = hopf_speeds(disks["Table 1 as printed"], gradient=steep)
    for gravity in (9.8, 9.80665, 10.0):
        weight = _PAPER["mg"] * gravity / _GRAVITY
        found[f"gravity {gravity:g} m/s²"] = hopf_speeds(_PAPER | {"mg": weight})
    return found | {name: hopf_speeds(change=change) for name, change in MATRIX_CHANGES.items()}


def reproduces(crossings: tuple[Crossing, ...]) -> bool:
    """Whether the first two crossings round to the printed speeds with the printed directions."""
    found = [(round(crossing.spin, 1), crossing.stable_side) for crossing in crossings]
    return found == [(PRINTED[0], "below"), (PRINTED[1], "above")]


def _disks() -> dict[str, dict[str, float]]:
    """Numbers of other disks, or those in which they differ from the paper's."""
    along, across, about = (_PAPER[name] for name in "ABC")
    shift, heavy = _PAPER["m"] * _PAPER["e"] ** 2, 8000.0 / 7700.0
    heavier = {name: heavy * _PAPER[name] for name in ("m", "mg", "A", "B", "C")}
    ring = Disk.ring(
        radius=0.045, hole_radius=0.015, hole_distance=0.02, thickness=1e-6, density=7.7e7
    )
    rounded = {"m": 0.4355, "mg": 0.4355 * _GRAVITY, "e": 2.55e-3}
    return {
        "equations as they are": {},
        "Table 1 as printed": paper_numbers(Scenario(disk=ROUNDED_STEEL_DISK)),
        "Table 1, rounded the other way": rounded | {"A": 2.485e-4, "B": 2.265e-4, "C": 4.675e-4},
        "infinitely thin disk": paper_numbers(Scenario(disk=ring)),
        "density 8000 kg/m³": heavier,
        "density 8000 kg/m³ for the mass alone": {name: heavier[name] for name in ("m", "mg")},
        "B about S": {"B": across - shift},
        "C about S": {"C": about - shift},
        "B and C about S": {"B": across - shift, "C": about - shift},
        "B and C shifted the wrong way": {"B": across + shift, "C": about + shift},
        "A and B exchanged": {"A": across, "B": along},
    }


def _abbreviated(sign_x: float, sign_y: float, sign_z: float) -> Change:
    """With another sum of the moments of inertia for the abbreviation D = A - B - C of (50)."""
    disk = STEEL_DISK
    other = sign_x * disk.inertia_x + sign_y * disk.inertia_y + sign_z * disk.inertia_z
    return lambda printed: printed | {"G_h": printed_matrices(_PAPER, D=other)["G_h"]}


def _negative(*names: str) -> Change:
    return lambda printed: printed | {name: -printed[name] for name in names}


def _part(sign: float) -> Change:
    """With the symmetric (1) or the skew part (-1) of B_C alone."""
    return lambda printed: printed | {"B_C": (printed["B_C"] + sign * printed["B_C"].T) / 2}


MATRIX_CHANGES: Mapping[str, Change] = {
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
"""Changes of the matrices by misprints or slips, by their names."""
