"""Stability of the full system over spin and friction gradient, beyond the paper.

The linear system depends on friction through the gradient mu / epsilon of the friction law at
zero slip alone.

Hopf points are the crossings of pairs at each of some gradients. Corners lie where two stability
boundaries meet. Along the curve on which a real eigenvalue is zero, which is known in closed form,
they are the crossings of the other eigenvalues; where two Hopf curves cross, the real parts of
both pairs are zero, two equations for spin and gradient.
"""

from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import root

from analysis.mechanics.paper import paper_numbers
from analysis.problem.checks import (
    Array,
    finite_row,
    not_negative,
    positive,
    spin_array,
    within,
)
from analysis.problem.friction import ViscousFriction
from analysis.problem.quantities import STEEPEST_FRICTION
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.stability.critical import Spectra, spin_interval
from analysis.stability.linearisation import (
    ROUND_OFF,
    ComplexArray,
    require_spinning,
    spin_scale,
)
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
    gradients = _gradients(gradients)
    not_negative("gradients", float(np.min(gradients)))
    unstable = np.empty((gradients.size, spins.size), dtype=int)
    for row, gradient in enumerate(gradients.tolist()):
        matrices = full_matrices(scenario, spins, motion, gradient=gradient)
        values = np.linalg.eigvals(matrices)
        floor = ROUND_OFF * np.max(np.abs(values), axis=1, keepdims=True)
        unstable[row] = np.sum(values.real > floor, axis=1)
    return unstable


def _gradients(values: npt.ArrayLike) -> Array:
    """Friction gradients, shape (n,), none of them steeper than a law may be."""
    result = finite_row("gradients", values)
    within("gradients", float(np.max(result)), 0.0, STEEPEST_FRICTION)
    return result


_SPINS = 1001
"""Spins between which crossings are looked for."""

SPINS = (0.0, 100.0)
"""Lowest and highest spin in rad/s by default."""


Kind = Literal["double hopf", "zero hopf", "double zero"]


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
    Omega2 = spin_array(spins) ** 2
    m, r, e, A, B, C, mg = paper_numbers(scenario, motion).values()
    B_bar = scenario.disk.inertia_about_cog[1]
    left = ((B - A + m * e * r) * Omega2 + mg * e) * (
        (C - A + 2 * m * e * r + m * r**2) * Omega2 + mg * (r + e)
    )
    right = ((A - B_bar) * Omega2 - mg * e) * ((C - A - m * e**2) * Omega2 + mg * (r + e))
    exists = left * right > 0.0
    ratio = np.divide(right, left, out=np.full_like(left, np.nan), where=exists)
    result: Array = np.sqrt(Omega2 * ratio) / scenario.table.gravity
    return result


class HopfCurve(NamedTuple):
    """Hopf points of the full system, at each gradient one.

    Parameters
    ----------
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s.
    gradients : ndarray, shape (n,)
        Friction gradients mu / epsilon in s/m.
    frequencies : ndarray, shape (n,)
        Imaginary part of the crossing pair in rad/s.
    """

    spins: Array
    gradients: Array
    frequencies: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """A point at which two stability boundaries of the full system meet.

    Parameters
    ----------
    kind : {"double hopf", "zero hopf", "double zero"}
        Two Hopf curves cross; a Hopf curve crosses the static curve; a Hopf curve starts there.
    spin : float
        Spinning speed in rad/s.
    gradient : float
        Friction gradient mu / epsilon in s/m.
    frequencies : tuple of float
        Imaginary parts of the critical pairs in rad/s.
    """

    kind: Kind
    spin: float
    gradient: float
    frequencies: tuple[float, ...]


