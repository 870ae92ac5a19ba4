"""What is measured: eigenvalues, critical speeds and their variants, and the stable region."""

from collections.abc import Callable, Iterator
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
    Scenario,
    SmoothCoulomb,
)
from analysis.mechanics.paper import closed_form, critical_speed
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.stability import spectra
from analysis.stability.boundaries import corners, hopf_curves
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Spectra, critical_speeds
from analysis.stability.linearisation import ComplexArray
from mbs_models import Scene
from validation.comparison.limits import largest
from validation.studies.comparisons import distance, engine_matrices, gaps, spinning
from validation.studies.stability.variants import PRINTED, reproduces, variants
from validation.study import Row, Study

SPIN = 30.0
"""Spin in rad/s at which single eigenvalues are looked at."""

CHECKED_SPINS = np.linspace(0.0, 60.0, 25)
"""Spins of the comparison for the models of the paper in rad/s."""

FEW_SPINS = np.array([0.0, 17.0, 30.0, 60.0])
"""Those for all other sets of constraints."""

INTERVAL = (0.0, 60.0)
"""Spins in rad/s between which critical and stable ones are looked for."""

PAPER_GRADIENT = 3.0
"""The paper's friction gradient in s/m."""

OWN = "worst distance of a right one to its nearest"
"""Column with how far the engine's own eigenvalues are off, relative to max(|λ|, 1)."""

STABLE = "stable spins in rad/s"
"""Column with where a motion is stable by the in-house eigenvalues, in words."""

# --- Eigenvalues of the engine ------------------------------------------------------------------


def scenes() -> dict[str, Scene]:
    """Every possible set of constraints in each formulation of the engine."""
    scenarios = [Scenario(constraints=held) for held in POSSIBLE_SETS]
    found = [Scene(each, way) for each in scenarios for way in mbs_models.formulations(each)]
    return {f"{each.scenario.name}, {each.built_as}": each for each in found}


def compare(scene: Scene) -> Iterator[Row]:
    """Eigenvalues of both motions on both sides, and those of the engine's own function."""
    scenario, formulation = scene.scenario, scene.built_as
    spins = FEW_SPINS if scenario.model is None else CHECKED_SPINS
    at = spins.tolist().index(SPIN)
    free = tuple(each for each in scenario.constraints if each != "constant-spin")
    for motion in MOTIONS:
        expected = spectra.eigenvalues(scenario, spins, motion=motion)
        matrices = engine_matrices(scenario, spins, formulation=formulation, motion=motion)
        found = np.linalg.eigvals(matrices).astype(complex)
        started = spinning(scenario, SPIN, formulation=formulation, motion=motion)
        stock = mbs_models.stock_eigenvalues(started)
        yield {
            "motion": motion,
            "constraints": scenario.name,
            "formulation": formulation,
            "eigenvalues": expected.shape[1],
            OWN: np.max(np.min(gaps(stock, found[at]), axis=0)),
            "is constrained": scene.has_constraints,
            "but for the spin": Scenario(constraints=free).name,
            STABLE: critical_speeds(scenario, INTERVAL, motion=motion).where,
            "difference": largest(map(distance, found, expected)),
            "spins": spins,
            "real": found.real,
            "imag": found.imag,
        }


EIGENVALUES = Study(name="eigenvalues", cases=scenes, measure=compare)

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

CLOSED, COMPUTED, FREQUENCY, BORN, LIMIT, *OTHERS = IN_PAPER
HOPF, RUBBING = OTHERS[:2], OTHERS[2:]

THIRD = "largest Re λ₃ from 0 to 50 rad/s"
"""Of which Section 6 prints a bound alone."""

HERE, TABLE_1, ENGINE = "unrounded disk", "Table 1", "engine"
"""Columns with what is found: in-house for either disk, and in the engine for the first."""


def paper() -> dict[str, Scenario]:
    """The one case of a study of the paper's scenario."""
    return {"paper": Scenario()}


def printed_numbers(_: Any) -> Iterator[Row]:
    """Every printed number of Sections 3 and 6 beside what is found."""
    sides = {
        HERE: in_house_numbers(STEEL_DISK),
        TABLE_1: in_house_numbers(ROUNDED_STEEL_DISK),
        ENGINE: numbers(STEEL_DISK, lambda scenario: partial(engine_matrices, scenario)),
    }
    for name in (*IN_PAPER, THIRD):
        found = {side: values.get(name) for side, values in sides.items()}
        yield {"quantity": name, "printed": IN_PAPER.get(name), **found}


def rounds_to(value: float, printed: str) -> bool:
    """Whether a number is a printed one, with or without its unit, in the digits of that.

    Examples
    --------
    >>> rounds_to(30.9168, "30.92 rad/s"), rounds_to(30.8866, "30.92 rad/s")
    (True, False)
    >>> rounds_to(-1584.5, "-1.5e3"), rounds_to(0.43542, "0.435")
    (False, True)
    """
    number, *_ = printed.split()
    digits = sum(each.isdigit() for each in number.partition("e")[0].lstrip("-0."))
    return float(f"{value:.{digits}g}") == float(number)


