"""Many runs at once, told by arrays or listed: those of single members, each on its own."""

import os
import pickle
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from math import pi
from typing import Any

import numpy as np
import pytest

from analysis import (
    LEVELS,
    Ensemble,
    Scenario,
    Start,
    State,
    ToleranceError,
    Trajectories,
    Trajectory,
    simulate,
    simulate_many,
)
from analysis.compiled import code
from analysis.data.changes import changed
from analysis.models import ensemble as many
from tests.helpers import assert_close, model

TIMES = np.linspace(0.0, 1.0, 51)
SHORT = TIMES[:11]
SOME = 6
REDUCED: dict[str, Any] = {"form": "reduced"}


@pytest.fixture(autouse=True)
def _compiled_in_a_quarter_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "COMPACT", True)


def spins(*values: float, **fields: Any) -> Ensemble:
    return Ensemble(scenario=model(4), fields={"spin": np.array(values), **fields})


def assert_same_as_alone(runs: Trajectories, relative: float, **how: Any) -> None:
    """Every member is what `simulate` makes of it, in the arrays and by itself."""
    for member, scenario in enumerate(runs.ensemble):
        single = simulate(scenario, runs.times, **how)
        found, count = runs[member], int(np.sum(runs.times <= single.times[-1]))
        assert found.scenario == scenario
        assert dict(found.method) == dict(single.method)
        assert found.error_estimate == pytest.approx(single.error_estimate, abs=1e-11)
        assert found.inversion.outcome == single.inversion.outcome
        assert runs.inversions[member] == found.inversion
        for each in (found, single):
            assert (each.ending and each.ending.reason) == runs.endings[member]
        assert runs.ends[member] == found.times[-1] == pytest.approx(single.times[-1], abs=1e-10)
        for name in ("coordinates", "rates", "multipliers"):
            assert_close(getattr(found, name), getattr(single, name), relative=100 * relative)
        for name in ("coordinates", "rates"):
            whole = getattr(runs, name)[member]
            assert_close(whole[:count], getattr(single, name)[:count], relative=relative)
            assert np.isnan(whole[count:]).all()


def test_members_of_a_compiled_ensemble_are_those_of_single_runs() -> None:
    pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")
    # More than one batch, and members that end: inverted, or flat.
    ensemble = spins(
        *(20.0, 33.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 0.0),
        beta=np.append(np.full(8, 1.5), 1.0),
        gamma=np.append(np.full(8, 0.1 - pi / 2), pi / 2),
    )
    how: dict[str, Any] = {"stop_when": "inverted", "method": "taylor", "tolerance": 1e-8}
    runs = simulate_many(ensemble, TIMES, **how, **REDUCED)
    assert_same_as_alone(runs, 1e-10, **how, **REDUCED)
    assert set(runs.endings) == {None, "inverted", "flat"}
    again = pickle.loads(pickle.dumps(runs))  # noqa: S301 - as worker processes do
    np.testing.assert_array_equal(again.coordinates, runs.coordinates)
    np.testing.assert_array_equal(again[3].multipliers, runs[3].multipliers)


def test_members_of_a_pure_ensemble_are_those_of_single_runs() -> None:
    how: dict[str, Any] = {"method": "DOP853", "local_tolerance": 1e-6, "stop_when": "inverted"}
    runs = simulate_many(spins(30.0, 40.0), TIMES, workers=1, **how, **REDUCED)
    assert_same_as_alone(runs, 1e-15, **how, **REDUCED)


