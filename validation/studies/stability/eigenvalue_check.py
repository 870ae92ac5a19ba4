"""Eigenvalues of the stationary motions in the engine, and how far two sets of them lie apart."""

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

import mbs_models
from analysis import Motion, Scenario, Start
from analysis.problem.checks import Array
from analysis.stability.linearisation import ComplexArray
from mbs_models import Formulation, Scene
from validation.comparison.limits import largest

EIGENVALUE_LIMIT = 1e-6
"""Largest difference that passes, relative to the larger of |lambda| and 1."""


def spinning(
    scenario: Scenario,
    spin: float,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
) -> Scene:
    """Scene that starts on a stationary motion of a scenario."""
    start = Start.stationary(spin, motion)
    return Scene(scenario=replace(scenario, start=start), formulation=formulation)


def engine_matrices(
    scenario: Scenario,
    spins: Array,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
) -> Array:
    """State matrices of the engine over the spin, shape (n, k, k): `mbs_models.state_matrix`."""
    scenes = (
        spinning(scenario, spin, formulation=formulation, motion=motion) for spin in spins.tolist()
    )
    return np.array([mbs_models.state_matrix(scene) for scene in scenes])


def distance(found: ComplexArray, expected: ComplexArray) -> float:
    """Largest difference of two sets of eigenvalues, matched for the smallest sum.

    Relative to the larger of |lambda| and 1; infinite if there are none, not as many in both, or
    one is no number.
    """
    if found.shape != expected.shape or not np.all(np.isfinite([found, expected])):
        return np.inf
    apart = gaps(found, expected)
    return largest(apart[linear_sum_assignment(apart)].tolist())


def gaps(found: ComplexArray, expected: ComplexArray) -> Array:
    """Differences of each of n from each of k eigenvalues, relative as in `distance`, (n, k)."""
    return np.abs(found[:, None] - expected) / np.maximum(np.abs(expected), 1.0)
