"""Outcomes of many motions: those of single ones, and the same table from everywhere."""

from concurrent.futures import BrokenExecutor
from math import pi
from typing import Any, cast

import numpy as np
import pytest
from scipy.integrate import simpson

from analysis import (
    MODELS,
    ConstraintSet,
    Ensemble,
    Scenario,
    SmoothCoulomb,
    Start,
    TimeLimitError,
    outcomes,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from analysis.compiled import code
from analysis.data.outcomes import DONE, OUTCOMES, Row
from tests.helpers import TILTED, model, not_none
from tests.sweeps import sweep
from validation.sweeps.case import run_chunk
from validation.sweeps.outcomes import COLUMNS, NUMBERS

ENDING: dict[str, np.ndarray[Any, Any]] = {
    "spin": np.array([36.0, 40.0, 44.0, 40.0, 0.0, 40.0]),
    "beta": np.append(np.full(4, 1.5), [1.0, 1.5]),
    "gamma": np.append(np.full(4, 0.1 - pi / 2), [pi / 2, 0.1]),
    "beta_rate": np.array([0.0, 0.0, 0.0, 30.0, 0.0, 0.0]),
    "eccentricity": np.array([2e-3, 2e-3, 0.0, 2e-3, 2e-3, 2e-3]),
}
"""Members that are inverted, are not, fall flat, and have no motion."""


@pytest.fixture(autouse=True)
def _compiled_in_a_quarter_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "COMPACT", True)


def assert_alike(found: Row, expected: Row, relative: float) -> None:
    for name in set(found) | set(expected):
        cell, other = found.get(name), expected.get(name)
        if isinstance(other, float) and name != "seconds":
            # An error estimate is a difference of nearly the same numbers.
            tiny = 1e-10 if name == "error_estimate" else 1e-13
            assert cell == pytest.approx(other, rel=relative, abs=tiny), name
        elif name not in ("seconds", "number"):
            assert cell == other, name


def test_outcomes_of_arrays_are_those_of_single_motions() -> None:
    pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")
    ensemble = Ensemble(scenario=model(4), fields=ENDING)
    how: dict[str, Any] = {"form": "reduced", "tolerance": 1e-6, "method": "taylor"}
    runs = simulate_many(ensemble, np.linspace(0.0, 2.0, 201), workers=1, **how)
    table = outcomes(runs)
    assert set(table.columns["ending"]) == {None, "flat"}
    assert set(table.columns["status"]) == {DONE, "refused"}
    assert {"inverted", "not inverted"} <= set(table.columns["inversion"])
    assert np.all(table.columns["seconds"] > 0.0)
    motions = outcomes([runs.outcome(member) for member in range(len(runs))])
    for found, expected in zip(table.rows(), motions.rows(), strict=True):
        assert_alike({name: found[name] for name in OUTCOMES}, expected, 1e-11)


LEANING = {
    "scenario": model(3, friction=SmoothCoulomb(load="contact")), "end": 0.5, "tolerance": 1e-6,
}  # fmt: skip


@pytest.mark.parametrize(
    ("axes", "how"),
    [
        (("spin=25,45", "mu=0.3,-0.1,0.6", "beta_rate=0,30"), {"end": 1.5, "keep": ("beta",)}),
        pytest.param(("inclination=0,0.05", "spin=30,45"), LEANING, marks=pytest.mark.slow),
    ],
    ids=["reduced", "index-1"],
)
def test_rows_of_a_batch_are_those_of_its_cases(
    axes: tuple[str, ...], how: dict[str, Any]
) -> None:
    pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")
    wanted = sweep(*axes, method="taylor", **{"tolerance": 1e-6, **how})
    numbers = range(wanted.design.size)
    for number, row in zip(numbers, run_chunk(wanted, numbers, 60.0, 60.0), strict=True):
        (alone,) = run_chunk(wanted, [number], 60.0, 60.0)
        assert row["number"] == number
        kept, expected = (each.pop("series", {}) for each in (row, alone))
        assert kept.keys() == expected.keys()
        for name in kept:
            found, known = (np.frombuffer(each[name], NUMBERS) for each in (kept, expected))
            np.testing.assert_allclose(found, known, rtol=1e-9)
        assert_alike(row, alone, 1e-9)


