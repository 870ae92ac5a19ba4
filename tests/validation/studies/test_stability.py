"""The study of linear stability: engine against in-house, and what its page says of that."""

from dataclasses import replace
from math import nan

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import mbs_models
from analysis import POSSIBLE_SETS, ConstraintSet, Scenario
from analysis.problem.constraints import set_name
from analysis.stability import spectra
from analysis.stability.critical import critical_speeds
from tests.helpers import failing, planted
from validation import study as studying
from validation.studies.comparisons import (
    EIGENVALUE_LIMIT,
    distance,
    engine_matrices,
)
from validation.studies.stability import figures, measured
from validation.studies.stability.section import STUDIES, present
from validation.studies.stability.variants import PRINTED, reproduces, variants


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_engine_and_in_house_eigenvalues_agree_under_every_set(constraints: ConstraintSet) -> None:
    scenario, spins = Scenario(constraints=constraints), np.array([0.0, 33.0])
    for formulation in mbs_models.formulations(scenario)[:2]:
        found = np.linalg.eigvals(engine_matrices(scenario, spins, formulation=formulation))
        for one, other in zip(found, spectra.eigenvalues(scenario, spins), strict=True):
            assert distance(one.astype(complex), other) <= EIGENVALUE_LIMIT


def test_no_choice_gives_the_printed_speeds_and_printed_signs_the_wrong_directions() -> None:
    tried = variants()
    assert len(tried) > 25
    assert not any(reproduces(crossings) for crossings in tried.values())
    right, printed = (
        tried[name] for name in ("equations as they are", "(53) and (54) with the printed signs")
    )
    shifted = (replace(each, spin=spin) for each, spin in zip(right, PRINTED, strict=True))
    assert reproduces(tuple(shifted))
    expected = [each.spin for each in critical_speeds(Scenario()).hopf]
    for found in (printed, right):
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
        found = {label: studying.rows_of(study.measure, cases[label]) for label in labels}
        made[study.name] = pd.DataFrame(
            {"case": label, **row} for label, each in found.items() for row in each
        )
    return made


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("figure_6", "figure_10", "figure_11", "chart"):
        monkeypatch.setattr(figures, name, lambda *_: Figure())


def test_all_holds_but_for_the_scenes_that_are_missing(rows: dict[str, pd.DataFrame]) -> None:
    content = present(rows)
    assert failing(content.checks) == {"eigenvalues: scenes in both motions"}
    assert [*content.numbers["answers"].values()] == ["yes", "no", "partly"]
    assert content.numbers["stable"] == "nowhere"


@pytest.mark.parametrize(
    ("study", "label", "column", "check"),
    [
        ("eigenvalues", "inverted", "difference", "eigenvalues: engine against"),
        ("eigenvalues", "inverted", measured.OWN, "eigenvalues: the engine's own"),
        ("critical-speeds", measured.COMPUTED, "engine", "critical speed: ways apart"),
        ("hopf-variants", "equations as they are", measured.SPEEDS, "variants: the equations"),
        ("stable-region", measured.INSIDE, "in-house", "growth inside, in-house"),
        ("stable-region", measured.INSIDE, "engine", "growth inside, engine"),
        ("stable-region", "beyond edge 3", "in-house", "growth beyond edge 3, in-house"),
        ("stable-region", "beyond edge 3", "engine", "growth beyond edge 3, engine"),
    ],
)
def test_what_differs_or_is_no_number_fails(
    study: str, label: str, column: str, check: str, rows: dict[str, pd.DataFrame]
) -> None:
    at = rows[study].isin([label]).any(axis=1).idxmax()
    known = failing(present(rows).checks)
    # What grows beyond the region is to decay to be wrong.
    for value in (-0.1 if "beyond" in label else 1e-4, nan):
        content = present({**rows, study: planted(rows[study], at, column, value)})
        assert any(check in each for each in failing(content.checks) - known)
        assert (content.numbers["answers"]["critical"] == "no") == (study == "critical-speeds")


def test_a_held_spin_that_changes_where_it_is_stable_or_a_missing_point_fails(
    rows: dict[str, pd.DataFrame],
) -> None:
    held = rows["eigenvalues"].iloc[:2].assign(**{"stable spins in rad/s": "0 to 60"})
    more = pd.concat([rows["eigenvalues"], held], ignore_index=True)
    fewer = rows["stable-region"].iloc[:-1]
    found = failing(present({**rows, "eigenvalues": more, "stable-region": fewer}).checks)
    assert {"eigenvalues: sets that holding the spin changes", "stable region: points"} <= found
