"""Worker processes: what becomes of calls when their pool is shut down."""

import time

from validation.kit.processes import Processes


def test_shutdown_finishes_what_was_submitted_unless_it_cancels() -> None:
    pool = Processes(1)
    calls = [pool.submit(abs, -number) for number in range(3)]
    pool.shutdown()
    assert [call.result(0.0) for call in calls] == [0, 1, 2]
    pool = Processes(1)
    calls = [pool.submit(time.sleep, 20.0) for _ in range(2)]
    pool.shutdown(cancel_futures=True)
    ended = [call for call in calls if call.done() and not call.cancelled()]
    assert all(call.exception() for call in ended)
