"""Steps of a run: all are counted, and what ends a motion is found wherever it lies in one."""

from collections.abc import Callable
from contextlib import nullcontext
from itertools import count
from typing import Any

import numpy as np
import pytest

from analysis import METHODS, Method
from analysis.problem.checks import Array
from analysis.solve.stepping import InitialValueProblem, Run, integrate
from analysis.solve.watch import Watch

STEPPED = pytest.mark.parametrize("method", [each for each in METHODS if each != "taylor"])


def run_of(
    right_hand_side: Callable[[float, Array], Any], method: Method = "DOP853", **conditions: Any
) -> Run:
    """Run from two numbers up to 1 s, in long steps."""
    problem = InitialValueProblem(right_hand_side, np.array([1.0, 0.0]), 1.0, conditions)
    times = np.array([0.0, 1.0])
    return integrate(problem, times, method, 1e-4, allow_pulling=True, watch=Watch())


@STEPPED
def test_all_evaluations_of_a_run_are_counted(method: Method) -> None:
    calls = count()

    def right_hand_side(_: float, state: Array) -> Array:
        next(calls)
        return np.array([state[1], -50.0 * state[0] - 0.1 * state[1] ** 3])

    assert run_of(right_hand_side, method).evaluations == next(calls)


@pytest.mark.parametrize("method", ["DOP853", "RK45", "RK23"])
@pytest.mark.parametrize("limit", [1.5, 2.5])
def test_stage_where_there_is_no_solution_ends_no_motion_that_does_not_go_there(
    method: Method, limit: float
) -> None:
    def right_hand_side(_: float, state: Array) -> Array:
        if state[0] > 2.0:
            raise ArithmeticError("no solution")
        return np.array([100.0 * (limit - state[0]), 0.0])

    outcome = pytest.raises(ArithmeticError, match="no solution") if limit > 2.0 else nullcontext()
    with outcome:
        assert run_of(right_hand_side, method).states[-1, 0] == pytest.approx(limit, abs=1e-3)


@pytest.mark.parametrize("fraction", [1.0, 0.5, 0.1])
def test_steps_are_as_long_as_they_may_be_where_nothing_changes(fraction: float) -> None:
    at_rest = InitialValueProblem(lambda _, state: 0.0 * state, np.ones(2), 0.01)
    how: dict[str, Any] = {"allow_pulling": True, "watch": Watch()}
    # Of a run before.
    how["watch"].steps = 1000
    run = integrate(at_rest, np.array([0.0, 1.0]), "DOP853", 1e-4, fraction, **how)
    # The first ones have to grow.
    assert 100 / fraction <= run.steps < 100 / fraction + 10


@STEPPED
def test_a_motion_without_finite_derivative_ends_at_once(method: Method) -> None:
    with pytest.raises(ArithmeticError, match=f"^{method} stopped after t = .* s: "):
        run_of(lambda _, state: state * np.nan, method)


def test_a_run_that_gives_up_says_where() -> None:
    # It grows as 1 / (1 - 2 t), and steps cannot get past that.
    with pytest.raises(ArithmeticError, match=r"^DOP853 stopped after t = 0\.50000\d s: R"):
        run_of(lambda _, state: 2.0 * state**2)


@pytest.mark.parametrize("method", ["Radau", "BDF"])
def test_a_first_step_is_short_where_a_longer_one_leads_to_no_solution(method: Method) -> None:
    def right_hand_side(_: float, state: Array) -> Array:
        if state[1] > 2e-3:
            raise ArithmeticError("no solution")
        return np.array([0.0, 10.0 * (5e-4 - state[1])])

    assert run_of(right_hand_side, method).states[-1, 1] == pytest.approx(5e-4, rel=1e-3)


@pytest.mark.parametrize("unit", [1.0, -1.0, 1e9])
@pytest.mark.parametrize("half", [0.03, 0.01, 3e-5])
def test_short_dip_ends_a_motion_wherever_in_a_step_it_lies_and_so_does_the_end_of_a_rise(
    half: float, unit: float
) -> None:
    for middle in np.linspace(0.1, 0.9, 41).tolist():

        def dip(state: Array, middle: float = middle) -> float:
            return unit * float((state[1] - middle) ** 2 - half**2)

        run = run_of(lambda *_: (0.0, 1.0), dip=dip)
        assert run.ended == "dip"
        assert run.times[-1] == pytest.approx(middle - np.sign(unit) * half, abs=1e-12)


def test_a_condition_that_is_steep_far_from_both_ends_of_a_step_ends_a_motion() -> None:
    def steep(state: Array) -> float:
        return 1.0 - float(np.exp(20.0 * (state[1] - 0.4)))

    run = run_of(lambda time, _: (0.0, 8.0 * (0.34 - time)), steep=steep)
    assert run.ended == "steep"
    assert run.states[-1, 1] == pytest.approx(0.4, abs=1e-12)


def test_implicit_steps_do_not_iterate_on_rounding() -> None:
    def right_hand_side(_: float, state: Array) -> Array:
        rates = np.array([state[1], -1e3 * state[1] - 1e4 * state[0]])
        return rates * (1.0 + 3e-10 * np.sin(1e17 * state[::-1]))

    problem, times = InitialValueProblem(right_hand_side, np.array([1.0, 0.0]), 0.1), [0.0, 0.3]
    how: dict[str, Any] = {"allow_pulling": True, "watch": Watch()}
    # Iterated to the end, it takes ten times as many.
    assert integrate(problem, np.array(times), "Radau", 1e-10, **how).evaluations < 30_000
