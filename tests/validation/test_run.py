"""One call for either side."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

from analysis import STEEL_DISK, PenaltyContact, Scenario, Start
from analysis.problem.choices import SOURCES, Source
from validation.run import run, run_effort, run_to_rest

TIMES = np.linspace(0.0, 0.05, 6)


@pytest.mark.parametrize(
    ("source", "how"),
    [
        ("engine", {"tolerance": 1e-6}),
        ("engine", {"step": 1e-3, "formulation": "floating"}),
        ("engine", {"local_tolerance": 1e-9}),
        ("engine", {"local_tolerance": 1e-9, "integrator": "LSODA"}),
        ("in-house", {"formulation": "index-1", "method": "RK45", "tolerance": 1e-6}),
    ],
)
def test_run_hands_all_it_is_given_to_the_side_asked_for(source: Source, how: Any) -> None:
    scenario = Scenario(start=Start(spin=35.0))
    seen: list[float] = []
    found = run(scenario, TIMES, source=source, **how, progress=lambda time, _: seen.append(time))
    assert (found.source, found.scenario) == (source, scenario)
    assert how.items() <= found.method.items()
    assert "local_tolerance" not in how or found.method["integrator"] in ("DOPRI5", "LSODA")
    assert seen
    np.testing.assert_array_equal(found.times, TIMES)
    # A single run tells no error.
    assert (found.error_estimate is None) == ("tolerance" not in how)


WRONG: dict[str, dict[str, Any]] = {
    "source must be one of engine, in-house": {"source": "both"},
    "step must be left out for source 'in-house'": {"source": "in-house", "step": 1e-3},
    "local_tolerance is no option of": {"local_tolerance": 1e-9, "integrator": "RK44"},
    "step must be left out for a run with its tolerance": {"tolerance": 1e-6, "step": 1e-3},
}


@pytest.mark.parametrize("said", WRONG)
def test_how_a_side_cannot_run_is_refused_also_by_its_effort(said: str) -> None:
    for call in (run, run_effort):
        with pytest.raises(ValueError, match=f"^{said}"):
            call(Scenario(), TIMES, **WRONG[said])


@pytest.mark.parametrize("source", SOURCES)
def test_start_in_touch_on_a_rounded_rim_carries_the_weight_and_does_not_move_from_the_table(
    source: Source,
) -> None:
    random = np.random.default_rng(7)
    for half_thickness in (2e-4, 5e-3, STEEL_DISK.radius):
        rim = PenaltyContact.rounded(STEEL_DISK, half_thickness=half_thickness)
        # The damper tells the rate of the gap to the last digits.
        contact = replace(rim, damping=50.0 * rim.damping)
        for beta in (0.005, 0.02, *random.uniform(0.1, pi - 0.1, 4)):
            start = Start(
                beta=float(beta),
                gamma=float(random.uniform(-pi, pi)),
                spin=float(random.uniform(-40.0, 40.0)),
                beta_rate=float(random.uniform(-20.0, 20.0)),
            )
            scenario = Scenario.rest(contact=contact, start=start)
            motion = run_to_rest(scenario, 2e-4, source=source, spacing=1e-4, tolerance=1e-2)
            assert motion.normal_force[0] == pytest.approx(scenario.weight, rel=1e-7), start
