"""Workers of a process that is killed or interrupted end as well."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from itertools import count
from pathlib import Path

import pytest

from analysis.solve.workers import Pool
from tests.calls import ROOT
from tests.helpers import is_running, not_none

PARENT = """
from tests.analysis.solve.test_workers import told_and_work
from analysis.solve.workers import Pool
with Pool(2) as pool:
    list(pool.map(told_and_work, range(6)))
"""


def told_and_work(_: int) -> None:
    """Tell the process's id and compute for ever."""
    os.write(1, f"{os.getpid()}\n".encode())
    for _ in count():
        pass


pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")

# What runs in the background of a script is born deaf to Ctrl-C.
INTERRUPTIBLE = ["env", "--default-signal=INT", sys.executable, "-c", PARENT]
started = partial(subprocess.Popen, INTERRUPTIBLE, cwd=ROOT, text=True, start_new_session=True)


def test_a_working_directory_that_is_gone_is_told(folder: Path) -> None:
    folder.rmdir()
    with pytest.raises(OSError, match="workers start in the working directory, and that is gone"):
        Pool(2)


@pytest.mark.slow
def test_workers_that_are_interrupted_as_they_start_say_nothing() -> None:
    with started(stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as parent:
        children = Path(f"/proc/{parent.pid}/task/{parent.pid}/children")
        # That of a resource tracker, and those of two workers.
        while len(children.read_text().split()) < 3:
            assert parent.poll() is None
        time.sleep(0.05)
        os.killpg(parent.pid, signal.SIGINT)
        said = parent.communicate(timeout=60.0)[1]
    assert said.count("Traceback") == 1
    assert said.endswith("KeyboardInterrupt\n")


@pytest.mark.slow
@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_workers_of_a_killed_or_interrupted_parent_end(sent: signal.Signals) -> None:
    workers = list[int]()
    with started(stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as parent:
        try:
            workers += [int(not_none(parent.stdout).readline()) for _ in range(2)]
            assert all(map(is_running, workers))
            # A terminal's Ctrl-C reaches them all, and neither they nor it go on with other calls.
            (os.killpg if sent == signal.SIGINT else os.kill)(parent.pid, sent)
            parent.wait(20.0)
            limit = time.monotonic() + 60.0
            while any(map(is_running, workers)):
                assert time.monotonic() < limit, "workers go on without their parent"
                time.sleep(0.02)
        finally:
            parent.kill()
            for worker in filter(is_running, workers):
                os.kill(worker, signal.SIGKILL)
