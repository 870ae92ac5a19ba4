"""Stability of the full system over spin and friction gradient, beyond the paper.

The linear system depends on friction through the gradient mu / epsilon of the friction law at
zero slip alone.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from analysis.data.checks import not_negative
from analysis.data.friction import ViscousFriction
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.linearisation import ROUND_OFF, finite_row, spin_array
from analysis.stability.printed import full_matrices


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
    spins = spin_array(spins)
    gradients = finite_row("gradients", gradients)
    not_negative("gradients", float(np.min(gradients)))
    unstable = np.empty((gradients.size, spins.size), dtype=int)
    for row, gradient in enumerate(gradients.tolist()):
        matrices = full_matrices(scenario, spins, motion, gradient=gradient)
        values = np.linalg.eigvals(matrices)
        floor = ROUND_OFF * np.max(np.abs(values), axis=1, keepdims=True)
        unstable[row] = np.sum(values.real > floor, axis=1)
    return unstable
