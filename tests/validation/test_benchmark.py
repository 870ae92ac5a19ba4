"""The benchmark ends with 1 if something misses what it should reach."""

import json
from collections.abc import Callable, Iterator
from itertools import islice
from math import inf, nan

import pytest

from tests.calls import answer
from validation import benchmark
from validation.benchmark import measured
from validation.study import Check


def test_missed_limit_is_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def part(_: int) -> Iterator[Check]:
        """A part."""
        yield measured("of no bound", 5.0, "ms")
        yield measured("bound", value, "ms", limit)

    monkeypatch.setattr(benchmark, "PARTS", (part,))
    monkeypatch.setattr(benchmark, "slowness", lambda: 1.0)
    cases = [(1.0, 1.0, 0), (nan, inf, 0), (1.1, 1.0, 1), (nan, 1.0, 1), (inf, 1.0, 1)]
    for value, limit, code in cases:
        shown, data = answer("benchmark"), answer("benchmark --json --plot a.png")
        assert shown.code == data.code == code, (value, limit)
        assert ("NO" in shown.out) == (code == 1)
        told = [each["at most"] for each in json.loads(data.out)]
        assert told == [None, None if limit == inf else limit]


def test_limits_of_times_alone_grow_on_a_slow_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "slowness", lambda: 4.0)
    held = [measured("run", 30.0, unit, 10.0).holds for unit in ("ms", "s", "rad")]
    assert held == [True, True, False]


def test_a_machine_is_slow_by_what_arithmetic_takes_and_never_fast(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for part, slow in ((2.0, 2.0), (0.5, 1.0)):
        taken = [part * benchmark.PACE]
        monkeypatch.setattr(benchmark, "milliseconds", lambda *_, told=taken, **__: told)
        assert benchmark.slowness() == slow


def test_sweep_is_timed_against_its_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    def timed(*calls: Callable[[], object], repeats: int) -> list[float]:
        """Times in ms of a slow machine on which all goes evenly."""
        for call in calls:
            call()
        alone = len(calls) - 2
        return [6.0 * repeats, 20.0 * repeats, *[5.0 * repeats / alone] * alone]

    monkeypatch.setattr(benchmark, "milliseconds", timed)
    monkeypatch.setattr(benchmark, "slowness", lambda: 1.0)
    over, beside = islice(benchmark.sweeps(1), 2)
    assert (over.value, over.limit) == (pytest.approx(1.2), 1.2)
    assert beside.value == pytest.approx(1.0 / benchmark.CASES)