def in_house_numbers(disk: Body) -> dict[str, float]:
    """Those of the in-house systems, in closed form where the paper has one."""
    reduced = Scenario(constraints=MODELS[4], disk=disk)
    closed = critical_speed(reduced)
    return numbers(disk, spectra.matrices_over_spin) | {
        CLOSED: closed.spin,
        FREQUENCY: closed.frequency,
        LIMIT: float(closed_form(reduced, [SPIN])[0, 2].real),
    }


def numbers(disk: Body, matrices: Callable[[Scenario], spectra.Matrices]) -> dict[str, float]:
    """Numbers of Sections 3 and 6 from state matrices alone, by the names of `IN_PAPER`."""
    reduced, full = (Scenario(constraints=MODELS[level], disk=disk) for level in (4, 1))

    def real(scenario: Scenario, spins: Array, smoothing: float = 0.1) -> Array:
        """Real parts of eigenvalues in 1/s, rising, shape (n, k)."""
        rubbing = replace(scenario, friction=SmoothCoulomb(smoothing=smoothing))
        return np.sort(np.linalg.eigvals(matrices(rubbing)(spins)).real)

    at = np.array([SPIN])
    slow = Spectra(matrices(reduced), np.linspace(10.0, 32.0, 23))
    crossing, birth = slow.crossings()[0], slow.pair_changes()[0]
    hopf = Spectra(matrices(full), np.linspace(26.0, 31.0, 11)).crossings()
    rubbing = [real(full, at, each)[0, 1::-1] for each in (0.1, 0.01)]
    return {
        COMPUTED: crossing.spin,
        FREQUENCY: crossing.frequency,
        BORN: birth.spin,
        # The error is of the order of the squared ratio of the smoothing speeds.
        LIMIT: real(reduced, at, 1e-4)[0, 0] * 1e-4 / 0.1,
        **{name: each.spin for name, each in zip(HOPF, hopf, strict=True)},
        **dict(zip(RUBBING, np.ravel(rubbing), strict=True)),
        THIRD: np.max(real(reduced, np.linspace(0.0, 50.0, 26))[:, 0]),
    }


NUMBERS = Study(name="critical-speeds", cases=paper, measure=printed_numbers)

SPEEDS = "Hopf speeds in rad/s"


def try_variants(_: Any) -> Iterator[Row]:
    """Hopf speeds of what could have been chosen otherwise or slipped in by mistake."""
    for name, crossings in variants().items():
        yield {
            "variant": name,
            SPEEDS: ", ".join(f"{each.spin:.3f}" for each in crossings),
            "decays": ", ".join(each.stable_side for each in crossings),
            "both as printed": "yes" if reproduces(crossings) else "no",
        }


VARIANTS = Study(name="hopf-variants", cases=paper, measure=try_variants)


# --- The stable region --------------------------------------------------------------------------

MEETING = {
    "double zero": "a Hopf curve starts on that of real eigenvalues",
    "zero hopf": "a Hopf curve crosses that of real eigenvalues",
    "double hopf": "two Hopf curves cross",
}

INSIDE = "inside"

GRADIENTS = np.geomspace(0.3, 30.0, 21)
"""Friction gradients in s/m at which Hopf curves are looked for."""


def stable_region(scenario: Scenario) -> Iterator[Row]:
    """Boundaries and corners of the stable region, and points inside and outside of it.

    The inner point is the mean of the corners, in the spin and the logarithm of the gradient; the
    outer ones mirror it in the middles of the edges, and one has the paper's gradient.
    """
    for number, each in enumerate(hopf_curves(scenario, GRADIENTS)):
        curve = {"spins": each.spins, "gradients": each.gradients}
        yield {"kind": "curve", "place": str(number), **curve}
    met = corners(scenario, GRADIENTS)
    for corner in met:
        where = {"spin": corner.spin, "gradient": corner.gradient}
        yield {"kind": "corner", "place": MEETING[corner.kind], **where}
    places = np.array([(corner.spin, np.log(corner.gradient)) for corner in met])
    middle = np.mean(places, axis=0)
    edges = (np.sum(places, axis=0) - places) / (len(places) - 1)
    points = {f"beyond edge {n}": 2.0 * edge - middle for n, edge in enumerate(edges, 1)}
    points |= {INSIDE: middle, "at the paper's gradient": (middle[0], np.log(PAPER_GRADIENT))}
    for name, (spin, log_gradient) in points.items():
        where = {"spin": float(spin), "gradient": float(np.exp(log_gradient))}
        yield {"kind": "point", "place": name, **where, **growth(scenario, **where)}


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


REGION = Study(name="stable-region", cases=paper, measure=stable_region)
