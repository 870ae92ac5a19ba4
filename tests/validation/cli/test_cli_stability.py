"""The command line's eigenvalues and critical speeds."""

import json
import re

import numpy as np
import pytest

from analysis.problem.choices import SOURCES
from tests.calls import Capture, printed


@pytest.mark.parametrize(
    ("system", "size"),
    [
        ("--system full", 8),
        ("--system reduced --mu 0.2", 3),
        ("--system numeric --model 3", 3),
        ("--constraints contact,no-slip-along", 7),
    ],
)
def test_every_eigenvalue_is_told_and_both_sources_agree(
    system: str, size: int, capsys: Capture
) -> None:
    found = []
    for source in SOURCES:
        call = f"eigenvalues {system} --source {source} --spin 30:35:2 --json"
        rows = json.loads(printed(capsys, call))
        assert [row["spin"] for row in rows] == [30.0, 35.0]
        values = [np.array(row["real"]) + 1j * np.array(row["imag"]) for row in rows]
        assert all(len(each) == size for each in values)
        found.append(values)
    # Column by column, also where the spins lie far apart.
    np.testing.assert_allclose(found[0], found[1], rtol=1e-6, atol=1e-6)


def test_critical_says_first_where_the_motion_is_stable_and_last_the_closed_form(
    capsys: Capture,
) -> None:
    shown = printed(capsys, "critical")
    assert shown.startswith("Model 1: inverted spinning is stable nowhere. By model, ")
    assert re.search(r"^Model 3 +30\.9168 to 60$", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes unstable +26\.8736 ", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes stable +30\.1049 ", shown, re.MULTILINE)
    assert shown.index("nowhere") < shown.index("26.8736")
    assert "Closed form of the reduced system with any friction, Eq. (126): 30.9168 rad/s" in shown
    assert "no friction: undamped" in printed(capsys, "critical --system full --mu 0")


def test_spins_are_taken_in_any_order(capsys: Capture) -> None:
    call = "eigenvalues --system reduced --json --spin "
    expected = printed(capsys, call, "30.2 30.5 30.8")
    for spins in ("30.5 30.8:30.2", "30.5,30.2,30.8,30.5"):
        assert printed(capsys, call, spins) == expected
