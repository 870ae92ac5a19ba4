"""From which friction coefficient on Eq. (79) may be singular (Sect. 4.1).

The matrix A_0 of Eq. (79) is singular where w_N^T M^-1 (w_N - mu W_T n) = 0, with the slip
n = gamma_T / (|gamma_T| + epsilon), shorter than 1. With a slip in the worst direction that is at
mu = w_N^T M^-1 w_N / (|W_T^T M^-1 w_N| |n|); below the same ratio with |n| = 1 it cannot be.
"""

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import bisect, minimize

from analysis import STEEL_DISK, Scenario, SmoothCoulomb, Start
from analysis.data.checks import Array
from analysis.data.trajectory import SOURCES
from analysis.mechanics import paper
from mbs_models import Scene
from validation.studies.claims.grades import Judged, grade
from validation.studies.comparisons import solutions
from validation.study import Check, Row, Study, at_most

STRONGEST = 10.0
"""Largest friction coefficient that is tried."""

APART = 1e-6
"""By which the coefficients at which a side loses its solution may differ from the formula."""


def _responses(z: Array) -> tuple[float, Array]:
    """Normal acceleration of the contact point by a unit force along the normal, and by W_T."""
    normal = paper.normal_direction(STEEL_DISK, z)
    response = np.linalg.solve(paper.mass_matrix(STEEL_DISK, z), normal)
    return float(normal @ response), paper.tangential_directions(STEEL_DISK, z).T @ response


def singular_from(angles: Sequence[float] | Array) -> float:
    """Smallest coefficient at which A_0 is singular with beta and gamma in rad, for any slip."""
    normal, tangential = _responses(np.array((0.0, 0.0, 0.0, 0.0, *angles)))
    return float(normal / np.linalg.norm(tangential))


def bound() -> tuple[float, float, float]:
    """Smallest coefficient at which A_0 is singular in any attitude, and beta, gamma there."""
    starts = [
        (b, g) for b in np.linspace(0.1, np.pi - 0.1, 12) for g in np.linspace(-3.0, 3.0, 13)
    ]
    start = min(starts, key=singular_from)
    best = minimize(singular_from, start, method="Nelder-Mead", tol=1e-10)
    return float(best.fun), float(best.x[0]), float(best.x[1])


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


def measure(_: Any) -> list[Row]:
    """The bound, and where either side loses its solution."""
    coefficient, beta, gamma = bound()
    engine, inhouse = losses(beta, gamma)
    row = {"bound": coefficient, "beta": beta, "gamma": gamma}
    return [row | {"engine": engine, "in-house": inhouse}]


CONTACT_MATRIX = Study(
    name="contact-matrix", cases=lambda: {"worst attitude": None}, measure=measure
)


def judge(table: pd.DataFrame) -> Judged:
    """Section 4.1: A_0 is not guaranteed to be invertible."""
    row = table.iloc[0]
    lost = [row[side] < STRONGEST for side in SOURCES]
    return {"row": row, "verdict": grade(yes=all(lost), partly=any(lost))}


def checks(table: pd.DataFrame) -> list[Check]:
    """Whether both sides lose their solution where the formula says."""
    row = table.iloc[0]
    return [
        at_most(f"contact matrix: loss of the {side}", abs(row[side] - row["bound"]), APART)
        for side in SOURCES
    ]
