"""Workers of a process that is killed end as well."""

import os
import signal
import subprocess
import sys
import time
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from tests.calls import ROOT
from tests.helpers import is_running, not_none

PARENT = """
from tests.analysis.solve.test_workers import told_and_work
from analysis.solve.workers import Pool
with Pool(2) as pool:
    list(pool.map(told_and_work, range(2)))
"""


def told_and_work(_: int) -> None:
    """Tell the process's id and compute for ever."""
    os.write(1, f"{os.getpid()}\n".encode())
    for _ in count():
        pass


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")
def test_workers_of_a_killed_parent_end() -> None:
    call, workers = [sys.executable, "-c", PARENT], list[int]()
    pipes: Any = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(call, cwd=ROOT, text=True, **pipes) as parent:
        try:
            workers += [int(not_none(parent.stdout).readline()) for _ in range(2)]
            assert all(map(is_running, workers))
            parent.kill()
            # They end at once.
            limit = time.monotonic() + 60.0
            while any(map(is_running, workers)):
                assert time.monotonic() < limit, "workers go on without their parent"
                time.sleep(0.02)
        finally:
            parent.kill()
            for worker in filter(is_running, workers):
                os.kill(worker, signal.SIGKILL)
