"""From which friction coefficient on Eq. (79) may be singular (Sect. 4.1).

The matrix A_0 of Eq. (79) is singular where w_N^T M^-1 (w_N - mu W_T n) = 0, with the slip
n = gamma_T / (|gamma_T| + epsilon), shorter than 1. With a slip in the worst direction that is at
mu = w_N^T M^-1 w_N / (|W_T^T M^-1 w_N| |n|); below the same ratio with |n| = 1 it cannot be.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from analysis import STEEL_DISK, SmoothCoulomb, Trajectory
from analysis.data.checks import Array
from analysis.mechanics import paper
from validation.studies.claims.claim import Claim, grade


def least_coefficients(run: Trajectory, *, any_slip: bool) -> Array:
    """Smallest coefficient at which A_0 is singular at each sample, shape (n,).

    Parameters
    ----------
    run : Trajectory
    any_slip : bool
        With the worst slip at this position, instead of the slip of the motion. Infinite where
        friction with the slip of the motion presses the disk away from the table.
    """
    result = np.empty(run.times.size)
    for row, (z, u) in enumerate(zip(run.coordinates, run.rates, strict=True)):
        normal, tangential = _responses(z)
        if any_slip:
            result[row] = normal / np.linalg.norm(tangential)
            continue
        slip = paper.tangential_directions(run.scenario.disk, z).T @ u
        pressing = tangential @ slip / (np.linalg.norm(slip) + run.scenario.friction.finest_speed)
        result[row] = normal / pressing if pressing > 0.0 else np.inf
    return result


def _responses(z: Array) -> tuple[float, Array]:
    """Normal acceleration of the contact point by a unit force along the normal, and by W_T."""
    normal = paper.normal_direction(STEEL_DISK, z)
    response = np.linalg.solve(paper.mass_matrix(STEEL_DISK, z), normal)
    return float(normal @ response), paper.tangential_directions(STEEL_DISK, z).T @ response


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """Smallest coefficient at which A_0 is singular in any attitude, and that attitude in rad."""

    coefficient: float
    beta: float
    gamma: float


def bound() -> Bound:
    """Search all attitudes; where the disk lies does not matter."""

    def ratio(angles: Sequence[float] | Array) -> float:
        normal, tangential = _responses(np.array((0.0, 0.0, 0.0, 0.0, *angles)))
        return float(normal / np.linalg.norm(tangential))

    starts = [
        (b, g) for b in np.linspace(0.1, np.pi - 0.1, 12) for g in np.linspace(-3.0, 3.0, 13)
    ]
    best = minimize(ratio, min(starts, key=ratio), method="Nelder-Mead", tol=1e-10)
    return Bound(coefficient=float(best.fun), beta=float(best.x[0]), gamma=float(best.x[1]))


def is_singular(least: Bound) -> bool:
    """Whether the determinant of A_0 changes its sign at a bound, with the worst slip there."""
    if not np.isfinite(least.coefficient):
        return False
    z = np.array((0.0, 0.0, 0.0, 0.0, least.beta, least.gamma))
    normal = paper.normal_direction(STEEL_DISK, z)
    _, tangential = _responses(z)
    # Of unit length, as epsilon goes to zero.
    slip = tangential / np.linalg.norm(tangential)
    friction = paper.tangential_directions(STEEL_DISK, z) @ slip
    mass = paper.mass_matrix(STEEL_DISK, z)

    def determinant(coefficient: float) -> float:
        force = normal - coefficient * friction
        return float(np.linalg.det(np.block([[mass, -force[:, None]], [normal, np.zeros(1)]])))

    below, above = (determinant(part * least.coefficient) for part in (0.999, 1.001))
    return below * above < 0.0


def claim(run: Trajectory, least: Bound) -> Claim:
    """Section 4.1: A_0 is not guaranteed to be invertible.

    Parameters
    ----------
    run : Trajectory
        From Table 3, with the contact force as the load.
    least : Bound
    """
    early = run.times <= 2.0
    worst, actual = (least_coefficients(run, any_slip=any_slip) for any_slip in (True, False))
    friction = run.scenario.friction
    assert isinstance(friction, SmoothCoulomb)
    return Claim(
        place="Sect. 4.1",
        statement="the matrix of (79) is not guaranteed to be invertible",
        criterion="there is an attitude and a coefficient at which it is singular; no: there is "
        "none",
        measured=f"possible from μ = {least.coefficient:.4f} on, at β = {least.beta:.3f} and "
        f"γ = {least.gamma:.3f} rad, in no attitude below. At the places that Table 3's motion "
        f"(μ = {friction.coefficient:g}) passes within 2 s, the worst slip needs "
        f"μ = {np.min(worst[early]):.2f}, the slip it has μ = {np.min(actual[early]):.0f}; "
        f"until {run.times[-1]:g} s {np.min(worst):.2f} and {np.min(actual):.1f}",
        verdict=grade(yes=is_singular(least)),
    )
