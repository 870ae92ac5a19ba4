"""What ends a motion is found wherever it lies within a step."""

import numpy as np
import pytest

from analysis.problem.checks import Array
from analysis.solve.stepping import InitialValueProblem, integrate
from analysis.solve.watch import Watch


@pytest.mark.parametrize("lowest", [0.5, 0.54, 0.5625, 0.6])
@pytest.mark.parametrize("half", [0.03, 0.01])
def test_short_dip_ends_a_motion_wherever_in_a_step_it_lies(lowest: float, half: float) -> None:
    def condition(state: Array) -> float:
        return float((state[0] - lowest) ** 2 - half**2)

    clock = InitialValueProblem(
        lambda _, state: np.ones_like(state),
        np.zeros(1),
        leaning=None,
        normal_force=None,
        longest_step=1.0,
        attitudes=lambda states: states,
        conditions={"dip": condition},
    )
    times = np.array([0.0, 1.0])
    run = integrate(clock, times, "DOP853", 1e-3, allow_pulling=True, watch=Watch())
    assert run.ended == "dip"
    assert run.times[-1] == pytest.approx(lowest - half, abs=1e-12)
