"""The command `map`: what becomes of the disk over two parameters."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from analysis.problem.checks import whole
from analysis.simulation.compiled.library import require_heyoka
from validation.commands.options import announce_cases, checked_end, in_cases
from validation.display.tables import Table
from validation.maps.panel import Panel, expected_cases, run_panel
from validation.maps.problems import DISTANCES, PROBLEMS, panels, shifted_sweeps, uncertainty
from validation.parser import kinds
from validation.parser.files import PICTURES, Result, save
from validation.sweeps.pools import Pool, open_pool
from validation.sweeps.store import Store, listed_failures
from validation.sweeps.sweep import Sweep, look_ahead

_SHORTEST = 0.02
"""Of a motion in s: two samples as they are on the way to rest."""


def map(  # noqa: A001 - the command's name
    name: Annotated[
        Literal["spin-friction", "spin-eccentricity", "attitude", "tilting", "basins", "rest"],
        {"metavar": "MAP"},
    ],
    *,
    out: kinds.Folder = Path("maps"),
    cells: int = 8,
    levels: int = 2,
    end: float | None = None,
    witnesses: int = 8,
    time_limit: float = 60.0,
    compiled: bool = False,
    pairs: int = 0,
    retry: bool = False,
    problem: kinds.AnyProblem,
    pool: kinds.Pool,
) -> Result:
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
        About so many cases of the coarse grid, evenly spread, that the other side runs as well,
        and as large a part of the others.
    time_limit
        Of each run, processor time in s.
    compiled
        Run compiled, in batches, to 1e-6 rad; needs tippedisk[fast].
    pairs
        Random starts, each run at 4 small distances as well: how fine the map is.
    retry
        Run cases again that failed, on either side.
    """
    mapped = PROBLEMS[name]
    whole("pairs", pairs, least=0)
    problem.check_fixed([mapped.right.field, mapped.up.field, *["model"] * mapped.basins])
    scenario = problem.scenario()
    how: dict[str, Any] = {
        "end": checked_end(mapped.end if end is None else end, _SHORTEST),
        "time_limit": time_limit,
        "compiled": compiled,
    }
    if compiled:
        require_heyoka()
    wanted = panels(mapped, scenario, cells=cells, levels=levels, witnesses=witnesses, **how)
    shifted = shifted_sweeps(mapped, scenario, number=pairs, **how)
    runs = [(each, levels, expected_cases(cells, levels)) for each in wanted]
    runs += [(each, 0, pairs) for each in shifted]
    # Workers that cannot be had are not announced.
    with open_pool(**pool) as opened:
        place = out / name
        done = _run_panels(runs, place, opened, by_face=mapped.by_face, retry=retry)
    maps, starts = done[: len(wanted)], done[len(wanted) :]
    # Matplotlib takes half a second, which no refusal waits for.
    from validation.maps import figures

    figure = figures.draw({each.sweep.scenario.name: each for each in maps})
    for suffix in PICTURES[:2]:
        save(figure, place.with_suffix(suffix))
    notes = [f"{place}{PICTURES[0]}", *_lost(done)]
    return Result(**_told(maps, starts, mapped.title), draw=lambda: figure, notes=notes)


def _told(maps: Sequence[Panel], starts: Sequence[Panel], title: str) -> dict[str, Any]:
    """Tables and values of a `Result`: a row for each panel, with how fine the map is."""
    rows = [each.summary | {"time in s": float(each.cells["seconds"].sum())} for each in maps]
    fine, note = _fineness(starts) if starts else ({}, "")
    table = Table.of(rows, title, note)
    # A map of several models has starts of the first alone.
    rows = [row | (dict.fromkeys(fine) if number else fine) for number, row in enumerate(rows)]
    return {"tables": [table], "values": rows, "csv": Table.of(rows, title).to_csv}


def _lost(done: Sequence[Panel]) -> Iterator[str]:
    """What is to be said of cases that failed."""
    if lost := [each for each in done if each.failures]:
        named = (f"{each.sweep.scenario.name}{listed_failures(each.failures)}" for each in lost)
        yield f"{', '.join(named)}; --retry runs them again"


def _run_panels(
    runs: Sequence[tuple[Sweep, int, int]],
    place: Path,
    pool: Pool,
    *,
    by_face: bool,
    retry: bool,
) -> list[Panel]:
    """Panels of sweeps, each halved so often and of about so many cases, in stores by number."""
    stores = [place.with_name(f"{place.name}-{index}.db") for index, _ in enumerate(runs, 1)]
    for (sweep, *_), store in zip(runs, stores, strict=True):
        if store.exists():
            # One of another sweep is refused before anything is said or run.
            with Store(store, sweep):
                pass
    seconds = sum(count * look_ahead(sweep)[0] for sweep, _, count in runs)
    # What is refused leaves no folder behind.
    place.parent.mkdir(parents=True, exist_ok=True)
    some = f"some {in_cases(sum(count for *_, count in runs))}"
    announce_cases("map", some, seconds, pool.workers, " where none is in the folder yet")
    return [
        run_panel(sweep, store, pool, by_face=by_face, levels=halved, retry=retry)
        for (sweep, halved, _), store in zip(runs, stores, strict=True)
    ]


def _fineness(starts: Sequence[Panel]) -> tuple[dict[str, float | None], str]:
    """Uncertainty exponent of a map, and parts of pairs that it comes from: columns, and words."""
    heads = ["uncertainty exponent", "standard deviation"]
    heads += [f"part at {each:.3g} widths" for each in DISTANCES]
    found = uncertainty([each.cells["outcome"] for each in starts])
    if found is None:
        none = "no uncertainty exponent: pairs of starts end differently at too few distances"
        return dict.fromkeys(heads), none
    parts = ", ".join(f"{100 * part:.0f} %" for part in found.parts)
    return dict(zip(heads, (found.exponent, found.error, *found.parts.tolist()), strict=True)), (
        f"uncertainty exponent {found.exponent:.2f} ± {found.error:.2f}: of pairs of starts "
        f"{', '.join(f'{each:.1e}' for each in DISTANCES)} widths apart, {parts} end differently"
    )
