"""What the commands on nonlinear dynamics do."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import asdict
from math import pi
from typing import Any

from analysis import Scenario
from analysis.data.changes import changed, check_field
from analysis.data.limits import MOST_SCENARIOS
from analysis.data.names import ArgumentError
from analysis.data.written import is_text, unit
from analysis.nonlinear import families
from analysis.nonlinear.families import Family
from analysis.nonlinear.heteroclinic import NoConnectionError, fall, heteroclinic_connection
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.motions import Event
from analysis.stability.printed import critical_speed
from validation.commands.options import chosen_end, parse_spins, run_options
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import counted, progress_bar
from validation.kit.tables import Table
from validation.nonlinear import tables
from validation.nonlinear.tables import Motion

_SIDE = 0.05
"""Distance in rad/s from the connection at which the picture shows motions."""


# --- Periodic motions ---------------------------------------------------------------------------


def cycles(options: argparse.Namespace) -> Result:
    """Tell the periodic motions: some at given spins, a family, or one over a parameter."""
    spins = None if options.spin is None else parse_spins(options.spin).tolist()
    chosen = [name for name in ("rotating", "asymmetric", "over") if getattr(options, name)]
    if len(chosen) > 1:
        raise ArgumentError(chosen[1], f"does not go together with {chosen[0]}")
    if chosen in (["rotating"], ["asymmetric"]) and spins is not None:
        raise ArgumentError("spin", f"does not go together with {chosen[0]}: a family has many")
    if chosen != ["over"] and options.amplitude is not None:
        raise ArgumentError("amplitude", "belongs to --over; a family goes through all amplitudes")
    scenario = _reduced(options)
    if chosen == ["over"]:
        return _over(options, scenario, spins)
    if spins is not None:
        return _at(scenario, spins)
    find = {"rotating": _rotating, "asymmetric": _asymmetric}
    return find[chosen[0]](scenario) if chosen else _symmetric(scenario)


def _told(
    family: Family,
    rows: Sequence[Motion],
    draw: Callable[[Any], Any],
    *,
    first: tuple[str, str] | None = None,
    found: Sequence[Event] | None = None,
    more: Sequence[Table] = (),
    **values: Any,
) -> Result:
    """What is told of periodic motions of any kind.

    Parameters
    ----------
    family : Family
    rows : sequence of Motion
        Its motions as the table has them.
    draw : callable
        Makes axes of the picture, given the module of figures.
    first : tuple of 2 str, optional
        What else the table tells of each; see `motion_table`.
    found : sequence of Event, optional
        What happens along the family.
    more : sequence of Table
        Further ones to print.
    **values
        What JSON is told besides.
    """

    def picture() -> Any:
        from validation.nonlinear import figures

        return draw(figures).figure

    shown = [tables.motion_table(rows, family.motions[0].kind, first), *more]
    if found is not None:
        shown.append(tables.event_table(found, family.motions))
    happened = [{"kind": kind, **motion.told()} for kind, motion in found or ()]
    reason = family.reason
    return Result(
        tables=shown,
        values={"motions": rows, "events": happened, "reason": reason, **values},
        draw=picture,
        notes=[] if reason is None else [f"The family ends early: {reason}."],
    )


def _rows(family: Family) -> list[Motion]:
    return [each.told() for each in family.motions]


def _at(scenario: Scenario, spins: Sequence[float]) -> Result:
    found = tuple(families.cycle_at(scenario, spin) for spin in counted(spins, "spins"))
    named = [(f"{cycle.spin:.6g} rad/s", cycle.whole[1]) for cycle in found]
    family = Family(motions=found, begins=critical_speed(scenario).spin)
    return _told(family, _rows(family), lambda figures: figures.portrait(named))


def _followed(scenario: Scenario) -> Family:
    with progress_bar("cycle {n:.0f} of {total:.0f}") as progress:
        return families.cycle_family(scenario, progress=progress)


def _symmetric(scenario: Scenario) -> Result:
    family, hopf, normal = _followed(scenario), critical_speed(scenario), hopf_type(scenario)
    rows = _rows(family)
    spins, amplitudes = tables.small_cycles(rows)
    growth = fitted_growth(spins, amplitudes, normal.spin) if len(spins) > 4 else None

    def draw(figures: Any) -> Any:
        from validation.kit.figures import new_figure

        _, axes = new_figure(4, height=11.0, share=False)
        figures.period_diagram(rows, hopf, axes=axes[1:])
        return figures.bifurcation_diagram(rows, hopf, axes=axes[0])

    return _told(
        family,
        rows,
        draw,
        found=families.events(family),
        more=[tables.hopf_table(normal, growth)],
        hopf={**asdict(normal), "kind": normal.kind, "curvature": normal.curvature},
        growth=None if growth is None else growth._asdict(),
    )


def _rotating(scenario: Scenario) -> Result:
    with progress_bar("rotating motion {n:.0f} of {total:.0f}") as progress:
        family = families.rotating_family(scenario, progress=progress)
    rows = _rows(family)
    return _told(
        family,
        rows,
        lambda figures: figures.rotation_diagram(rows, family.begins),
        found=families.events(family),
        connection=family.begins,
    )


def _asymmetric(scenario: Scenario) -> Result:
    symmetric = _followed(scenario)
    with progress_bar("cycle {n:.0f} of {total:.0f}") as progress:
        family = families.first_asymmetric_family(symmetric, progress=progress)
    rows, found = _rows(family), families.events(family)
    return _told(
        family,
        rows,
        lambda figures: figures.asymmetric_diagram(rows, _rows(symmetric), found[0].motion.told()),
        found=found,
    )


def _over(options: argparse.Namespace, scenario: Scenario, spins: list[float] | None) -> Result:
    axis = _axis(options)
    if (spins is None) == (options.amplitude is None) or (spins is not None and len(spins) > 1):
        raise ArgumentError("over", "needs what is held: one --spin, or --amplitude")
    values, scenarios = _scenarios(scenario, axis)
    held = {"amplitude": options.amplitude} if spins is None else {"spin": spins[0]}
    found = families.cycles_over(scenarios, **held)
    rows = [{axis.field: value, **row} for value, row in zip(values, _rows(found), strict=False)]
    shown = (tables.HEADS["spin" if spins is None else "amplitude"], tables.HEADS["multiplier"])
    table = tables.motion_table(rows, first=(axis.field, _head(axis)))
    return _told(
        found, rows, lambda _: _draw_over(table, axis, shown), first=(axis.field, _head(axis))
    )


# --- The connection -----------------------------------------------------------------------------


def heteroclinic(options: argparse.Namespace) -> Result:
    """Tell the heteroclinic connection."""
    scenario = _reduced(options)
    if options.over is not None:
        return _connections_over(options, scenario)
    found = heteroclinic_connection(scenario)
    slow = tables.prediction(scenario)

    def picture() -> Any:
        from validation.nonlinear import figures

        spins = [found.spin + side for side in (-_SIDE, 0.0, _SIDE)]
        named = [(f"{spin:.6f} rad/s", fall(scenario, spin).states) for spin in spins]
        return figures.portrait(named, saddles=(-pi / 2, 1.5 * pi)).figure

    return Result(
        tables=[tables.connection_table(found, slow)],
        values={
            **asdict(found),
            "saddle_index": found.saddle_index,
            "prediction": None if slow is None else slow.spin,
        },
        draw=picture,
    )


def _connections_over(options: argparse.Namespace, scenario: Scenario) -> Result:
    axis = _axis(options)
    rows, told, reasons = [], [], []
    pairs = list(zip(*_scenarios(scenario, axis), strict=True))
    for value, each in counted(pairs, axis.field):
        connection, reason = None, None
        try:
            connection = heteroclinic_connection(each)
        except NoConnectionError as error:
            reason = str(error)
            reasons.append(f"{axis.field} = {value:g}: {reason}.")
        hopf, slow = critical_speed(each).spin, tables.prediction(each)
        predicted = None if slow is None else slow.spin
        found = (None, None) if connection is None else (connection.spin, connection.saddle_index)
        rows.append((value, hopf, found[0], predicted, found[1]))
        told.append(
            {
                axis.field: value,
                "hopf": hopf,
                "connection": None if connection is None else asdict(connection),
                "prediction": predicted,
                "reason": reason,
            }
        )
    table = Table(
        name="ends_over",
        title=f"Hopf point and heteroclinic connection over {axis.field}",
        columns=(
            _head(axis),
            "Hopf point in rad/s",
            "connection in rad/s",
            "first-order prediction in rad/s",
            "saddle index",
        ),
        rows=rows,
        note=" ".join(reasons),
    )
    return Result(
        tables=[table],
        values={"ends": told},
        draw=lambda: _draw_over(table, axis, table.columns[1:4]).figure,
    )


# --- Over a parameter ---------------------------------------------------------------------------


def _axis(options: argparse.Namespace) -> Any:
    """What --over goes through: a number of the scenario but for its start, with a count."""
    from validation.sweeps.axes import axis_from_text

    try:
        axis = axis_from_text(options.over)
    except ValueError as error:
        raise ArgumentError("over", f"tells no axis: {error}") from None
    field = axis.field
    if is_text(field) or field.partition(".")[0] not in ("disk", "friction", "table"):
        raise ValueError(
            f"axis must be a number of disk, friction or table, such as mu=0.1:1:10, got {field}"
        )
    if axis.size is None:
        raise ValueError(f"axis {field} needs a count: first:last:count")
    if axis.size > MOST_SCENARIOS:
        raise ValueError(
            f"axis {field} must have at most {MOST_SCENARIOS} values here, got {axis.size}"
        )
    return axis


def _scenarios(scenario: Scenario, axis: Any) -> tuple[list[float], list[Scenario]]:
    """Values of an axis, and the scenario with each of them."""
    values = [axis.at(index) for index in range(axis.size)]
    check_field(scenario, axis.field, {axis.field: values[0]})
    made = [changed(scenario, {axis.field: value}) for value in values]
    return [float(value) for value in values], made


def _head(axis: Any) -> str:
    """Heading of the axis's values."""
    name, measure = axis.field.rpartition(".")[2].replace("_", " "), unit(axis.field)
    return f"{name} in {measure}" if measure else name


