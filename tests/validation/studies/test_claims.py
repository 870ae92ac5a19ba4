"""What is measured for each statement of the paper, and how it is judged."""

from dataclasses import replace
from functools import cache
from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import LEVELS, Level, Load, Scenario, SmoothCoulomb, Trajectory, simulate
from analysis.data.trajectory import SOURCES
from tests.helpers import random_trajectory
from validation.studies import inversion
from validation.studies.claims import contact_matrix, motion, orders, pure_rolling, starts
from validation.studies.claims import section as claims
from validation.studies.claims.grades import grade, within
from validation.studies.claims.starts import LEAST_SPINS, RANDOM_STARTS, Starts
from validation.study import Check, load


@cache
def model_1(load: Load = "weight") -> Trajectory:
    """From Table 3 over 2 s."""
    scenario = Scenario(friction=SmoothCoulomb(load=load))
    return simulate(scenario, np.linspace(0.0, 2.0, 401), local_tolerance=1e-8)


def upright(gamma: Any, times: Any) -> Trajectory:
    """Samples with this gamma; the rest of them is no motion."""
    row = np.ones(times.size)
    coordinates = np.column_stack([0.0 * row, 0.0 * row, row, row, np.pi / 2 * row, gamma])
    return replace(
        random_trajectory(1),
        times=times,
        coordinates=coordinates,
        rates=np.zeros((times.size, 6)),
        multipliers=np.ones((times.size, 1)),
    )


def test_a_size_is_judged_by_two_limits() -> None:
    found = [within(value, 1.0, 2.0)["verdict"] for value in (1.0, 1.5, 2.5, nan, inf)]
    assert found == ["yes", "partly", "no", "no", "no"]
    assert within(1.5, 1.0)["verdict"] == "no"
    assert grade(yes=True, partly=False) == "yes"


def test_a_sequence_falls_only_if_every_step_does() -> None:
    assert [motion.falls(each) for each in ([3, 2, 1], [3, 1, 2], [1, 1])] == [True, False, False]


# --- The motion from Table 3 --------------------------------------------------------------------


def test_gamma_does_not_converge_within_half_a_second() -> None:
    found = motion.figure_7(model_1("contact"), model_1())
    assert [each["verdict"] for each in found.values()] == ["no", "partly", "yes", "partly"]
    assert found["converges"]["short"] == pytest.approx([0.282, 0.288], abs=1e-3)
    assert found["converges"]["overshoot"] == pytest.approx([0.663, 0.686], abs=1e-3)
    assert max(found["loads"]["change"]) == pytest.approx(0.0243, abs=1e-4)


def test_convergence_holds_from_half_a_second_on_or_is_no_convergence() -> None:
    def verdict(gamma: Any) -> str:
        run = upright(gamma, times)
        return str(motion.figure_7(run, run)["converges"]["verdict"])

    times = np.linspace(0.0, 2.0, 201)
    early, late = np.where(times < 0.4, -1.0, 1.6), np.where(times < 0.6, -1.0, 1.6)
    assert verdict(early) == "yes"
    assert verdict(np.where((times > 1.0) & (times < 1.1), 1.4, early)) == "partly"
    assert verdict(late) == "no"


def test_measures_of_a_motion() -> None:
    times = np.linspace(0.0, 1.0, 11)
    gamma = np.pi / 2 + np.where(times < 0.55, 0.2, 0.05)
    run = upright(gamma, times)
    assert motion.settling_time(run) == pytest.approx(0.6)
    assert motion.settling_time(upright(gamma[::-1], times)) == inf
    assert motion.overshoot(run) == pytest.approx(0.2)
    assert motion.first_time(upright(times, times), "gamma", 0.55) == pytest.approx(0.55)
    assert np.isnan(motion.first_time(upright(times, times), "gamma", 1.1))
    later = upright(5.0 * times, 5.0 * times)
    rates = np.zeros((11, 6))
    rates[:, 3] = 35.0 - np.maximum(0.0, later.times - 2.0)
    assert motion.leaves(replace(later, rates=rates)) == pytest.approx(3.5)
    assert motion.leaves(later) == inf
    assert motion.potential_share(model_1()) == pytest.approx(0.473, abs=0.001)


