"""The command `sweep`: many runs of a scenario, kept in one file."""

import shutil
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from analysis.motion.endings import named_conditions
from analysis.motion.outcomes import DONE
from analysis.problem.checks import choice
from analysis.problem.names import ArgumentError
from analysis.problem.scenario_file import read_toml
from validation.commands.options import PATIENCE, checked_end
from validation.commands.output import PictureOut, Result
from validation.kit.progress import duration, say
from validation.parser import kinds
from validation.parser.options import Group
from validation.parser.runs import RunOptions
from validation.sweeps.axes import Design, axis_from, axis_from_text
from validation.sweeps.plan import Plan
from validation.sweeps.pools import open_pool
from validation.sweeps.results import Results, write_csv
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store, expected_size
from validation.sweeps.sweep import Sweep, look_ahead


def sweep(
    varied: kinds.Axes,
    *,
    axes: kinds.Toml = None,
    layout: Literal["grid", "random", "latin-hypercube", "sobol"] | None = None,
    number: int | None = None,
    seed: int | None = None,
    out: kinds.StoreOut,
    retry: bool = False,
    accept_other_code: bool = False,
    most: int = 10_000_000,
    problem: kinds.AnyProblem,
    how: Annotated[
        dict[str, Any],
        Group(
            RunOptions,
            *("source", "formulation", "tolerance", "step", "local_tolerance", "method"),
            *("stop_when", "time_limit"),
            source="in-house",
            time_limit=60.0,
        ),
    ],
    end: float = 4.0,
    spacing: float = 5e-3,
    witnesses: int = 0,
    keep: Annotated[str, {"metavar": "NAMES"}] = "",
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
    layout
        How cases are laid out (grid).
    number
        Of drawn cases.
    seed
        Of the drawing (0).
    out
        Store, .db; made if there is none.
    retry
        Run cases again that failed.
    accept_other_code
        Add to a store of other sources; each row says which it comes from.
    most
        Cases to allow.
    tolerance
        Largest error of beta and gamma in rad (1e-6; to rest 1e-3).
    method
        In-house only: solver; taylor runs compiled (DOP853; to rest LSODA).
    end
        End of each motion in s.
    spacing
        Between samples in s.
    witnesses
        Cases, evenly spread, that the other side runs as well, with the difference.
    keep
        Series to keep of each run at its samples, such as beta,gamma,normal_force.
    rest
        Run until the disk lies still, as `tippedisk rest`.
    time_limit
        Of each run, processor time in s.
    plot
        Draw it, .png, .svg, .pdf or -.
    """
    given = {"layout": layout, "number": number, "seed": seed}
    wanted = Sweep(
        scenario=problem.scenario(rest=rest),
        design=_design(varied, axes, given),
        plan=Plan(
            **how,
            end=checked_end(end),
            spacing=spacing,
            to_rest=rest,
            witnesses=witnesses,
            keep=tuple(name.strip() for name in keep.split(",") if name.strip()),
        ),
    )
    if wanted.plan.stop_when is not None:
        named_conditions(wanted.plan.stop_when, wanted.scenario.initial_state)
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
        if left := wanted.design.size - store.count():
            _announce(wanted, seconds, left, opened.workers)
            if refused:
                say(f"tippedisk sweep: {refused}")
        run_cases(store, opened, retry=retry)
        failed = store.count() - store.count(DONE)
        found = f"{out}: {store.count()} cases" + (f", {failed} of them failed" if failed else "")
    return Result(
        values=lambda: list(Results.load(out).rows()),
        csv=partial(write_csv, out),
        draw=lambda: _pictures().draw(Results.load(out)),
        notes=[found],
    )


def _pictures() -> Any:
    # Matplotlib takes half a second, which a sweep without a picture need not wait for.
    from validation.maps import sweeps

    return sweeps


def _design(words: Sequence[str], file: Path | None, given: Mapping[str, Any]) -> Design:
    """What varies, from the words of the call and from a file."""
    told: dict[str, Any] = {}
    axes = [axis_from_text(text) for text in words]
    if file is not None:
        told, _ = read_toml(file)
        try:
            for name in told:
                choice("key", name, ("axes", *given))
            # What is no table is refused as an axis of that name.
            found = _dotted({"": told.pop("axes", {})})
            axes = [*(axis_from(field, value) for field, value in found), *axes]
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    told |= {name: value for name, value in given.items() if value is not None}
    return Design(axes=tuple(axes), **told)


def _dotted(table: dict[str, Any], name: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        full = f"{name}.{key}" if name else key
        if isinstance(value, dict):
            yield from _dotted(value, full)
        else:
            yield full, value


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


def _announce(wanted: Sweep, seconds: float, left: int, processes: int) -> None:
    """Say what is coming, if it takes long."""
    seconds *= left / processes
    if seconds > PATIENCE:
        say(
            f"tippedisk sweep: {left} cases, roughly {duration(seconds)} on {processes} "
            f"processes, at most {expected_size(wanted) / 1e6:.1f} MB"
        )