def test_ensemble_in_pieces_is_the_same_told_by_arrays_or_listed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")
    monkeypatch.setattr(many, "COMPILED_CHUNK", 3)
    ensemble = spins(30.0, 40.0, 60.0, 50.0, beta_rate=np.array([0.0, 0.0, 30.0, 0.0]))
    how: dict[str, Any] = {"tolerance": 1e-6, **REDUCED}
    told: list[tuple[int, int]] = []
    with ThreadPoolExecutor(1) as thread:
        elsewhere = how | {"executor": thread, "progress": lambda *counts: told.append(counts)}
        runs = simulate_many(ensemble, TIMES, **elsewhere)
        listed = simulate_many(list(ensemble), TIMES, **elsewhere)
    assert told == 2 * [(3, 4), (4, 4)]
    whole = simulate_many(ensemble, TIMES, workers=1, **how)
    np.testing.assert_allclose(runs.coordinates, whole.coordinates, rtol=0.0, atol=1e-12)
    for each in (runs, whole):
        assert list(each.failures) == [2]
        assert np.isnan(each.coordinates[2]).all()
        with pytest.raises(ValueError, match="start needs a contact that pulls"):
            each[2]
    assert str(runs.outcome(2)) == str(listed[2])
    for member in (0, 1, 3):
        outcome = listed[member]
        assert isinstance(outcome, Trajectory)
        np.testing.assert_array_equal(outcome.coordinates, runs[member].coordinates)


RANGES: dict[str, tuple[float, ...]] = {
    "start.spin": (20.0, -3.0, 2e5),
    "start.beta": (1.2, 0.0, 1e-9, np.nan),
    "start.beta_rate": (0.0, 0.0, 2.0, np.inf),
    "start.gamma_rate": (0.3,),
    "start.x": (0.0, 0.01),
    "start.height": (0.0, 0.01, -1.0),
    "friction.smoothing": (0.1, 0.0, 1e-13),
    "disk.eccentricity": (2e-3, 0.0, 0.05, -1.0),
    "disk.inertia_y": (2.2e-4, 1e-3, 1e-9),
    "table.inclination": (0.0, 0.1, 2.0),
    "dissipation.pivoting": (0.0, 1e-6, 2.0),
}


def first_refusal(base: Scenario, fields: dict[str, Any]) -> str | None:
    """What the rules of one scenario say, member by member."""
    for member in range(SOME):
        try:
            changed(base, {name: values[member] for name, values in fields.items()})
        except ValueError as error:
            return f"member {member} of fields: {error}"
    return None


@pytest.mark.parametrize("level", LEVELS)
def test_ensemble_refuses_what_a_scenario_refuses(level: Any) -> None:
    random, refused = np.random.default_rng(level), 0
    for _ in range(60):
        names = random.choice(list(RANGES), size=2, replace=False)
        fields = {name: random.choice(RANGES[name], size=SOME) for name in names}
        wanted = first_refusal(model(level), fields)
        if wanted is None:
            assert len(Ensemble(scenario=model(level), fields=fields)) == SOME
            continue
        refused += 1
        with pytest.raises(ValueError, match=r"^member") as told:
            Ensemble(scenario=model(level), fields=fields)
        assert str(told.value) == wanted
    assert refused > 10


def test_each_member_has_its_own_end_in_order() -> None:
    members = [model(1), model(1, start=Start(spin=200.0))]
    how: dict[str, Any] = {"method": "DOP853", "workers": 1}
    (hopeless,) = simulate_many(members[:1], SHORT, tolerance=1e-16, **how)
    assert isinstance(hopeless, ToleranceError)
    fine, pulling = simulate_many(members, SHORT, tolerance=1e-6, **how)
    for member, outcome in zip(members, (fine, pulling), strict=True):
        assert isinstance(outcome, Trajectory)
        assert outcome.scenario == member
        assert outcome.ending == simulate(member, SHORT, tolerance=1e-6).ending


def killer(_: State) -> float:
    os._exit(1)


@pytest.mark.slow
def test_members_of_a_killed_process_say_so() -> None:
    outcomes = simulate_many([model(4)] * 3, SHORT, method="DOP853", stop_when=killer, workers=2)
    assert [type(outcome) for outcome in outcomes] == [BrokenProcessPool] * 3
