"""Workers of a process that is killed end as well."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.helpers import is_running

ROOT = Path(__file__).parents[3]

SCRIPT = """
from tests.analysis.solve.test_workers import note_and_work
from analysis.solve.workers import Pool
from sys import argv
if __name__ == "__main__":
    with Pool(2) as pool:
        list(pool.map(note_and_work, [argv[1]] * 2))
"""

PATIENCE = 60.0
"""Time in s after which a test gives up; the workers end at once."""


def note_and_work(folder: str) -> None:
    """Leave the process's id in a folder and compute for ten minutes."""
    (Path(folder) / str(os.getpid())).touch()
    end = time.monotonic() + 600.0
    while time.monotonic() < end:
        sum(range(1000))


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")
def test_workers_of_a_killed_parent_end(tmp_path: Path) -> None:
    script = tmp_path / "parent.py"
    script.write_text(SCRIPT)
    notes = tmp_path / "workers"
    notes.mkdir()
    parent = subprocess.Popen(
        [sys.executable, str(script), str(notes)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.DEVNULL,
    )
    limit = time.monotonic() + PATIENCE
    workers: list[int] = []
    try:
        while len(workers) < 2:
            assert parent.poll() is None
            assert time.monotonic() < limit
            time.sleep(0.02)
            workers = [int(note.name) for note in notes.iterdir()]
        assert all(map(is_running, workers))
        parent.kill()
        parent.wait()
        limit = time.monotonic() + PATIENCE
        while any(map(is_running, workers)):
            assert time.monotonic() < limit, "workers go on without their parent"
            time.sleep(0.02)
    finally:
        parent.kill()
        for worker in filter(is_running, workers):
            os.kill(worker, signal.SIGKILL)
