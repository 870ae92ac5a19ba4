"""What something takes, in a unit that means the same on every machine."""

import os
import time
from functools import cache

import numpy as np

from analysis import Scenario, simulate

_REPEATS = 3


class Clock:
    """Time and processor time since it was made."""

    def __init__(self) -> None:
        self._begin = time.perf_counter()
        self._processor = processor_time()

    @property
    def seconds(self) -> float:
        """Time in s."""
        return time.perf_counter() - self._begin

    def sentence(self, kept: float = 0.0) -> str:
        """What it took so far, as the foot of a page has it.

        Parameters
        ----------
        kept : float
            Processor time in s of the results taken over from earlier runs.
        """
        total = processor_time() - self._processor + kept
        unit = model_1_seconds()
        earlier = f", {kept:.0f} s of it in earlier runs whose results were kept" if kept else ""
        return (
            f"in {self.seconds:.0f} s, with {total:.0f} s of processor time{earlier}: "
            f"{total / unit:.0f} times the {unit:.2g} s that an in-house run of Model 1 over 2 s "
            "takes on this machine"
        )


def processor_time() -> float:
    """Processor time in s of this process and of those it has started and seen end."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@cache
def model_1_seconds() -> float:
    """Processor time in s of an in-house run of Model 1 over 2 s, the least of some."""
    times = np.linspace(0.0, 2.0, 201)
    taken = []
    for _ in range(_REPEATS):
        begin = time.process_time()
        simulate(Scenario(), times)
        taken.append(time.process_time() - begin)
    return min(taken)