def hopf_curves(
    scenario: Scenario,
    gradients: npt.ArrayLike,
    spins: tuple[float, float] = SPINS,
    motion: Motion = "inverted",
) -> tuple[HopfCurve, ...]:
    """Hopf points of the full system over the friction gradient, told apart by their frequency.

    Two that cancel out within a thousandth of the spins are missed.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table; its friction is not looked at.
    gradients : array_like, shape (n,)
        Friction gradients mu / epsilon in s/m, positive.
    spins : tuple of 2 floats
        Lowest, not negative, and highest spin in rad/s.
    motion : {"inverted", "noninverted"}

    Returns
    -------
    tuple of HopfCurve
        First those of the lowest frequency at each gradient; empty if there is none.

    Raises
    ------
    ValueError
        If an argument is out of range, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    wanted = _gradients(gradients)
    positive("gradients", float(np.min(wanted)))
    grid, scale = np.linspace(*spin_interval(spins, "spins"), _SPINS), spin_scale(scenario)
    lines: dict[int, list[tuple[float, float, float]]] = {}
    for gradient in wanted.tolist():
        matrices = partial(full_matrices, scenario, motion=motion, gradient=gradient)
        found = [
            each for each in Spectra(matrices, grid, scale).crossings() if each.kind == "hopf"
        ]
        found.sort(key=lambda each: each.frequency)
        for rank, each in enumerate(found):
            lines.setdefault(rank, []).append((each.spin, gradient, each.frequency))
    return tuple(HopfCurve(*np.transpose(line)) for line in lines.values())


def corners(
    scenario: Scenario,
    gradients: npt.ArrayLike,
    spins: tuple[float, float] = SPINS,
    motion: Motion = "inverted",
) -> tuple[Corner, ...]:
    """Where stability boundaries of the full system meet, by rising gradient.

    Parameters
    ----------
    scenario, gradients, spins, motion
        See `hopf_curves`; corners lie between the gradients.

    Raises
    ------
    ValueError
        See `hopf_curves`.
    ArithmeticError
        If the place where two curves cross cannot be refined.
    """
    found = []
    for slow, fast in combinations(hopf_curves(scenario, gradients, spins, motion), 2):
        both, here, there = np.intersect1d(slow.gradients, fast.gradients, return_indices=True)
        apart = slow.spins[here] - fast.spins[there]
        for step in np.flatnonzero(apart[:-1] * apart[1:] < 0.0).tolist():
            pairs = slow.frequencies[here[step]], fast.frequencies[there[step]]
            begin = np.array((slow.spins[here[step]], np.log(both[step])))
            found.append(_double_hopf(scenario, motion, begin, pairs))

    def static(spins: Array) -> Array:
        gradients = static_gradient(scenario, spins, motion)
        return full_matrices(scenario, spins, motion, gradient=gradients)

    grid = np.linspace(*spins, _SPINS)
    lies = static_gradient(scenario, grid, motion)
    inside = grid[(lies >= np.min(gradients)) & (lies <= np.max(gradients))]
    for each in Spectra(static, inside, spin_scale(scenario)).crossings() if inside.size else ():
        kind: Kind = "zero hopf" if each.kind == "hopf" else "double zero"
        gradient = float(static_gradient(scenario, each.spin, motion)[0])
        frequencies = (each.frequency,)
        found.append(Corner(kind=kind, spin=each.spin, gradient=gradient, frequencies=frequencies))
    return tuple(sorted(found, key=lambda corner: corner.gradient))


def _double_hopf(
    scenario: Scenario, motion: Motion, begin: Array, frequencies: tuple[float, float]
) -> Corner:
    """Corner near a spin and a logarithm of the gradient, with pairs near these frequencies."""

    def pairs(place: Array) -> ComplexArray:
        matrices = full_matrices(scenario, place[0], motion, gradient=np.exp(place[1]))
        values = np.linalg.eigvals(matrices[0]).astype(complex)
        return values[[np.argmin(np.abs(values - 1j * each)) for each in frequencies]]

    found = root(lambda place: pairs(place).real, begin, tol=1e-13)
    if not found.success:
        raise ArithmeticError(f"no corner near {begin[0]:g} rad/s: {found.message}")
    low, high = pairs(found.x).imag.tolist()
    return Corner(
        kind="double hopf",
        spin=float(found.x[0]),
        gradient=float(np.exp(found.x[1])),
        frequencies=(low, high),
    )
