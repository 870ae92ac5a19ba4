"""Eigenvalues of stacks of state matrices, and their branches over the spin.

Branches are followed by continuity of eigenvalue and eigenvector, not by sorting. Between two
neighbouring matrices every eigenvalue is matched to one of the next matrix so that the sum of
the relative distances of the eigenvalues and of the angles between the eigenvectors is smallest.
Where a second match is not much worse, the step is halved; where that does not help, because
eigenvalues meet, the direction in which they moved decides. Where two real eigenvalues collide
and leave as a complex pair, which of them becomes which is a convention: the larger one gets the
positive imaginary part, here and on the way back.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from analysis.data.checks import Array, choice
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.linearisation import (
    ZERO,
    ComplexArray,
    falling,
    has_drift,
    spin_array,
    spin_scale,
    spinning,
)
from analysis.stability.printed import full_matrices, reduced_matrices

System = Literal["full", "reduced", "numeric"]
SYSTEMS: tuple[System, ...] = get_args(System)
"""Eq. (55), for Model 1; Eq. (111), for Model 4; any constraints, linearised by dual numbers."""

Matrices = Callable[[Array], Array]
"""State matrices, shape (n, k, k), at spins in rad/s, shape (n,)."""

_LARGEST_STEP = 0.05
"""Branches are followed in steps of at most this many rad/s, whatever spins are asked for."""

_MOST_STEPS = 20_000
"""Beyond some 1000 rad/s the steps grow, so that the work does not."""

_BISECTIONS = 8
"""How often a step is halved at most in which the matching is not clear."""

_CLEAR = 0.3
"""A match is clear if it costs at most this part of the eigenvalue's next best match."""