def _draw_over(table: Table, axis: Any, columns: Sequence[str]) -> Any:
    """Draw columns of a table over its first one, that of an axis."""
    from validation.kit import figures

    axes = figures.new_figure(height=4.6)[1]
    for index, name in enumerate(columns):
        place = list(table.columns).index(name)
        points = [(row[0], row[place]) for row in table.rows if row[place] is not None]
        if points:
            look = {"color": figures.COLOURS[index % 4], "linestyle": figures.STYLES[index % 4]}
            axes.plot(*zip(*points, strict=True), marker=".", label=name, **look)
    axes.set(xlabel=table.columns[0], xscale="log" if axis.log else "linear")
    figures.legend_above(axes)
    return axes


# --- Passage ------------------------------------------------------------------------------------


def passage(options: argparse.Namespace) -> Result:
    """Tell when an inverted disk is lost."""
    from validation.nonlinear.passage import SPACING, follow, passage_table

    end = chosen_end(options, SPACING)
    scenario = chosen_scenario(options, rest=options.rest)
    found = follow(scenario, end, run_options(options)["source"])
    named = [(found.pair.scenario.name, found)]

    def picture() -> Any:
        from validation.nonlinear import figures

        return figures.passage_diagram(named)[0].figure

    own = ("crossing", "lost", "predicted", "lowest_spin", "rate")
    return Result(
        tables=[passage_table(named)],
        values={"hopf": found.pair.spin, "frequency": found.pair.frequency}
        | {name: getattr(found, name) for name in own},
        draw=picture,
    )


def _reduced(options: argparse.Namespace) -> Scenario:
    """Scenario of the options, of Model 4 unless they say otherwise."""
    if options.model is None and options.constraints is None and options.scenario is None:
        options.model = 4
    return chosen_scenario(options)
