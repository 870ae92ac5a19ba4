"""Any set of constraints linearised numerically, against closed matrices and textbooks."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import mbs_models
from analysis import (
    CENTRED_DISK,
    LOADS,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    STEEL_DISK,
    AnisotropicCoulomb,
    ConstraintSet,
    Load,
    Motion,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.mechanics.paper import first_order, paper_numbers, printed_matrices
from analysis.problem.checks import Array
from analysis.problem.constraints import set_name
from analysis.stability.linearisation import ComplexArray, Linearisation, spinning, upright
from analysis.stability.spectra import eigenvalues
from tests.bodies import TIPPE_TOP
from tests.helpers import mostly_slow, random_disk

SPINS = np.array([0.0, 5.0, 30.0, 60.0])

some_sets = pytest.mark.parametrize(
    "constraints",
    mostly_slow(POSSIBLE_SETS, (MODELS[1], MODELS[3], MODELS[4], POSSIBLE_SETS[-1])),
    ids=set_name,
)


def closed_matrix(scenario: Scenario, spin: float, motion: Motion) -> Array:
    """State matrix of Eq. (55), shape (8, 8), with linearised constraints on acceleration level.

    The forces that hold the slip or the centre of gravity are zero in the stationary motion, so
    that they act along their directions there, and add no stiffness.
    """
    numbers = paper_numbers(scenario, motion)
    printed = printed_matrices(numbers)
    mass, r, e = printed["M"], numbers["r"], numbers["e"]
    slips = (
        ("no-slip-along", (1.0, 0.0, 0.0, r), (0.0, -spin, -r * spin, 0.0)),
        ("no-slip-across", (0.0, 1.0, r, 0.0), (spin, 0.0, 0.0, 0.0)),
    )
    forces = mass @ first_order(printed, np.array([spin]), 0.0)[0, 4:]
    rows, terms = [], []
    for name, by_rate, by_place in slips:
        if name in scenario.constraints:
            rows.append(np.array(by_rate))
            terms.append(np.concatenate((np.zeros(4), by_place)))
        else:
            slope = scenario.friction.gradient * scenario.weight
            forces -= slope * np.outer(by_rate, np.concatenate((by_place, by_rate)))
    if "fixed-cog" in scenario.constraints:
        rows += [np.array((1.0, 0.0, 0.0, -e)), np.array((0.0, 1.0, -e, 0.0))]
        terms += [np.zeros(8), np.zeros(8)]
    count = len(rows)
    W, chi = np.reshape(rows, (count, 4)), np.reshape(terms, (count, 8))
    matrix = np.block([[mass, -W.T], [W, np.zeros((count, count))]])
    accelerations = np.linalg.solve(matrix, np.vstack((forces, -chi)))[:4]
    return np.vstack((np.hstack((np.zeros((4, 4)), np.eye(4))), accelerations))


def gap(found: ComplexArray, expected: ComplexArray) -> float:
    """Largest distance of an eigenvalue to the nearest expected one, relative to the largest."""
    nearest = np.min(np.abs(found[:, :, None] - expected[:, None, :]), axis=2)
    return float(np.max(nearest) / np.max(np.abs(expected)))


def error(scenario: Scenario, motion: Motion, spins: Array = SPINS) -> float:
    """Largest distance of the eigenvalues to those of the closed matrices."""
    closed = np.array([closed_matrix(scenario, spin, motion) for spin in spins.tolist()])
    found = spinning(scenario, motion).matrices(spins)
    return gap(*(np.linalg.eigvals(each).astype(complex) for each in (found, closed)))


@pytest.mark.parametrize("motion", MOTIONS)
@some_sets
def test_every_set_has_the_eigenvalues_of_the_closed_matrices_under_its_constraints(
    constraints: ConstraintSet, motion: Motion
) -> None:
    disks = (STEEL_DISK, CENTRED_DISK, random_disk(np.random.default_rng(0)))
    for disk, gravity in zip(disks, (9.81, 9.81, 1.62), strict=True):
        scenario = Scenario(constraints=constraints, disk=disk, table=Table(gravity=gravity))
        assert error(scenario, motion) < 1e-10
    # As good at a spin far from those it is made of.
    assert error(Scenario(constraints=constraints), motion, np.array([-40.0, 2e3])) < 1e-10


def test_reduced_matrices_have_the_eigenvalues_of_the_linearisation() -> None:
    for motion in MOTIONS:
        printed = eigenvalues(Scenario(constraints=MODELS[4]), SPINS, "reduced", motion)
        for level in (3, 4):
            scenario = Scenario(constraints=MODELS[level])
            assert gap(eigenvalues(scenario, SPINS, "numeric", motion), printed) < 1e-11


def test_a_place_that_is_not_stationary_is_refused() -> None:
    system = Linearisation(Scenario(), upright(Scenario(), pi / 2 - 0.2))
    with pytest.raises(ArithmeticError, match="change of the spin or of the place of Model 1"):
        system.matrices(np.array([20.0]))


@pytest.mark.parametrize("radius", [0.05, 0.1])
def test_constraints_that_hold_the_same_are_refused(radius: float) -> None:
    # Upright, a held centre of gravity that may not slip sideways cannot tilt. One radius meets
    # an exact zero, the other rounding.
    held: ConstraintSet = ("contact", "fixed-cog", "no-slip-across", "held-tilt-rate")
    scenario = Scenario(constraints=held, disk=replace(STEEL_DISK, radius=radius))
    with pytest.raises(ArithmeticError, match="singular"):
        spinning(scenario).matrices(np.array([30.0]))


@pytest.mark.parametrize("smoothing", [1e-5, 1e-8])
def test_friction_may_bend_as_finely_as_it_likes(smoothing: float) -> None:
    scenario = Scenario(friction=SmoothCoulomb(coefficient=1e-4, smoothing=smoothing))
    # A slip of 1e-16 m/s, which rounding leaves at pi / 2, is that part of the smoothing.
    assert error(scenario, "inverted") < 1e-15 / smoothing


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("load", LOADS)
def test_tippe_top_is_linearised_as_in_the_engine(motion: Motion, load: Load) -> None:
    law = SmoothCoulomb(coefficient=0.3, smoothing=0.01, load=load)
    spun = Scenario(disk=TIPPE_TOP, friction=law, start=Start.stationary(150.0, motion))
    found = eigenvalues(spun, [150.0], motion=motion)[0]
    engine = mbs_models.eigenvalues(mbs_models.Scene(spun))
    apart = np.abs(found[:, None] - engine).min(axis=1)
    assert found.size == engine.size
    assert np.max(apart) < 1e-6 * np.max(np.abs(engine))


def test_law_without_one_slope_is_linearised_where_no_system_is_asked_for() -> None:
    law = AnisotropicCoulomb(along=0.3, across=0.3)
    expected = eigenvalues(Scenario(), SPINS, "numeric")
    assert eigenvalues(Scenario(friction=law), SPINS) == pytest.approx(expected, abs=1e-9)
