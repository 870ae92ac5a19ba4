"""The command line's eigenvalues and critical speeds."""

import json
import re

import numpy as np
import pytest

from analysis.problem.choices import SOURCES
from tests.calls import printed


@pytest.mark.parametrize(
    ("system", "size"),
    [
        ("--system full", 8),
        ("--system reduced --mu 0.2", 3),
        ("--system numeric --model 3", 3),
        ("--constraints contact,no-slip-along", 7),
    ],
)
def test_every_eigenvalue_is_told_and_both_sources_agree(system: str, size: int) -> None:
    found = []
    for source in SOURCES:
        call = f"eigenvalues {system} --source {source} --spin 30:35:2 --json"
        rows = json.loads(printed(call))
        assert [row["spin"] for row in rows] == [30.0, 35.0]
        values = [np.array(row["real"]) + 1j * np.array(row["imag"]) for row in rows]
        assert all(len(each) == size for each in values)
        found.append(values)
    # Column by column, also where the spins lie far apart.
    np.testing.assert_allclose(found[0], found[1], rtol=1e-6, atol=1e-6)


def test_critical_says_first_where_the_motion_is_stable_and_last_the_closed_form() -> None:
    shown = printed("critical")
    assert shown.startswith("Model 1: inverted spinning is stable nowhere. By model, ")
    assert re.search(r"^Model 3 +30\.9168 to 60$", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes unstable +26\.8736 ", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes stable +30\.1049 ", shown, re.MULTILINE)
    assert shown.index("nowhere") < shown.index("26.8736")
    assert "Closed form of the reduced system with any friction, Eq. (126): 30.9168 rad/s" in shown
    assert "no friction: undamped" in printed("critical --system full --mu 0")


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
    for spins in ("30.5 30.8:30.2", "30.5,30.2,30.8,30.5"):
        assert printed(call, spins) == expected
