"""The commands on nonlinear dynamics: `cycles`, `heteroclinic` and `passage`."""

from collections.abc import Sequence
from dataclasses import asdict
from math import pi
from operator import itemgetter
from typing import Any

import numpy as np

from analysis import Scenario
from analysis.nonlinear import families
from analysis.nonlinear.collocation import NoCycleError
from analysis.nonlinear.following import Family, events
from analysis.nonlinear.heteroclinic import fall, heteroclinic_connection
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.motions import Event
from analysis.problem.choices import Source
from analysis.problem.limits import MOST_SCENARIOS
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import declared
from analysis.problem.variations import changed
from validation.commands.options import Problem, parse_spins
from validation.display.figures import MARKED, legend_above, new_figure
from validation.display.progress import counted, progress_bar
from validation.display.tables import Table
from validation.nonlinear import figures, tables
from validation.nonlinear.tables import Motion
from validation.parser.files import Result
from validation.parser.kinds import AnyProblem, Axis, ReducedProblem, SomeSpins

_DRAWN = {
    "symmetric": ("amplitude",),
    "asymmetric": ("amplitude", "lowest"),
    "rotating": ("largest_tilt", "tilt"),
}
_ALWAYS = ("period", "multiplier", "log10_strong")
"""What is drawn of a family, by its kind and of any."""

_SIDE = 0.05
"""Distance in rad/s from the connection at which the picture shows motions."""


# --- Periodic motions ---------------------------------------------------------------------------


def cycles(
    *,
    problem: ReducedProblem,
    spin: SomeSpins = None,
    rotating: bool = False,
    asymmetric: bool = False,
    over: Axis = None,
    amplitude: float | None = None,
) -> Result:
    """Periodic motions of the reduced system, with their multipliers.

    Follow the periodic motions of the reduced system (Model 4) from the Hopf point of inverted
    spinning to their end, with period, Floquet multipliers and bifurcations; or find those at
    given spins; or follow others: one table of motions, and one of what happens along them.

    Parameters
    ----------
    spin
        Only the cycles at spins in rad/s: values, with commas or not, or first:last:number.
    rotating
        Instead, the motions beyond the heteroclinic end, in which gamma turns round; the picture
        ends 1 rad/s above it, and the table where the disk is nearly flat.
    asymmetric
        Instead, the cycles without mirror symmetry, where symmetric ones lose it.
    over
        Go through a parameter, as in sweep: mu=0.1:1:10:log, eps=0.01,0.1,
        hole-radius=0.01:0.02:4.
    amplitude
        Of the cycle that --over follows, in rad.
    """
    spins = None if spin is None else parse_spins(spin).tolist()
    given = {"rotating": rotating, "asymmetric": asymmetric, "over": over is not None}
    chosen = [name for name, is_given in given.items() if is_given]
    if len(chosen) > 1:
        raise ArgumentError(chosen[1], f"does not go together with {chosen[0]}")
    if (rotating or asymmetric) and spins is not None:
        raise ArgumentError("spin", f"does not go together with {chosen[0]}: a family has many")
    if over is None and amplitude is not None:
        raise ArgumentError("amplitude", "belongs to --over; a family goes through all amplitudes")
    if over is not None:
        return _cycles_over(over, problem, spins, amplitude)
    scenario = problem.scenario()
    if spins is not None:
        return _at(scenario, spins)
    what = "rotating motion" if rotating else "cycle"
    with progress_bar(f"{what} {{n:.0f}} of {{total:.0f}}") as progress:
        follow = families.rotating_family if rotating else families.cycle_family
        family = follow(scenario, progress=progress)
        if asymmetric:
            family = families.first_asymmetric_family(family, progress=progress)
    return _whole(family)


def _motions(rows: Sequence[Motion], family: Family | None = None, **shown: Any) -> Result:
    """What is told of periodic motions, or of a family of them and why it ends.

    Parameters
    ----------
    rows : list of Motion
    family : Family, optional
    **shown
        Parameters of `Result`; `values` are those besides the motions.
    """
    reason = None if family is None else family.reason
    ends = dict.fromkeys(("hopf", "growth", "connection"))
    values = {"motions": rows, "events": [], "reason": reason, **ends} | shown.pop("values", {})
    notes = [f"The family ends: {reason}."] if reason else []
    notes += shown.pop("notes", [])
    return Result(**shown, values=values, notes=notes)


