"""Eigenvalues of stacks of state matrices, and their branches over the spin.

Branches are followed by continuity, not by sorting: in equal steps every eigenvalue goes on as it
has come, and takes the next one that is nearest to where it is expected. Where two real
eigenvalues collide and leave as a complex pair, which of them becomes which is a convention: the
larger one gets the positive imaginary part, here and on the way back.
"""

from collections.abc import Callable
from functools import partial
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from analysis.mechanics import paper
from analysis.problem.checks import Array, choice, increasing, instance, spin_array
from analysis.problem.quantities import Level
from analysis.problem.scenario import Scenario
from analysis.problem.start import MOTIONS, Motion
from analysis.stability.linearisation import (
    ComplexArray,
    falling,
    has_drift,
    require_spinning,
    spin_scale,
    spinning,
)

System = Literal["full", "reduced", "numeric"]
SYSTEMS: tuple[System, ...] = get_args(System)
"""Eq. (55), for Model 1; Eq. (111), for Model 4; any constraints, linearised by dual numbers."""

Matrices = Callable[[Array], Array]
"""State matrices, shape (n, k, k), at spins in rad/s, shape (n,)."""


def full_matrices(
    scenario: Scenario,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
    *,
    gradient: npt.ArrayLike | None = None,
) -> Array:
    """State matrices of the full system, Eqs. (48)-(55), without the drift.

    In the R-frame, which turns with the disk, a place fixed on the table circles with -Omega. That
    gives Eq. (55) the pair of eigenvalues +-i Omega exactly, whatever the friction. In the states
    (beta, gamma, inertial velocity of G along e_x^R and e_y^R, rates of beta and gamma) the place
    does not occur.

    Load "weight" and load "contact" have the same linearisation, because the contact force is m g
    up to second order, Eq. (40).

    Parameters
    ----------
    scenario : Scenario
        Its constraints are not looked at.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
    gradient : float or array_like, shape (n,), optional
        Friction gradient mu / epsilon in s/m, or one for each spin, in place of that of the
        scenario's law.

    Returns
    -------
    ndarray, shape (n, 6, 6)
    """
    spins = np.atleast_1d(spins)
    d = scenario.weight * np.array(scenario.friction.gradient if gradient is None else gradient)
    printed = paper.printed_matrices(paper.paper_numbers(scenario, motion))
    matrices = paper.first_order(printed, spins, d)
    change = np.zeros((spins.size, 8, 8))
    change[:, 4, 1], change[:, 5, 0] = -spins, spins
    turned = (np.eye(8) + change) @ matrices @ (np.eye(8) - change)
    return np.ascontiguousarray(turned[:, 2:, 2:])


CLOSED: dict[System, tuple[Level, Callable[..., Array]]] = {
    "full": (1, full_matrices),
    "reduced": (4, paper.reduced_matrices),
}
"""Systems in closed form: the model that each is of, and what gives its matrices."""

_LARGEST_STEP = 0.05
"""Branches are followed in steps of at most this many rad/s, whatever spins are asked for,"""

_LARGEST_FRACTION = 1 / 300
"""and of this part of `spin_scale`, which is shorter where the disk is large or gravity weak."""

_MOST_STEPS = 20_000
"""At spins beyond as many steps they grow, so that the work does not."""

_TIE_BREAK = 1e-6
"""Weight of the convention for colliding eigenvalues against distance."""


def chosen_system(scenario: Scenario, system: System | None = None) -> System:
    """Return the linear system of a scenario: the given one, or the closed one if there is one.

    Raises
    ------
    ValueError
        If the system is unknown, or the scenario is none.
    """
    instance("scenario", scenario, Scenario)
    if system is not None:
        return choice("system", system, SYSTEMS)
    is_paper = scenario.disk.is_plain and scenario.friction.is_simple
    if not is_paper or scenario.contact is not None:
        return "numeric"
    closed = (name for name, (level, _) in CLOSED.items() if level == scenario.model)
    return next(closed, "numeric")


