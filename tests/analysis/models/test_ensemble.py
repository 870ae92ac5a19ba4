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
    PenaltyContact,
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
from analysis.data.endings import CONTACT_WOULD_PULL
from analysis.models import ensemble as many
from tests.helpers import assert_close, model

TIMES = np.linspace(0.0, 1.0, 51)
SOME = 6


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
        assert (
            found.inversion.outcome == single.inversion.outcome == runs.inversions.outcomes[member]
        )
        for name, of_one in (("times", "time"), ("time_errors", "time_error")):
            told, alone = getattr(runs.inversions, name), getattr(found.inversion, of_one)
            wanted = np.nan if alone is None else alone
            np.testing.assert_allclose(told[member], wanted, rtol=1e-12, atol=1e-14)
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
    fields = {
        "spin": np.array([20.0, 33.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 0.0]),
        "beta": np.append(np.full(8, 1.5), 1.0),
        "gamma": np.append(np.full(8, 0.1 - pi / 2), pi / 2),
    }
    how: dict[str, Any] = {"form": "reduced", "stop_when": "inverted", "method": "taylor"}
    ensemble = Ensemble(scenario=model(4), fields=fields)
    runs = simulate_many(ensemble, TIMES, tolerance=1e-8, **how)
    assert_same_as_alone(runs, 1e-10, tolerance=1e-8, **how)
    assert set(runs.endings) == {None, "inverted", "flat"}
    again = pickle.loads(pickle.dumps(runs))  # noqa: S301 - as worker processes do
    np.testing.assert_array_equal(again.coordinates, runs.coordinates)
    np.testing.assert_array_equal(again[3].multipliers, runs[3].multipliers)


def test_members_of_a_pure_ensemble_are_those_of_single_runs() -> None:
    how: dict[str, Any] = {"form": "reduced", "method": "DOP853", "local_tolerance": 1e-6}
    runs = simulate_many(spins(30.0, 40.0), TIMES, workers=1, **how, stop_when="inverted")
    assert_same_as_alone(runs, 1e-15, **how, stop_when="inverted")


def test_ensemble_in_pieces_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")
    monkeypatch.setattr(many, "COMPILED_CHUNK", 3)
    ensemble = spins(30.0, 40.0, 60.0, 50.0, beta_rate=np.array([0.0, 0.0, 30.0, 0.0]))
    how: dict[str, Any] = {"form": "reduced", "tolerance": 1e-6}
    told: list[tuple[int, int]] = []
    with ThreadPoolExecutor(1) as thread:
        runs = simulate_many(ensemble, TIMES, executor=thread, **how,
                             progress=lambda *counts: told.append(counts))  # fmt: skip
    assert told == [(3, 4), (4, 4)]
    whole = simulate_many(ensemble, TIMES, workers=1, **how)
    np.testing.assert_allclose(runs.coordinates, whole.coordinates, rtol=0.0, atol=1e-12)
    for each in (runs, whole):
        assert list(each.failures) == [2]
        assert np.isnan(each.coordinates[2]).all()
        assert "start needs a contact that pulls" in str(each.outcome(2))
        with pytest.raises(ValueError, match="contact that pulls"):
            each[2]


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
        scenario = {name: values[member] for name, values in fields.items()}
        try:
            changed(base, scenario)
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


@pytest.mark.parametrize(
    ("scenario", "fields", "message"),
    [
        (model(1), {}, "fields must map names to arrays"),
        (model(1), {"spim": [1.0]}, "fields must be a field of a scenario"),
        (model(1), {"spin": [1.0], "start.spin": [2.0]}, "start.spin twice"),
        (model(1), {"spin": [1.0, 2.0], "mu": [0.1]}, r"one shape, got \(2,\) of start.spin"),
        (model(1), {"spin": 3.0}, r"start.spin must have shape \(m,\)"),
        (model(1), {"stiffness": [1e5]}, "needs a penalty contact"),
        (
            Scenario(contact=PenaltyContact(stiffness=1e5)),
            {"stiffness": [1e5, 1.0]},
            "member 1 of fields: stiffness must be at least",
        ),
    ],
)
def test_arrays_that_do_not_fit_are_refused(scenario: Any, fields: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Ensemble(scenario=scenario, fields=fields)


SHORT = TIMES[:11]
SPINS = (20.0, 30.0, 40.0, 50.0, 60.0)


def spinning(spin: float) -> Scenario:
    return model(4, start=Start(spin=spin))


def test_members_are_those_of_single_runs_in_order() -> None:
    members = [spinning(spin) for spin in SPINS]
    told: list[tuple[int, int]] = []
    with ThreadPoolExecutor(2) as threads:
        outcomes = simulate_many(
            members,
            SHORT,
            form="reduced",
            method="DOP853",
            executor=threads,
            progress=lambda *counts: told.append(counts),
        )
    assert told[-1] == (5, 5)
    for member, outcome in zip(members, outcomes, strict=True):
        assert isinstance(outcome, Trajectory)
        single = simulate(member, SHORT, form="reduced")
        np.testing.assert_array_equal(outcome.coordinates, single.coordinates)
        assert outcome.scenario == member


def test_each_member_has_its_own_end() -> None:
    members = [model(1), model(1, start=Start(spin=200.0))]
    how: dict[str, Any] = {"method": "DOP853", "workers": 1}
    (hopeless,) = simulate_many(members[:1], SHORT, tolerance=1e-16, **how)
    assert isinstance(hopeless, ToleranceError)
    fine, pulling = simulate_many(members, SHORT, tolerance=1e-6, **how)
    assert isinstance(fine, Trajectory)
    assert fine.method["tolerance"] == 1e-6
    assert isinstance(pulling, Trajectory)
    assert pulling.ending is not None
    assert pulling.ending.reason == CONTACT_WOULD_PULL


def killer(_: State) -> float:
    os._exit(1)


@pytest.mark.slow
def test_members_of_a_killed_process_say_so() -> None:
    outcomes = simulate_many([model(4)] * 3, SHORT, method="DOP853", stop_when=killer, workers=2)
    assert [type(outcome) for outcome in outcomes] == [BrokenProcessPool] * 3
