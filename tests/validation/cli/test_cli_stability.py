"""The command line's eigenvalues, critical speeds, cycles and heteroclinic connection."""

import json
import re
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from analysis import Scenario
from analysis.nonlinear.collocation import NoCycleError
from analysis.nonlinear.heteroclinic import Connection, NoConnectionError
from analysis.problem.choices import SOURCES
from tests.calls import printed, refusal
from validation.nonlinear.tables import connection_table

STUDY = "validation.studies.comparisons"

SIZES = {
    "--system full": 8,
    "--system reduced --mu 0.2": 3,
    "--constraints contact,no-slip-along": 7,
}


@pytest.mark.parametrize("system", SIZES)
def test_every_eigenvalue_is_told_and_both_sources_agree(
    system: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for source in SOURCES:
        if source == "in-house":
            monkeypatch.delattr(f"{STUDY}.engine_matrices")
        call = f"eigenvalues {system} --source {source} --spin 30:35:2 --json"
        rows = json.loads(printed(call))
        assert [row["spin"] for row in rows] == [30.0, 35.0]
        values = [np.array(row["real"]) + 1j * np.array(row["imag"]) for row in rows]
        assert all(len(each) == SIZES[system] for each in values)
        found.append(values)
    # Column by column, also where the spins lie far apart.
    np.testing.assert_allclose(found[0], found[1], rtol=1e-6, atol=1e-6)
    assert not np.array_equal(found[0], found[1])


def test_critical_says_first_where_the_motion_is_stable_and_last_the_closed_form() -> None:
    shown = printed("critical")
    assert shown.startswith("Where inverted spinning is stable, all eigenvalues together, from 0 ")
    assert re.search(r"^Model 1 +nowhere$", shown, re.MULTILINE)
    assert re.search(r"^Model 3 +30\.9168 to 60$", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes unstable +26\.8736 ", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes stable +30\.1049 ", shown, re.MULTILINE)
    assert shown.index("nowhere") < shown.index("26.8736")
    assert "Closed form of the reduced system with any friction, Eq. (126): 30.9168 rad/s" in shown
    undamped = printed("critical --system full --mu 0")
    assert "no friction: undamped" in undamped
    # Where spins begin, nothing is said of pairs that are there on either side, too.
    assert re.findall(r"become a pair +(\S+)", undamped) == ["20.8806"]
    # Other constraints stand below those of the models.
    other = printed("critical --constraints contact,no-slip-along")
    assert re.search(r"^Model 4 .*\ncontact \+ no-slip-along +nowhere$", other, re.MULTILINE)
    # A table that is written is not printed, and all others are.
    beside = printed("critical --csv crossings.csv")
    assert shown.startswith(beside.rstrip())
    assert "nowhere" in beside
    assert "26.8736" not in beside
    assert Path("crossings.csv").read_text().count("unstable") == 1


def test_critical_takes_a_body_without_a_closed_form() -> None:
    # A tippe top, of radius R, distance e = a R, and moments C about its axis and A across: upside
    # down it is stable above the spin whose square is m g e (1 + a)² / (C (1 + a - A / C)).
    top = "--body sphere --radius 0.02 --mass 0.02 --eccentricity 0.003 --inertia-x 3e-6"
    call = f"critical {top} --inertia-y 2.98e-6 --inertia-z 2.98e-6"
    found = json.loads(printed(f"{call} --json"))
    across = 2.98e-6 - 0.02 * 0.003**2
    square = 0.02 * 9.81 * 0.003 * 1.15**2 / (1.15 * 3e-6 - across)
    assert found["crossings"][0]["spin"] == pytest.approx(square**0.5, rel=1e-9)
    assert found["closed_form"] is None
    assert not re.search("Model [234]|Closed form", printed(call))


def test_spins_are_taken_in_any_order() -> None:
    call = "eigenvalues --system reduced --json --spin "
    expected = printed(call, "30.2 30.5 30.8")
    for spins in ("30.5 30.8:30.2:2", "30.5,30.2,30.8,30.5"):
        assert printed(call, spins) == expected


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


LAST = {
    "cycles --asymmetric --mu 0.1 --eps 0.4": ("period-doubling", 29.969),
    "cycles --rotating": ("fold", 30.082),
}


@pytest.mark.slow
@pytest.mark.parametrize("call", LAST)
def test_other_families_are_followed_from_where_they_are_born(
    call: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{FAMILIES}._amplitudes", lambda _: (0.5, 1.0, 1.5, 1.9))
    monkeypatch.setattr(f"{FAMILIES}.BEYOND", np.array((0.2, 0.4, 0.6)))
    monkeypatch.setattr(f"{FAMILIES}.TILTS", np.array((0.1, 0.12, 0.14)))
    found = json.loads(printed(call, "--json --plot family.svg"))
    assert [*found] == KEYS
    assert [each["stable"] for each in found["motions"]] == [True, True, False]
    last = found["events"][-1]
    assert (last["kind"], round(last["spin"], 3)) == LAST[call]
    assert "<svg" in Path("family.svg").read_text()


def test_a_family_that_is_not_there_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{FAMILIES}._amplitudes", lambda _: (0.5, 1.0))
    said = refusal("cycles --asymmetric", code=1)
    assert "no cycle of the family loses its symmetry" in said


def test_motions_are_told_where_what_happens_along_them_is_not_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(f"{FAMILIES}._amplitudes", lambda _: (0.5, 1.0))
    monkeypatch.setattr(
        "validation.commands.nonlinear.events", Mock(side_effect=NoCycleError("lost"))
    )
    said = printed("cycles")
    assert "Bifurcations along the family" not in said
    assert "What happens along the family was not found: lost." in said
    assert "Periodic motions of the reduced system" in said


def test_a_decaying_pair_is_not_told_as_two_real_eigenvalues() -> None:
    focus = Connection(
        spin=35.8, below=35.8, above=35.8, growing=19.0, slow=-28.0, strong=-28.0, winding=22.0
    )
    rows = connection_table(focus, None).rows
    assert ("imaginary part of the decaying ones in 1/s", 22.0) in rows


@pytest.mark.slow
def test_the_connection_is_told_beside_its_prediction_and_followed() -> None:
    found = json.loads(printed("heteroclinic --json"))
    assert (found["spin"], found["prediction"]) == pytest.approx((30.120962, 30.197776), abs=1e-6)
    ends = json.loads(printed("heteroclinic --over mu=0.1,0.3 --json"))["ends"]
    assert [end["friction.coefficient"] for end in ends] == [0.1, 0.3]
    assert ends[1]["connection"]["spin"] == found["spin"]


def test_connections_over_a_parameter_stand_beside_the_hopf_points_or_say_why_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def connection(scenario: Scenario) -> Connection:
        if scenario.friction.gradient < 2.0:
            raise NoConnectionError("there is none")
        return Connection(spin=30.1, below=30.1, above=30.1, growing=10, slow=-15, strong=-200)

    monkeypatch.setattr("validation.nonlinear.tables.heteroclinic_connection", connection)
    drawn: list[Any] = []
    monkeypatch.setattr("validation.parser.files.save", lambda figure, _: drawn.append(figure))
    shown = printed("heteroclinic --over mu=0.1,0.3 --plot over.png")
    assert re.search(r"^0\.1 +30\.9168 +– +30\.387 +–$", shown, re.MULTILINE)
    assert re.search(r"^0\.3 +30\.9168 +30\.1 +30\.1978 +1\.5$", shown, re.MULTILINE)
    assert "friction.coefficient = 0.1: there is none." in shown
    lines = {line.get_label(): line.get_ydata() for line in drawn[0].axes[0].lines}
    assert lines["Hopf point"] == pytest.approx([30.9168] * 2, abs=1e-4)
    assert lines["connection"] == pytest.approx([np.nan, 30.1], nan_ok=True)
    assert lines["first-order prediction"] == pytest.approx([30.3870, 30.1978], abs=1e-4)


def test_a_picture_of_eigenvalues_has_room_below_the_least_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr("validation.parser.files.save", lambda figure, _: drawn.append(figure))
    printed("eigenvalues --spin 30 --plot one.png")
    least, limits = drawn[0].axes[0].dataLim.y0, drawn[0].axes[0].get_ylim()
    assert limits[0] < 1.2 * least < 0.0