def test_velocity_of_the_centre_of_gravity_is_the_rate_of_its_place() -> None:
    run = model_1()
    position, velocity = motion.cog_path(run)
    rate = np.gradient(position, run.times, axis=0, edge_order=2)
    np.testing.assert_allclose(velocity[1:-1], rate[1:-1], atol=2e-3)


# --- Contact matrix, orders, rolling -------------------------------------------------------------


def test_both_sides_lose_their_solution_where_the_matrix_is_singular() -> None:
    bound, beta, gamma = contact_matrix.bound()
    assert bound == pytest.approx(1.0585, abs=1e-4)
    assert contact_matrix.losses(beta, gamma) == pytest.approx([bound] * 2, abs=1e-6)
    elsewhere = contact_matrix.losses(beta, gamma + 0.5)
    assert elsewhere[0] == pytest.approx(elsewhere[1], abs=1e-6)
    assert elsewhere[0] > bound + 0.01


def test_no_attitude_needs_less_friction_to_be_singular() -> None:
    run = random_trajectory(1)
    coordinates = run.coordinates.copy()
    rng = np.random.default_rng(0)
    coordinates[:, 4:] = rng.uniform((0.05, -np.pi), (np.pi - 0.05, np.pi), (5, 2))
    run = replace(run, coordinates=coordinates, scenario=Scenario())
    worst = contact_matrix.along(run, any_slip=True)
    assert np.min(worst) >= contact_matrix.bound()[0]
    assert np.all(contact_matrix.along(run, any_slip=False) >= worst)


@pytest.mark.parametrize(
    ("engine", "in_house", "verdict", "holds"),
    [
        (1.05, 1.05, "yes", True),
        (1.05, inf, "partly", False),
        (inf, inf, "no", False),
        (1.06, 1.05, "yes", False),
        (nan, nan, "no", False),
    ],
)
def test_matrix_is_singular_if_both_sides_say_so(
    engine: float, in_house: float, verdict: str, holds: bool
) -> None:
    table = pd.DataFrame([{"bound": 1.05, "engine": engine, "in_house": in_house}])
    assert contact_matrix.judge(table)["verdict"] == verdict
    assert all(check.holds for check in contact_matrix.checks(table)) is holds


def test_closed_form_has_the_orders_of_the_paper() -> None:
    table = pd.DataFrame(orders.measure(40.0))
    assert orders.judge(table)["verdict"] == "yes"
    rest = table[table["order"].isna()]["fitted"]
    assert rest.tolist() == pytest.approx([3.0, 2.0, 2.0], abs=0.01)
    assert orders.judge(table.assign(fitted=table["fitted"] + 0.1))["verdict"] == "no"
    assert orders.judge(table.assign(fitted=nan))["verdict"] == "no"


def rolled(outcome: str = "not inverted") -> pd.DataFrame:
    """What pure rolling finds, the last case in the engine with this outcome."""
    rows = [
        {
            "case": label,
            "source": source,
            "spin": case.spin,
            "gradient": None if case.coefficient == inf else 1.0,
            "highest": 0.9,
            "longest_up": 0.1,
            "outcome": "not inverted",
            "direction": np.zeros(pure_rolling.TIMES.size),
        }
        for label, case in pure_rolling.cases().items()
        for source in SOURCES
    ]
    rows[-1]["outcome"] = outcome
    return pd.DataFrame(rows)


def test_one_start_that_rolls_over_would_do_against_pure_rolling() -> None:
    assert pure_rolling.judge(rolled())["verdict"] == "yes"
    assert pure_rolling.judge(rolled("inverted"))["verdict"] == "partly"
    assert pure_rolling.judge(rolled().assign(outcome="lost"))["verdict"] == "no"
    assert pure_rolling.judge(rolled().iloc[:-2])["verdict"] == "partly"


@pytest.mark.parametrize("wrong", [0.95, nan])
def test_sides_that_roll_otherwise_fail(wrong: float) -> None:
    table = rolled()
    table.loc[4, "highest"] = wrong
    good = pure_rolling.checks(rolled())
    assert [check.holds for check in good] == [True, True]
    assert [check.holds for check in pure_rolling.checks(table)] == [False, True]
    assert [check.holds for check in pure_rolling.checks(rolled("lost"))] == [True, False]
    assert not all(check.holds for check in pure_rolling.checks(rolled().iloc[:-1]))


