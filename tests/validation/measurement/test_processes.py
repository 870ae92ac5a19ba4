"""Worker processes: what becomes of calls when their pool is left."""

import os
import signal
import time
from pathlib import Path

import pytest
from pebble import ProcessExpired

from validation.measurement.processes import Processes


def test_processes_end_at_once_where_their_context_is_left() -> None:
    begin = time.monotonic()
    with Processes(1) as pool:
        done, *calls = pool.submit(abs, -1), *[pool.submit(time.sleep, 60.0) for _ in range(2)]
        assert done.result() == 1
    assert time.monotonic() - begin < 30.0
    assert all(call.exception() for call in calls if call.done() and not call.cancelled())


def test_an_interrupt_ends_no_call() -> None:
    # A terminal's Ctrl-C reaches workers as well, and is left to the process that was called.
    with Processes(1) as pool:
        assert pool.submit(signal.raise_signal, signal.SIGINT).result() is None


@pytest.mark.parametrize("code", [0, 7])
def test_a_worker_that_ends_fails_its_own_call_alone_whatever_its_code(code: int) -> None:
    with Processes(1) as pool:
        ended, other = pool.submit(os._exit, code), pool.submit(abs, -1)
        with pytest.raises(ProcessExpired) as caught:
            ended.result(timeout=20.0)
        assert str(caught.value.exitcode) == str(code)
        assert other.result() == 1


@pytest.mark.skipif(os.name != "posix", reason="elsewhere no folder goes that a process is in")
def test_workers_that_have_no_folder_to_start_in_are_refused(folder: Path) -> None:
    folder.rmdir()
    with pytest.raises(OSError, match="working directory"):
        Processes(1)
