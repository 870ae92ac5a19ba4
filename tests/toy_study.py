"""A study that is quick to measure, with cases that go wrong when asked to."""

import os
import time
from math import inf
from typing import Any

from validation.study import Row, Study, relative

CASES = {"one": 1.0, "two": 2.0}


def measure(case: Any) -> list[Row]:
    """Some powers of a number."""
    if isinstance(case, str):
        return {
            "raises": lambda: 1 / 0,
            "ends": lambda: os._exit(7),
            "hangs": lambda: time.sleep(60.0),
            "nothing": list,
            "inf": lambda: _rows(inf),
            "shorter": lambda: _rows(1.0)[:1],
        }[case]()  # type: ignore[operator]
    return _rows(case)


def _rows(number: float) -> list[Row]:
    return [
        {"power": k, "value": number**k, "curve": [number, k], "seconds": time.perf_counter()}
        for k in (1, 2)
    ]


STUDY = Study(
    name="toy",
    cases=CASES.copy,
    measure=measure,
    sample=("one",),
    confirm={"power": None, "value": relative("value", 1e-9), "curve": 1e-9},
    timed=True,
    limit=5.0,
    columns={"value": "a power"},
)
