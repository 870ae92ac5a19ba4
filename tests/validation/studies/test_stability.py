"""The study of linear stability: engine against in-house, and what its page says of that."""

from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import mbs_models
from analysis import POSSIBLE_SETS, ConstraintSet, Scenario
from analysis.data.constraint_set import set_name
from analysis.stability import spectra
from analysis.stability.critical import Crossing, critical_speeds
from tests.helpers import failing, planted
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


def wrong(rows: dict[str, pd.DataFrame], study: str, at: int, column: str, value: Any) -> Content:
    """What is shown with one value replaced."""
    return present({**rows, study: planted(rows[study], at, column, value)})


def test_all_holds_but_for_the_scenes_that_are_missing(rows: dict[str, pd.DataFrame]) -> None:
    content = present(rows)
    assert failing(content.checks) == {"eigenvalues: scenes in both motions"}
    assert [verdict.answer for verdict in content.verdicts] == ["yes", "no", "partly"]
    assert "stable nowhere from 0 to 60" in content.verdicts[2].numbers


@pytest.mark.parametrize(
    ("study", "quantity", "column", "check"),
    [
        ("eigenvalues", None, "difference", "eigenvalues"),
        ("eigenvalues", None, measured.OWN, "eigenvalues"),
        ("critical-speeds", measured.COMPUTED, "engine", "critical speed: ways apart"),
        ("stable-region", measured.INSIDE, "in-house", "growth inside, in-house"),
        ("stable-region", measured.INSIDE, "engine", "growth inside, engine"),
    ],
)
def test_what_differs_or_is_no_number_fails(
    study: str, quantity: Any, column: str, check: str, rows: dict[str, pd.DataFrame]
) -> None:
    at = rows[study].isin([quantity]).any(axis=1).idxmax()
    known = failing(present(rows).checks)
    for value in (1e-4, nan, inf):
        content = wrong(rows, study, at, column, value)
        assert any(check in each for each in failing(content.checks) - known)
        if study == "critical-speeds":
            assert content.verdicts[0].answer == "no"


def test_a_held_spin_that_changes_where_it_is_stable_fails(rows: dict[str, pd.DataFrame]) -> None:
    held = rows["eigenvalues"].iloc[:2].assign(**{"stable spins in rad/s": "0 to 60"})
    more = {**rows, "eigenvalues": pd.concat([rows["eigenvalues"], held], ignore_index=True)}
    assert "eigenvalues: sets that holding the spin changes" in failing(present(more).checks)


@pytest.mark.parametrize("side", ["in-house", "engine"])
def test_the_stable_region_ends_at_its_edges_and_all_its_points_are_asked(
    side: str, rows: dict[str, pd.DataFrame]
) -> None:
    region = rows["stable-region"]
    at = int(np.flatnonzero(region.place == measured.INSIDE)[0]) - 1
    beyond = wrong(rows, "stable-region", at, side, -0.1)
    assert f"stable region: growth beyond edge 3, {side}" in failing(beyond.checks)
    fewer = present({**rows, "stable-region": region.drop(index=at)})
    assert "stable region: points" in failing(fewer.checks)
