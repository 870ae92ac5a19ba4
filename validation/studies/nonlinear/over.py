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
from validation.studies.nonlinear.tables import prediction
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
    table = field.partition(".")[0]
    if is_text(field) or table not in ("disk", "friction", "table"):
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


def column(axis: Axis) -> str:
    """Heading of the axis's values."""
    name, measure = axis.field.rpartition(".")[2].replace("_", " "), unit(axis.field)
    return f"{name} in {measure}" if measure else name


def cycles_table(axis: Axis, values: Sequence[float], found: CyclesOver) -> Table:
    """Cycles over a parameter."""
    return Table(
        name="cycles_over",
        title=f"A cycle over {axis.field}",
        columns=(
            column(axis),
            "spin in rad/s",
            "amplitude in rad",
            "period in s",
            "half multiplier",
            "multiplier",
        ),
        rows=[
            (value, c.spin, c.amplitude, c.period, c.half_multiplier, c.multiplier)
            for value, c in zip(values, found.cycles, strict=False)
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
        """That of a scenario.

        Raises
        ------
        ValueError
            If the scenario has no cycles.
        """
        found, reason = None, None
        try:
            found = heteroclinic_connection(scenario)
        except NoConnectionError as error:
            reason = str(error)
        slow = prediction(scenario)
        return cls(
            hopf=critical_speed(scenario).spin,
            connection=found,
            prediction=None if slow is None else slow.spin,
            reason=reason,
        )


def ends_table(axis: Axis, values: Sequence[float], ends: Sequence[End]) -> Table:
    """Hopf point and connection over a parameter."""
    missing = [
        f"{axis.field} = {value:g}: {end.reason}."
        for value, end in zip(values, ends, strict=True)
        if end.reason is not None
    ]
    return Table(
        name="ends_over",
        title=f"Hopf point and heteroclinic connection over {axis.field}",
        columns=(
            column(axis),
            "Hopf point in rad/s",
            "connection in rad/s",
            "first-order prediction in rad/s",
            "saddle index",
        ),
        rows=[
            (
                value,
                end.hopf,
                None if end.connection is None else end.connection.spin,
                end.prediction,
                None if end.connection is None else end.connection.saddle_index,
            )
            for value, end in zip(values, ends, strict=True)
        ],
        note=" ".join(missing),
    )


def draw(table: Table, log: bool, columns: Sequence[str], axes: Any = None) -> Any:
    """Draw columns of a table over its first one, with one pair of axes for each unit.

    Parameters
    ----------
    table : Table
        Of `cycles_table` or `ends_table`.
    log : bool
        Whether the first column has a logarithmic axis.
    columns : sequence of str
        What to draw.
    axes : Axes, optional
    """
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    for index, name in enumerate(columns):
        place = table.columns.index(name)
        points = [(row[0], row[place]) for row in table.rows if row[place] is not None]
        if points:
            axes.plot(
                *zip(*points, strict=True),
                figures.STYLES[index % 4],
                color=figures.COLOURS[index % 4],
                marker=".",
                label=name,
            )
    axes.set(xlabel=table.columns[0], xscale="log" if log else "linear")
    figures.legend_above(axes)
    return axes
