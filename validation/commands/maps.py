"""The command `map`: what becomes of the disk over two parameters."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from analysis.compiled.library import require_heyoka
from analysis.data.checks import whole
from validation.commands.options import checked_end, output_folder
from validation.commands.output import Result, save
from validation.kit.progress import duration, say
from validation.kit.tables import Table
from validation.maps.panel import Panel, run_panel
from validation.maps.problems import PROBLEMS, Problem, panels
from validation.maps.refinement import expected_cases
from validation.maps.uncertainty import DISTANCES, Uncertainty, run_pairs, shifted_sweeps
from validation.parser import kinds
from validation.parser.paths import PICTURES
from validation.sweeps.pools import open_pool
from validation.sweeps.sweep import Sweep, look_ahead

_SHORTEST = 0.02
"""Of a motion in s: two samples as they are on the way to rest."""


def map(  # noqa: A001 - the command's name
    name: Annotated[
        Literal["spin-friction", "spin-eccentricity", "attitude", "tilting", "basins", "rest"],
        {"metavar": "MAP"},
    ],
    *,
    out: kinds.Folder = "maps",
    cells: int = 8,
    levels: int = 2,
    end: float | None = None,
    witnesses: int = 8,
    compiled: bool = False,
    pairs: int = 0,
    problem: kinds.AnyProblem,
    pool: kinds.Pool,
    time_limit: float = 60.0,
) -> kinds.Numbers:
    """Draw what becomes of the disk over two parameters.

    Run a map of what becomes of the disk over two parameters, and draw it:
      spin-friction      inversion over spin and friction coefficient
      spin-eccentricity  inversion over spin and eccentricity
      attitude           inversion over gamma and beta at the start
      tilting            inversion over the rate of beta and beta at the start
      basins             the same as attitude, in Models 1 to 4 beside each other
      rest               which face is up at rest, over spin and beta at the start
    A coarse grid is run whole; cells that hold different outcomes are halved again and again.
    Model 1 runs in the engine, everything else in the in-house equations; the other side runs some
    of the cases, too. Each panel has a store as `tippedisk sweep` writes it; the same command goes
    on.

    Parameters
    ----------
    out
        Folder.
    cells
        Of the coarse grid along an axis.
    levels
        How often cells are halved.
    end
        End of each motion in s (4; rest: 20).
    witnesses
        On the coarse grid, and as large a part of the other cases.
    compiled
        Run compiled, in batches, to 1e-6 rad; needs tippedisk[fast].
    pairs
        Random starts, each run at 4 small distances as well: how fine the map is.
    time_limit
        Of each run, processor time in s.
    """
    mapped = PROBLEMS[name]
    whole("pairs", pairs, least=0)
    scenario = problem.scenario()
    how: dict[str, Any] = {
        "end": checked_end(mapped.end if end is None else end, _SHORTEST),
        "compiled": compiled,
    }
    if compiled:
        require_heyoka()
    size: dict[str, Any] = {"cells": cells, "levels": levels, "witnesses": witnesses}
    wanted, shifted = (
        [replace(each, plan=replace(each.plan, time_limit=time_limit)) for each in sweeps]
        for sweeps in (
            panels(mapped, scenario, **size, **how),
            shifted_sweeps(mapped, scenario, number=pairs, **how),
        )
    )
    # Workers that cannot be had are not announced, and leave no folder behind.
    with open_pool(**pool) as opened:
        folder = output_folder("out", out)
        runs = [(sweep, expected_cases(cells, levels)) for sweep in wanted]
        _announce([*runs, *((sweep, sweep.design.size) for sweep in shifted)], opened.workers)
        done = []
        for index, sweep in enumerate(wanted, 1):
            path = folder / f"{name}{f'-{index}' if len(wanted) > 1 else ''}.db"
            done.append(run_panel(sweep, path, opened, to_rest=mapped.to_rest, levels=levels))
        fineness = run_pairs(shifted, folder, opened, to_rest=mapped.to_rest) if pairs else None
    return Result(
        tables=[_table(mapped, done, "" if fineness is None else _fineness(fineness))],
        notes=[str(_draw(folder / name, done))],
    )


def _table(problem: Problem, done: Sequence[Panel], note: str) -> Table:
    """What became of the disk in each panel, and what the other side says of it."""
    return Table.of(
        done,
        {
            "constraints": lambda each: each.sweep.scenario.name,
            "outcomes": lambda each: each.shares,
            "runs": lambda each: len(each.cells),
            "in place of": lambda each: each.sweep.design.size,
            "time in s": lambda each: float(each.cells["seconds"].sum()),
            "seen by the other side": lambda each: len(each.seen),
            "alike": lambda each: int(each.seen["alike"].sum()),
            "median difference in rad": lambda each: _of_seen(each, "median"),
            "largest": lambda each: _of_seen(each, "max"),
        },
        title=problem.title,
        note=note,
    )


def _of_seen(panel: Panel, what: str) -> float | None:
    if panel.seen.empty:
        return None
    return float(getattr(panel.seen["difference"].astype(float), what)())


def _announce(runs: Sequence[tuple[Sweep, int]], processes: int) -> None:
    """Say about how many runs are coming, and how long they take where none has been made yet."""
    seconds = sum(count * look_ahead(sweep)[0] for sweep, count in runs)
    say(
        f"tippedisk map: some {sum(count for _, count in runs)} cases, roughly "
        f"{duration(seconds / processes)} on {processes} processes where none is in the folder yet"
    )


def _draw(path: Path, done: Sequence[Panel]) -> Path:
    """Write the figure; returns its path."""
    from validation.maps import figures

    figure = figures.draw({each.sweep.scenario.name: each for each in done})
    for suffix in PICTURES[:2]:
        save(figure, path.with_suffix(suffix))
    return path.with_suffix(PICTURES[0])


def _fineness(found: Uncertainty) -> str:
    parts = ", ".join(f"{100 * part:.0f} %" for part in found.parts)
    return (
        f"uncertainty exponent {found.exponent:.2f} ± {found.error:.2f}: of pairs of starts "
        f"{', '.join(f'{each:.1e}' for each in DISTANCES)} widths apart, {parts} end differently"
    )
