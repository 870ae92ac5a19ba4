"""Every call of the command line is made in a folder of its own."""

from pathlib import Path

import pytest

from tests.helpers import random_trajectory


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working directory with a stored motion of five samples."""
    monkeypatch.chdir(tmp_path)
    random_trajectory().save("run.npz")
    return tmp_path
