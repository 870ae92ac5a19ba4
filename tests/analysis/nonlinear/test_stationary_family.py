"""All stationary motions of an eccentric disk."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from analysis import CENTRED_DISK, ConstraintSet, Scenario, SmoothCoulomb, Start, Table, simulate
from analysis.nonlinear.continuation import Curve
from analysis.nonlinear.stationary import (
    Parameter,
    StationaryMotion,
    stationary_branch,
    stationary_motions,
)
from analysis.problem.checks import Array
from analysis.stability.linearisation import stationary_eigenvalues
from analysis.stability.spectra import matrices_over_spin

HELD = Scenario(constraints=("contact", "constant-spin"))
"""At held spin a disk has tilted stationary motions."""


@pytest.mark.parametrize(
    "constraints",
    [
        ("contact",),
        ("contact", "constant-spin"),
        ("contact", "fixed-cog"),
        ("contact", "no-slip-along", "no-slip-across"),
    ],
)
def test_an_eccentric_disk_spins_upright_or_not_at_all(constraints: ConstraintSet) -> None:
    inverted, noninverted = stationary_motions(Scenario(constraints=constraints), 28.0, starts=12)
    assert inverted.gamma == pytest.approx(np.pi / 2, abs=1e-8)
    assert noninverted.gamma == pytest.approx(-np.pi / 2, abs=1e-8)
    for each in (inverted, noninverted):
        assert not each.is_tilted
        assert (each.x, each.y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert noninverted.growth > 1.0


@pytest.mark.parametrize(
    ("constraints", "least"),
    [
        (("contact", "constant-spin"), 49.373),
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
    assert min(motion.spin for motion in branch) == pytest.approx(least, abs=2e-2)
    last = min(branch, key=lambda motion: abs(motion.gamma - np.pi / 2))
    # There one real eigenvalue of inverted spinning passes zero.
    below, above = (
        np.linalg.det(matrices_over_spin(scenario)(np.array([last.spin + side]))[0])
        for side in (-1.0, 1.0)
    )
    assert below * above < 0.0


def test_a_curve_that_goes_on_without_end_says_so() -> None:
    def circle(point: Array) -> tuple[Array, Array]:
        return np.array([point @ point - 1.0]), 2.0 * point[None]

    curve = Curve(circle, (-2.0, 2.0), 0.1)
    with pytest.raises(ArithmeticError, match="has more than 2000 points one way, and goes on"):
        curve.through(np.array((1.0, 0.0)))


@pytest.mark.parametrize(("gamma", "growth", "order"), [(2.607, -1.0, 4), (1.8202, 1.0, 3)])
def test_small_deviations_of_tilted_motions_grow_as_the_eigenvalues_say(
    gamma: float, growth: float, order: int
) -> None:
    motions = stationary_motions(HELD, 55.0, starts=20)
    motion = min(motions, key=lambda each: abs(each.gamma - gamma))
    assert motion.is_tilted
    assert motion.growth * growth > 0.0
    # Exponentials of the deviation from equally spaced samples, by linear prediction.
    step, samples = 0.01, deviation_of_gamma(HELD, motion)
    columns = [samples[order - 1 - back : -1 - back] for back in range(order)]
    weights = np.linalg.lstsq(np.column_stack(columns), samples[order:], rcond=None)[0]
    measured = np.log(np.roots([1.0, *-weights]).astype(complex)) / step
    assert np.max(measured.real) == pytest.approx(motion.growth, rel=2e-3)


def deviation_of_gamma(scenario: Scenario, motion: StationaryMotion) -> Array:
    """Half the difference of two runs from displaced starts, once fast parts have died out."""
    place = {name: getattr(motion, name) for name in ("x", "y", "beta", "gamma")}
    rates = dict.fromkeys(("x_rate", "y_rate", "beta_rate", "gamma_rate"), 0.0)
    runs = []
    for side in (1e-5, -1e-5):
        start = Start(spin=motion.spin, **{**place, "gamma": motion.gamma + side}, **rates)
        times = np.arange(0.0, 1.505, 0.01)
        run = simulate(replace(scenario, start=start), times, local_tolerance=1e-12)
        runs.append(run.coordinate("gamma")[60:])
    return np.asarray((runs[0] - runs[1]) / 2.0)


@pytest.mark.slow
def test_tilted_motions_are_followed_over_friction() -> None:
    def rubbing(mu: float) -> Scenario:
        return replace(HELD, friction=SmoothCoulomb(coefficient=mu))

    friction = Parameter(change=rubbing, value=0.3, unit=0.3)
    tilted = stationary_motions(HELD, 60.0, starts=20)[0]
    branch = stationary_branch(HELD, tilted, (0.28, 1.0), friction)
    largest = max(branch, key=lambda motion: motion.value)
    assert largest.value == pytest.approx(0.4185, abs=2e-3)
    # At the fold a real eigenvalue passes zero.
    assert min(branch, key=lambda motion: abs(motion.gamma - 2.4)).growth < 0.0
    assert min(branch, key=lambda motion: abs(motion.gamma - 2.0)).growth > 2.0
    assert all(motion.spin == 60.0 for motion in branch)
    at = min(branch, key=lambda motion: abs(motion.value - 0.4) + abs(motion.gamma - 2.4))
    again = stationary_motions(rubbing(at.value), 60.0, starts=20)
    assert min(abs(each.gamma - at.gamma) for each in again) < 1e-8


UPRIGHT = StationaryMotion.at(Scenario(), 10.0, np.array((0.0, 0.0, np.pi / 2, np.pi / 2)))
TILTED = replace(UPRIGHT, beta=1.2)
REFUSED: dict[str, Callable[[], object]] = {
    "spin must not be 0": lambda: stationary_motions(Scenario(), 0.0),
    "eccentricity must be positive": lambda: stationary_motions(Scenario(disk=CENTRED_DISK), 9.0),
    "horizontal table": lambda: stationary_motions(Scenario(table=Table(inclination=0.1)), 9.0),
    "ideal contact": lambda: stationary_motions(Scenario.rest(), 10.0),
    "starts must be at least 1": lambda: stationary_motions(Scenario(), 10.0, starts=0),
    "start must be tilted": lambda: stationary_branch(Scenario(), UPRIGHT, (5.0, 20.0)),
    r"positive spins about 10, got \(20": lambda: stationary_branch(
        Scenario(), TILTED, (20.0, 30.0)
    ),
    "unit must be positive": lambda: Parameter(change=lambda _: Scenario(), value=1.0, unit=0.0),
    "is not stationary": lambda: stationary_eigenvalues(
        Scenario(), 30.0, (0.0, 0.0, np.pi / 2 + 1e-4, np.pi / 2)
    ),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_there_is_not_is_refused(message: str) -> None:
    with pytest.raises((ValueError, ArithmeticError), match=message):
        REFUSED[message]()
