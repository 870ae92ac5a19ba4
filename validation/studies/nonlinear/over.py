"""Cycles and their end over any parameter: friction, the disk's geometry and mass, gravity."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from analysis import Scenario
from analysis.data.changes import changed, check_field
from analysis.data.limits import MOST_SCENARIOS
from analysis.data.written import is_text, unit
from analysis.nonlinear.heteroclinic import Connection, NoConnectionError, heteroclinic_connection
from analysis.nonlinear.over import CyclesOver
from analysis.stability.linear_reduced import critical_speed
from validation.kit import figures
from validation.kit.tables import Table
from validation.studies.nonlinear.tables import HEADS, prediction
from validation.sweeps.axes import Axis


def scenarios_over(scenario: Scenario, axis: Axis) -> tuple[list[float], list[Scenario]]:
    """Values of an axis, and the scenario with each of them.

    Parameters
    ----------
    scenario : Scenario
    axis : Axis
        A number of the scenario but for its start; with a count, or a list.

    Raises
    ------
    ValueError
        If the axis is no such or has more than `MOST_SCENARIOS` values, or a value is out of
        range or does not fit the rest.
    """
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
    values = [axis.at(index) for index in range(axis.size)]
    check_field(scenario, field, {field: values[0]})
    made = [changed(scenario, {field: value}) for value in values]
    return [float(value) for value in values], made


def _head(axis: Axis) -> str:
    """Heading of the axis's values."""
    name, measure = axis.field.rpartition(".")[2].replace("_", " "), unit(axis.field)
    return f"{name} in {measure}" if measure else name


def cycles_table(axis: Axis, values: Sequence[float], found: CyclesOver) -> Table:
    """Cycles over a parameter."""
    names = ("spin", "amplitude", "period", "half_multiplier", "multiplier")
    return Table(
        name="cycles_over",
        title=f"A cycle over {axis.field}",
        columns=(_head(axis), *(HEADS[name] for name in names)),
        rows=[
            (value, *(getattr(cycle, name) for name in names))
            for value, cycle in zip(values, found.cycles, strict=False)
        ],
        note="" if found.reason is None else f"It ends early: {found.reason}.",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """Where the cycles of a scenario begin and end.

    Parameters
    ----------
    hopf : float
        Spin in rad/s.
    connection : Connection or None
        None if there is none.
    prediction : float or None
        Spin of the connection to first order in rad/s.
    reason : str or None
        Why there is no connection.
    """

    hopf: float
    connection: Connection | None
    prediction: float | None
    reason: str | None = None

    @classmethod
    def of(cls, scenario: Scenario) -> "End":
        """That of a scenario; `ValueError` if it has no cycles."""
        found, reason = None, None
        try:
            found = heteroclinic_connection(scenario)
        except NoConnectionError as error:
            reason = str(error)
        return cls(
            hopf=critical_speed(scenario).spin,
            connection=found,
            prediction=getattr(prediction(scenario), "spin", None),
            reason=reason,
        )


def ends_table(axis: Axis, values: Sequence[float], ends: Sequence[End]) -> Table:
    """Hopf point and connection over a parameter."""
    pairs = list(zip(values, ends, strict=True))
    return Table(
        name="ends_over",
        title=f"Hopf point and heteroclinic connection over {axis.field}",
        columns=(
            _head(axis),
            "Hopf point in rad/s",
            "connection in rad/s",
            "first-order prediction in rad/s",
            "saddle index",
        ),
        rows=[
            (
                value,
                end.hopf,
                getattr(end.connection, "spin", None),
                end.prediction,
                getattr(end.connection, "saddle_index", None),
            )
            for value, end in pairs
        ],
        note=" ".join(
            f"{axis.field} = {value:g}: {end.reason}."
            for value, end in pairs
            if end.reason is not None
        ),
    )


def draw(table: Table, log: bool, columns: Sequence[str]) -> Any:
    """Draw columns of a table over its first one.

    Parameters
    ----------
    table : Table
        Of `cycles_table` or `ends_table`.
    log : bool
        Whether the first column has a logarithmic axis.
    columns : sequence of str
        What to draw.
    """
    axes = figures.new_figure(height=4.6)[1]
    for index, name in enumerate(columns):
        place = table.columns.index(name)
        points = [(row[0], row[place]) for row in table.rows if row[place] is not None]
        if points:
            look = {"color": figures.COLOURS[index % 4], "linestyle": figures.STYLES[index % 4]}
            axes.plot(*zip(*points, strict=True), marker=".", label=name, **look)
    axes.set(xlabel=table.columns[0], xscale="log" if log else "linear")
    figures.legend_above(axes)
    return axes
