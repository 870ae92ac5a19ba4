"""Provenance of results."""

import subprocess
from pathlib import Path

from validation.measurement.provenance import commit


def git(folder: Path, *arguments: str) -> str:
    call = ["git", "-C", str(folder), "-c", "user.name=a", "-c", "user.email=a@b.c", *arguments]
    return subprocess.check_output(call, text=True).strip()


def test_commit_is_that_of_the_working_copy_and_of_none_around_it(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    (tmp_path / "file").write_text("1")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "-qm", "First")
    head = git(tmp_path, "rev-parse", "--short=10", "HEAD")
    assert commit(tmp_path) == head
    (tmp_path / "file").write_text("2")
    assert commit(tmp_path) == f"{head}+changes"
    inner = tmp_path / "site-packages"
    inner.mkdir()
    assert commit(inner) == ""
