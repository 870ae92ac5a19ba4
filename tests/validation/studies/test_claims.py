"""What is measured for each statement of the paper, and how it is judged."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analysis import Inversion, Level, Load, Scenario, SmoothCoulomb, Trajectory, simulate
from analysis.mechanics.recorded import accelerations
from tests.helpers import random_trajectory
from validation.studies.claims import (
    attraction,
    contact_matrix,
    drift,
    motion,
    orders,
    pure_rolling,
    start_spins,
)
from validation.studies.claims.attraction import Outcome, RandomStart, Results
from validation.studies.claims.claim import Claim, falls, grade, table
from validation.studies.claims.start_spins import LeastSpin


@cache
def model_1(load: Load = "weight") -> Trajectory:
    """From Table 3 over 2 s."""
    times = np.linspace(0.0, 2.0, 401)
    scenario = Scenario(friction=SmoothCoulomb(load=load))
    return simulate(scenario, times, local_tolerance=1e-8)


def upright(gamma: np.ndarray, times: np.ndarray) -> Trajectory:
    """Samples with this gamma; the rest of them is no motion."""
    row = np.ones(times.size)
    run = random_trajectory(1)
    coordinates = np.column_stack([0.0 * row, 0.0 * row, row, row, np.pi / 2 * row, gamma])
    return replace(
        run,
        times=times,
        coordinates=coordinates,
        rates=np.zeros((times.size, 6)),
        multipliers=np.ones((times.size, 1)),
    )


def test_verdicts_are_three_words() -> None:
    with pytest.raises(ValueError, match="verdict must be one of yes, partly, no"):
        Claim(place="", statement="", criterion="", measured="", verdict="maybe")  # type: ignore[arg-type]
    assert grade(yes=True, partly=False) == "yes"
    assert grade(yes=False, partly=True) == "partly"
    assert grade(yes=False) == "no"


@pytest.mark.parametrize(
    ("values", "expected"), [([3.0, 2.0, 1.0], True), ([3.0, 1.0, 2.0], False), ([1, 1], False)]
)
def test_a_sequence_falls_only_if_every_step_does(values: list[float], expected: bool) -> None:
    assert falls(values) is expected


def test_table_shows_criterion_and_number_beside_the_verdict() -> None:
    shown = table([Claim(place="P", statement="S", criterion="C", measured="M", verdict="partly")])
    assert list(shown.rows[0]) == ["P", "S", "C", "M", "partly"]


def test_gamma_does_not_converge_within_half_a_second() -> None:
    claims = motion.figure_7(
        {load: (model_1(load), model_1(load)) for load in ("weight", "contact")}
    )
    assert [claim.verdict for claim in claims] == ["no", "partly", "yes", "partly"]
    assert "0.28 rad short at 0.5 s (m g: 0.29)" in claims[0].measured
    assert "overshoot 0.66 rad (m g: 0.69)" in claims[0].measured
    assert "2.4e-02 rad" in claims[3].measured


def test_convergence_holds_from_half_a_second_on_or_is_no_convergence() -> None:
    def verdict(gamma: np.ndarray) -> str:
        run = upright(gamma, times)
        claims = motion.figure_7({"weight": (run, run), "contact": (run, run)})
        return claims[0].verdict

    times = np.linspace(0.0, 2.0, 201)
    early, late = np.where(times < 0.4, -1.0, 1.6), np.where(times < 0.6, -1.0, 1.6)
    assert verdict(early) == "yes"
    assert verdict(np.where((times > 1.0) & (times < 1.1), 1.4, early)) == "partly"
    assert verdict(late) == "no"


def test_spin_is_constant_only_if_it_is_in_all_three_models() -> None:
    run = model_1()
    rates = run.rates.copy()
    rates[:, 3] = 35.0
    kept = replace(run, times=2.0 * run.times, rates=rates)
    rates[-1, 3] = 33.9
    left = replace(kept, rates=rates)
    for longs, verdict in (
        ((kept, kept, kept), "yes"),
        ((left, kept, kept), "partly"),
        ((left, left, left), "no"),
    ):
        claims = motion.spinning([run] * 3, longs)
        assert [claim.verdict for claim in claims] == ["yes", verdict, "partly"]


def test_half_of_the_kinetic_energy_lost_went_into_height() -> None:
    assert motion.potential_share(model_1()) == pytest.approx(0.473, abs=0.001)


def test_settling_ends_with_the_last_sample_away() -> None:
    times = np.linspace(0.0, 1.0, 11)
    gamma = np.pi / 2 + np.where(times < 0.55, 0.2, 0.05)
    run = upright(gamma, times)
    assert motion.settling_time(run) == pytest.approx(0.6)
    assert motion.overshoot(run) == pytest.approx(0.2)
    assert motion.settling_time(upright(gamma[::-1], times)) == np.inf
    assert motion.settling_time(upright(0.0 * times + np.pi / 2, times)) == 0.0


def test_first_time_lies_between_samples() -> None:
    times = np.linspace(0.0, 1.0, 11)
    assert motion.first_time(upright(times, times), "gamma", 0.55) == pytest.approx(0.55)
    assert np.isnan(motion.first_time(upright(times, times), "gamma", 1.1))


def test_spin_leaves_its_band_at_the_first_sample_outside() -> None:
    times = np.linspace(0.0, 5.0, 51)
    run = upright(times, times)
    rates = np.zeros((51, 6))
    rates[:, 3] = 35.0 - np.maximum(0.0, times - 2.0)
    assert motion.leaves(replace(run, rates=rates)) == pytest.approx(3.1)
    assert motion.leaves(run) == np.inf


def test_closed_form_has_the_orders_of_the_paper() -> None:
    found = orders.slopes()
    assert orders.claim(found).verdict == "yes"
    rest = [found[name] for name, order in orders.QUANTITIES.items() if order is None]
    assert rest == pytest.approx([3.0, 2.0, 2.0], abs=0.01)
    wrong = {name: slope + 0.1 for name, slope in found.items()}
    assert orders.claim(wrong).verdict == "no"


def test_contact_matrix_is_singular_at_the_coefficient_found() -> None:
    least = contact_matrix.bound()
    assert least.coefficient == pytest.approx(1.0585, abs=1e-4)
    z = np.array([0.01, -0.02, 0.0, 0.3, least.beta, least.gamma])

    def is_singular(coefficient: float, speed: float) -> bool:
        friction = SmoothCoulomb(coefficient=coefficient, smoothing=1e-9, load="contact")
        # Sliding along e_y without turning.
        u = np.array([0.0, speed, 0.0, 0.0, 0.0, 0.0])
        try:
            accelerations(Scenario(friction=friction), z, u)
        except ArithmeticError:
            return True
        return False

    below, above = 0.999 * least.coefficient, 1.001 * least.coefficient
    assert [is_singular(below, speed) for speed in (1.0, -1.0)] == [False, False]
    # Friction presses the disk on the table for one direction of the slip alone.
    assert sorted(is_singular(above, speed) for speed in (1.0, -1.0)) == [False, True]


@pytest.mark.parametrize("wrong", [0.9, 1.1, np.nan, np.inf])
def test_matrix_that_is_not_singular_is_not_called_so(wrong: float) -> None:
    least = contact_matrix.bound()
    run = simulate(Scenario(), np.linspace(0.0, 0.1, 11))
    assert contact_matrix.claim(run, least).verdict == "yes"
    elsewhere = replace(least, coefficient=wrong * least.coefficient)
    assert contact_matrix.claim(run, elsewhere).verdict == "no"
    assert contact_matrix.claim(run, replace(least, gamma=least.gamma + 0.5)).verdict == "no"


def test_no_attitude_needs_less_friction_to_be_singular() -> None:
    least = contact_matrix.bound().coefficient
    rng = np.random.default_rng(0)
    run = random_trajectory(1)
    coordinates = run.coordinates.copy()
    coordinates[:, 4:] = rng.uniform((0.05, -np.pi), (np.pi - 0.05, np.pi), (5, 2))
    run = replace(run, coordinates=coordinates, scenario=Scenario())
    assert np.min(contact_matrix.least_coefficients(run, any_slip=True)) >= least
    actual = contact_matrix.least_coefficients(run, any_slip=False)
    assert np.all(actual >= contact_matrix.least_coefficients(run, any_slip=True))


def test_velocity_of_the_centre_of_gravity_is_the_rate_of_its_place() -> None:
    run = model_1()
    position, velocity = drift.cog_path(run)
    rate = np.gradient(position, run.times, axis=0, edge_order=2)
    np.testing.assert_allclose(velocity[1:-1], rate[1:-1], atol=2e-3)


def test_centre_of_gravity_moves_by_more_than_twice_the_eccentricity_in_model_1() -> None:
    far, slow = drift.claims(model_1())
    assert far.verdict == "no"
    assert slow.verdict == "partly"


@pytest.mark.parametrize(("spin", "highest"), [(40.0, 0.884), (100.0, 0.900)])
def test_disk_that_rolls_without_slip_swings_up_and_falls_back(
    spin: float, highest: float
) -> None:
    rolled = pure_rolling.roll(spin)
    assert np.max(rolled.direction) == pytest.approx(highest, abs=0.003)
    assert rolled.inversion.outcome == "not inverted"
    assert 0.05 < rolled.longest < 0.2
    assert pure_rolling.claim([rolled]).verdict == "yes"


def test_one_start_that_rolls_over_would_do_against_pure_rolling() -> None:
    rolled = pure_rolling.roll(40.0)
    over = replace(rolled, inversion=Inversion(outcome="inverted", time=1.0))
    assert pure_rolling.claim([rolled, over]).verdict == "partly"
    assert pure_rolling.claim([over]).verdict == "no"


def test_bisection_ends_around_the_least_spin(monkeypatch: pytest.MonkeyPatch) -> None:
    def outcome(level: int, spin: float, source: str = "in-house") -> str:
        assert level == 4
        return "lost" if spin > 30.3 + 0.1 * (source == "engine") else "not inverted"

    monkeypatch.setattr(start_spins, "outcome", outcome)
    found = start_spins.find_least_spin(4)
    assert found.below < 30.3 <= found.above
    assert found.above - found.below <= start_spins.WIDTH
    assert found.outcomes == ("not inverted", "lost")
    assert found.engine == ("not inverted", "not inverted")
    assert found.lost == ()
    assert not found.confirmed
    assert found.monotone
    assert found.critical == pytest.approx((30.917,), abs=1e-3)
    assert not replace(found, scan=("lost", *found.scan[1:])).monotone
    assert not replace(found, scan=(*found.scan[:2], "flat")).monotone
    assert replace(found, engine=found.outcomes).confirmed
    (row,) = start_spins.table([found]).rows
    assert row[-1] is False


def test_bracket_without_a_change_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_spins, "outcome", lambda *_: "lost")
    with pytest.raises(ArithmeticError, match="Model 4: no change between 29 and 33 rad/s"):
        start_spins.find_least_spin(4)


def test_supercritical_means_above_both_critical_speeds() -> None:
    high = LeastSpin(
        level=1,
        below=31.0,
        above=31.1,
        outcomes=("flat", "lost"),
        engine=("flat", "lost"),
        scan=("flat", "lost", "lost"),
        critical=(30.1,),
        lost=(),
    )
    low = replace(high, above=30.5)
    assert start_spins.claim([high, high]).verdict == "yes"
    assert start_spins.claim([high, low]).verdict == "partly"
    assert start_spins.claim([low, low]).verdict == "no"
    assert start_spins.claim([high, replace(high, critical=(31.5,))]).verdict == "partly"
    assert start_spins.claim([replace(high, scan=("lost",) * 3)]).verdict == "no"


def test_subcritical_start_does_not_invert_and_supercritical_does() -> None:
    assert start_spins.outcome(4, 29.0) == "flat"
    assert start_spins.outcome(4, 40.0) == "inverted"


def test_random_starts_are_the_same_every_time_and_differ_by_number() -> None:
    start = RandomStart(level=1, tilt="any tilt", spin=40.0, number=3)
    assert start.scenario == start.scenario
    assert start.scenario != replace(start, number=4).scenario
    one, other = (
        each.scenario.initial_state for each in (start, replace(start, spin=50.0, level=4))
    )
    assert one.coordinates[4:] == other.coordinates[4:]
    near = [replace(start, tilt="near upright", number=n).scenario for n in range(50)]
    tilts = [scenario.initial_state.coordinates[4] - np.pi / 2 for scenario in near]
    assert max(map(abs, tilts)) <= 0.2


@pytest.mark.parametrize("level", attraction.LEVELS)
def test_motion_that_comes_to_need_a_pulling_contact_is_told_apart(level: Level) -> None:
    start = RandomStart(level=level, tilt="any tilt", spin=100.0, number=0)
    assert attraction.outcome(start) == "contact would pull"


def test_disk_that_falls_is_flat() -> None:
    start = RandomStart(level=4, tilt="near upright", spin=25.0, number=0)
    assert attraction.outcome(start) == "flat"


def stored(share: float = 1.0) -> Results:
    """Twenty starts of each kind, of which a share is inverted."""
    return {
        RandomStart(level=level, tilt=tilt, spin=spin, number=number): (
            "inverted" if number < 20 * share else "not inverted"
        )
        for level in attraction.LEVELS
        for tilt in attraction.TILTS
        for spin in attraction.SPINS
        for number in range(20)
    }


def test_starts_are_collected_from_the_jobs_in_their_order() -> None:
    jobs = attraction.jobs()
    found = attraction.collect({job.key: ["inverted", "flat"] for job in jobs})
    assert len(found) == 2 * len(jobs)
    first = RandomStart(level=1, tilt="near upright", spin=25.0, number=0)
    assert (found[first], found[replace(first, number=1)]) == ("inverted", "flat")


def test_attraction_is_judged_by_the_worst_supercritical_spin() -> None:
    assert attraction.claim(stored()).verdict == "yes"
    assert attraction.claim(stored(0.9)).verdict == "no"
    one = stored()
    key = RandomStart(level=1, tilt="any tilt", spin=50.0, number=0)
    other = replace(key, number=1)
    assert attraction.claim(one | {key: "not inverted"}).verdict == "yes"
    assert attraction.claim(one | {key: "flat", other: "flat"}).verdict == "partly"
    # What inverts below the critical speed, or does not, is no part of the statement.
    low: Results = {start: "flat" for start in one if start.spin == 25.0}
    assert attraction.claim(one | low).verdict == "yes"


def test_confirmation_compares_engine_in_house_and_shipped() -> None:
    start = attraction.repeated()[0]
    same = attraction.confirmation({start: ("lost", "lost")}, {start: "lost"})
    assert same.rows[0][-1] is True
    pairs: tuple[tuple[Outcome, Outcome], ...] = (("lost", "flat"), ("flat", "flat"))
    for pair in pairs:
        differing = attraction.confirmation({start: pair}, {start: "lost"})
        assert differing.rows[0][-1] is False


def test_shares_are_drawn() -> None:
    assert attraction.draw(stored()).png.startswith(b"\x89PNG")


def test_friction_tends_to_pure_rolling() -> None:
    times = np.linspace(0.0, 0.5, 51)
    limit = Scenario(constraints=pure_rolling.PURE_ROLLING)
    rolled = simulate(limit, times, local_tolerance=1e-8).coordinate("gamma")
    errors = []
    for coefficient in (3e3, 3e4):
        scenario = Scenario(friction=SmoothCoulomb(coefficient=coefficient))
        slipping = simulate(scenario, times, method="LSODA", local_tolerance=1e-8)
        errors.append(np.max(np.abs(slipping.coordinate("gamma") - rolled)))
    assert errors[1] < 0.15 * errors[0] < 0.01


def test_pure_rolling_is_the_same_in_the_engine() -> None:
    engine, inhouse = pure_rolling.slip(np.inf)
    difference = np.abs(engine.cog_direction - inhouse.cog_direction)
    assert np.max(difference[engine.times <= 1.0]) < 1e-3
    assert np.max(engine.cog_direction) == pytest.approx(np.max(inhouse.cog_direction), abs=1e-4)
