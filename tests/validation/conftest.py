"""Every test has a working directory of its own."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def _in_a_folder(folder: Path) -> None:
    pass
