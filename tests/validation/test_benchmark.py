"""The benchmark's verdict."""

import pytest

from validation import benchmark
from validation.kit.tables import Table


@pytest.mark.parametrize(("reached", "code"), [(True, 0), (False, 1)])
def test_benchmark_that_misses_what_it_should_reach_fails(
    reached: bool, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = Table(name="a", title="a", columns=("reached",), rows=[[True], [reached]])
    for name in ("targets", "stability", "engine_sweeps", "load_laws"):
        monkeypatch.setattr(benchmark, name, lambda _: table)
    for name in ("to_rest", "start_up"):
        monkeypatch.setattr(benchmark, name, lambda: table)
    monkeypatch.setattr(benchmark, "compiled", lambda _: [])
    monkeypatch.setattr("sys.argv", ["benchmark"])
    assert benchmark.main() == code
