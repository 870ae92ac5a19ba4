"""Recorded formulas, and the index-1 system that is recorded and eliminated once."""

from collections.abc import Callable
from functools import partial
from math import sqrt
from typing import Any

import numpy as np
import pytest

from analysis import (
    LAWS,
    LOADS,
    POSSIBLE_SETS,
    STEEL_DISK,
    ConstraintSet,
    Load,
    Scenario,
    Table,
)
from analysis.data.checks import Array
from analysis.data.elementary import cos, sin
from analysis.models import index1
from analysis.models.recorder import Recorder, call
from tests.helpers import all_sets, assert_close, random_disk, random_state, random_table


def _arrays(scenario: Scenario, z: list[float], u: list[float]) -> tuple[Array, Array]:
    matrix, right = index1.system(scenario, z, u)
    return np.array(matrix), np.array(right)


def by_lapack(scenario: Scenario, z: list[float], u: list[float]) -> Any:
    """The index-1 system from floats, solved with row pivots; None if it has no solution."""
    matrix, right = _arrays(scenario, z, u)
    columns = np.linalg.solve(matrix, right).T
    if len(columns) == 1:
        return columns[0]
    if columns[1, 6] >= 1.0:
        return None
    return columns[0] + max(0.0, columns[0, 6]) / (1.0 - columns[1, 6]) * columns[1]


@all_sets
@pytest.mark.parametrize("load", LOADS)
def test_recorded_system_has_the_solution_of_lapack_under_every_law(
    constraints: ConstraintSet, load: Load
) -> None:
    random = np.random.default_rng(len(constraints))
    found = 0
    for law in LAWS.values():
        for table in (Table(), random_table(random)):
            scenario = Scenario(
                constraints=constraints,
                disk=random_disk(random),
                table=table,
                friction=law(load=load),
            )
            for _ in range(5):
                z, u = (each.tolist() for each in random_state(random))
                expected = by_lapack(scenario, z, u)
                if expected is None:
                    with pytest.raises(ArithmeticError, match="each newton of normal force"):
                        index1.accelerations(scenario, z, u)
                else:
                    actual = np.concatenate(index1.accelerations(scenario, z, u))
                    assert_close(actual, expected, relative=1e-11)
                    found += 1
    assert found > 20


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids="+".join)
@pytest.mark.parametrize("tilt", [1e-6, 1e-3])
def test_elimination_without_looking_for_pivots_loses_no_more_than_lapack(
    constraints: ConstraintSet, tilt: float
) -> None:
    # Nearly flat, alpha and gamma turn the disk alike: the mass matrix is nearly singular.
    scenario = Scenario(constraints=constraints, disk=STEEL_DISK)
    solve = index1.solver(scenario)
    random = np.random.default_rng(8)
    backward: list[list[float]] = []
    for _ in range(20):
        z, u = random.normal(size=(2, 6))
        z[4] = tilt
        matrix, right = _arrays(scenario, z.tolist(), u.tolist())
        backward.append(
            [
                float(np.linalg.norm(matrix @ x - right[:, 0]) / np.linalg.norm(matrix * x))
                for x in (np.linalg.solve(matrix, right)[:, 0], np.array(solve(*z, *u)))
            ]
        )
    lapack, eliminated = np.max(backward, axis=0)
    assert eliminated < max(10.0 * lapack, 1e-15)


def recorded(formula: Callable[..., tuple[Any, ...]], **functions: Any) -> tuple[Any, str]:
    """A formula of two constants and two variables, as code, and its source."""
    recorder = Recorder(("a", "b"), ("x", "y"))
    results = formula(*recorder.constants, *recorder.variables)
    return recorder.code(results, **functions), recorder.source(results)


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
    assert not set("*/+-") & set(source)


def test_an_operation_of_two_formulas_is_done_once_and_an_unused_one_never() -> None:
    calls: list[float] = []

    def root(number: float) -> float:
        calls.append(number)
        return sqrt(number)

    def formula(_a: Any, _b: Any, x: Any, y: Any) -> tuple[Any, ...]:
        of = partial(call, "root")
        of(x + 100.0)
        return of(x) + y, of(x) * of(y)

    code, _ = recorded(formula, root=root)
    assert code(0.0, 0.0)(4.0, 9.0) == (11.0, 6.0)
    assert sorted(calls) == [4.0, 9.0]


def test_what_comes_of_constants_alone_is_worked_out_when_they_are_bound() -> None:
    calls: list[float] = []

    def noted(number: float) -> float:
        calls.append(number)
        return number

    code, _ = recorded(lambda a, b, x, y: (call("noted", a * b) * x, y), noted=noted)
    function = code(2.0, 3.0)
    assert calls == [6.0]
    assert [function(1.0, 0.0), function(2.0, 1.0)] == [(6.0, 0.0), (12.0, 1.0)]
    assert calls == [6.0]
