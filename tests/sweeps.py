"""Sweeps that several tests run, and a pool that runs them at once."""

from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from analysis import MODELS, Scenario
from validation.sweeps.axes import Design, axis_from_text
from validation.sweeps.case import CaseRow
from validation.sweeps.plan import Plan
from validation.sweeps.pools import Pool
from validation.sweeps.results import Results
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep


def direct(executor: Executor | None = None) -> Pool:
    """A pool of this process."""
    return Pool(executor or ThreadPoolExecutor(1), 1)


def sweep(
    *axes: str, scenario: Scenario | None = None, layout: dict[str, Any] | None = None, **plan: Any
) -> Sweep:
    """Sweep over a grid or drawn points, short runs of the reduced system by default."""
    if scenario is None:
        scenario = Scenario(constraints=MODELS[4])
        plan.setdefault("formulation", "reduced")
    plan.setdefault("end", 0.05)
    plan.setdefault("tolerance", 1e-4)
    design = Design(axes=tuple(map(axis_from_text, axes)), **(layout or {}))
    return Sweep(scenario=scenario, design=design, plan=Plan(**plan))


def swept(
    wanted: Sweep,
    path: Path = Path("a.db"),
    pool: Pool | None = None,
    *,
    told: Callable[[list[CaseRow]], object] = len,
    **options: Any,
) -> Results:
    """Results of a sweep, or of what is wanted of it, that a pool or else this process runs.

    Rows are told when they come in.
    """

    class Told(Store):
        def add(self, rows: Iterable[CaseRow]) -> None:
            super().add(found := list(rows))
            if found:
                told(found)

    with Told(path, wanted) as kept:
        run_cases(kept, pool or direct(), **options)
    return Results.load(path)
