"""Any set of constraints linearised numerically, against closed matrices and textbooks."""

from dataclasses import replace
from math import pi, sqrt

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
    Stribeck,
    Table,
    ViscousFriction,
    simulate,
)
from analysis.mechanics import paper
from analysis.mechanics.paper import first_order, paper_numbers, printed_matrices
from analysis.problem.checks import Array
from analysis.problem.constraints import set_name
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import ComplexArray, Linearisation, spinning, upright
from analysis.stability.spectra import eigenvalues
from tests.bodies import COMPOSED, TIPPE_TOP
from tests.helpers import mostly_slow, random_disk

SPINS = np.array([0.0, 5.0, 30.0, 60.0])

some_sets = pytest.mark.parametrize(
    "constraints",
    mostly_slow(POSSIBLE_SETS, (MODELS[1], MODELS[3], MODELS[4], POSSIBLE_SETS[-1])),
    ids=set_name,
)

ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")


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


def test_number_of_eigenvalues_is_what_the_freedom_leaves() -> None:
    sizes = {}
    for held in POSSIBLE_SETS:
        places = len(paper.constraint_positions(held, STEEL_DISK, np.zeros(6)))
        speeds = len(paper.constraint_directions(held, STEEL_DISK, np.zeros(6)))
        # Alpha and a free spin aside.
        sizes[held] = 12 - places - speeds - (1 if "constant-spin" in held else 2)
        assert eigenvalues(Scenario(constraints=held), [7.0]).shape == (1, sizes[held])
    assert [sizes[held] for held in (*MODELS.values(), ROLLING)] == [8, 4, 3, 3, 6]


@some_sets
def test_linear_stability_depends_on_the_law_by_its_slope_at_no_slip_alone(
    constraints: ConstraintSet,
) -> None:
    stribeck = Stribeck(load="contact")
    slopes = (3.0, stribeck.gradient, 3.01)
    laws = (SmoothCoulomb(), stribeck, *(ViscousFriction(viscosity=slope) for slope in slopes))
    first, other, linear, expected, mild = (
        eigenvalues(Scenario(constraints=constraints, friction=law), SPINS, "numeric")
        for law in laws
    )
    assert gap(linear, first) < 1e-10
    assert gap(other, expected) < 1e-10
    assert (gap(mild, first) > 1e-6) == Scenario(constraints=constraints).rubs


def test_reduced_matrices_have_the_eigenvalues_of_the_linearisation() -> None:
    for motion in MOTIONS:
        printed = eigenvalues(Scenario(constraints=MODELS[4]), SPINS, "reduced", motion)
        for level in (3, 4):
            scenario = Scenario(constraints=MODELS[level])
            assert gap(eigenvalues(scenario, SPINS, "numeric", motion), printed) < 1e-11


def test_round_disk_that_spins_without_slip_is_upright_above_the_textbooks_spin() -> None:
    """Spin² > m g r / (A + m r²), which is 4 g / (5 r) for a thin homogeneous disk."""
    across = CENTRED_DISK.mass * CENTRED_DISK.radius**2 / 4
    disk = replace(CENTRED_DISK, inertia_x=across, inertia_y=across, inertia_z=2 * across)
    scenario = Scenario(constraints=ROLLING, disk=disk)
    threshold = sqrt(0.8 * scenario.table.gravity / disk.radius)
    below, above = eigenvalues(scenario, [0.999 * threshold, 1.001 * threshold])
    assert np.max(below.real) > 0.1
    assert np.max(above.real) < 1e-4
    (change,) = critical_speeds(scenario).pair_changes
    assert change.spin == pytest.approx(threshold, rel=1e-9)


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


def test_tippe_top_leaves_its_start_as_fast_as_its_eigenvalues_say() -> None:
    law = SmoothCoulomb(coefficient=0.3, smoothing=0.01)
    start = Start(gamma=-pi / 2 + 1e-6, spin=150.0)
    spun = Scenario(disk=TIPPE_TOP, friction=law, start=start)
    growth = eigenvalues(spun, [150.0], motion="noninverted").real.max()
    run = simulate(spun, np.linspace(0.0, 2.0, 1001), local_tolerance=1e-12)
    off = np.hypot(run.coordinate("gamma") + pi / 2, run.coordinate("beta") - pi / 2)
    # Averaged over turns, of which the growing pair makes some three in a second.
    early, late = off[400:600].mean(), off[800:1000].mean()
    assert np.log(late / early) / 0.8 == pytest.approx(growth, rel=0.02)


def test_body_that_cannot_spin_upright_is_refused() -> None:
    with pytest.raises(ValueError, match="disk must be able to spin upright for that, got Disk"):
        eigenvalues(Scenario(disk=COMPOSED), [30.0])


def test_law_without_one_slope_is_linearised_where_no_system_is_asked_for() -> None:
    law = AnisotropicCoulomb(along=0.3, across=0.3)
    expected = eigenvalues(Scenario(), SPINS, "numeric")
    assert eigenvalues(Scenario(friction=law), SPINS) == pytest.approx(expected, abs=1e-9)
