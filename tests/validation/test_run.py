"""One call for either side."""

from typing import Any

import numpy as np
import pytest

from analysis import Scenario, Start
from tests.calls import python
from validation.run import run, run_effort

TIMES = np.linspace(0.0, 0.05, 6)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"tolerance": 1e-6}, {"tolerance": 1e-6}),
        ({"step": 1e-3, "formulation": "floating"}, {"step": 1e-3, "formulation": "floating"}),
        ({"local_tolerance": 1e-9}, {"integrator": "DOPRI5"}),
        (
            {"source": "in-house", "formulation": "index-1", "method": "RK45", "tolerance": 1e-6},
            {"formulation": "index-1", "method": "RK45", "tolerance": 1e-6},
        ),
    ],
)
def test_run_hands_all_it_is_given_to_the_side_asked_for(how: Any, said: dict[str, str]) -> None:
    scenario = Scenario(start=Start(spin=35.0))
    seen: list[float] = []
    found = run(scenario, TIMES, **how, progress=lambda time, _: seen.append(time))
    assert (found.source, found.scenario) == (how.get("source", "engine"), scenario)
    assert said.items() <= found.method.items()
    assert seen
    np.testing.assert_array_equal(found.times, TIMES)
    # A single run tells no error.
    assert (found.error_estimate is None) == ("tolerance" not in how)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"source": "both"}, "source must be one of engine, in-house"),
        ({"source": "in-house", "step": 1e-3}, "step must be left out for source 'in-house'"),
        ({"local_tolerance": 1e-9, "integrator": "RK44"}, "integrator must be DOPRI5 with a"),
        ({"tolerance": 1e-6, "step": 1e-3}, "step must be left out for a run with its tolerance"),
    ],
)
def test_how_a_side_cannot_run_is_refused_also_by_its_effort(how: Any, said: str) -> None:
    for call in (run, run_effort):
        with pytest.raises(ValueError, match=f"^{said}"):
            call(Scenario(), TIMES, **how)


def test_in_house_run_does_not_load_the_engine() -> None:
    code = (
        "import sys; from validation.run import run; from analysis import Scenario; "
        "run(Scenario(), [0.0, 0.01], source='in-house'); assert 'exudyn' not in sys.modules"
    )
    python("-c", code)
