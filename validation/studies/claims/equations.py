"""What the paper says of its equations: Eq. (79) may be singular, and the orders of a closed form.

The matrix A_0 of Eq. (79) is singular where w_N^T M^-1 (w_N - mu W_T n) = 0, with the slip
n = gamma_T / (|gamma_T| + epsilon), shorter than 1. With a slip in the worst direction that is at
mu = w_N^T M^-1 w_N / (|W_T^T M^-1 w_N| |n|); below the same ratio with |n| = 1 it cannot be.
"""

from collections.abc import Sequence
from math import inf, pi

import numpy as np
from scipy.optimize import bisect, brute

from analysis import MODELS, STEEL_DISK, Scenario, SmoothCoulomb, Start
from analysis.mechanics import paper
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES
from mbs_models import Scene
from validation.studies.comparisons import solutions
from validation.study import Check, Row, at_most, grade, within

STRONGEST = 10.0
"""Largest friction coefficient that is tried."""

APART = 1e-6
"""By which the coefficients at which a side loses its solution may differ from the formula."""

SMOOTHINGS = np.geomspace(1e-3, 1e-2, 7)
"""Smoothing speeds in m/s; below, rounding shows in the error of b."""

SPIN = 40.0
"""In rad/s, at which exponents are fitted."""

ORDERS = np.array((-1, 1, 0, 1))
"""Of the smoothing in a = λ₃, b and c of (118), and in a less its limit (119) and (122)."""

CLOSE = 0.05
"""By which a fitted exponent may differ from the paper's."""


# --- Where the contact matrix is singular -------------------------------------------------------


def _responses(z: Array) -> tuple[float, Array]:
    """Normal acceleration of the contact point by a unit force along the normal, and by W_T."""
    normal = paper.normal_direction(STEEL_DISK, z)
    response = np.linalg.solve(paper.mass_matrix(STEEL_DISK, z), normal)
    return float(normal @ response), paper.tangential_directions(STEEL_DISK, z).T @ response


def singular_from(angles: Sequence[float] | Array) -> float:
    """Smallest coefficient at which A_0 is singular with beta and gamma in rad, for any slip."""
    normal, tangential = _responses(np.array((0.0, 0.0, 0.0, 0.0, *angles)))
    return float(normal / np.linalg.norm(tangential))


def losses(beta: float, gamma: float) -> list[float]:
    """Coefficients from which on engine and in-house equations have no solution; else inf.

    The disk slides in the worst direction, without turning and almost without smoothing.
    """
    _, pressing = _responses(np.array((0.0, 0.0, 0.0, 0.0, beta, gamma)))
    x_rate, y_rate = (pressing / np.linalg.norm(pressing)).tolist()
    start = Start(beta=beta, gamma=gamma, spin=0.0, x_rate=x_rate, y_rate=y_rate)

    def solved(coefficient: float) -> list[bool]:
        law = SmoothCoulomb(coefficient=coefficient, smoothing=1e-9, load="contact")
        scene = Scene(Scenario(friction=law, start=start), "euler-tree")
        return [each is not None for each in solutions(scene, scene.scenario.initial_state)]

    return [
        inf
        if solved(STRONGEST)[side]
        else bisect(lambda mu, on=side: solved(mu)[on] - 0.5, 0.0, STRONGEST, xtol=0.1 * APART)
        for side in (0, 1)
    ]


def loss() -> Row:
    """The worst attitude, the smallest coefficient there, and where either side is lost."""
    (beta, gamma), bound, *_ = brute(
        singular_from, ((0.1, pi - 0.1), (-3.0, 3.0)), Ns=13, full_output=True
    )
    engine, inhouse = losses(beta, gamma)
    return {"bound": bound, "beta": beta, "gamma": gamma, "engine": engine, "in-house": inhouse}


def judge_loss(found: Row) -> Row:
    """Section 4.1: A_0 is not guaranteed to be invertible."""
    lost = [found[side] < STRONGEST for side in SOURCES]
    return found | {"verdict": grade(yes=all(lost), partly=any(lost))}


def checks(found: Row) -> list[Check]:
    """Whether both sides lose their solution where the formula says."""
    return [
        at_most(f"contact matrix: loss of the {side}", abs(found[side] - found["bound"]), APART)
        for side in SOURCES
    ]


# --- Orders in the smoothing --------------------------------------------------------------------


def exponents() -> Array:
    """Exponents of the smoothing fitted to what is in `ORDERS`, shape (4,)."""
    sizes = []
    for smoothing in SMOOTHINGS:
        scenario = Scenario(constraints=MODELS[4], friction=SmoothCoulomb(smoothing=smoothing))
        found = np.linalg.eigvals(paper.reduced_matrices(scenario, [SPIN])[0])
        third, lower, upper = np.sort_complex(found)
        a, b, c = third.real, -(lower + upper).real, (lower * upper).real
        sizes.append(np.abs((a, b, c, a - paper.closed_form(scenario, [SPIN])[0, 2].real)))
    return np.polyfit(np.log(SMOOTHINGS), np.log(sizes), 1)[0]


def judge_orders(fitted: Array) -> Row:
    """Section 6: a = O(1/ε), b = O(ε), c = O(1), λ₃ = A_33 + O(ε)."""
    right = np.abs(fitted - ORDERS) <= CLOSE
    return within(np.sum(~right), 0, len(ORDERS) - 1) | {"fitted": fitted}
