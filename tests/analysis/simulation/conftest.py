"""How compiled runs are made here."""

import pytest

from analysis.simulation.compiled import code


@pytest.fixture(autouse=True)
def _compiled_in_a_quarter_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "COMPACT", True)
