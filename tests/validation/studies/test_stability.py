"""The study of linear stability: engine against in-house, and what its page says of that."""

from dataclasses import replace
from math import nan

import numpy as np
import pandas as pd
import pytest

from analysis import Scenario
from analysis.stability.critical import critical_speeds
from tests.faults import GONE, Rows, faults
from tests.helpers import failing, planted
from validation import study as studying
from validation.studies.stability import measured
from validation.studies.stability.section import STUDIES, present
from validation.studies.stability.variants import PRINTED, reproduces, variants


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
def rows() -> Rows:
    """All rows, those of two scenes in place of the eigenvalues of all."""
    scenes = ("Model 1, contact-tree", "Model 4, euler-tree")
    made = {}
    for study in STUDIES:
        cases = study.cases()
        labels = scenes if study is measured.EIGENVALUES else cases
        found = {label: studying.rows_of(study.measure, cases[label]) for label in labels}
        made[study.name] = pd.DataFrame(
            {"case": label, **row} for label, each in found.items() for row in each
        )
    values = made["eigenvalues"]
    places = np.arange(2 * len(measured.scenes())) % len(values)
    return made | {"eigenvalues": values.iloc[places].reset_index(drop=True)}


def test_all_holds_and_only_a_critical_speed_that_differs_is_not_the_printed_one(
    rows: Rows,
) -> None:
    content, table = present(rows), rows["critical-speeds"]
    assert not failing(content.checks)
    assert content.numbers["answers"] == {"critical": "yes", "hopf": "no", "unstable": "yes"}
    assert content.numbers["stable"] == "nowhere"
    at = table.isin([measured.COMPUTED]).any(axis=1).idxmax()
    for wrong in (1e-4, nan):
        content = present(rows | {"critical-speeds": planted(table, at, "engine", wrong)})
        assert content.numbers["answers"]["critical"] == "no"


BEYOND = "beyond edge 3"
OFF = (1e-4, nan)

test_what_differs_is_no_number_or_missing_fails_its_check = faults(
    present,
    [
        ("eigenvalues", "inverted", "difference", "engine against in-house", *OFF),
        ("eigenvalues", "inverted", measured.OWN, "the engine's own, unconstrained", *OFF),
        ("eigenvalues", 0, "stable spins in rad/s", "sets that holding the spin ch", "0 to 60"),
        ("eigenvalues", 0, "", "eigenvalues: scenes in both motions", GONE),
        ("critical-speeds", measured.COMPUTED, "engine", "critical speed: ways apart", *OFF),
        ("hopf-variants", "equations as they are", measured.SPEEDS, "variants: the eq", *OFF),
        ("stable-region", measured.INSIDE, "in-house", "growth inside, in-house", *OFF),
        ("stable-region", measured.INSIDE, "engine", "growth inside, engine", *OFF),
        # What grows beyond the region is to decay to be wrong.
        ("stable-region", BEYOND, "in-house", f"growth {BEYOND}, in-house", -0.1, nan),
        ("stable-region", BEYOND, "engine", f"growth {BEYOND}, engine", -0.1, nan),
        ("stable-region", BEYOND, "", "stable region: points", GONE),
    ],
)