def matrices_over_spin(
    scenario: Scenario,
    system: System | None = None,
    motion: Motion = "inverted",
) -> Matrices:
    """Return what gives the state matrices of a linear system at any spins, but for the drift.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with no dissipation but rolling resistance; "full" takes Model 1 on
        the ideal contact alone, and "reduced" Model 4.
    system : {"full", "reduced", "numeric"}, optional
        Eq. (55), Eq. (111), or any constraints or a penalty contact linearised by dual numbers;
        by default the one that is closed for this scenario, and "numeric" if none is.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If the system or the motion is unknown, or the scenario none of this system.
    """
    system = chosen_system(scenario, system)
    choice("motion", motion, MOTIONS)
    if system == "numeric":
        return spinning(scenario, motion).matrices
    level, matrices = CLOSED[system]
    others = "; eigenvalues of other constraints are those of the system 'numeric'"
    require_spinning(scenario, f"the {system} system", level, others)
    return partial(matrices, scenario, motion=motion)


def eigenvalues(
    scenario: Scenario,
    spins: npt.ArrayLike,
    system: System | None = None,
    motion: Motion = "inverted",
) -> ComplexArray:
    """Eigenvalues in 1/s, k = 8, 4, 3, 3 for Models 1 to 4, by falling real and imaginary part.

    On a penalty contact there are 10.

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
) -> ComplexArray:
    """Eigenvalues in 1/s by branches over the spin, one in a column.

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

    Returns
    -------
    ndarray, complex, shape (n, k)

    Raises
    ------
    ValueError
        If spins are not finite or do not increase, the system or the motion is unknown, or the
        scenario none of this system.
    """
    wanted = increasing("spins", spin_array(spins))
    # There is a step even where no other spin than 0 is asked for.
    first, last = min(0.0, wanted[0]), max(_LARGEST_STEP, wanted[-1])
    below, above = (helper_spins(scenario, *each) for each in ((first, 0.0), (0.0, last)))
    matrices = matrices_over_spin(scenario, system, motion)
    spins = np.append(below[:-1], above)
    helpers = follow(matrices(spins), below.size - 1)
    right = np.clip(np.searchsorted(spins, wanted), 1, spins.size - 1)
    fraction = ((wanted - spins[right - 1]) / (spins[right] - spins[right - 1]))[:, None]
    before, after = helpers[right - 1], helpers[right]
    expected = before + fraction * (after - before)
    values = matched(before, expected, np.linalg.eigvals(matrices(wanted)).astype(complex))
    if has_drift(scenario.constraints):
        values = np.insert(values, [2, 2], np.column_stack((1j * wanted, -1j * wanted)), axis=1)
    return values


def helper_spins(scenario: Scenario, low: float, high: float) -> Array:
    """Equally spaced spins from `low` to `high` in rad/s, close enough to follow branches."""
    step = min(_LARGEST_STEP, _LARGEST_FRACTION * spin_scale(scenario))
    count = min(int(np.ceil((high - low) / step)), _MOST_STEPS)
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
    values = np.linalg.eigvals(matrices).astype(complex)
    first = values[start][_numbering(values[start])]
    before, after = (_onward(first, way) for way in (values[:start][::-1], values[start + 1 :]))
    return np.array([*before[:0:-1], *after])


def _onward(first: ComplexArray, values: ComplexArray) -> list[ComplexArray]:
    """Those of equal steps one after the other, each in the order of the first."""
    found = [first[None], first[None]]
    for step in range(len(values)):
        expected = 2.0 * found[-1] - found[-2]
        found.append(matched(found[-1], expected, values[step : step + 1]))
    return [each[0] for each in found[1:]]


def matched(last: ComplexArray, expected: ComplexArray, values: ComplexArray) -> ComplexArray:
    """Values in the order of those they are expected to be, no two the same.

    Parameters
    ----------
    last, expected, values : ndarray, complex, shape (n, k)
        Where two could take the place of each other, the change from the last ones decides; see
        the top of the file.
    """
    cost = np.abs(values[:, None] - expected[:, :, None])
    order = np.argmin(cost, axis=2)
    for step, chosen in enumerate(order.tolist()):
        if len(set(chosen)) < len(chosen):
            change = values[step] - last[step][:, None]
            convention = _TIE_BREAK * np.abs(change.real + change.imag)
            order[step] = linear_sum_assignment(cost[step] + convention)[1]
    return np.take_along_axis(values, order, axis=1)


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
