"""The study of linear stability: engine against in-house, and what its page says of that."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import mbs_models
from analysis import POSSIBLE_SETS, ConstraintSet, Scenario
from analysis.data.constraint_set import set_name
from analysis.stability import spectra
from analysis.stability.critical import Crossing, critical_speeds
from validation import study as kit
from validation.page.content import Content
from validation.studies.stability import figures, measured
from validation.studies.stability.eigenvalue_check import (
    EIGENVALUE_LIMIT,
    distance,
    engine_matrices,
)
from validation.studies.stability.section import STUDIES, present
from validation.studies.stability.variants import PRINTED, hopf_speeds, reproduces, variants

PAPER = Scenario()


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_engine_and_in_house_eigenvalues_agree_under_every_set(constraints: ConstraintSet) -> None:
    scenario, spins = Scenario(constraints=constraints), np.array([0.0, 33.0])
    for formulation in mbs_models.formulations(scenario)[:2]:
        found = np.linalg.eigvals(engine_matrices(scenario, spins, formulation=formulation))
        for one, other in zip(found, spectra.eigenvalues(scenario, spins), strict=True):
            assert distance(one.astype(complex), other) <= EIGENVALUE_LIMIT


@pytest.fixture(scope="module")
def tried() -> dict[str, tuple[Crossing, ...]]:
    return variants()


def test_no_obvious_choice_reproduces_the_printed_critical_speeds(
    tried: dict[str, tuple[Crossing, ...]],
) -> None:
    assert len(tried) > 25
    assert not any(reproduces(crossings) for crossings in tried.values())
    right = tried["equations as they are"]
    shifted = (replace(each, spin=spin) for each, spin in zip(right, PRINTED, strict=True))
    assert reproduces(tuple(shifted))


def test_printed_signs_give_the_speeds_of_the_full_system_in_the_wrong_directions(
    tried: dict[str, tuple[Crossing, ...]],
) -> None:
    printed = tried["(53) and (54) with the printed signs"]
    expected = [each.spin for each in critical_speeds(PAPER).hopf]
    for found in (printed, hopf_speeds()):
        np.testing.assert_allclose([each.spin for each in found], expected, rtol=1e-10)
    assert [crossing.stable_side for crossing in printed] == ["above", "below"]


@pytest.fixture(scope="module")
def rows() -> dict[str, pd.DataFrame]:
    """All rows, of eigenvalues those of two scenes."""
    scenes = ("Model 1, contact-tree", "Model 4, euler-tree")
    made = {}
    for study in STUDIES:
        cases = study.cases()
        labels = scenes if study is measured.EIGENVALUES else cases
        found = {label: kit.rows_of(study.measure, cases[label]) for label in labels}
        made[study.name] = kit.frame(
            {"case": label, **row} for label, each in found.items() for row in each
        )
    return made


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("figure_6", "figure_10", "figure_11", "chart"):
        monkeypatch.setattr(figures, name, lambda *_: Figure())


def failing(content: Content) -> set[str]:
    return {check.name for check in content.checks if not check.holds}


def planted(
    rows: dict[str, pd.DataFrame], study: str, where: int, column: str, value: object
) -> dict[str, pd.DataFrame]:
    """The same rows with one value replaced."""
    changed = rows[study].astype({column: object})
    changed.at[where, column] = value
    return {**rows, study: changed.infer_objects()}


def test_all_holds_but_for_the_scenes_that_are_missing(rows: dict[str, pd.DataFrame]) -> None:
    content = present(rows)
    assert failing(content) == {"eigenvalues: scenes in both motions"}
    assert [verdict.answer for verdict in content.verdicts] == ["yes", "no", "partly"]
    assert "stable nowhere from 0 to 60" in content.verdicts[2].numbers


@pytest.mark.parametrize("value", [1e-4, nan, inf])
@pytest.mark.parametrize("column", ["difference", measured.OWN])
def test_eigenvalues_that_differ_fail(
    column: str, value: float, rows: dict[str, pd.DataFrame]
) -> None:
    assert len(failing(present(planted(rows, "eigenvalues", 0, column, value)))) == 2


def test_a_held_spin_that_changes_where_it_is_stable_fails(rows: dict[str, pd.DataFrame]) -> None:
    held = rows["eigenvalues"].iloc[:2].assign(**{"stable spins in rad/s": "0 to 60"})
    wrong = {**rows, "eigenvalues": pd.concat([rows["eigenvalues"], held], ignore_index=True)}
    assert "eigenvalues: sets that holding the spin changes" in failing(present(wrong))


def test_a_critical_speed_that_one_way_finds_elsewhere_fails(
    rows: dict[str, pd.DataFrame],
) -> None:
    at = int(np.flatnonzero(rows["critical-speeds"].quantity == measured.COMPUTED)[0])
    for value in (30.9, nan):
        content = present(planted(rows, "critical-speeds", at, "engine", value))
        assert "critical speed: ways apart" in failing(content)
        assert content.verdicts[0].answer == "no"


@pytest.mark.parametrize("side", ["in-house", "engine"])
def test_the_verdict_on_the_stable_region_comes_from_the_points_that_were_asked(
    side: str, rows: dict[str, pd.DataFrame]
) -> None:
    region = rows["stable-region"]
    at = int(np.flatnonzero(region.place == measured.INSIDE)[0])
    for value in (0.1, nan):
        content = present(planted(rows, "stable-region", at, side, value))
        assert content.verdicts[2].answer == "yes"
        assert f"stable region: growth inside, {side}" in failing(content)
    other = present(planted(rows, "stable-region", at - 1, side, -0.1))
    assert f"stable region: growth beyond edge 3, {side}" in failing(other)
    fewer = present({**rows, "stable-region": region.drop(index=at - 1)})
    assert "stable region: points" in failing(fewer)
