"""Tables of the linear stability: printed numbers, variants, corners, sensitivities."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from analysis import (
    LEVELS,
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Motion,
    Scenario,
    SmoothCoulomb,
    Start,
)
from analysis.stability import linear_reduced, spectra
from analysis.stability.corners import Corner
from analysis.stability.critical import CriticalSpeeds, critical_speeds
from analysis.stability.linear_variants import PRINTED, reproduces, variants
from analysis.stability.sensitivities import closed_form_sensitivities, full_sensitivities
from analysis.stability.stable_spins import stable_spins
from validation.kit.tables import Cell, Table

_SPIN = 30.0
_NAMES = {
    "eccentricity": "eccentricity e",
    "inertia_x": "A",
    "inertia_y": "B",
    "inertia_z": "C",
    "radius": "radius r",
    "mass": "mass m",
    "size": "size (all lengths)",
    "friction_gradient": "friction gradient μ/ε",
}


def found_numbers(disk: Disk) -> dict[str, float]:
    """What the in-house systems give for every printed number of Sections 3 and 6."""
    model_1, model_4 = (Scenario(constraints=MODELS[level], disk=disk) for level in (1, 4))
    closed = linear_reduced.critical_speed(model_4)
    limit = linear_reduced.closed_form(model_4, [_SPIN]).a
    reduced = critical_speeds(model_4, (0.0, 60.0), "reduced")
    full = critical_speeds(model_1, (0.0, 60.0), "full").hopf
    strong = replace(model_1, friction=SmoothCoulomb(smoothing=0.01))
    third = spectra.eigenvalues(model_4, np.linspace(0.0, 50.0, 501), "reduced").real
    result = {
        "critical spin, closed form (126)": closed.spin,
        "frequency there (127)": closed.frequency,
        "limit of λ₃ (122)": limit,
        "critical spin, computed": reduced.hopf[0].spin,
        "pair born at": reduced.pair_changes[0].spin,
        "largest Re λ₃, 0 to 50 rad/s": float(np.max(np.min(third, axis=1))),
        "Ω_crit1": full[0].spin,
        "Ω_crit2": full[1].spin,
    }
    for scenario, label in ((model_1, "ε = 0.1 m/s"), (strong, "ε = 0.01 m/s")):
        two = np.sort(spectra.eigenvalues(scenario, [_SPIN], "full")[0].real)[:2]
        result[f"λ₇ at 30 rad/s, {label}"] = float(two[1])
        result[f"λ₈ at 30 rad/s, {label}"] = float(two[0])
    return result


_PRINTED: dict[str, tuple[float, str, str]] = {
    "critical spin, closed form (126)": (30.92, "rad/s", "agrees; Table 1 would give 30.89"),
    "frequency there (127)": (6.9, "rad/s", "misprint: the paper's own formula gives 7.09"),
    "limit of λ₃ (122)": (-129.04, "1/s", "agrees; Table 1 would give -128.79"),
    "critical spin, computed": (31.0, "rad/s", "agrees; equals the closed form exactly"),
    "pair born at": (12.5, "rad/s", "agrees"),
    "largest Re λ₃, 0 to 50 rad/s": (-100.0, "1/s", "the paper says: below -100 throughout"),
    "Ω_crit1": (27.1, "rad/s", "not reproduced, see the variants below"),
    "Ω_crit2": (30.2, "rad/s", "not reproduced, see the variants below"),
    "λ₇ at 30 rad/s, ε = 0.1 m/s": (-9e2, "1/s", "the printed value belongs to ε = 0.01 m/s"),
    "λ₈ at 30 rad/s, ε = 0.1 m/s": (-1.5e3, "1/s", "the printed value belongs to ε = 0.01 m/s"),
    "λ₇ at 30 rad/s, ε = 0.01 m/s": (-9e2, "1/s", "agrees"),
    "λ₈ at 30 rad/s, ε = 0.01 m/s": (-1.5e3, "1/s", "agrees roughly"),
}


def printed_numbers(engine: Mapping[str, float]) -> Table:
    """Every printed number of Sections 3 and 6 beside what is found here.

    Parameters
    ----------
    engine : mapping
        What the engine gives for some of them, by the names of `found_numbers`.
    """
    steel, rounded = found_numbers(STEEL_DISK), found_numbers(ROUNDED_STEEL_DISK)
    return Table.of(
        _PRINTED,
        {
            "quantity": lambda name: name,
            "unit": lambda name: _PRINTED[name][1],
            "paper": lambda name: _PRINTED[name][0],
            "here, unrounded disk": lambda name: steel[name],
            "here, Table 1": lambda name: rounded[name],
            "engine, unrounded disk": engine.get,
            "difference to the paper": lambda name: steel[name] - _PRINTED[name][0],
            "explanation": lambda name: _PRINTED[name][2],
        },
        name="stability-numbers",
        title="Numbers of Sections 3 and 6",
        digits=6,
    )


def variant_table() -> Table:
    """Whether some choice reproduces the two printed Hopf speeds of the full system."""
    rows: list[list[Cell]] = []
    for name, crossings in variants().items():
        described = [f"{c.spin:.3f} (decays {c.stable_side})" for c in crossings]
        rows.append([name, ", ".join(described) or "none", reproduces(crossings)])
    held = sum(bool(row[-1]) for row in rows)
    return Table(
        name="variants",
        title=f"Hopf speeds of the full system from 20 to 36 rad/s; the paper prints "
        f"{PRINTED[0]} (stable below) and {PRINTED[1]} (stable above)",
        columns=("variant", "Hopf speeds in rad/s", "gives both printed speeds"),
        rows=[[*row[:2], "yes" if row[2] else "no"] for row in rows],
        note=f"{held} of {len(rows)} obvious choices give both printed speeds. The matrices, a "
        "numerical linearisation of the nonlinear equations and the engine agree on the first "
        "row.",
    )


def critical_table(found: CriticalSpeeds) -> Table:
    """Critical speeds of one system; each row says what becomes of one eigenvalue or pair."""
    rows: list[list[Cell]] = [
        [
            ("this pair " if crossing.kind == "hopf" else "this real eigenvalue ")
            + ("becomes stable" if crossing.stable_side == "above" else "becomes unstable"),
            crossing.spin,
            crossing.frequency,
        ]
        for crossing in found.crossings
    ]
    rows += [
        [
            "two real eigenvalues become a pair"
            if change.complex_side == "above"
            else "a pair becomes two real eigenvalues",
            change.spin,
            0.0,
        ]
        for change in found.pair_changes
    ]
    return Table(
        name=f"critical-{found.system}-{found.motion}",
        title=f"Single eigenvalues of {found.scenario.name}, {found.system} system, "
        f"{found.motion}, from {found.interval[0]:g} to {found.interval[1]:g} rad/s",
        columns=("as the spin rises", "spin in rad/s", "frequency in rad/s"),
        rows=rows,
        note=found.reason or "",
    )


def stable_table(
    scenario: Scenario, interval: tuple[float, float], motion: Motion = "inverted"
) -> Table:
    """Spins at which a motion is stable as a whole: every eigenvalue decays.

    Parameters
    ----------
    scenario : Scenario
        Its own constraints and those of the four models, with its disk, friction and gravity.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s.
    motion : {"inverted", "noninverted"}
    """
    sets = [MODELS[level] for level in LEVELS]
    if scenario.model is None:
        sets.append(scenario.constraints)
    compared = [replace(scenario, constraints=each, start=Start()) for each in sets]
    return Table(
        name=f"stable-{motion}",
        title=f"Where {motion} spinning is stable, all eigenvalues of a model together, from "
        f"{interval[0]:g} to {interval[1]:g} rad/s",
        columns=("model", "stable spins in rad/s"),
        rows=[[each.name, stable_range(each, interval, motion)] for each in compared],
    )


def stable_range(
    scenario: Scenario, interval: tuple[float, float], motion: Motion = "inverted"
) -> str:
    """Spins at which a motion is stable as a whole, in words."""
    return in_words(stable_spins(scenario, interval, motion=motion))


def in_words(found: Sequence[tuple[float, float]]) -> str:
    """Intervals of the spin in words."""
    return ", ".join(f"{low:.6g} to {high:.6g}" for low, high in found) or "nowhere"


def corner_table(corners: Sequence[Corner]) -> Table:
    """Corners of the region in which inverted spinning is stable."""
    return Table.of(
        corners,
        {
            "kind": lambda corner: corner.kind,
            "spin in rad/s": lambda corner: corner.spin,
            "μ/ε in s/m": lambda corner: corner.gradient,
            "ε at μ = 0.3 in m/s": lambda corner: 0.3 / corner.gradient,
            "frequencies": lambda corner: ", ".join(
                f"{frequency:.3f}" for frequency in corner.frequencies
            ),
        },
        name="corners",
        title="Where the stability boundaries of the full system meet",
        note="Between these three points inverted spinning is asymptotically stable in the full "
        "system, against the paper's conclusion that it always has an unstable subspace; at the "
        "paper's own gradient of 3 s/m that conclusion holds at every spin.",
    )


def sensitivity_table() -> Table:
    """How the critical speeds move with the disk and the friction gradient."""
    scenario = Scenario()
    closed = closed_form_sensitivities(scenario)
    full = [
        each for each in full_sensitivities(scenario, (0.0, 60.0)) if each.crossing.kind == "hopf"
    ]
    return Table(
        name="sensitivities",
        title="Sensitivities of the critical speeds, d ln Ω / d ln p",
        columns=(
            "parameter p",
            f"closed form {linear_reduced.critical_speed(scenario).spin:.3f} rad/s",
            *(f"full system {each.crossing.spin:.3f} rad/s" for each in full),
        ),
        rows=[
            [_NAMES[name], closed[name], *(float(each.values[name]) for each in full)]
            for name in _NAMES
        ],
        note="All other parameters are held; the moments of inertia are those about G.",
    )
