"""What is measured for each statement of the paper, and how it is judged."""

from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import Scenario
from mbs_models.friction import slip_velocity
from tests.faults import GONE, Rows, faults
from tests.helpers import failing, not_none, random_trajectory
from validation.page.section import Section
from validation.studies import inversion
from validation.studies.claims import equations, motion, pure_rolling, starts
from validation.studies.claims import section as claims
from validation.studies.claims.starts import LEAST_SPINS, RANDOM_STARTS, Starts
from validation.study import load

# --- The motion from Table 3 --------------------------------------------------------------------


def measured(gamma: Any, times: Any, spin: Any = 0.0) -> dict[str, Any]:
    """Measures of samples with these values; the rest of them is no motion."""
    coordinates = np.tile([0.0, 0.0, 1.0, 1.0, np.pi / 2, 0.0], (times.size, 1))
    coordinates[:, 5], rates = gamma, np.outer(np.ones(times.size), np.zeros(6))
    rates[:, 3] = spin
    arrays = {"times": times, "coordinates": coordinates, "rates": rates}
    multipliers = np.ones((times.size, 1))
    return motion.measures(replace(random_trajectory(1), multipliers=multipliers, **arrays))


def test_measures_of_a_motion(inversions: pd.DataFrame) -> None:
    times = np.linspace(0.0, 1.0, 11)
    gamma = np.pi / 2 + np.where(times < 0.55, 0.2, 0.05)
    assert measured(gamma, times)["settled"] == pytest.approx(0.6)
    assert measured(gamma[::-1], times)["settled"] == inf
    assert measured(1.7 * times, times)["reached"] == pytest.approx(np.pi / 3.4)
    assert np.isnan(measured(times, times)["reached"])
    later = 5.0 * times
    slowing = 35.0 - np.maximum(0.0, later - 2.0)
    assert measured(later, later, slowing)["constant_until"] == pytest.approx(3.5)
    assert measured(later, later)["constant_until"] == inf
    run = inversion.motions(inversions)["Model 1", "engine"]
    found, rising = motion.measures(run), run.times <= not_none(run.inversion_time)
    assert found["risen"] / found["lost"] == pytest.approx(0.473, abs=0.001)
    rate = np.gradient(run.cog_positions[rising, :2], run.times[rising], axis=0, edge_order=2)
    speed = np.sqrt(np.mean(np.sum(rate**2, axis=1)))
    assert found["cog_speed"] == pytest.approx(speed, rel=1e-2)
    states = zip(run.coordinates[rising], run.rates[rising], strict=True)
    slips = [slip_velocity(run.scenario.disk.radius, *state) for state in states]
    assert found["slip_speed"] == pytest.approx(np.sqrt(2.0 * np.mean(np.square(slips))), rel=1e-9)


def test_convergence_holds_from_half_a_second_on_or_is_no_convergence(
    inversions: pd.DataFrame,
) -> None:
    runs = inversion.motions(inversions)
    levels = motion.measured(runs).iloc[1:]
    for settled, reached, told in ((0.5, 0.4, "yes"), (inf, 0.5, "partly"), (0.6, 0.6, "no")):
        contact = levels.iloc[:1].assign(settled=settled, reached=reached)
        judged = motion.judge(runs, pd.concat([contact, levels]), levels)
        assert judged["converges"]["verdict"] == told


# --- Contact matrix, orders, rolling -------------------------------------------------------------


def test_both_sides_lose_their_solution_where_the_matrix_is_singular_first() -> None:
    found = equations.loss()
    assert found["bound"] == pytest.approx(1.0585, abs=1e-4)
    assert not failing(equations.checks(found))
    assert len(failing(equations.checks(lost(1.06, inf)))) == 2
    engine, inhouse = equations.losses(found["beta"], found["gamma"] + 0.5)
    assert engine == pytest.approx(inhouse, abs=1e-6)
    assert engine > found["bound"] + 0.01
    angles = np.random.default_rng(0).uniform((0.05, -np.pi), (np.pi - 0.05, np.pi), (5, 2))
    assert min(map(equations.singular_from, angles)) >= found["bound"]


def rolled(**last: Any) -> pd.DataFrame:
    """What pure rolling finds, the last case with these values."""
    found: dict[str, Any] = dict.fromkeys((*pure_rolling.HIGHEST, *pure_rolling.LONGEST), 0.9)
    found |= dict.fromkeys(pure_rolling.OUTCOME, "not inverted")
    rows = [
        {"case": label, "rolls": each.constraints == pure_rolling.ROLLING, **found}
        for label, each in pure_rolling.cases().items()
    ]
    return pd.DataFrame([*rows[:-1], rows[-1] | last])


# --- Starts -------------------------------------------------------------------------------------


def test_random_starts_are_the_same_every_time_and_differ_by_number() -> None:
    found = Starts(1, "near upright", 40.0)
    assert found.scenario(3) == found.scenario(3) != found.scenario(4)
    angles = [
        [each.scenario(number).initial_state.coordinates[4] for number in range(50)]
        for each in (found, found._replace(spin=50.0, level=4))
    ]
    assert angles[0] == angles[1]
    assert np.max(np.abs(np.array(angles) - np.pi / 2)) <= 0.2
    (row,) = starts.measure(Starts(4, "near upright", 25.0, number=1))
    assert row["outcomes"] == ["flat"]


def attracted(inverted: int = 100, **flat: Any) -> pd.DataFrame:
    """Shares of random starts: so many of a hundred invert, and none of those told by `flat`."""
    rows = [{"case": label, **each._asdict()} for label, each in starts.cases().items()]
    for row in rows:
        most = 0 if flat and flat.items() <= row.items() else inverted
        count = min(max(most - row["first"], 0), 10)
        row["outcomes"] = ["inverted"] * count + ["flat"] * (10 - count)
    return starts.shares(pd.DataFrame(rows))