_TIE_BREAK = 1e-6
"""Weight of the convention for colliding eigenvalues against distance and angle."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Branches:
    """Eigenvalues ordered into branches over the spin.

    Parameters
    ----------
    spins : ndarray, shape (n,)
        Strictly increasing spinning speeds in rad/s.
    values : ndarray, shape (n, k)
        Eigenvalues in 1/s; one column is one branch.
    """

    spins: Array
    values: ComplexArray


def chosen_system(scenario: Scenario, system: System | None = None) -> System:
    """Return the linear system of a scenario: the given one, or the closed one if there is one.

    Raises
    ------
    ValueError
        If the system is unknown.
    """
    if system is not None:
        return choice("system", system, SYSTEMS)
    closed: dict[int | None, System] = {1: "full", 4: "reduced"}
    return closed.get(scenario.model, "numeric")


def matrices_over_spin(
    scenario: Scenario,
    system: System | None = None,
    motion: Motion = "inverted",
    *,
    drift: bool = False,
) -> Matrices:
    """Return what gives the state matrices of a linear system at any spins.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact; "full" takes that of Model 1 alone, and
        "reduced" that of Model 4.
    system : {"full", "reduced", "numeric"}, optional
        Eq. (55), Eq. (111), or any constraints linearised by dual numbers; by default the one
        that is closed for these constraints, and "numeric" if none is.
    motion : {"inverted", "noninverted"}
    drift : bool
        Whether the drift pair +-i spin stays in, where there is one.

    Raises
    ------
    ValueError
        If the system or the motion is unknown, or the scenario none of this system.
    """
    system = chosen_system(scenario, system)
    choice("motion", motion, MOTIONS)
    if system == "full":
        full_matrices(scenario, 0.0, motion)
        return lambda spins: full_matrices(scenario, spins, motion, drift=drift)
    if system == "reduced":
        reduced_matrices(scenario, 0.0, motion)
        return lambda spins: reduced_matrices(scenario, spins, motion)
    numeric = spinning(scenario, motion)
    return lambda spins: numeric.matrices(spins, drift=drift)


def eigenvalues(
    scenario: Scenario,
    spins: npt.ArrayLike,
    system: System | None = None,
    motion: Motion = "inverted",
) -> ComplexArray:
    """Eigenvalues in 1/s, k = 8, 4, 3, 3 for Models 1 to 4, by falling real and imaginary part.

    The drift pair of a disk whose centre of gravity is not held is exactly +-i spin.

    Parameters
    ----------
    scenario, system, motion
        See `matrices_over_spin`.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, in any order.

    Returns
    -------
    ndarray, complex, shape (n, k)

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the system or the motion is unknown, or the
        scenario none of this system.
    """
    spins = spin_array(spins)
    values = np.linalg.eigvals(matrices_over_spin(scenario, system, motion)(spins))
    if has_drift(scenario.constraints):
        values = np.column_stack((values, 1j * spins, -1j * spins))
    return falling(values)


def branches(
    scenario: Scenario,
    spins: npt.ArrayLike,
    system: System | None = None,
    motion: Motion = "inverted",
) -> Branches:
    """Eigenvalue branches of a linear system over the spin.

    A column means the same branch in every call: branches are followed from spin 0, where they
    are numbered by falling real part, in steps fine enough whatever spins are asked for. Where a
    disk may spin elsewhere on the table, the columns 2 and 3 hold the pair +-i spin of that, which
    is exact and says nothing about stability; for inverted spinning of Model 1 that is the paper's
    numbering, lambda_1 to lambda_8 (Fig. 6).

    Parameters
    ----------
    scenario, system, motion
        See `matrices_over_spin`.
    spins : array_like, shape (n,)
        Strictly increasing spinning speeds in rad/s.

    Raises
    ------
    ValueError
        If spins are not finite or do not increase, the system or the motion is unknown, or the
        scenario none of this system.
    """
    wanted = spin_array(spins)
    if np.any(np.diff(wanted) <= 0.0):
        worst = int(np.argmax(np.diff(wanted) <= 0.0))
        raise ValueError(
            f"spins must increase strictly, got {wanted[worst]:g} before {wanted[worst + 1]:g}"
        )
    low, high = min(0.0, wanted[0]), max(0.0, wanted[-1])
    every = np.union1d(np.append(helper_spins(low, high), 0.0), wanted)
    matrices = matrices_over_spin(scenario, system, motion)
    every, values, vectors = _refine(matrices, every, ZERO * spin_scale(scenario))
    start = int(np.searchsorted(every, 0.0))
    order = _chain(_matches(every, values, vectors), _numbering(values[start]), start)
    values = np.take_along_axis(values, order, axis=1)[np.searchsorted(every, wanted)]
    if has_drift(scenario.constraints):
        values = np.insert(values, [2, 2], np.column_stack((1j * wanted, -1j * wanted)), axis=1)
    return Branches(spins=wanted, values=values)


def helper_spins(low: float, high: float) -> Array:
    """Equally spaced spins from `low` to `high` in rad/s, close enough to follow branches."""
    count = min(int(np.ceil((high - low) / _LARGEST_STEP)), _MOST_STEPS)
    return np.linspace(low, high, count + 1)


def follow(matrices: Array, start: int = 0) -> ComplexArray:
    """Eigenvalues of a stack of real matrices ordered into branches, shape (n, k).

    Parameters
    ----------
    matrices : ndarray, shape (n, k, k)
        Matrices that change little from one to the next.
    start : int
        Index of the matrix whose eigenvalues number the branches, by falling real part; a
        complex pair has neighbouring numbers, the positive imaginary part first.
    """
    values, vectors = _eigen(matrices)
    at = np.arange(len(values), dtype=float)
    order = _chain(_matches(at, values, vectors), _numbering(values[start]), start)
    return np.take_along_axis(values, order, axis=1)


def _eigen(matrices: Array) -> tuple[ComplexArray, ComplexArray]:
    values, vectors = np.linalg.eig(matrices)
    return values.astype(complex), vectors.astype(complex)


def _numbering(values: ComplexArray) -> list[int]:
    """Order by falling real part in which no complex pair starts at an odd position.

    A real eigenvalue that would push a pair there takes the next real one to its side.
    """
    order: list[int] = np.lexsort((-values.imag, -values.real)).tolist()
    for place in range(1, len(order), 2):
        if values[order[place]].imag > 0.0:
            later = (index for index in order[place:] if values[index].imag == 0.0)
            real = next(later, None)
            if real is not None:
                order.remove(real)
                order.insert(place, real)
    return order


def _refine(
    matrices: Matrices, spins: Array, zero: float
) -> tuple[Array, ComplexArray, ComplexArray]:
    """Spins, eigenvalues and eigenvectors, with steps halved where the matching is not clear.

    Eigenvalues below `zero`, as a round disk has several, need not be told apart.
    """
    values, vectors = _eigen(matrices(spins))
    for _ in range(_BISECTIONS):
        clear = _is_clear(_costs(values, vectors))
        none = np.abs(values) < zero
        count = np.sum(none, axis=1)
        clear |= none[:-1] & (count[:-1] == count[1:])[:, None]
        doubtful = np.nonzero(~np.all(clear, axis=1))[0]
        middle = (spins[doubtful] + spins[doubtful + 1]) / 2
        if middle.size == 0:
            break
        more_values, more_vectors = _eigen(matrices(middle))
        order = np.argsort(np.concatenate((spins, middle)))
        spins = np.concatenate((spins, middle))[order]
        values = np.concatenate((values, more_values))[order]
        vectors = np.concatenate((vectors, more_vectors))[order]
    return spins, values, vectors


def _is_clear(cost: Array) -> npt.NDArray[np.bool_]:
    """Whether an eigenvalue has no second match nearly as good as the best, shape (n - 1, k)."""
    best, second = np.moveaxis(np.partition(cost, 1, axis=2)[:, :, :2], 2, 0)
    result: npt.NDArray[np.bool_] = best <= _CLEAR * second
    return result


def _matches(at: Array, values: ComplexArray, vectors: ComplexArray) -> npt.NDArray[np.intp]:
    """Position in the next matrix of every eigenvalue, shape (n - 1, k)."""
    cost = _costs(values, vectors)
    result: npt.NDArray[np.intp] = np.argmin(cost, axis=2)
    # Row by row the best choice: where that takes no eigenvalue twice, it is the best assignment.
    taken_twice = np.any(np.diff(np.sort(result, axis=1), axis=1) == 0, axis=1)
    for index in np.nonzero(taken_twice | ~np.all(_is_clear(cost), axis=1))[0].tolist():
        expected = values[index]
        if index > 0:
            origin = values[index - 1, np.argsort(result[index - 1])]
            stretch = (at[index + 1] - at[index]) / (at[index] - at[index - 1])
            expected = expected + stretch * (expected - origin)
        step = slice(index, index + 2)
        careful = _careful_cost(expected, values[step], vectors[step])
        result[index] = linear_sum_assignment(careful)[1]
    return result


def _careful_cost(expected: ComplexArray, values: ComplexArray, vectors: ComplexArray) -> Array:
    """Cost of the matches of one step, shape (k, k), from extrapolated eigenvalues.

    Where eigenvalues meet, eigenvectors may be no guide and distances tie; the direction in which
    an eigenvalue moved decides first.
    """
    distance = np.abs(expected[:, None] - values[None, 1])
    # Differences below rounding are none, and their quotients would overflow.
    rounding = np.finfo(float).eps * np.max(np.abs(values)) + np.finfo(float).tiny
    next_best = np.maximum(np.partition(distance, 1, axis=1)[:, 1:2], rounding)
    careful: Array = 3.0 * distance / next_best + _costs(values, vectors)[0]
    return careful


def _chain(steps: npt.NDArray[np.intp], first: list[int], start: int) -> npt.NDArray[np.intp]:
    """Positions of the branches in every matrix, shape (n, k), from those in matrix `start`."""
    after, before = [first], [first]
    for step in steps[start:].tolist():
        after.append([step[index] for index in after[-1]])
    for step in np.argsort(steps[:start], axis=1)[::-1].tolist():
        before.append([step[index] for index in before[-1]])
    return np.array(before[:0:-1] + after, dtype=np.intp)


def _costs(values: ComplexArray, vectors: ComplexArray) -> Array:
    """Cost of matching eigenvalue i of a matrix to j of the next, shape (n - 1, k, k)."""
    before, after = values[:-1, :, None], values[1:, None, :]
    size = np.abs(before) + np.abs(after)
    size += 1e-3 * np.max(size, axis=(1, 2), keepdims=True) + np.finfo(float).tiny
    change = after - before
    convention = np.square(change.real + change.imag) / size
    overlap = np.abs(np.swapaxes(vectors[:-1].conj(), 1, 2) @ vectors[1:])
    cost: Array = (np.abs(change) + _TIE_BREAK * convention) / size + 1.0 - overlap
    return cost
