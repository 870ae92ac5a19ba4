"""A motion ends where a condition turns negative first, whatever the times asked for."""

from collections.abc import Callable
from itertools import count
from typing import Any

import numpy as np
import pytest

from analysis import METHODS, MODELS, Method, Scenario, Start, State, Trajectory, simulate
from analysis.data.checks import Array
from analysis.data.watch import Watch
from analysis.solve.stepping import InitialValueProblem, integrate
from tests.helpers import model, mostly_slow

QUICK, ALL = 8, 300


def random_scenario(random: np.random.Generator) -> Scenario:
    """A start that ends, for more than one reason, within a second, or does not."""
    ranges = {"spin": (15.0, 150.0), "beta": (0.8, 2.3), "gamma": (-3.0, 3.0)}
    start = Start(**{name: random.uniform(*ends) for name, ends in ranges.items()})
    return Scenario(constraints=[*MODELS.values()][random.integers(4)], start=start)


def turned_by(angle: float) -> Callable[[State], float]:
    """Condition that ends a run where gamma has risen by an angle."""

    def condition(state: State) -> float:
        return Start().gamma + angle - state.coordinates[5]

    condition.__name__ = f"turned by {angle}"
    return condition


def assert_ends(run: Trajectory, reason: str | None, time: float, within: float) -> None:
    assert (run.ending and run.ending.reason) == reason, run.scenario
    assert run.times[-1] == pytest.approx(time, abs=within), run.scenario


@pytest.mark.parametrize(
    ("spin", "tolerance"),
    # The first pulls for a tenth of a millisecond.
    [(138.5465, 1e-8), (139.0, 1e-3)],
)
def test_a_short_pull_between_two_samples_ends_a_run(spin: float, tolerance: float) -> None:
    scenario = Scenario(start=Start(spin=spin))
    few = simulate(scenario, [0.0, 1.0], tolerance=tolerance)
    many = simulate(scenario, np.linspace(0.0, 0.2, 10001), tolerance=1e-9)
    assert_ends(few, "contact would pull", many.times[-1], tolerance)


def test_a_pull_behind_the_end_of_a_run_in_the_same_step_is_not_noted() -> None:
    # It would last 2.2 ms.
    scenario = Scenario(start=Start(spin=139.0))
    before = simulate(scenario, [0.0, 0.1597], local_tolerance=1e-9).coordinate("gamma")
    assert before[-1] > np.max(before[:-1])
    far = turned_by(float(before[-1]) - Start().gamma)
    how: dict[str, Any] = {"local_tolerance": 1e-3, "allow_pulling": True}
    run = simulate(scenario, [0.0, 1.0], stop_when=far, **how)
    assert_ends(run, far.__name__, 0.1597, 1e-4)
    assert run.pulling == ()


def test_conditions_say_nothing_of_what_comes_after_a_fall() -> None:
    start = Start(spin=9.4667, beta=1.18926, gamma=1.70513, beta_rate=-0.44891)
    how: dict[str, Any] = {"form": "reduced", "tolerance": 1e-3}
    run = simulate(model(4, start=start), [0.0, 1.5], stop_when="lost", **how)
    assert_ends(run, "flat", 0.148187, 1e-5)


@pytest.mark.parametrize("starts", mostly_slow([QUICK, ALL], [QUICK]))
def test_endings_do_not_depend_on_times_and_are_those_of_other_solvers(starts: int) -> None:
    random = np.random.default_rng(21)
    ended = 0
    for number in range(starts):
        scenario = random_scenario(random)
        how: dict[str, Any] = {"tolerance": 1e-6, "stop_when": ["inverted", "lost"]}
        if scenario.model == 4 and number % 2:
            how["form"] = "reduced"
        between = np.sort(random.uniform(0.0, 0.6, 40))
        few = simulate(scenario, [0.0, 0.6], **how)
        others = [simulate(scenario, [0.0, *between, 0.6], **how)]
        if starts == ALL:
            # Compiling takes longer than a quick test may.
            others.append(simulate(scenario, [0.0, 0.6], method="taylor", **how))
        reason = None if few.ending is None else few.ending.reason
        for other in others:
            assert_ends(other, reason, few.times[-1], 2e-6)
        ended += few.ending is not None
    assert ended > starts // 4


@pytest.mark.parametrize("order", [1, -1])
def test_of_two_endings_in_one_step_the_earlier_one_counts(order: int) -> None:
    # They are a few microseconds apart, and the step is hundreds of times as long.
    scenario, first = Scenario(start=Start(beta=2.0)), turned_by(0.5)
    run, alone = (
        simulate(scenario, [0.0, 1.0], stop_when=each, local_tolerance=1e-6)
        for each in ([first, turned_by(0.5001)][::order], first)
    )
    assert_ends(run, "turned by 0.5", alone.times[-1], 0.0)


@pytest.mark.parametrize("method", [each for each in METHODS if each != "taylor"])
def test_all_evaluations_of_a_run_are_counted(method: Method) -> None:
    calls = count()

    def right_hand_side(_: float, state: Array) -> Array:
        next(calls)
        return np.array([state[1], -50.0 * state[0] - 0.1 * state[1] ** 3])

    problem = InitialValueProblem(
        right_hand_side,
        np.array([1.0, 0.0]),
        leaning=None,
        normal_force=None,
        longest_step=0.5,
        attitudes=lambda states: states,
    )
    times = np.linspace(0.0, 2.0, 21)
    run = integrate(problem, times, method, 1e-6, allow_pulling=False, watch=Watch())
    assert run.evaluations == next(calls)