@pytest.mark.slow
def test_disk_that_rolls_without_slip_swings_up_and_falls_back_on_both_sides() -> None:
    engine, inhouse = pure_rolling.measure(pure_rolling.Case(inf, 40.0))
    assert engine["highest"] == pytest.approx(inhouse["highest"], abs=1e-6)
    assert inhouse["highest"] == pytest.approx(0.884, abs=0.001)
    assert [each["outcome"] for each in (engine, inhouse)] == ["not inverted"] * 2
    assert 0.05 < inhouse["longest_up"] < 0.2


def test_friction_tends_to_pure_rolling() -> None:
    times = np.linspace(0.0, 0.5, 51)
    limit = Scenario(constraints=pure_rolling.ROLLING)
    without = simulate(limit, times, local_tolerance=1e-8).coordinate("gamma")
    errors = []
    for coefficient in (3e3, 3e4):
        scenario = Scenario(friction=SmoothCoulomb(coefficient=coefficient))
        slipping = simulate(scenario, times, method="LSODA", local_tolerance=1e-8)
        errors.append(np.max(np.abs(slipping.coordinate("gamma") - without)))
    assert errors[1] < 0.15 * errors[0] < 0.01


# --- Starts -------------------------------------------------------------------------------------


def test_random_starts_are_the_same_every_time_and_differ_by_number() -> None:
    found = Starts(1, "any tilt", 40.0)
    assert found.scenario(3) == found.scenario(3) != found.scenario(4)
    one, other = (
        each.scenario(3).initial_state for each in (found, found._replace(spin=50.0, level=4))
    )
    assert one.coordinates[4:] == other.coordinates[4:]
    near = [Starts(1, "near upright", 40.0).scenario(number) for number in range(50)]
    assert max(abs(each.initial_state.coordinates[4] - np.pi / 2) for each in near) <= 0.2


@pytest.mark.parametrize(
    ("level", "tilt", "spin", "expected"),
    [(1, "any tilt", 100.0, "contact would pull"), (4, "near upright", 25.0, "flat")],
)
def test_what_becomes_of_a_start_is_told_apart(
    level: Level, tilt: starts.Tilt, spin: float, expected: str
) -> None:
    (row,) = starts.measure(Starts(level, tilt, spin, number=1))
    assert row["outcomes"] == [expected]


def blocks(inverted: int = 100) -> pd.DataFrame:
    """Random starts, of which so many of a hundred invert."""
    return pd.DataFrame(
        {
            "case": label,
            "level": each.level,
            "tilt": each.tilt,
            "spin": each.spin,
            "outcomes": [
                "inverted" if each.first + k < inverted else "not inverted" for k in range(10)
            ],
        }
        for label, each in starts.cases().items()
    )


def attraction(table: pd.DataFrame) -> str:
    return str(starts.judge_attraction(starts.shares(table))["verdict"])


def test_attraction_is_judged_above_the_critical_speed() -> None:
    assert [attraction(blocks(number)) for number in (100, 95, 94)] == ["yes", "yes", "no"]
    table = blocks()
    tilted = (table["tilt"] == "any tilt") & (table["spin"] == 50.0) & (table["level"] == 1)
    flat = pd.Series([["flat"] * 10] * len(table))
    assert attraction(table.assign(outcomes=table["outcomes"].where(~tilted, flat))) == "partly"
    # What inverts below the critical speed, or does not, is no part of the statement.
    low = table["spin"] == 25.0
    assert attraction(table.assign(outcomes=table["outcomes"].where(~low, flat))) == "yes"


def test_shares_have_the_interval_of_clopper_and_pearson() -> None:
    found = starts.shares(blocks(54)).iloc[0]
    assert found["inverted in %"] == 54.0
    assert [found["from"], found["to"]] == pytest.approx([43.741, 64.016], abs=1e-3)
    assert starts.shares(blocks(100)).iloc[0]["from"] == pytest.approx(100 * 0.025**0.01)


