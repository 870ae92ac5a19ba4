"""Where numbers come from: machine, versions, date and commit."""

import os
import platform
import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from analysis.data.trajectory import versions

PACKAGES = ("exudyn", "numpy", "scipy", "matplotlib")
"""Packages that results depend on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """What a set of results was made with.

    Parameters
    ----------
    machine : str
        Processor, cores and system.
    packages : dict
        Versions of Python and of each of `PACKAGES`.
    date : str
        Day in UTC, as 2026-01-31.
    commit : str
        Short hash of the sources, with "+changes" if they differ from it; empty without one.
    """

    machine: str
    packages: dict[str, str]
    date: str
    commit: str

    @classmethod
    def here(cls) -> "Provenance":
        """That of the running program."""
        return cls(
            machine=machine(),
            packages=versions(*PACKAGES),
            date=time.strftime("%Y-%m-%d", time.gmtime()),
            commit=commit(),
        )

    def text(self) -> str:
        """All of it in a line."""
        packages = ", ".join(f"{name} {version}" for name, version in self.packages.items())
        source = f", commit {self.commit}" if self.commit else ""
        return f"{self.date}, {self.machine}, {packages}{source}"


def machine() -> str:
    """Processor, cores and system in a few words."""
    about = Path("/proc/cpuinfo")
    text = about.read_text() if about.exists() else ""
    named = re.search(r"model name\s*: (.*)", text)
    model = named[1] if named else platform.processor() or platform.machine()
    return f"{model}, {os.cpu_count()} cores, {platform.system()}"


def commit(folder: Path | None = None) -> str:
    """Short hash of the commit checked out in a folder, by default that of the sources.

    Empty if there is no Git, or the folder is not the top of a working copy: installed packages
    may lie inside that of something else.
    """
    folder = Path(__file__).parents[2] if folder is None else folder
    git = shutil.which("git")
    if git is None:
        return ""

    def ask(*arguments: str) -> str:
        answer = subprocess.run(
            [git, "-C", str(folder), *arguments], capture_output=True, text=True, check=False
        )
        return answer.stdout.strip() if answer.returncode == 0 else ""

    top = ask("rev-parse", "--show-toplevel")
    if not top or Path(top).resolve() != folder.resolve():
        return ""
    # Tables of results are no sources: measuring several in a row changes those.
    sources = ("--", ".", ":(exclude)validation/results")
    changed = ask("status", "--porcelain", "--untracked-files=no", *sources)
    return ask("rev-parse", "--short=10", "HEAD") + ("+changes" if changed else "")
