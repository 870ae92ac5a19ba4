"""Recorded formulas."""

from collections.abc import Callable
from functools import partial
from math import sqrt
from typing import Any

from analysis.mechanics.recorder import Recorder, call
from analysis.problem.elementary import cos, sin


def recorded(formula: Callable[..., tuple[Any, ...]], **functions: Any) -> tuple[Any, str]:
    """A formula of two constants and two variables, as code, and its source."""
    recorder = Recorder(("a", "b"), ("x", "y"))
    results = formula(*recorder.constants, *recorder.variables)
    return partial(recorder.code(results), **functions), recorder.source(results)


def test_recorded_operations_are_those_of_floats() -> None:
    def formula(a: Any, b: Any, x: Any, y: Any) -> tuple[Any, ...]:
        return (
            (-x + 2 - y) * b / (3 - a * x),
            1 / (y - 0.5) - x * (-1.0),
            x - (y - (a - b)),
            x / (y / (a / b)),
            sin(x * cos(y)) - (0.25 + y) * 3,
        )

    numbers = (0.3, -1.7, 2.9, 0.61)
    code, _ = recorded(formula)
    assert code(*numbers[:2])(*numbers[2:]) == formula(*numbers)


def test_zeros_and_ones_leave_no_operation() -> None:
    def formula(a: Any, _b: Any, x: Any, y: Any) -> tuple[Any, ...]:
        return 0.0 * x + a, (y + 0.0) * 1.0 - 0.0, (0.0 + y) / 1.0, 0.0 / x, 0 * y

    code, source = recorded(formula)
    assert code(5.0, 6.0)(7.0, 8.0) == (5.0, 8.0, 8.0, 0.0, 0.0)
    assert not set("/+-") & set(source)
    assert " * " not in source


def test_an_operation_is_done_once_of_constants_when_they_are_bound_and_an_unused_one_never() -> (
    None
):
    calls: list[float] = []

    def root(number: float) -> float:
        calls.append(number)
        return sqrt(number)

    def formula(a: Any, b: Any, x: Any, y: Any) -> tuple[Any, ...]:
        of = partial(call, "root")
        of(x + 100.0)
        return of(x) + y, of(x) * of(y), of(a * b) * x

    code, _ = recorded(formula, root=root)
    function = code(2.0, 8.0)
    assert calls == [16.0]
    assert function(4.0, 9.0) == (11.0, 6.0, 16.0)
    assert sorted(calls) == [4.0, 9.0, 16.0]
