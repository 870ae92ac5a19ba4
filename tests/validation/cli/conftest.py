"""A motion lies in the working directory of every call of the command line."""

from pathlib import Path

import pytest

from tests.helpers import short_run


@pytest.fixture(autouse=True)
def _run(folder: Path) -> None:
    short_run().save(folder / "run.npz")
