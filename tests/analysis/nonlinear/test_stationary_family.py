"""All stationary motions of a disk, and of other bodies."""

from dataclasses import replace

import numpy as np
import pytest

import mbs_models
from analysis import MODELS, ConstraintSet, Scenario, SmoothCoulomb, Start, simulate
from analysis.nonlinear.stationary import (
    Parameter,
    StationaryMotion,
    stationary_branch,
    stationary_motions,
)
from analysis.stability.spectra import matrices_over_spin
from tests.bodies import BODIES, ELLIPSE, TIPPE_TOP
from tests.helpers import ROLLING, not_none

HELD = Scenario(constraints=("contact", "constant-spin"))
"""At held spin a disk has tilted stationary motions."""


@pytest.mark.parametrize("constraints", [MODELS[1], MODELS[2], HELD.constraints, ROLLING])
def test_an_eccentric_disk_spins_upright_or_not_at_all(constraints: ConstraintSet) -> None:
    inverted, noninverted = stationary_motions(Scenario(constraints=constraints), 28.0, starts=12)
    assert inverted.gamma == pytest.approx(np.pi / 2, abs=1e-8)
    assert noninverted.gamma == pytest.approx(-np.pi / 2, abs=1e-8)
    for each in (inverted, noninverted):
        assert not each.is_tilted
        assert (each.x, each.y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert noninverted.growth > 1.0


def test_spinning_upright_is_found_without_luck() -> None:
    found = stationary_motions(Scenario(), 60.0, starts=1)
    assert [each.gamma for each in found] == pytest.approx([np.pi / 2, -np.pi / 2])


@pytest.mark.parametrize(
    ("constraints", "least"),
    [
        (HELD.constraints, 49.373),
        pytest.param(("contact", "fixed-cog", "constant-spin"), 47.895, marks=pytest.mark.slow),
    ],
)
def test_tilted_motions_at_held_spin_fold_and_meet_inverted_spinning_where_it_is_neutral(
    constraints: ConstraintSet, least: float
) -> None:
    scenario = Scenario(constraints=constraints)
    tilted = stationary_motions(scenario, 60.0, starts=20)[0]
    assert tilted.is_tilted
    branch = stationary_branch(scenario, tilted, (40.0, 100.0))
    (begin,) = (motion for motion in branch if motion.gamma == tilted.gamma)
    assert (begin.x, begin.y) == pytest.approx((tilted.x, tilted.y), rel=1e-12)
    assert min(motion.spin for motion in branch) == pytest.approx(least, abs=2e-2)
    last = min(branch, key=lambda motion: abs(motion.gamma - np.pi / 2))
    # There one real eigenvalue of inverted spinning passes zero.
    below, above = (
        np.linalg.det(matrices_over_spin(scenario)(np.array([last.spin + side]))[0])
        for side in (-1.0, 1.0)
    )
    assert below * above < 0.0


FREE = Scenario(friction=SmoothCoulomb(coefficient=0.0))
"""Frictionless."""


def test_frictionless_tippe_top_leans_and_nods_as_its_closed_form_says() -> None:
    spin, gravity = 100.0, 9.81
    top, scenario = TIPPE_TOP, replace(FREE, disk=TIPPE_TOP)
    (a, b, _), torque = top.inertia_about_cog, top.mass * gravity * top.eccentricity
    lean = torque / ((a - b) * spin**2)
    found = stationary_motions(scenario, spin, starts=12)
    tilted = [each for each in found if abs(np.sin(each.beta) * np.sin(each.gamma)) < 0.999]
    assert len(found) - len(tilted) == 2
    # The second derivative of the potential that its momenta leave, over the inertia of a nod.
    angle, axial = np.arccos(lean), spin * a * lean
    vertical = axial * lean + spin * b * (1 - lean**2)

    def potential(angle: float) -> float:
        across = vertical - axial * np.cos(angle)
        return float(across**2 / (2 * b * np.sin(angle) ** 2) + torque * np.cos(angle))

    step = 1e-3
    ahead, here, back = (potential(angle + each) for each in (step, 0.0, -step))
    inertia = b + top.mass * top.eccentricity**2 * np.sin(angle) ** 2
    nod = np.sqrt((ahead - 2 * here + back) / step**2 / inertia)
    for each in tilted:
        assert np.sin(each.beta) * np.sin(each.gamma) == pytest.approx(lean, abs=1e-9)
        assert np.min(np.abs(each.eigenvalues - 1j * nod)) < 1e-4 * nod
        assert each.growth < 1e-5 * nod


def started(scenario: Scenario, motion: StationaryMotion) -> Scenario:
    """A scenario that starts in a stationary motion."""
    place = {which: getattr(motion, which) for which in ("x", "y", "beta", "gamma")}
    rates = dict.fromkeys(("x_rate", "y_rate", "beta_rate", "gamma_rate"), 0.0)
    return replace(scenario, start=Start(spin=motion.spin, **place, **rates))


EVERY: dict[str, tuple[Scenario, float, int]] = {
    "disk that slides on a circle": (HELD, 60.0, 20),
    # By a thousandth of what friction is smoothed over.
    "disk that hardly slides": (HELD, 73.794, 20),
    **{name: (replace(HELD if body.is_round_disk else FREE, disk=body), 100.0, 10)
       for name, body in BODIES.items()},
}  # fmt: skip
"""Scenarios, spins in rad/s, and how many starts the search has."""


@pytest.mark.parametrize("name", EVERY)
def test_stationary_motions_stay_where_they_are_and_are_linearised_as_in_the_engine(
    name: str,
) -> None:
    scenario, spin, starts = EVERY[name]
    found = stationary_motions(scenario, spin, starts=starts)
    for each in found[:3]:
        run = simulate(started(scenario, each), np.array((0.0, 0.01, 0.02)))
        for which in ("x", "y", "beta", "gamma"):
            assert run.coordinate(which) == pytest.approx(getattr(each, which), abs=1e-7)
    tilted = found[1]
    assert tilted.is_tilted
    engine = mbs_models.eigenvalues(started(scenario, tilted))
    told = tilted.eigenvalues
    if "constant-spin" in scenario.constraints:
        # Those about the vertical and of the place are neutral ones of its neighbours.
        assert told.size == engine.size - 2
    else:
        # It slides where it will: the place turns with the frame, and is a double eigenvalue.
        told = told[np.abs(np.abs(told.imag) - spin) > 0.1]
        assert told.size == 4
    gaps = np.abs(told[:, None] - engine).min(axis=1)
    # A double eigenvalue of zero parts by the root of an error in the matrix.
    assert np.all(gaps < np.where(np.abs(told) < 1e-6, 1e-4, 1e-6))


def test_motions_of_other_bodies_are_followed_in_the_spin() -> None:
    scenario = replace(FREE, disk=ELLIPSE)
    start = stationary_motions(scenario, 60.0, starts=10)[0]
    branch = stationary_branch(scenario, start, (55.0, 65.0))
    assert sorted(each.value for each in (branch[0], branch[-1])) == pytest.approx([55.0, 65.0])


def test_motions_that_are_not_isolated_lose_no_others() -> None:
    held: ConstraintSet = ("contact", "no-slip-across", "held-tilt-rate")
    found = stationary_motions(Scenario(constraints=held), 28.0, starts=12)
    assert len(found) > 2
    assert {each.reason for each in found} == {None}
    # The disk may stand at any tilt.
    assert all(np.min(np.abs(each.eigenvalues)) < 1e-5 for each in found)


def test_attitudes_in_which_the_contact_jams_end_no_search() -> None:
    strong = SmoothCoulomb(coefficient=1.5, smoothing=0.01, load="contact")
    found = stationary_motions(replace(HELD, friction=strong), 60.0)
    assert {round(each.gamma, 6) for each in found} >= {1.570796, -1.570796}


def test_motion_whose_eigenvalues_cannot_be_told_says_why() -> None:
    place = np.array((0.0, 0.0, np.pi / 2 + 1e-4, np.pi / 2))
    found = StationaryMotion.at(Scenario(), 30.0, place)
    assert np.isnan(found.growth)
    assert "is not stationary" in not_none(found.reason)


@pytest.mark.slow
def test_tilted_motions_are_followed_over_friction() -> None:
    def rubbing(mu: float) -> Scenario:
        return replace(HELD, friction=SmoothCoulomb(coefficient=mu))

    friction = Parameter(change=rubbing, value=0.3, unit=0.3)
    tilted = stationary_motions(HELD, 60.0, starts=20)[0]
    branch = stationary_branch(HELD, tilted, (0.2, 1.0), friction)
    # At one end it comes to inverted spinning.
    upright = min(branch, key=lambda motion: abs(motion.gamma - np.pi / 2))
    assert upright in (branch[0], branch[-1])
    assert upright.value == pytest.approx(0.2409, abs=2e-3)
    largest = max(branch, key=lambda motion: motion.value)
    assert largest.value == pytest.approx(0.4185, abs=2e-3)
    # At the fold a real eigenvalue passes zero.
    assert min(branch, key=lambda motion: abs(motion.gamma - 2.4)).growth < 0.0
    assert min(branch, key=lambda motion: abs(motion.gamma - 2.0)).growth > 2.0
    assert all(motion.spin == 60.0 for motion in branch)
    at = min(branch, key=lambda motion: abs(motion.value - 0.4) + abs(motion.gamma - 2.4))
    again = stationary_motions(rubbing(at.value), 60.0, starts=20)
    assert min(abs(each.gamma - at.gamma) for each in again) < 1e-8
