"""Stability functions of explicit integrators, measured on the engine itself."""

from math import factorial
from typing import Any

import numpy as np
import pytest

from mbs_models.linear_stability import STAGES, largest_step, stability_polynomial


@pytest.mark.parametrize("integrator", STAGES)
def test_stability_function_starts_like_the_exponential(integrator: Any) -> None:
    order = {"RK44": 4, "RK67": 6}[integrator]
    found = stability_polynomial(integrator)
    expected = [1.0 / factorial(power) for power in range(order + 1)]
    np.testing.assert_allclose(found[: order + 1], expected, atol=1e-14)


def test_stability_limit_of_the_classical_method_is_the_known_one() -> None:
    assert largest_step("RK44", -1.0) == pytest.approx(2.785, abs=2e-3)
    assert largest_step("RK44", 1.0j) == pytest.approx(2.828, abs=2e-3)
    assert largest_step("RK44", -200.0) == pytest.approx(2.785 / 200.0, rel=1e-3)
