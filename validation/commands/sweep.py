"""The subcommand `sweep`: many runs of a scenario, kept in one file."""

import argparse
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from analysis.data.checks import choice, positive
from analysis.data.names import ArgumentError
from analysis.data.outcomes import DONE
from analysis.data.scenario_file import read_toml
from validation.commands.options import PATIENCE, chosen_end, run_options
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import bar, duration, say
from validation.sweeps.axes import Design, axis_from, axis_from_text
from validation.sweeps.plan import Plan
from validation.sweeps.pools import open_pool
from validation.sweeps.results import Results, write_csv
from validation.sweeps.runner import Told, run_cases
from validation.sweeps.store import Store, expected_size
from validation.sweeps.sweep import LookAhead, Sweep, look_ahead

_LAYOUT = ("layout", "number", "seed")


def sweep(options: argparse.Namespace) -> Result:
    """Run what the store does not hold yet, and say what it holds then."""
    out = options.out
    time_limit = positive("time_limit", options.time_limit)
    wanted = Sweep(
        scenario=chosen_scenario(options, rest=options.rest),
        design=chosen_design(options),
        plan=_plan(options),
    )
    _check_size(wanted, out, options.most)
    if options.plot is not None:
        try:
            _pictures().check_drawable(wanted)
        except ValueError as error:
            raise ArgumentError("plot", f"cannot be made: {error}") from None
    ahead = look_ahead(wanted)
    # The workers first: where there are none, no store is made.
    with (
        open_pool(options.executor, workers=options.workers, scheduler=options.scheduler) as pool,
        Store(out, wanted, accept_other_code=options.accept_other_code) as store,
        _interrupted(store, wanted),
        _counter(wanted.design.size, store.count()) as told,
    ):
        if left := wanted.design.size - store.count():
            _announce(wanted, ahead, left, pool.workers)
        how = {"time_limit": time_limit, "retry": options.retry, "told": told}
        run_cases(wanted, store, pool, **how)
        failed = store.count() - store.count(DONE)
        found = f"{out}: {store.count()} cases" + (f", {failed} of them failed" if failed else "")
    return Result(
        values=list(Results.load(out).rows()) if options.json else (),
        csv=partial(write_csv, out),
        draw=lambda: _pictures().draw(Results.load(out)),
        notes=[found],
    )


def _pictures() -> Any:
    # Matplotlib takes half a second, which a sweep without a picture need not wait for.
    from validation.maps import sweeps

    return sweeps


def chosen_design(options: argparse.Namespace) -> Design:
    """What varies, from the words of the call and from a file."""
    told: dict[str, Any] = {}
    axes = [axis_from_text(text) for text in options.axes]
    if options.axes_file is not None:
        told, _ = read_toml(options.axes_file)
        try:
            for name in told:
                choice("key", name, ("axes", *_LAYOUT))
            # What is no table is refused as an axis of that name.
            found = _dotted({"": told.pop("axes", {})})
            axes = [*(axis_from(field, value) for field, value in found), *axes]
        except ValueError as error:
            raise ValueError(f"{options.axes_file}: {error}") from None
    given = {name: getattr(options, name) for name in _LAYOUT}
    told |= {name: value for name, value in given.items() if value is not None}
    return Design(axes=tuple(axes), **told)


def _dotted(table: dict[str, Any], name: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        full = f"{name}.{key}" if name else key
        if isinstance(value, dict):
            yield from _dotted(value, full)
        else:
            yield full, value


def _plan(options: argparse.Namespace) -> Plan:
    how = run_options(options)
    del how["time_limit"]
    return Plan(
        **how,
        end=chosen_end(options),
        spacing=options.spacing,
        to_rest=options.rest,
        witnesses=options.witnesses,
        keep=tuple(name.strip() for name in options.keep.split(",") if name.strip()),
    )


def _check_size(wanted: Sweep, out: Path, most: int) -> None:
    """Raise before anything runs if there are more cases than wanted, or than the disk holds."""
    size = wanted.design.size
    if size > most:
        raise ArgumentError("most", f"allows {most} cases, and {size} are asked for")
    needed, free = expected_size(wanted), shutil.disk_usage(out.parent).free
    if needed > free:
        raise ValueError(
            f"{size} cases may take {needed / 1e6:.0f} MB at {out}, where {free / 1e6:.0f} MB are "
            "free"
        )


def _announce(wanted: Sweep, ahead: LookAhead, left: int, processes: int) -> None:
    """Say what is coming, if it takes long or some cases will be refused."""
    seconds = left * ahead.seconds / processes
    if ahead.refused:
        say(
            f"tippedisk sweep: {ahead.refused} of {ahead.looked_at} cases looked at are refused, "
            f"such as: {ahead.reason}"
        )
    if seconds > PATIENCE:
        say(
            f"tippedisk sweep: {left} cases, roughly {duration(seconds)} on {processes} "
            f"processes, at most {expected_size(wanted) / 1e6:.1f} MB"
        )


@contextmanager
def _interrupted(store: Store, wanted: Sweep) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        say(
            f"tippedisk sweep: {store.count()} of {wanted.design.size} cases are in {store.path}; "
            "the same command goes on"
        )
        raise


@contextmanager
def _counter(total: int, done: int) -> Iterator[Told]:
    """A bar with the rate and the time left."""
    failures = 0
    with bar(total=total, initial=done, unit="cases") as shown:

        def told(new: int, failed: int) -> None:
            nonlocal failures
            failures += failed
            if failures:
                shown.set_postfix_str(f"{failures} failed", refresh=False)
            shown.update(new)

        yield told