def test_bisection_ends_around_the_least_spin(monkeypatch: pytest.MonkeyPatch) -> None:
    def outcome(scenario: Scenario, source: str, *_: object, **_how: object) -> str:
        spin = scenario.initial_state.rates[3]
        return "lost" if spin > 30.3 + 0.1 * (source == "engine") else "not inverted"

    monkeypatch.setattr(starts, "outcome", outcome)
    (row,) = starts.search(4)
    assert row[starts.BELOW] < 30.3 <= row[starts.ABOVE] <= row[starts.BELOW] + starts.WIDTH
    assert (row["outcome there"], row["outcome"]) == ("not inverted", "lost")
    assert (row["engine"], row["engine above"]) == ("not inverted", "not inverted")
    assert row[starts.OWN] == pytest.approx(30.917, abs=1e-3)
    assert row["another pair unstable above"] is None
    monkeypatch.setattr(starts, "outcome", lambda *_, **_how: "lost")
    with pytest.raises(ArithmeticError, match="Model 4: no change between 29 and 33 rad/s"):
        starts.search(4)


def test_supercritical_means_above_both_critical_speeds() -> None:
    def verdict(least: list[float], **changed: Any) -> str:
        table = load(LEAST_SPINS).assign(**{starts.ABOVE: least, **changed})
        return str(starts.judge_least_spins(table)["verdict"])

    high = [31.1] * 4
    assert verdict(high) == "yes"
    assert verdict([31.1, 31.1, 31.1, 30.5]) == "partly"
    assert verdict([30.5] * 4) == "no"
    assert verdict(high, **{starts.OWN: 31.5}) == "partly"
    assert verdict(high, **{"at 20 rad/s": "lost"}) == "no"


# --- The whole section --------------------------------------------------------------------------


@cache
def rows() -> dict[str, pd.DataFrame]:
    """Rows of all studies, those of long runs and of the engine stood in for."""
    curves = ("times", "coordinates", "rates", "multipliers")
    figures = [
        {"case": case, "source": source, "level": 1, "load": load, "formulation": "a"}
        | {
            "error_estimate": 0.0,
            **{name: getattr(model_1(load), name).tolist() for name in curves},
        }
        for case, (_, load, _) in inversion.cases().items()
        for source in SOURCES
    ]
    longs = [{"case": f"Model {level}", **motion._measures(model_1())} for level in LEVELS]
    stored = load(RANDOM_STARTS)
    first = stored["outcomes"].map(lambda outcomes: outcomes[: starts.AGAIN])
    again = stored.assign(outcomes=first)[stored["case"].isin(starts.IN_ENGINE.cases())]
    names = ["bound", "engine", "in_house", "beta", "gamma", "of_motion"]
    names += ["worst_early", "worst", "slip_early", "slip"]
    return {
        "inversion": pd.DataFrame(figures),
        "long-runs": pd.DataFrame(longs),
        "contact-matrix": pd.DataFrame([dict.fromkeys(names, 1.0)]),
        "pure-rolling": rolled(),
        "closed-form-orders": pd.DataFrame(orders.measure(40.0)).assign(case="a"),
        "least-spins": load(LEAST_SPINS),
        "random-starts": stored,
        "random-starts-engine": again,
    }


def failed(**changed: pd.DataFrame) -> list[Check]:
    found = claims.present(rows() | {n.replace("_", "-"): each for n, each in changed.items()})
    return [check for check in found.checks if not check.holds]


def test_all_statements_are_judged_and_the_front_says_how_many_hold() -> None:
    content = claims.present(rows())
    assert failed() == []
    counted = content.numbers["counted"]
    assert sum(counted.values()) == len(content.numbers["c"]) == 19
    first, nearly = content.verdicts
    assert f"{counted['yes']} hold, {counted['partly']} hold in part" in first.numbers
    assert nearly.answer == "partly"
    assert "37 % at 31 rad/s (28 to 47)" in nearly.numbers
    assert "100 % at 36 rad/s (96 to 100)" in nearly.numbers


@pytest.mark.parametrize("column", ["engine", "engine above"])
def test_engine_that_does_otherwise_fails(column: str) -> None:
    least, again = rows()["least-spins"].copy(), rows()["random-starts-engine"]
    least.loc[0, column] = "flat"
    assert len(failed(least_spins=least)) == 1
    other = again.assign(outcomes=[["flat"] * 3, *again["outcomes"][1:]])
    assert len(failed(random_starts_engine=other)) == 1


def test_what_is_missing_fails() -> None:
    assert failed(least_spins=rows()["least-spins"].iloc[:-1])
    assert failed(random_starts=rows()["random-starts"].iloc[:-1])