def test_spin_is_told_a_second_after_the_inversion() -> None:
    motion = simulate(model(1), np.linspace(0.0, 2.0, 101), local_tolerance=1e-8)
    (row,) = outcomes([motion]).rows()
    inversion = motion.inversion
    assert row["inverted_at"] == inversion.time
    assert row["inverted_at_error"] == inversion.time_error
    later, then = (motion.at(not_none(inversion.time) + after).rates[3] for after in (1.0, 0.0))
    assert abs(later - then) > 1.0
    assert row["spin_after"] == pytest.approx(later, abs=0.01)


@pytest.mark.parametrize(
    ("held", "torque", "angle"),
    [(MODELS[4], "spin_torque", "alpha"), (TILTED[0], "tilt_torque", "beta")],
    ids=["spin", "tilt"],
)
def test_sliding_took_what_a_held_rate_brought(
    held: ConstraintSet, torque: str, angle: str
) -> None:
    start = Start(beta_rate=0.5 if angle == "beta" else None)
    scenario = Scenario(constraints=held, start=start)
    motion = simulate(scenario, np.linspace(0.0, 0.2, 41), local_tolerance=1e-6)
    assert np.ptp(motion.rate(angle)) < 1e-9
    (row,) = outcomes([motion]).rows()
    brought = simpson(motion.multiplier(torque) * motion.rate(angle), x=motion.times)
    assert abs(brought) > 1e-5
    assert row[f"brought_by_{torque}"] == pytest.approx(brought)
    lost = cast("float", row["energy_start"]) - cast("float", row["energy_end"])
    assert row["taken_sliding"] == pytest.approx(lost + brought, rel=1e-12)


def test_budget_of_a_motion_to_rest_is_told_from_its_first_sample_to_its_last() -> None:
    motion = simulate_to_rest(Scenario.rest(), 0.05, spacing=0.01, local_tolerance=1e-9)
    (row,) = outcomes([motion]).rows()
    totals = [row[name] for name in ("energy_start", "energy_end")]
    assert totals == motion.energies.sum(axis=1)[[0, -1]].tolist()
    taken = sum(cast("float", row[name]) for name in row if name.startswith("taken_"))
    assert taken == pytest.approx(motion.dissipated[-1].sum())
    assert taken > 0.0


def test_errors_are_rows_that_say_why() -> None:
    errors = [ValueError("no\n such"), ArithmeticError(), TimeLimitError("late"), BrokenExecutor()]
    motion = simulate(model(1), np.linspace(0.0, 0.1, 3), local_tolerance=1e-6)
    table = outcomes([*errors, motion])
    assert table.columns["status"].tolist() == ["refused", "failed", "too slow", "crashed", DONE]
    assert table.columns["reason"][:2].tolist() == ["no such", "ArithmeticError"]
    assert np.isnan(table.columns["end"]).tolist() == [True] * 4 + [False]


def test_columns_of_a_sweep_are_those_of_an_ensemble() -> None:
    ensemble = Ensemble(scenario=Scenario(), fields={"spin": np.array([30.0, 40.0])})
    how: dict[str, Any] = {"method": "DOP853", "local_tolerance": 1e-6, "workers": 1}
    runs = simulate_many(ensemble, np.linspace(0.0, 0.1, 3), **how)
    table = outcomes(runs)
    assert list(table.columns) == ["number", "start.spin", *OUTCOMES]
    assert list(COLUMNS)[: len(OUTCOMES)] == list(OUTCOMES)
    assert (table.units["start.spin"], table.units["force_least"]) == ("rad/s", "N")
    assert table.columns["start.spin"].tolist() == [30.0, 40.0]
    for row, other in zip(table.rows(), outcomes(list(runs)).rows(), strict=True):
        assert_alike({name: row[name] for name in OUTCOMES}, other, 1e-13)
