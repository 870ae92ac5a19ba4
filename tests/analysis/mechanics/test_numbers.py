"""Numbers that are no floats: dual ones, with exact derivatives, and recorded formulas."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest

from analysis import LAWS, FrictionLaw
from analysis.mechanics.dual import derivatives, of_duals, per_speed_and_slope
from analysis.mechanics.recorder import Recorder, call
from analysis.problem.elementary import asinh, atan2, cos, exp, hypot, log, sin, sqrt, tanh
from tests.helpers import assert_close, derivative, jacobian
from tests.wayward_law import Answering, Pushing

FORMULAS: dict[str, Callable[[Sequence[Any]], list[Any]]] = {
    "sums": lambda x: [-x[0] + 2.0 - x[1], 3.0 - (x[0] - x[1]), x[1] + 1.5],
    "products": lambda x: [x[0] * x[1] * 2.0, 3.0 * x[1], x[0] * x[0] * x[0]],
    "quotients": lambda x: [x[0] / x[1], 1.0 / x[1], x[0] / 4.0],
    "functions": lambda x: [sin(x[0] * x[1]), cos(x[0]) / sqrt(x[1]), sqrt(x[0] * x[0] + 1.0)],
    "powers": lambda x: [x[0] ** 2, x[1] ** -0.5, 2.0 ** x[0], 3 ** x[1], x[1] ** x[0]],
    "further functions": lambda x: [exp(x[0]), tanh(x[0]), log(x[1]), asinh(x[1])],
    "functions of two": lambda x: [hypot(*x), hypot(2.0, x[1]), atan2(*x), atan2(-x[0], -2.0)],
    "sizes and choices": lambda x: [abs(x[0]), abs(-x[1]), x[0] if x[0] <= x[1] >= 1.0 else 0.0],
}


@pytest.mark.parametrize("name", FORMULAS)
def test_derivatives_are_those_of_the_formula(name: str) -> None:
    place = np.array((0.7, 1.9))
    slopes = jacobian(lambda x: np.array(FORMULAS[name](x.tolist())), place)
    assert_close(derivatives(FORMULAS[name], place), slopes, relative=1e-11)


FLOATS, DUALS, ARRAYS = (
    Answering(says=says)
    for says in (
        lambda speed: 0.3 / math.hypot(0.2, speed),
        lambda speed: 0.3 / hypot(0.2, speed),
        # NumPy makes an array without axes.
        lambda speed: np.where(speed < 1e9, 0.3 / hypot(0.2, speed), 0.0),
    )
)
"""The same law in functions that take floats alone, dual numbers, and arrays."""


SIMPLE: list[FrictionLaw] = [law for law in (kind() for kind in LAWS.values()) if law.is_simple]


@pytest.mark.parametrize("law", [*SIMPLE, FLOATS, DUALS], ids=lambda law: type(law).__name__)
def test_slope_is_the_derivative_of_the_force_for_each_unit_of_slip(law: FrictionLaw) -> None:
    unit = law.gradient / law.finest_speed
    for relative in (1e-4, 0.049, 0.051, 0.3, 1.0, 3.0):
        speed = relative * law.finest_speed
        stretched = derivative(lambda t, v=speed: np.array(law.per_speed(v * (1.0 + t))))  # type: ignore[misc]
        # Differences over a small speed lose digits.
        expected, accuracy = float(stretched) / speed / unit, 1e-10 + 1e-12 / relative
        assert per_speed_and_slope(law, speed)[1] / unit == pytest.approx(expected, abs=accuracy)
    near = 1e-6 * law.finest_speed
    assert law.per_speed(near) == pytest.approx(law.gradient, rel=2e-6)
    expected = (law.per_speed(near) - law.gradient) / near
    assert per_speed_and_slope(law, 0.0)[1] / unit == pytest.approx(expected / unit, abs=2e-6)


def test_slope_is_exact_where_a_law_takes_dual_numbers_and_near_where_it_does_not() -> None:
    speeds = np.geomspace(1e-3, 10.0, 9).reshape(3, 3)
    expected = -0.3 * speeds / (0.04 + speeds**2) ** 1.5
    for law, accuracy in ((DUALS, 1e-14), (FLOATS, 1e-9), (ARRAYS, 1e-9)):
        values, slopes = per_speed_and_slope(law, speeds)
        wanted = [law.per_speed(each) for each in speeds.flat]
        np.testing.assert_allclose(np.ravel(values), wanted, rtol=1e-15)
        np.testing.assert_allclose(slopes, expected, rtol=accuracy, atol=accuracy)


@pytest.mark.parametrize("slip", [0.0, 1.0])
def test_a_force_of_floats_alone_is_told_where_its_slopes_are_asked_for(slip: float) -> None:
    # From a slip on.
    law = Pushing(says=lambda x, y, n: (-math.sqrt(n) * x if x > slip else -n * x, -n * y))
    with pytest.raises(ValueError, match=r"^friction law '.*:Pushing' must do with arithmetic "):
        of_duals(law)


# --- Recorded formulas -------------------------------------------------------------------------


def recorded(formula: Callable[..., tuple[Any, ...]], **functions: Any) -> tuple[Any, str]:
    """A formula of two constants and two variables, as code, and its source."""
    recorder = Recorder(("a", "b"), ("x", "y"))
    results = formula(*recorder.constants, *recorder.variables)
    return partial(recorder.code(results), **functions), recorder.source(results)


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
        return math.sqrt(number)

    def formula(a: Any, b: Any, x: Any, y: Any) -> tuple[Any, ...]:
        of = partial(call, "root")
        of(x + 100.0)
        return of(x) + y, of(x) * of(y), of(a * b) * x

    code, _ = recorded(formula, root=root)
    function = code(2.0, 8.0)
    assert calls == [16.0]
    assert function(4.0, 9.0) == (11.0, 6.0, 16.0)
    assert sorted(calls) == [4.0, 9.0, 16.0]
