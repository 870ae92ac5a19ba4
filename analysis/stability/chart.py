"""Stability of the full system over spin and friction gradient, beyond the paper.

The linear system depends on friction through the gradient mu / epsilon of the friction law at
zero slip alone.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, float_array
from analysis.data.friction import ViscousFriction
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.linear_full import full_system, signed_eccentricity
from analysis.stability.linearisation import ROUND_OFF, require_spinning, spin_array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StabilityChart:
    """Number of unstable eigenvalues over a grid.

    Parameters
    ----------
    motion : {"inverted", "noninverted"}
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s.
    gradients : ndarray, shape (m,)
        Friction gradients mu / epsilon in s/m.
    unstable : ndarray of int, shape (m, n)
        Eigenvalues with positive real part; the drift pair +-i spin is no part of the count.
    """

    motion: Motion
    spins: Array
    gradients: Array
    unstable: npt.NDArray[np.int_]


def with_gradient(scenario: Scenario, gradient: float) -> Scenario:
    """Scenario with a friction law of this gradient mu / epsilon in s/m at zero slip."""
    return replace(scenario, friction=ViscousFriction(viscosity=gradient))


def gradient_matrices(scenario: Scenario, spins: Array, gradient: float, motion: Motion) -> Array:
    """State matrices of the full system without the drift pair, shape (n, 6, 6)."""
    return full_system(scenario, spins, motion, gradient=gradient).relevant_matrices


def stability_chart(
    scenario: Scenario,
    spins: npt.ArrayLike,
    gradients: npt.ArrayLike,
    motion: Motion = "inverted",
) -> StabilityChart:
    """Count the unstable eigenvalues of the full system over spin and friction gradient.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table. The gradients take the place of its friction.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s.
    gradients : array_like, shape (m,)
        Friction gradients mu / epsilon in s/m, not negative.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If spins or gradients are empty or not finite, a gradient is negative, the motion is
        unknown or the scenario another one.
    """
    spins = spin_array(spins)
    gradients = _gradient_array(gradients)
    unstable = np.empty((gradients.size, spins.size), dtype=int)
    for row, gradient in enumerate(gradients.tolist()):
        values = np.linalg.eigvals(gradient_matrices(scenario, spins, gradient, motion))
        floor = ROUND_OFF * np.max(np.abs(values), axis=1, keepdims=True)
        unstable[row] = np.sum(values.real > floor, axis=1)
    return StabilityChart(motion=motion, spins=spins, gradients=gradients, unstable=unstable)


def _gradient_array(gradients: npt.ArrayLike) -> Array:
    result = np.atleast_1d(float_array("gradients", gradients))
    if result.ndim != 1 or result.size == 0:
        raise ValueError(
            f"gradients must be one-dimensional with at least 1 entry, got shape {result.shape}"
        )
    bad = result[~(np.isfinite(result) & (result >= 0.0))]
    if bad.size:
        raise ValueError(f"gradients must be finite and not negative, got {bad[0]:g}")
    return result


def static_gradient(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> Array:
    """Friction gradient at which a real eigenvalue is zero, in s/m, shape (n,), in closed form.

    An eigenvalue is zero where det(K + N) = 0 in Eq. (55). The determinant is quadratic in
    d = mu m g / epsilon without a linear term:

        d² ((B - A + m e r) Omega² + m e g) ((C - A + 2 m e r + m r²) Omega² + m g (r + e))
        = (m Omega)² ((A - B_bar) Omega² - m e g) ((C - A - m e²) Omega² + m g (r + e)).

    Below the gradient found, an odd number of eigenvalues is unstable: inverted spinning falls
    over without oscillating. Where there is no such gradient the result is nan; so it is at every
    spin for noninverted spinning of a disk with A >= B_bar, whose right side is positive and
    whose left side is not: it is unstable at every spin and with every friction.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table; its friction is not looked at.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    disk = scenario.disk
    Omega2 = spin_array(spins) ** 2
    e = signed_eccentricity(disk, motion)
    m, r, mg = disk.mass, disk.radius, scenario.weight
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    B_bar = disk.inertia_about_cog[1]
    left = ((B - A + m * e * r) * Omega2 + mg * e) * (
        (C - A + 2 * m * e * r + m * r**2) * Omega2 + mg * (r + e)
    )
    right = ((A - B_bar) * Omega2 - mg * e) * ((C - A - m * e**2) * Omega2 + mg * (r + e))
    exists = left * right > 0.0
    ratio = np.divide(right, left, out=np.full_like(left, np.nan), where=exists)
    result: Array = np.sqrt(Omega2 * ratio) / scenario.table.gravity
    return result
