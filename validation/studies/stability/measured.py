"""What is measured: eigenvalues, critical speeds and their variants, and the stable region."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

import mbs_models
from analysis import (
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    ConstraintSet,
    Scenario,
    SmoothCoulomb,
)
from analysis.data.body import Body
from analysis.stability import spectra
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Spectra, critical_speeds
from analysis.stability.hopf_curves import corners, hopf_curves
from analysis.stability.linearisation import ComplexArray
from analysis.stability.printed import closed_form, critical_speed
from mbs_models import Formulation
from validation.kit.limits import largest
from validation.studies.stability.eigenvalue_check import (
    CHECKED_SPINS,
    FEW_SPINS,
    distance,
    engine_matrices,
    gaps,
    spinning,
)
from validation.studies.stability.variants import PRINTED, reproduces, variants
from validation.study import Row, Study

SPIN = 30.0
"""Spin in rad/s at which single eigenvalues are looked at."""

INTERVAL = (0.0, 60.0)
"""Spins in rad/s between which critical and stable ones are looked for."""

PAPER_GRADIENT = 3.0
"""The paper's friction gradient in s/m."""

OWN = "worst distance of a right one to its nearest"
"""Column with how far the engine's own eigenvalues are off, relative to max(|λ|, 1)."""

# --- Eigenvalues of the engine ------------------------------------------------------------------


def scenes() -> dict[str, tuple[ConstraintSet, Formulation]]:
    """Every possible set of constraints in each formulation of the engine."""
    scenarios = [Scenario(constraints=held) for held in POSSIBLE_SETS]
    return {
        f"{scenario.name}, {formulation}": (scenario.constraints, formulation)
        for scenario in scenarios
        for formulation in mbs_models.formulations(scenario)
    }


def compare(case: tuple[ConstraintSet, Formulation]) -> list[Row]:
    """Eigenvalues of both motions on both sides, and those of the engine's own function."""
    scenario, formulation = Scenario(constraints=case[0]), case[1]
    spins = FEW_SPINS if scenario.model is None else CHECKED_SPINS
    at = spins.tolist().index(SPIN)
    free = tuple(each for each in scenario.constraints if each != "constant-spin")
    rows = []
    for motion in MOTIONS:
        expected = spectra.eigenvalues(scenario, spins, motion=motion)
        matrices = engine_matrices(scenario, spins, formulation=formulation, motion=motion)
        found = np.linalg.eigvals(matrices).astype(complex)
        scene = spinning(scenario, SPIN, formulation=formulation, motion=motion)
        own = mbs_models.stock_eigenvalues(scene)
        rows.append(
            {
                "motion": motion,
                "constraints": scenario.name,
                "formulation": formulation,
                "eigenvalues": expected.shape[1],
                OWN: np.max(np.min(gaps(own, found[at]), axis=0)),
                "is constrained": scene.has_constraints,
                "but for the spin": Scenario(constraints=free).name,
                "stable spins in rad/s": critical_speeds(scenario, INTERVAL, motion=motion).where,
                "difference": largest(map(distance, found, expected)),
                "spins": spins,
                "real": found.real,
                "imag": found.imag,
            }
        )
    return rows


EIGENVALUES = Study(name="eigenvalues", cases=scenes, measure=compare, keys=("motion",))

# --- Critical speeds ----------------------------------------------------------------------------

IN_PAPER = {
    "critical speed, reduced, closed form (126)": "30.92 rad/s",
    "the same, by root finding": "31 rad/s",
    "frequency there (127)": "6.9 rad/s",
    "λ₁ and λ₂ become a pair at": "12.5 rad/s",
    "limit of λ₃ (122)": "-129.04 1/s",
    "Ω_crit1, full system": f"{PRINTED[0]} rad/s",
    "Ω_crit2, full system": f"{PRINTED[1]} rad/s",
    "λ₇ at 30 rad/s, ε = 0.1 m/s": "-9e2 1/s",
    "λ₈ at 30 rad/s, ε = 0.1 m/s": "-1.5e3 1/s",
    "λ₇ at 30 rad/s, ε = 0.01 m/s": "-9e2 1/s",
    "λ₈ at 30 rad/s, ε = 0.01 m/s": "-1.5e3 1/s",
}
"""What Sections 3 and 6 print, in the digits that they give; λ₇ and λ₈ without a smoothing."""

CLOSED, COMPUTED, FREQUENCY, BORN, _, LOWER, UPPER = tuple(IN_PAPER)[:7]


def paper() -> dict[str, Scenario]:
    """The one case of a study of the paper's scenario."""
    return {"paper": Scenario()}


def printed_numbers(_: Any) -> list[Row]:
    """Every printed number of Sections 3 and 6 beside what is found."""
    disks = {"unrounded disk": STEEL_DISK, "Table 1": ROUNDED_STEEL_DISK}
    sides = {name: in_house_numbers(disk) for name, disk in disks.items()}
    sides["engine"] = engine_speeds()
    rows = []
    for name, printed in IN_PAPER.items():
        found = {side: values.get(name) for side, values in sides.items()}
        rows.append({"quantity": name, "paper": printed, **found})
    return rows


