"""What goes out is told once, or the same everywhere."""

import re
import tomllib
from importlib.resources import files

import pytest

from tests.calls import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
CHANGES = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def cited(key: str) -> list[str]:
    return re.findall(rf"^{key}: (.*)$", CITATION, re.MULTILINE)


def test_newest_release_is_the_version_that_is_built_and_cited() -> None:
    newest = re.findall(r"^## \[(\d.*)\] - (.*)$", CHANGES, re.MULTILINE)[0]
    assert newest == (PROJECT["version"], cited("date-released")[0])
    assert cited("version") == [PROJECT["version"]]
    assert cited("license") == [PROJECT["license"]]


@pytest.mark.parametrize("package", ["analysis", "mbs_models", "validation"])
def test_type_checkers_find_the_annotations(package: str) -> None:
    assert files(package).joinpath("py.typed").is_file()