def _whole(family: Family) -> Result:
    """A family, what happens along it, and where it begins."""
    rows, kind = [each.as_row() for each in family.motions], family.motions[0].kind
    shown, notes = [tables.motion_table(rows, kind)], list[str]()
    found: Sequence[Event] = ()
    try:
        found = events(family)
        shown.append(tables.event_table(found, family.motions))
    except NoCycleError as error:
        notes.append(f"What happens along the family was not found: {error}.")
    more: dict[str, Any] = {"events": [{"kind": what, **each.as_row()} for what, each, _ in found]}
    if kind == "rotating":
        more["connection"] = family.begins
    elif kind == "symmetric":
        normal = hopf_type(family.motions[0].scenario)
        growth = fitted_growth(family.motions, normal.spin)
        shown.append(tables.hopf_table(normal, growth))
        more["hopf"] = asdict(normal) | {"kind": normal.kind, "curvature": normal.curvature}
        more["growth"] = None if growth is None else growth._asdict()

    def draw() -> Any:
        placed: list[tuple[float, Motion]] = [
            *enumerate(rows),
            # Neighbours tell the stability.
            *((place, {**each.as_row(), "stable": None}) for _, each, place in found),
        ]
        drawn = [row for place, row in sorted(placed, key=itemgetter(0)) if place >= 0.0]
        mark = "heteroclinic connection" if kind == "rotating" else "the family begins"
        if kind == "rotating":
            drawn = figures.near(drawn, family.begins)
        return figures.diagram(drawn, (*_DRAWN[kind], *_ALWAYS), marks={mark: family.begins})

    return _motions(rows, family, tables=shown, values=more, draw=draw, notes=notes)


def _at(scenario: Scenario, spins: Sequence[float]) -> Result:
    found = [families.cycle_at(scenario, spin) for spin in counted(spins, "spins")]
    named = [(f"{cycle.spin:.6g} rad/s", cycle.whole[1]) for cycle in found]
    rows: list[Motion] = [each.as_row() for each in found]
    table = tables.motion_table(rows)
    return _motions(rows, tables=[table], draw=lambda: figures.portrait(named))


def _cycles_over(
    over: str, problem: Problem, spins: list[float] | None, amplitude: float | None
) -> Result:
    if (spins is None) == (amplitude is None) or (spins is not None and len(spins) > 1):
        raise ArgumentError("over", "needs what is held: one --spin, or --amplitude")
    axis, scenarios = _varied(over, problem)
    held = {"amplitude": amplitude} if spins is None else {"spin": spins[0]}
    found = families.cycles_over(scenarios, **held)
    rows: list[Motion] = [
        {axis.field: value, **each.as_row()}
        for value, each in zip(axis.grid, found.motions, strict=False)
    ]
    first = (axis.field, axis.label)
    names = ("spin" if spins is None else "amplitude", "multiplier")
    return _motions(
        rows,
        found,
        tables=[tables.motion_table(rows, first=first)],
        draw=lambda: figures.diagram(rows, names, parameter=first, log=axis.log),
    )


# --- The connection -----------------------------------------------------------------------------


def heteroclinic(*, problem: ReducedProblem, over: Axis = None) -> Result:
    """The heteroclinic connection in which the cycles mostly end.

    Find the spin at which the motion that leaves noninverted spinning ends in it again, to 1e-9
    rad/s, beside its prediction to first order on the slow manifold. The picture shows that motion
    on either side of the connection.

    Parameters
    ----------
    over
        Go through a parameter, as in sweep: mu=0.1:1:10:log, eps=0.01,0.1,
        hole-radius=0.01:0.02:4.
    """
    if over is not None:
        return _connections_over(over, problem)
    scenario = problem.scenario()
    found = heteroclinic_connection(scenario)
    slow = tables.prediction(scenario)

    def draw() -> Any:
        spins = [found.spin + side for side in (-_SIDE, 0.0, _SIDE)]
        ways = [fall(scenario, spin) for spin in spins]
        # The connection ends in the saddle.
        ends = (None, int(ways[1].distances.argmin()) + 1, None)
        where = ("below", "connection", "above")
        named = [
            (f"{name}: {spin:.6f} rad/s", way.states[:end])
            for name, spin, way, end in zip(where, spins, ways, ends, strict=True)
        ]
        return figures.portrait(named, saddles=(-pi / 2, 1.5 * pi))

    return Result(
        tables=[tables.connection_table(found, slow)],
        values={**tables.connection_row(found), "prediction": None if slow is None else slow.spin},
        draw=draw,
    )


