"""Dual numbers: exact derivatives of whatever is worked out with them."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.mechanics.dual import derivatives, rate
from analysis.problem.elementary import asinh, cos, exp, hypot, log, sin, sqrt, tanh
from tests.helpers import assert_close, jacobian

FORMULAS: dict[str, Callable[[Sequence[Any]], list[Any]]] = {
    "sums": lambda x: [-x[0] + 2.0 - x[1], 3.0 - (x[0] - x[1]), x[1] + 1.5],
    "products": lambda x: [x[0] * x[1] * 2.0, 3.0 * x[1], x[0] * x[0] * x[0]],
    "quotients": lambda x: [x[0] / x[1], 1.0 / x[1], x[0] / 4.0],
    "functions": lambda x: [sin(x[0] * x[1]), cos(x[0]) / sqrt(x[1]), sqrt(x[0] * x[0] + 1.0)],
    "further functions": lambda x: [exp(x[0]), tanh(x[0]), log(x[1]), asinh(x[1]), hypot(*x)],
}


@pytest.mark.parametrize("name", FORMULAS)
def test_derivatives_are_those_of_the_formula(name: str) -> None:
    place = np.array((0.7, 1.9))
    slopes = jacobian(lambda x: np.array(FORMULAS[name](x.tolist())), place)
    assert_close(derivatives(FORMULAS[name], place), slopes, relative=1e-11)


def test_values_may_be_arrays_of_many_places() -> None:
    x, y = np.linspace(0.1, 1.0, 5), np.linspace(2.0, 3.0, 5)
    (found,) = rate(lambda z: [z[0] * sin(z[1])], (x, y), (np.ones(5), 2.0 * np.ones(5)))
    np.testing.assert_allclose(found, np.sin(y) + 2.0 * x * np.cos(y), rtol=1e-14)
