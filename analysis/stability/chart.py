"""Stability of the full system over spin and friction gradient, beyond the paper.

The linear system depends on friction through the gradient mu / epsilon of the friction law at
zero slip alone.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from analysis.mechanics.paper import paper_numbers
from analysis.problem.checks import (
    Array,
    finite_row,
    not_negative,
    spin_array,
    within,
)
from analysis.problem.friction import ViscousFriction
from analysis.problem.quantities import STEEPEST_FRICTION
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.stability.linearisation import ROUND_OFF, require_spinning
from analysis.stability.spectra import full_matrices


def with_gradient(scenario: Scenario, gradient: float) -> Scenario:
    """Scenario with a friction law of this gradient mu / epsilon in s/m at zero slip."""
    return replace(scenario, friction=ViscousFriction(viscosity=gradient))


def stability_chart(
    scenario: Scenario,
    spins: npt.ArrayLike,
    gradients: npt.ArrayLike,
    motion: Motion = "inverted",
) -> npt.NDArray[np.int_]:
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

    Returns
    -------
    ndarray of int, shape (m, n)
        Eigenvalues with positive real part; the drift pair +-i spin is no part of the count.

    Raises
    ------
    ValueError
        If spins or gradients are empty or not finite, a gradient is negative, the motion is
        unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    spins = spin_array(spins)
    gradients = gradient_array(gradients)
    not_negative("gradients", float(np.min(gradients)))
    unstable = np.empty((gradients.size, spins.size), dtype=int)
    for row, gradient in enumerate(gradients.tolist()):
        matrices = full_matrices(scenario, spins, motion, gradient=gradient)
        values = np.linalg.eigvals(matrices)
        floor = ROUND_OFF * np.max(np.abs(values), axis=1, keepdims=True)
        unstable[row] = np.sum(values.real > floor, axis=1)
    return unstable


def gradient_array(values: npt.ArrayLike) -> Array:
    """Friction gradients, shape (n,), none of them steeper than a law may be."""
    result = finite_row("gradients", values)
    within("gradients", float(np.max(result)), 0.0, STEEPEST_FRICTION)
    return result


def static_gradient(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> Array:
    """Friction gradient at which a real eigenvalue is zero, in s/m, shape (n,), in closed form.

    An eigenvalue is zero where det(K + N) = 0 in Eq. (55). The determinant is quadratic in
    d = mu m g / epsilon without a linear term:

        d² ((B - A + m e r) Omega² + m e g) ((C - A + 2 m e r + m r²) Omega² + m g (r + e))
        = (m Omega)² ((A - B_bar) Omega² - m e g) ((C - A - m e²) Omega² + m g (r + e)).

    An odd number of eigenvalues is unstable where the left side is smaller than the right one:
    where the factor of d² is positive, as for inverted spinning of the paper's disk, that is below
    the gradient found, and the disk falls over without oscillating; else above. Where there is no
    such gradient the result is nan; so it is at every spin for noninverted spinning of a flat
    disk (C = A + B_bar) with A >= B_bar, whose right side is positive and whose left side is not:
    it is unstable at every spin and with every friction.

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
    Omega2 = spin_array(spins) ** 2
    m, r, e, A, B, C, mg = paper_numbers(scenario, motion).values()
    B_bar = scenario.disk.inertia_about_cog[1]
    left = ((B - A + m * e * r) * Omega2 + mg * e) * (
        (C - A + 2 * m * e * r + m * r**2) * Omega2 + mg * (r + e)
    )
    right = ((A - B_bar) * Omega2 - mg * e) * ((C - A - m * e**2) * Omega2 + mg * (r + e))
    exists = left * right > 0.0
    ratio = np.divide(right, left, out=np.full_like(left, np.nan), where=exists)
    return np.sqrt(Omega2 * ratio) / scenario.table.gravity