def _connections_over(over: str, problem: Problem) -> Result:
    axis, scenarios = _varied(over, problem)
    ends = [tables.ends(each) for each in counted(scenarios, axis.field)]
    rows = [{axis.field: value, **end} for value, end in zip(axis.grid, ends, strict=True)]
    shown = [
        {
            axis.label: row[axis.field],
            "Hopf point in rad/s": row["hopf"],
            "connection in rad/s": (row["connection"] or {}).get("spin"),
            "first-order prediction in rad/s": row["prediction"],
            "saddle index": (row["connection"] or {}).get("saddle_index"),
        }
        for row in rows
    ]
    table = Table.of(
        shown,
        title=f"Hopf point and heteroclinic connection over {axis.field}",
        note=" ".join(
            f"{axis.field} = {row[axis.field]:g}: {row['reason']}."
            for row in rows
            if row["reason"]
        ),
    )
    return Result(
        tables=[table],
        values={"ends": rows},
        draw=lambda: _drawn_ends(table, log=axis.log),
    )


def _drawn_ends(table: Table, *, log: bool) -> Any:
    """Hopf point, connection and prediction over the first column."""
    figure, axes = new_figure(height=4.6)
    columns = np.array(table.rows, dtype=float).T
    for name, values, look in zip(table.columns[1:4], columns[1:], MARKED, strict=False):
        axes.plot(columns[0], values, **look, label=name.removesuffix(" in rad/s"))
    axes.set(xlabel=table.columns[0], xscale="log" if log else "linear", ylabel="spin in rad/s")
    legend_above(axes)
    return figure


# --- Over a parameter ---------------------------------------------------------------------------


def _varied(over: str, problem: Problem) -> tuple[Any, list[Scenario]]:
    """What --over goes through, and the problem's scenario with each of its values.

    That is a number of the scenario but for its start, with a count.
    """
    from validation.sweeps.axes import Design, axis_from_text

    try:
        axis = axis_from_text(over)
    except ValueError as error:
        raise ArgumentError("over", f"tells no axis: {error}") from None
    field, size = axis.field, Design(axes=(axis,)).size
    if declared(field).is_text or field.partition(".")[0] not in ("disk", "friction", "table"):
        fault = "must be a number of disk, friction or table, such as mu=0.1:1:10"
        raise ArgumentError("over", f"{fault}, got {field}")
    if size > MOST_SCENARIOS:
        raise ArgumentError("over", f"must have at most {MOST_SCENARIOS} values, got {size}")
    problem.check_fixed([field])
    scenario = problem.scenario()
    try:
        return axis, [changed(scenario, {field: value}) for value in axis.grid]
    except ValueError as error:
        raise ArgumentError("over", f"gives no scenario: {error}") from None


# --- Passage ------------------------------------------------------------------------------------


def passage(
    *,
    problem: AnyProblem,
    source: Source = "in-house",
    end: float = 22.0,
    rest: bool = False,
) -> Result:
    """When an inverted disk is lost as its spin decays.

    Run a scenario, by default Model 1 from the paper's start, and tell when its falling spin
    passes the Hopf point of inverted spinning, when the inversion is lost, and when it should be
    by the eigenvalues alone.

    Parameters
    ----------
    source
        Who computes.
    end
        Longest time in s.
    rest
        Start from the defaults of `tippedisk rest`.
    """
    from validation.nonlinear.passage import follow, passage_table

    scenario = problem.scenario(rest=rest)
    with progress_bar() as progress:
        found = follow(scenario, end, source, progress=progress)
    named = [(scenario.name, found)]
    shown = ("hopf", "frequency", "crossing", "lost", "predicted", "lowest_spin", "rate")
    return Result(
        tables=[passage_table(named)],
        values={name: found[name] for name in shown},
        draw=lambda: figures.passage_diagram(named),
    )
