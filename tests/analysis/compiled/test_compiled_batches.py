"""Compiled batches: members are those of single runs, and each on its own."""

from typing import Any

import numpy as np
import pytest

from analysis import (
    Ensemble,
    Start,
    ToleranceError,
    Trajectory,
    simulate,
    simulate_many,
)
from analysis.compiled import code
from analysis.models import request
from tests.analysis.compiled.test_compiled import Branching
from tests.helpers import model, not_none
from validation import benchmark, by_hand

pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")

TIMES = np.linspace(0.0, 0.6, 121)


@pytest.fixture(autouse=True)
def _compiled_in_a_quarter_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "COMPACT", True)


def test_estimates_cover_the_time_at_which_a_condition_ends_a_member() -> None:
    members = [model(4, start=Start(spin=spin)) for spin in (36.0, 40.0, 44.0)]
    how: dict[str, Any] = {"form": "reduced", "stop_when": "inverted"}
    ends = [0.0, 1.0]
    outcomes = simulate_many(members, ends, **how, tolerance=1e-3)
    coarse, fine = (simulate_many(members, ends, **how, local_tolerance=x) for x in (1e-6, 1e-9))
    for member, *three in zip(members, outcomes, coarse, fine, strict=True):
        outcome, *pair = (each for each in three if isinstance(each, Trajectory))
        single = simulate(member, ends, **how, method="taylor", tolerance=1e-3)
        assert outcome.error_estimate == pytest.approx(single.error_estimate, rel=1e-3)
        late = abs(pair[0].times[-1] - pair[1].times[-1])
        assert late > 1e-12
        assert not_none(outcome.error_estimate) > 2.0 * late


def test_members_that_taylor_takes_to_no_tolerance_run_with_dop853(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(request, "COMPILED_TOLERANCES", (1e-6, 1e-6))
    members = [model(4, start=Start(spin=spin)) for spin in (30.0, 40.0)]
    how: dict[str, Any] = {"form": "reduced", "tolerance": 1e-9}
    times = np.linspace(0.0, 0.5, 6)
    spins = Ensemble(scenario=members[0], fields={"spin": np.array([30.0, 40.0])})
    listed, arrays = (simulate_many(each, times, **how) for each in (members, spins))
    for number, member in enumerate(members):
        alone = simulate(member, times, **how)
        for outcome in (listed[number], arrays[number]):
            assert isinstance(outcome, Trajectory)
            assert outcome.method == alone.method
            np.testing.assert_array_equal(outcome.coordinates, alone.coordinates)
    insisting = simulate_many(members, times, **how, method="taylor")
    assert all(isinstance(outcome, ToleranceError) for outcome in insisting)


def test_members_of_a_batch_pull_when_they_do_alone() -> None:
    fields = {"spin": np.array([40.0, 60.0]), "beta_rate": np.array([2.0, 25.0])}
    ensemble = Ensemble(scenario=model(4), fields=fields)
    how: dict[str, Any] = {"form": "reduced", "allow_pulling": True, "local_tolerance": 1e-12}
    runs = simulate_many(ensemble, TIMES, method="taylor", **how)
    for run, scenario in zip(runs, ensemble, strict=True):
        pure = simulate(scenario, TIMES, **how)
        np.testing.assert_allclose(run.pulling, pure.pulling, rtol=0.0, atol=1e-9)
    assert runs[1].pulling


def test_members_that_cannot_be_compiled_run_all_the_same() -> None:
    members = [model(4, friction=Branching()), model(4)]
    pure, compiled_one = simulate_many(members, TIMES, form="reduced", tolerance=1e-6)
    assert isinstance(pure, Trajectory)
    assert isinstance(compiled_one, Trajectory)
    assert pure.method["method"] == "DOP853"
    assert compiled_one.method["method"] == "taylor"
    (refused, _) = simulate_many(members, TIMES, form="reduced", tolerance=1e-6, method="taylor")
    assert isinstance(refused, ValueError)


def test_member_that_fails_leaves_its_batch_alone() -> None:
    members = [model(4), model(4, start=Start(beta_rate=30.0)), model(4)]
    first, pulling, last = simulate_many(members, TIMES, form="reduced", tolerance=1e-6)
    assert isinstance(pulling, ValueError)
    assert "start needs a contact that pulls" in str(pulling)
    assert isinstance(first, Trajectory)
    assert isinstance(last, Trajectory)
    np.testing.assert_array_equal(first.coordinates, last.coordinates)


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "form", "_"), benchmark.COMPILED, ids=["index-1", "reduced"])
def test_heyoka_driven_by_hand_samples_the_same_motion(scenario: Any, form: Any, _: int) -> None:
    times = benchmark.TIMES
    run = simulate(scenario, times, form=form, method="taylor", local_tolerance=1e-9)
    alone = by_hand.single(scenario, form, 1e-9, times)()[-1]
    many = by_hand.batches([scenario] * 8, form, 1e-9, times)()[0][:, :, 0]
    columns = slice(0, 2) if form == "reduced" else slice(4, 6)
    for sampled in (alone, many):
        np.testing.assert_allclose(sampled[:, columns], run.coordinates[:, 4:], atol=1e-7)