def rounds_to(value: float | None, printed: str) -> bool:
    """Whether a number is a printed one in the digits that are printed.

    Examples
    --------
    >>> rounds_to(30.9168, "30.92"), rounds_to(30.8866, "30.92"), rounds_to(-1584.5, "-1.5e3")
    (True, False, False)
    >>> rounds_to(0.43542, "0.435")
    True
    """
    digits = sum(each.isdigit() for each in printed.partition("e")[0].lstrip("-0."))
    return value is not None and float(f"{value:.{digits}g}") == float(printed)


def in_house_numbers(disk: Body) -> dict[str, float]:
    """What the in-house systems give, by the names of `IN_PAPER`."""
    model_1, model_4 = (Scenario(constraints=MODELS[level], disk=disk) for level in (1, 4))
    closed = critical_speed(model_4)
    reduced = critical_speeds(model_4, INTERVAL, "reduced")
    found = [closed.spin, reduced.hopf[0].spin, closed.frequency, reduced.pair_changes[0].spin]
    found.append(float(closed_form(model_4, [SPIN]).a))
    found += [crossing.spin for crossing in critical_speeds(model_1, INTERVAL, "full").hopf]
    for smoothing in (0.1, 0.01):
        rubbing = replace(model_1, friction=SmoothCoulomb(smoothing=smoothing))
        found += np.sort(spectra.eigenvalues(rubbing, [SPIN], "full")[0].real)[1::-1].tolist()
    return dict(zip(IN_PAPER, found, strict=True))


def engine_speeds() -> dict[str, float]:
    """Critical speeds of the engine, by the names of `IN_PAPER`."""
    looked = (MODELS[4], np.linspace(30.0, 32.0, 5)), (MODELS[1], np.linspace(26.0, 31.0, 11))
    found = (
        each.spin
        for held, spins in looked
        for each in Spectra(
            partial(engine_matrices, Scenario(constraints=held)), spins
        ).crossings()
    )
    return dict(zip((COMPUTED, LOWER, UPPER), found, strict=True))


NUMBERS = Study(name="critical-speeds", cases=paper, measure=printed_numbers, keys=("quantity",))


def try_variants(_: Any) -> list[Row]:
    """Hopf speeds of what could have been chosen otherwise or slipped in by mistake."""
    return [
        {
            "variant": name,
            "Hopf speeds in rad/s": ", ".join(
                f"{each.spin:.3f} (decays {each.stable_side})" for each in crossings
            ),
            "both as printed": "yes" if reproduces(crossings) else "no",
        }
        for name, crossings in variants().items()
    ]


VARIANTS = Study(name="hopf-variants", cases=paper, measure=try_variants, keys=("variant",))


# --- The stable region --------------------------------------------------------------------------

MEETING = {
    "double zero": "a Hopf curve starts on that of real eigenvalues",
    "zero hopf": "a Hopf curve crosses that of real eigenvalues",
    "double hopf": "two Hopf curves cross",
}

INSIDE = "inside"

GRADIENTS = np.sort(np.append(np.geomspace(0.3, 30.0, 81), np.linspace(1.045, 1.12, 16)))
"""Friction gradients in s/m at which Hopf points are looked for; more where a curve is level."""


def stable_region(scenario: Scenario) -> list[Row]:
    """Boundaries and corners of the stable region, and points inside and outside of it.

    The inner point is the mean of the corners, in the spin and the logarithm of the gradient; the
    outer ones mirror it in the middles of the edges, and one has the paper's gradient.
    """
    curves = hopf_curves(scenario, GRADIENTS)
    rows: list[Row] = [
        {"kind": "curve", "place": str(number), "spins": each.spins, "gradients": each.gradients}
        for number, each in enumerate(curves)
    ]
    places = []
    for corner in corners(scenario, GRADIENTS[::4]):
        places.append((corner.spin, np.log(corner.gradient)))
        rows.append({"kind": "corner", "place": MEETING[corner.kind], **_place(*places[-1])})
    middle = np.mean(places, axis=0)
    edges = (np.sum(places, axis=0) - places) / (len(places) - 1)
    points = {f"beyond edge {n}": 2.0 * edge - middle for n, edge in enumerate(edges, 1)}
    points |= {INSIDE: middle, "at the paper's gradient": (middle[0], np.log(PAPER_GRADIENT))}
    for name, (spin, log_gradient) in points.items():
        where = _place(spin, log_gradient)
        rows.append({"kind": "point", "place": name, **where, **growth(scenario, **where)})
    return rows


def _place(spin: float, log_gradient: float) -> Row:
    return {"spin": float(spin), "gradient": float(np.exp(log_gradient))}


def growth(scenario: Scenario, *, spin: float, gradient: float) -> dict[str, float]:
    """Largest growth rates in 1/s of inverted spinning on both sides, the drift pair left out."""
    rubbing = with_gradient(scenario, gradient)
    sides: dict[str, ComplexArray] = {
        "in-house": spectra.eigenvalues(rubbing, [spin])[0],
        "engine": mbs_models.eigenvalues(spinning(rubbing, spin)),
    }
    # Those nearest to ±i spin tell of a place on the table alone.
    drift: ComplexArray = np.array((1j * spin, -1j * spin))
    return {
        side: float(np.max(values[np.argsort(np.min(gaps(drift, values), axis=0))[2:]].real))
        for side, values in sides.items()
    }


REGION = Study(name="stable-region", cases=paper, measure=stable_region, keys=("kind", "place"))
