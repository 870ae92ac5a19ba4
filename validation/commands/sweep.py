"""The command `sweep`: many runs of a scenario, kept in one file."""

import shutil
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from analysis.problem.checks import choice
from analysis.problem.names import ArgumentError
from analysis.problem.scenario_file import read_toml
from validation.commands.options import PATIENCE, announce_cases, in_cases
from validation.comparison.differences import flat
from validation.display.progress import say
from validation.parser import kinds
from validation.parser.files import PictureOut, Result
from validation.sweeps.axes import Design, axis_from, axis_from_text
from validation.sweeps.plan import Plan
from validation.sweeps.pools import open_pool
from validation.sweeps.results import Results, write_csv
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store, expected_size, listed_failures
from validation.sweeps.sweep import Sweep, look_ahead


def sweep(
    varied: kinds.Axes,
    *,
    axes: kinds.Toml = None,
    drawing: kinds.Drawing,
    out: kinds.StoreOut,
    retry: bool = False,
    accept_other_code: bool = False,
    most: int = 10_000_000,
    problem: kinds.AnyProblem,
    how: kinds.Cases,
    rest: bool = False,
    pool: kinds.Pool,
    plot: PictureOut = None,
) -> Result:
    """Run a scenario many times with some of its fields varied.

    Run a scenario many times and keep the outcomes in one SQLite file.

    An axis is a field of the scenario's file and what it goes through:
      spin=0:60:61            61 values from 0 to 60, both included
      mu=0.01:1:20:log        even steps of the logarithm
      model=1,2,4             a list; friction.load=weight,contact likewise
      gamma=-pi/2:pi/2        drawn between, with --layout random, latin-hypercube or sobol
    A grid holds all combinations, the last axis fastest. Each case is a row: inverted or not,
    when, spin after it, extremes of the normal force, energy taken, why it ended, estimated error
    and processor time; a run that fails, hangs or crashes is a row with its reason.

    The same command goes on where an interrupted one stopped, also after kill -9. A file of
    another sweep, or of sources that compute something else, is refused.

    Parameters
    ----------
    varied
        What varies, as above.
    axes
        TOML with the table [axes] instead.
    out
        Store, .db; made if there is none.
    retry
        Run cases again that failed, on either side.
    accept_other_code
        Add to a store of other sources; each row says which it comes from.
    most
        Cases to allow.
    rest
        Run until the disk lies still, as `tippedisk rest`.
    """
    design = _design(varied, axes, drawing)
    problem.check_fixed([axis.field for axis in design.axes])
    wanted = Sweep(
        scenario=problem.scenario(rest=rest),
        design=design,
        plan=Plan(**how, to_rest=rest),
    )
    _check_size(wanted, out, most)
    if plot is not None:
        try:
            _pictures().check_drawable(wanted)
        except ValueError as error:
            raise ArgumentError("plot", f"cannot be made: {error}") from None
    seconds, refused = look_ahead(wanted)
    # The workers first: where there are none, no store is made.
    with (
        open_pool(**pool) as opened,
        Store(out, wanted, accept_other_code=accept_other_code) as store,
    ):
        if left := wanted.design.size - store.count(retry=retry):
            if seconds * left / opened.workers > PATIENCE:
                most_bytes = f", at most {expected_size(wanted) / 1e6:.1f} MB"
                announce_cases("sweep", in_cases(left), left * seconds, opened.workers, most_bytes)
            if refused:
                say(f"tippedisk sweep: {refused}")
        run_cases(store, opened, retry=retry)
        found = f"{out}: {in_cases(store.count())}{listed_failures(store.failures())}"
    return Result(
        values=lambda: list(Results.load(out).rows()),
        csv=partial(write_csv, out),
        draw=lambda: _pictures().draw_sweep(Results.load(out)),
        notes=[found],
    )


def _pictures() -> Any:
    # Matplotlib takes half a second, which a sweep without a picture need not wait for.
    from validation.maps import figures

    return figures


def _design(words: Sequence[str], file: Path | None, drawing: Mapping[str, Any]) -> Design:
    """What varies, from the words of the call and from a file."""
    stated: dict[str, Any] = {}
    axes = [axis_from_text(text) for text in words]
    if file is not None:
        stated, _ = read_toml(file)
        try:
            for name in stated:
                choice("key", name, ("axes", "layout", "number", "seed"))
            found = stated.pop("axes", {})
            if not isinstance(found, dict):
                raise ArgumentError("axes", f"must be a table, got {found!r}")
            axes = [*(axis_from(field, value) for field, value in flat(found).items()), *axes]
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    return Design(axes=tuple(axes), **{**stated, **drawing})


def _check_size(wanted: Sweep, out: Path, most: int) -> None:
    """Raise before anything runs if there are more cases than wanted, or than the disk holds."""
    size = wanted.design.size
    if size > most:
        raise ArgumentError("most", f"allows {in_cases(most)}, and {size} are asked for")
    needed, free = expected_size(wanted), shutil.disk_usage(out.resolve().parent).free
    if needed > free:
        raise ValueError(
            f"{in_cases(size)} may take {needed / 1e6:.0f} MB at {out}, where "
            f"{free / 1e6:.0f} MB are free"
        )
