"""From which friction coefficient on Eq. (79) may be singular (Sect. 4.1).

The matrix A_0 of Eq. (79) is singular where w_N^T M^-1 (w_N - mu W_T n) = 0, with the slip
n = gamma_T / (|gamma_T| + epsilon), shorter than 1. With a slip in the worst direction that is at
mu = w_N^T M^-1 w_N / (|W_T^T M^-1 w_N| |n|); below the same ratio with |n| = 1 it cannot be.
"""

from collections.abc import Sequence
from math import inf

import numpy as np
import pandas as pd
from scipy.optimize import bisect, minimize

from analysis import STEEL_DISK, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from analysis.mechanics import paper
from mbs_models import Scene
from validation.run import run
from validation.studies.claims.grades import Judged, grade
from validation.studies.claims.motion import LATER, LONG
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


def bound() -> tuple[float, float, float]:
    """Smallest coefficient at which A_0 is singular in any attitude, and beta, gamma there."""

    def ratio(angles: Sequence[float] | Array) -> float:
        normal, tangential = _responses(np.array((0.0, 0.0, 0.0, 0.0, *angles)))
        return float(normal / np.linalg.norm(tangential))

    starts = [
        (b, g) for b in np.linspace(0.1, np.pi - 0.1, 12) for g in np.linspace(-3.0, 3.0, 13)
    ]
    best = minimize(ratio, min(starts, key=ratio), method="Nelder-Mead", tol=1e-10)
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
        scenario = Scenario(friction=law, start=start)
        scene = Scene(scenario, "euler-tree")
        return [each is not None for each in solutions(scene, scenario.initial_state)]

    return [
        inf
        if solved(STRONGEST)[side]
        else bisect(lambda mu, on=side: solved(mu)[on] - 0.5, 0.0, STRONGEST, xtol=0.1 * APART)
        for side in (0, 1)
    ]


def along(motion: Trajectory, *, any_slip: bool) -> Array:
    """Smallest coefficient at which A_0 is singular at each sample, shape (n,).

    Parameters
    ----------
    motion : Trajectory
    any_slip : bool
        With the worst slip at this position, instead of the slip of the motion. Infinite where
        friction with the slip of the motion presses the disk away from the table.
    """
    result = np.empty(motion.times.size)
    for row, (z, u) in enumerate(zip(motion.coordinates, motion.rates, strict=True)):
        normal, tangential = _responses(z)
        pressing = float(np.linalg.norm(tangential))
        if not any_slip:
            slip = paper.tangential_directions(STEEL_DISK, z).T @ u
            finest = motion.scenario.friction.finest_speed
            pressing = tangential @ slip / (np.linalg.norm(slip) + finest)
        result[row] = normal / pressing if pressing > 0.0 else inf
    return result


def measure(end: float) -> list[Row]:
    """The bound, where either side loses its solution, and what Table 3's motion passes."""
    coefficient, beta, gamma = bound()
    engine, inhouse = losses(beta, gamma)
    times = np.linspace(0.0, end, round(100 * end) + 1)
    scenario = Scenario(friction=SmoothCoulomb(load="contact"))
    passed = run(scenario, times, source="in-house", local_tolerance=1e-6)
    row = {"bound": coefficient, "beta": beta, "gamma": gamma, "engine": engine}
    row |= {"in_house": inhouse}
    row["of_motion"] = scenario.friction.gradient * scenario.friction.finest_speed
    for name in ("worst", "slip"):
        least = along(passed, any_slip=name == "worst")
        row |= {f"{name}_early": np.min(least[times <= LATER]), name: np.min(least)}
    return [row]


CONTACT_MATRIX = Study(
    name="contact-matrix",
    cases=lambda: {"Table 3, load λ_N": LONG},
    measure=measure,
)


def judge(table: pd.DataFrame) -> Judged:
    """Section 4.1: A_0 is not guaranteed to be invertible."""
    (row,) = table.to_dict("records")
    lost = [row[side] < STRONGEST for side in ("engine", "in_house")]
    return {"row": row, "verdict": grade(yes=all(lost), partly=any(lost))}


def checks(table: pd.DataFrame) -> list[Check]:
    """Whether both sides lose their solution where the formula says."""
    (row,) = table.to_dict("records")
    return [
        at_most(f"contact matrix: loss of the {side}", abs(row[side] - row["bound"]), APART)
        for side in ("engine", "in_house")
    ]
