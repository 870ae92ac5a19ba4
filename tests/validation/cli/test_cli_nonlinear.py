"""The command line's cycles and heteroclinic connection."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.calls import printed, refusal

KEYS = ["motions", "events", "reason", "hopf", "growth", "connection"]
"""Of what is told of periodic motions, whichever they are."""

FAMILIES = "analysis.nonlinear.families"


def test_cycles_are_told_at_spins_and_over_a_parameter() -> None:
    found = json.loads(printed("cycles --spin 30.9 30.91 --json"))
    assert [*found] == KEYS
    motions = found["motions"]
    assert [each["spin"] for each in motions] == pytest.approx([30.9, 30.91])
    assert all(each["stable"] and 0.0 < each["multiplier"] < 1.0 for each in motions)
    call = "cycles --over hole-distance=0.02,0.021 --amplitude 0.3 --json --plot over.svg"
    first, second = json.loads(printed(call))["motions"]
    assert (first["disk.hole_distance"], second["disk.hole_distance"]) == (0.02, 0.021)
    # The Hopf point goes up with the eccentricity; the hole's distance changes the inertia, too.
    assert 0.2 < second["spin"] - first["spin"] < 0.3
    assert "<svg" in Path("over.svg").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("call", "kind", "spin"),
    [
        ("cycles --asymmetric --mu 0.1 --eps 0.4", "period-doubling", 29.969),
        ("cycles --rotating", "fold", 30.082),
    ],
)
def test_other_families_are_followed_from_where_they_are_born(
    call: str, kind: str, spin: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{FAMILIES}._amplitudes", lambda _: (0.5, 1.0, 1.5, 1.9))
    monkeypatch.setattr(f"{FAMILIES}.BEYOND", np.array((0.2, 0.4, 0.6)))
    monkeypatch.setattr(f"{FAMILIES}.TILTS", np.array((0.1, 0.12, 0.14)))
    found = json.loads(printed(call, "--json --plot family.svg"))
    assert [*found] == KEYS
    assert [each["stable"] for each in found["motions"]] == [True, True, False]
    assert (found["events"][-1]["kind"], round(found["events"][-1]["spin"], 3)) == (kind, spin)
    assert "<svg" in Path("family.svg").read_text()


def test_a_family_that_is_not_there_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{FAMILIES}._amplitudes", lambda _: (0.5, 1.0))
    said = refusal("cycles --asymmetric", code=1)
    assert "no cycle of the family loses its symmetry" in said


@pytest.mark.slow
def test_the_connection_is_told_beside_its_prediction_and_followed() -> None:
    found = json.loads(printed("heteroclinic --json"))
    assert (found["spin"], found["prediction"]) == pytest.approx((30.120962, 30.197778), abs=1e-6)
    ends = json.loads(printed("heteroclinic --over mu=0.1,0.3 --json"))["ends"]
    assert [end["friction.coefficient"] for end in ends] == [0.1, 0.3]
    assert ends[1]["connection"]["spin"] == found["spin"]
