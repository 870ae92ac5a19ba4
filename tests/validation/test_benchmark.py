"""The benchmark ends with 1 if something misses what it should reach."""

from collections.abc import Iterator
from math import inf, nan

import pytest

from validation import benchmark
from validation.benchmark import measured
from validation.study import Check


@pytest.mark.parametrize(
    ("value", "limit", "code"),
    [(1.0, 1.0, 0), (nan, inf, 0), (1.1, 1.0, 1), (nan, 1.0, 1), (inf, 1.0, 1)],
)
def test_missed_limit_is_the_exit_code(
    value: float,
    limit: float,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def part(_: int) -> Iterator[Check]:
        """A part."""
        yield measured("of no bound", 5.0, "ms")
        yield measured("bound", value, "ms", limit)

    monkeypatch.setattr(benchmark, "PARTS", (part,))
    monkeypatch.setattr("sys.argv", ["benchmark"])
    assert benchmark.main() == code
    assert ("NO" in capsys.readouterr().out) == (code == 1)


def test_sweep_is_timed_against_its_runs() -> None:
    first = next(benchmark.sweeps(1))
    assert first.limit == 1.2
    assert 0.5 < float(str(first.value)) < 5.0
