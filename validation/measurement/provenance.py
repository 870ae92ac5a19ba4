"""Where numbers come from: machine, versions, date and commit."""

import os
import platform
import re
import shutil
import subprocess
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.motion.trajectory import versions
from analysis.simulation.compiled.library import is_installed

PACKAGES = (
    *("exudyn", "numpy", "scipy", "matplotlib", "pandas", "jinja2", "markdown-it-py"),
    *(("heyoka",) if is_installed() else ()),
)
"""Packages that results, their tables and their pages depend on; the last one may be missing."""


def provenance() -> dict[str, Any]:
    """What results are made with by the running program.

    Returns
    -------
    dict
        `machine`, as `machine` tells it; `packages`, the versions of Python and of each of
        `PACKAGES`; `date`, the day in UTC, as 2026-01-31; `commit`, as `commit` tells it.
    """
    return {
        "machine": machine(),
        "packages": versions(*PACKAGES),
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "commit": commit(),
    }


def in_a_line(made_with: Mapping[str, Any]) -> str:
    """A provenance as text."""
    packages = ", ".join(f"{name} {version}" for name, version in made_with["packages"].items())
    source = f", commit {made_with['commit']}" if made_with["commit"] else ""
    return f"{made_with['date']}, {made_with['machine']}, {packages}{source}"


def machine() -> str:
    """Processor, cores and system in a few words."""
    about = Path("/proc/cpuinfo")
    text = about.read_text() if about.exists() else ""
    named = re.search(r"model name\s*: (.*)", text)
    model = named[1] if named else platform.processor() or platform.machine()
    return f"{model}, {os.cpu_count()} cores, {platform.system()}"


def commit(folder: Path | None = None) -> str:
    """Short hash of the commit checked out in a folder, by default that of the sources.

    With "+changes" if they differ from it. Empty if there is no Git, or the folder is not the top
    of a working copy: installed packages may lie inside that of something else.
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
