"""Series that a sweep keeps of each motion."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import MODELS, Scenario, Start, Trajectory, simulate_to_rest
from tests.sweeps import sweep, swept
from validation.run import run
from validation.sweeps.case import COLUMNS, series
from validation.sweeps.plan import REST_SERIES, SERIES, TIME, series_named
from validation.sweeps.store import expected_size

REDUCED = Scenario(constraints=MODELS[4])
KEEP = ("beta", "normal_force")


def motion(scenario: Scenario, **how: Any) -> Trajectory:
    times = np.linspace(0.0, 0.05, 11)
    given: dict[str, Any] = {"source": "in-house", "formulation": "reduced", "tolerance": 1e-4}
    return run(scenario, times, **(given | how))


def test_what_can_be_kept_is_all_that_a_motion_holds() -> None:
    made = motion(REDUCED)
    rest = simulate_to_rest(Scenario.rest(start=Start(spin=5.0)), 0.02, local_tolerance=1e-3)
    assert (TIME, *REST_SERIES) == tuple(rest.columns())
    # The constraints that Model 4 does not have have these forces.
    assert {TIME, *SERIES} - made.columns().keys() == {"lateral_force", "tilt_torque"}
    assert made.columns().keys() <= {TIME, *SERIES}
    # They share a dataset.
    assert not {"number", *COLUMNS} & {TIME, *SERIES, *REST_SERIES}


def test_kept_series_are_those_of_the_runs_themselves_with_gaps_where_there_is_none(
    tmp_path: Path,
) -> None:
    wanted, path = sweep("spin=30:40:2", "mu=0.3,-0.1", keep=KEEP), tmp_path / "a.db"
    # A sweep that goes on keeps them, too.
    swept(wanted, path, numbers=[0, 1])
    results = swept(wanted, path)
    found, made = results.series(2), motion(replace(REDUCED, start=Start(spin=40.0)))
    assert tuple(found) == (TIME, *KEEP)
    np.testing.assert_array_equal(found["time"], made.times)
    np.testing.assert_array_equal(found["beta"], made.coordinate("beta"))
    np.testing.assert_array_equal(found["normal_force"], made.normal_force)
    with pytest.raises(ValueError, match="holds no series of case 1"):
        results.series(1)
    pytest.importorskip("xarray")
    beta = results.to_xarray()["beta"]
    assert beta.dims == ("start.spin", "friction.coefficient", "sample")
    assert beta.shape == (2, 2, 11)
    np.testing.assert_array_equal(beta[1, 0], found["beta"])
    assert np.all(np.isnan(beta[:, 1]))


def test_groups_stand_for_their_series_and_absent_forces_are_left_out() -> None:
    named = series_named(("gamma", "coordinates", "alpha_rate"), to_rest=False)
    assert named == ("gamma", "x", "y", "z", "alpha", "beta", "alpha_rate")
    pushed = motion(Scenario(), formulation="index-1")
    assert set(series(pushed, ("beta", "spin_torque"))) == {TIME, "beta"}


def test_series_count_in_the_size_of_a_store() -> None:
    plain, kept = (sweep("spin=0:60:1000", end=2.0, keep=names) for names in ((), KEEP))
    assert expected_size(kept) - expected_size(plain) >= 1000 * 3 * 401 * 8
