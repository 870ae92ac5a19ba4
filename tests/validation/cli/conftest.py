"""A motion lies in the working directory of every call of the command line."""

from pathlib import Path

import pytest

from tests.helpers import random_trajectory


@pytest.fixture(autouse=True)
def _run(folder: Path) -> None:
    random_trajectory().save(folder / "run.npz")
