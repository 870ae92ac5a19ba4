"""The study of maps: its stored cells, what it makes of them, and that its checks can fail."""

import numpy as np
import pandas as pd
import pytest

from analysis import Scenario
from tests.helpers import failing
from validation.maps.panel import Panel
from validation.maps.problems import DISTANCES, PROBLEMS, Uncertainty, panels
from validation.studies import maps
from validation.study import load

PLANTED = [
    ("runs that failed", "tilting", 0, "outcome", "failed"),
    ("cells seen by both sides that end differently", "basins 3", None, "alike", False),
    ("repeated cells that end otherwise than in their map", "rest", 155, "outcome", "upper face"),
    ("cells that are not where their numbers are", "spin-friction", 0, "start.spin", np.nan),
    ("panels without such cells", "rest", None, "seen", False),
    ("panels without two outcomes repeated", "tilting, again", None, "outcome", "lost"),
]
"""What fails, and in which cell of a case, or in all of them, what is changed."""


def test_stored_maps_pass_all_checks_and_fail_where_a_wrong_value_is_planted() -> None:
    stored = load(maps.STUDY)
    assert not failing(maps.checks(stored))
    for name, case, number, column, value in PLANTED:
        wrong, numbers = stored.copy(), stored["number"]
        cells = (stored["case"] == case) & (numbers == (numbers if number is None else number))
        wrong.loc[cells, column] = value
        assert f"maps: {name}" in failing(maps.checks(wrong))


def toy(**outcomes: str) -> Panel:
    """The grid of a map of 3 by 3 cases, in which some end otherwise."""
    (sweep,) = panels(PROBLEMS["attitude"], Scenario(), cells=2, levels=0, end=1.0, witnesses=0)
    every = ["inverted"] * 9
    for name, value in outcomes.items():
        every[int(name[1:])] = value
    return Panel(sweep=sweep, cells=pd.DataFrame({"number": range(9), "outcome": every}))


def test_models_agree_where_both_invert_or_neither_does() -> None:
    one, other = toy(_0="flat", _4="lost"), toy(_0="not inverted", _5="flat")
    (parts,) = maps.agreement([one, other]).to_numpy()
    # Upright is the row in the middle.
    assert parts == pytest.approx([75.0, 75.0, 75.0, 87.5])
    assert (maps.agreement([one, one]) == 100.0).all(axis=None)


def test_least_spin_is_measured_from_the_second_critical_speed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    points = [[-2.0, 0.8], [-1.0, 0.8], [1.5, 0.8], [-2.0, 3.0], [-1.0, 3.0], [1.5, 3.0]]
    monkeypatch.setattr(maps, "critical_points", lambda *_: {"hopf": np.array(points)})
    panel = toy(_0="flat", _3="flat", _6="flat", _7="flat", _8="lost")
    # In place of spins, gamma is -pi/2, 0 and pi/2; the last row does not invert anywhere.
    np.testing.assert_allclose(maps.above_critical(panel, 0.8), [1.0, 1.0])
    np.testing.assert_allclose(maps.above_critical(panel, 1.5), [1.0])


def fine(exponent: float, error: float) -> Uncertainty:
    return Uncertainty(parts=np.zeros(len(DISTANCES)), exponent=exponent, error=error)


def test_verdicts_on_spins_and_boundaries_follow_their_criteria(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for apart, found, speeds, boundary in (
        ((0.0, 3.0), fine(0.8, 0.09), "yes", "yes"),
        ((0.0, 3.1), fine(0.8, 0.11), "partly", "not shown"),
        ((-0.1, 1.0), None, "no", "not shown"),
    ):
        monkeypatch.setattr(maps, "above_critical", lambda *_, told=apart: np.array(told))
        monkeypatch.setattr(maps, "uncertainty", lambda _, told=found: told)
        claims = maps.present({"maps": load(maps.STUDY)}).tables["claims"]
        assert claims["verdict"].tolist() == [speeds, speeds, boundary]