def test_bisection_ends_around_the_least_spin(monkeypatch: pytest.MonkeyPatch) -> None:
    def outcome(scenario: Scenario, source: str, *_: object, **_how: object) -> str:
        spin = scenario.initial_state.rates[3]
        return "lost" if spin > 30.3 + 0.1 * (source == "engine") else "not inverted"

    monkeypatch.setattr(starts, "outcome", outcome)
    (row,) = starts.search(4)
    assert row[starts.BELOW] < 30.3 <= row[starts.ABOVE] == row[starts.BELOW] + starts.WIDTH
    assert [row[place] for place in starts.ENDS] == ["not inverted", "lost"]
    assert [row[there] for there in starts.ENDS.values()] == ["not inverted"] * 2
    assert row[starts.OWN] == pytest.approx(30.917, abs=1e-3)
    monkeypatch.setattr(starts, "outcome", lambda *_, **_how: "lost")
    with pytest.raises(ArithmeticError, match="no change between 29 and 33 rad/s"):
        starts.search(4)


# --- Verdicts -----------------------------------------------------------------------------------


def lost(engine: float, inhouse: float) -> dict[str, Any]:
    return {"bound": 1.05, "engine": engine, "in-house": inhouse}


def least(*spins: float, **changed: Any) -> pd.DataFrame:
    return load(LEAST_SPINS).assign(**{starts.ABOVE: spins, **changed})


@pytest.mark.parametrize(
    ("judge", "table", "verdict"),
    [
        (equations.judge_loss, lost(1.05, 1.05), "yes"),
        (equations.judge_loss, lost(1.05, inf), "partly"),
        (equations.judge_loss, lost(nan, nan), "no"),
        (equations.judge_orders, equations.exponents() + 0.1, "no"),
        (equations.judge_orders, equations.ORDERS * nan, "no"),
        (pure_rolling.judge, rolled(), "yes"),
        (pure_rolling.judge, rolled(**{"outcome, engine": "inverted"}), "partly"),
        (pure_rolling.judge, rolled().replace("not inverted", "lost"), "no"),
        (starts.judge_attraction, attracted(95), "yes"),
        (starts.judge_attraction, attracted(94), "no"),
        (starts.judge_attraction, attracted(level=1, tilt="any tilt", spin=50.0), "partly"),
        # What inverts below the critical speed, or does not, is no part of the statement.
        (starts.judge_attraction, attracted(spin=25.0), "yes"),
        (starts.judge_least_spins, least(31.1, 31.1, 31.1, 31.1), "yes"),
        (starts.judge_least_spins, least(31.1, 31.1, 31.1, 30.5), "partly"),
        (starts.judge_least_spins, least(30.5, 30.5, 30.5, 30.5), "no"),
        (starts.judge_least_spins, least(31.1, 31.1, 31.1, 31.1, **{starts.OWN: 31.5}), "partly"),
        (starts.judge_least_spins, least(32, 32, 32, 32, **{"at 20 rad/s": "lost"}), "no"),
    ],
)
def test_a_statement_holds_by_its_criterion(judge: Any, table: Any, verdict: str) -> None:
    assert judge(table)["verdict"] == verdict


# --- The whole section --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rows(inversions: pd.DataFrame) -> Rows:
    """Rows of all studies, those of long runs and of the engine stood in for."""
    stored = load(RANDOM_STARTS)
    first = stored["outcomes"].map(lambda outcomes: outcomes[: starts.AGAIN])
    again = stored.assign(outcomes=first)[stored["case"].isin(starts.IN_ENGINE.cases())]
    return {
        "inversion": inversions,
        "long-runs": motion.measured(inversion.motions(inversions)).iloc[1:],
        "pure-rolling": rolled(),
        "least-spins": load(LEAST_SPINS),
        "random-starts": stored,
        "random-starts-engine": again,
    }


def test_all_statements_are_judged_and_the_front_says_how_many_hold(rows: Rows) -> None:
    content = claims.present(rows)
    assert not failing(content.checks)
    counted, judged, contact = (content.numbers[name] for name in ("counted", "c", "contact"))
    assert sum(counted.values()) == len(judged) == 26
    figure_7 = [judged[name]["verdict"] for name in ("converges", "tilt", "force", "loads")]
    assert figure_7 == ["no", "partly", "yes", "partly"]
    assert [contact["short"], contact["beyond"]] == pytest.approx([0.282, 0.663], abs=1e-3)
    section = Section("claims", content, Path(claims.__file__).with_name("claims.md"))
    section.filled(vars(claims))
    first, nearly = section.verdicts
    assert f"{counted['yes']} hold, {counted['partly']} hold in part" in first.numbers
    assert nearly.answer == "partly"
    assert "37 % at 31 rad/s (28 to 47)" in nearly.numbers


test_engine_that_does_otherwise_and_what_is_missing_fails = faults(
    claims.present,
    [
        ("least-spins", 0, "engine above", "least spins: engine, outcome", "flat", GONE),
        ("random-starts-engine", 0, "outcomes", "random starts: engine", ["flat"] * 3),
        ("random-starts-engine", 0, "spin", "random starts: repeated in the engine", nan, GONE),
        ("pure-rolling", -1, "outcome, engine", "cases with the same outcome", "inverted", GONE),
        ("pure-rolling", -1, "highest, engine", "highest places", nan),
        ("long-runs", 0, "away_early", "numbers that are missing", nan),
    ],
)
