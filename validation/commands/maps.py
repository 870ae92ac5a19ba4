"""The subcommand `map`: what becomes of the disk over two parameters."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analysis.compiled.library import require_heyoka
from analysis.data.checks import positive, whole
from validation.commands.options import chosen_end, output_folder
from validation.commands.output import Result, save
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import bar, duration, say
from validation.kit.tables import Table
from validation.maps.panel import Panel, run_panel
from validation.maps.problems import PROBLEMS, Problem, panels
from validation.maps.refinement import expected_cases
from validation.maps.uncertainty import DISTANCES, Uncertainty, run_pairs, shifted_sweeps
from validation.parser.paths import PICTURES
from validation.sweeps.pools import open_pool
from validation.sweeps.sweep import Sweep, look_ahead

_SHORTEST = 0.02
"""Of a motion in s: two samples as they are on the way to rest."""


def map(options: argparse.Namespace) -> Result:  # noqa: A001 - the subcommand's name
    """Run a map and draw it."""
    problem = PROBLEMS[options.name]
    positive("time_limit", options.time_limit)
    whole("pairs", options.pairs, least=0)
    if options.end is None:
        options.end = problem.end
    scenario, end = chosen_scenario(options), chosen_end(options, _SHORTEST)
    size = {"cells": options.cells, "levels": options.levels, "witnesses": options.witnesses}
    if options.compiled:
        require_heyoka()
    how: dict[str, Any] = {"end": end, "compiled": options.compiled}
    wanted = panels(problem, scenario, **size, **how)
    pairs = shifted_sweeps(problem, scenario, number=options.pairs, **how)
    # Workers that cannot be had are not announced, and leave no folder behind.
    with (
        open_pool(options.executor, workers=options.workers, scheduler=options.scheduler) as pool,
        bar(options.name, unit="cases") as shown,
    ):
        folder = output_folder("out", options.out)
        _announce(options, wanted, pairs, pool.workers)
        each: dict[str, Any] = {
            "time_limit": options.time_limit,
            "told": lambda new, _: shown.update(new),
        }
        each["to_rest"] = problem.to_rest
        done = []
        for index, sweep in enumerate(wanted, 1):
            path = folder / f"{options.name}{f'-{index}' if len(wanted) > 1 else ''}.db"
            done.append(run_panel(sweep, path, pool, levels=options.levels, **each))
        fineness = run_pairs(pairs, folder, pool, **each) if pairs else None
    return Result(
        tables=[_table(problem, done, "" if fineness is None else _fineness(fineness))],
        notes=[str(_draw(options, done))],
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


def _announce(
    options: argparse.Namespace, wanted: Sequence[Sweep], pairs: Sequence[Sweep], processes: int
) -> None:
    """Say about how many runs are coming, and how long they take where none has been made yet."""
    runs = [(sweep, expected_cases(options.cells, options.levels)) for sweep in wanted]
    runs += [(sweep, sweep.design.size) for sweep in pairs]
    seconds = sum(count * look_ahead(sweep).seconds for sweep, count in runs)
    say(
        f"tippedisk map: some {sum(count for _, count in runs)} cases, roughly "
        f"{duration(seconds / processes)} on {processes} processes where none is in the folder yet"
    )


def _draw(options: argparse.Namespace, done: Sequence[Panel]) -> Path:
    """Write the figure; returns its path."""
    from validation.maps import figures

    figure = figures.draw({each.sweep.scenario.name: each for each in done})
    for suffix in PICTURES[:2]:
        path = Path(options.out) / f"{options.name}{suffix}"
        save(figure, path)
    return path.with_suffix(".png")


def _fineness(found: Uncertainty) -> str:
    parts = ", ".join(f"{100 * part:.0f} %" for part in found.parts)
    return (
        f"uncertainty exponent {found.exponent:.2f} ± {found.error:.2f}: of pairs of starts "
        f"{', '.join(f'{each:.1e}' for each in DISTANCES)} widths apart, {parts} end differently"
    )
