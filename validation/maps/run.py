"""Running a map: one store for each of its panels, refined where outcomes change."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import NearestNDInterpolator

from analysis import Scenario
from analysis.data.checks import Array
from analysis.data.files import AnyArray
from validation.maps.problems import (
    Problem,
    classify,
    models_beside,
    quickest_plan,
    sweep_of,
)
from validation.maps.refinement import Classes, refine
from validation.maps.uncertainty import DISTANCES, Uncertainty, uncertainty
from validation.sweeps.pools import Pool
from validation.sweeps.results import Results
from validation.sweeps.runner import Told, run_cases
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep


@dataclass(frozen=True, slots=True, kw_only=True)
class Witness:
    """What the other side found in a case.

    Parameters
    ----------
    alike : bool
        Whether it is the same inversion, or the same face up.
    difference : float
        Largest of beta and gamma over the motion in rad.
    """

    alike: bool
    difference: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """A panel of a map that has been run.

    Parameters
    ----------
    problem : Problem
    sweep : Sweep
        Over the finest grid, of which some cases have been run.
    classes : mapping
        Classes of those cases by their numbers.
    times : mapping
        Times to inversion in s by the numbers of the cases that are inverted.
    witnesses : mapping
        By the numbers of the cases that the other side has run as well.
    seconds : float
        Processor time of the runs.
    """

    problem: Problem
    sweep: Sweep
    classes: Classes
    times: Mapping[int, float]
    witnesses: Mapping[int, Witness]
    seconds: float

    @classmethod
    def of(cls, problem: Problem, classes: Classes, results: Results) -> "Panel":
        """Panel from the rows of its store and their classes."""
        columns = results.columns
        numbers = columns["number"].tolist()
        if problem.to_rest:
            alike = columns["face_end"] * columns["other_face_end"] > 0.0
        else:
            alike = columns["inversion"] == columns["other_inversion"]
        seen = np.isfinite(columns["difference"])
        return cls(
            problem=problem,
            sweep=results.sweep,
            classes=classes,
            times={
                number: time
                for number, time in zip(numbers, columns["inverted_at"].tolist(), strict=True)
                if classes[number] == "inverted"
            },
            witnesses={
                number: Witness(alike=bool(alike[row]), difference=columns["difference"][row])
                for row, number in enumerate(numbers)
                if seen[row]
            },
            seconds=float(np.nansum(columns["seconds"])),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Of the finest grid: vertical, horizontal axis."""
        first, second = self.sweep.design.axes
        return first.size or 0, second.size or 0

    @property
    def filled(self) -> AnyArray:
        """Class of every case of the finest grid: that of the nearest one that was run."""
        numbers = sorted(self.classes)
        names = sorted(set(self.classes.values()))
        codes = [names.index(self.classes[number]) for number in numbers]
        nearest = NearestNDInterpolator(self.places(numbers), codes)
        whole = nearest(*np.indices(self.shape)).astype(int)
        found: AnyArray = np.array(names, dtype=object)[whole]
        return found

    def places(self, numbers: Sequence[int]) -> AnyArray:
        """Row and column on the finest grid by the numbers of cases, shape (n, 2)."""
        return np.column_stack(np.divmod(np.array(numbers, dtype=int), self.shape[1]))

    def values(self) -> tuple[Array, Array]:
        """Values along the vertical and the horizontal axis."""
        first, second = (
            np.array([axis.at(index) for index in range(axis.size or 0)], dtype=float)
            for axis in self.sweep.design.axes
        )
        return first, second


def panels(
    problem: Problem,
    scenario: Scenario,
    *,
    cells: int,
    levels: int,
    end: float,
    witnesses: int,
    compiled: bool = False,
) -> list[Sweep]:
    """Sweeps over the finest grids of a map.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    cells : int
        Of the coarse grid along each axis.
    levels : int
        How often cells are halved where outcomes change.
    end : float
        Of each motion in s.
    witnesses : int
        Cases of the coarse grid that the other side runs as well, evenly spread, and as large a
        part of the others.
    compiled : bool
        Whether runs are compiled; see `quickest_plan`.

    Raises
    ------
    ValueError
        If a number is out of range.
    """
    for name, least, value, most in (("cells", 1, cells, 10_000), ("levels", 0, levels, 12)):
        if not least <= value <= most:
            raise ValueError(f"{name} must lie from {least} to {most}, got {value}")
    count = cells * 2**levels + 1
    witnesses = min(round(witnesses * count**2 / (cells + 1) ** 2), count**2)
    scenarios = models_beside(scenario) if problem.basins else [scenario]
    plans = [quickest_plan(each, end, witnesses, compiled=compiled) for each in scenarios]
    return [
        sweep_of(problem, each, count=count, plan=plan)
        for each, plan in zip(scenarios, plans, strict=True)
    ]


def run_panel(
    problem: Problem,
    sweep: Sweep,
    path: Path,
    *,
    levels: int,
    pool: Pool,
    time_limit: float = 60.0,
    told: Told = lambda _done, _failed: None,
) -> Panel:
    """Run a panel, or what its store does not hold of it.

    Parameters
    ----------
    problem : Problem
    sweep : Sweep
        One of `panels`.
    path : Path
        Of its store.
    levels : int
        As in `panels`.
    pool, time_limit, told
        As in `run_cases`.
    """
    judge = classify(problem)
    with Store(path, sweep) as store:

        def run(numbers: Iterable[int]) -> Classes:
            run_cases(sweep, store, pool, numbers=numbers, time_limit=time_limit, told=told)
            return {
                int(row["number"]): judge(sweep.scenario, row)  # type: ignore[arg-type]
                for row in store.rows()
            }

        first, second = sweep.design.axes
        classes = refine((first.size or 0, second.size or 0), levels, run)
    return Panel.of(problem, classes, Results.load(path))


def run_pairs(
    problem: Problem,
    sweeps: Sequence[Sweep],
    folder: Path,
    *,
    pool: Pool,
    time_limit: float = 60.0,
    told: Told = lambda _done, _failed: None,
) -> Uncertainty | None:
    """Uncertainty exponent of a map from `shifted_sweeps`.

    Pairs of which one is not decided are left out. The other arguments are those of `run_panel`;
    each sweep has a store in the folder.
    """
    judge = classify(problem)
    classes = []
    for index, sweep in enumerate(sweeps):
        with Store(folder / f"pairs-{index}.db", sweep) as store:
            run_cases(sweep, store, pool, time_limit=time_limit, told=told)
            classes.append([judge(sweep.scenario, row) for row in store.rows()])
    first, *others = np.array(classes)
    decided = ~np.any(np.isin(classes, ("not decided", "failed")), axis=0)
    differs = np.array([other[decided] != first[decided] for other in others])
    return uncertainty(np.array(DISTANCES), differs)
