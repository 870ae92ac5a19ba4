"""What the report says of the nonlinear dynamics."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from analysis import Dissipation
from analysis.mechanics.paper import critical_speed
from validation.comparison.limits import largest
from validation.display.figures import COLOURS, ENGINE, angle_axis, legend_above
from validation.display.tables import Table
from validation.nonlinear import figures, passage, tables
from validation.nonlinear.tables import HEADS
from validation.studies.nonlinear import measured
from validation.studies.nonlinear.measured import PAPER, ROTATING, SWINGING
from validation.study import Check, Content, Row, Rows, at_most, equal, grade

TITLE = "Nonlinear dynamics"
STUDIES = (measured.FAMILIES, measured.ENGINE, measured.CONNECTIONS, measured.PASSAGES)

SAME_CYCLE = {"spin": 1e-6, "amplitude": 1e-6, "period": 1e-6, "multiplier": 1e-5}
"""How far cycles of engine and in-house may be apart, in rad/s, rad, s and 1."""

KEPT = 1e-8
"""Smallest difference that the digits kept of a cycle tell."""

SAME = 1e-6
"""How far spins in rad/s may be apart that are found in two ways."""

SAME_PASSAGE = 3e-3
"""How far passages of engine and in-house may be apart, in s and rad/s."""

FIT, ROOT = 1e-3, 0.03
"""How far fits may be off from theory, relative, and the power of the rate of decay from 1/2."""

SOON = 1.0
"""Time in s after a crossing within which a disk would be lost there."""

DRAWN = ("period", "multiplier", "log10_strong")
"""What is drawn of cycles besides amplitudes."""

HELD = ["amplitude", "spin", "period", "half_multiplier", "complex_multiplier", "stable"]
"""What is told of cycles at held spin,"""

CONNECTION = {"case": "friction or disk", "predicted": "first-order prediction"}
"""and headings of connections that no motion has."""


def present(rows: Rows) -> Content:
    """Numbers, tables, figures and checks."""
    families, engine, connections, passages = (rows[study.name] for study in STUDIES)
    cycles, rotations = (_motions(families, name) for name in (SWINGING, ROTATING))
    fits = families[families.kind != "motion"].set_index("kind").T
    connection = connections.set_index("case").loc[measured.OF_PAPER]
    slows = passages.case.str.startswith(measured.SLOWED)
    slowed, followed = passages[slows], passages[~slows]
    law = passage.delay_law(slowed.rate, slowed.hopf - slowed.lowest_spin)
    held = families[families.case.isin(measured.HELD_NAMES)]
    stable = sum(bool(each["stable"]) for each in cycles)
    late, apart = followed.lost - followed.crossing, _apart(engine)
    return Content(
        numbers={
            "cycles": cycles,
            "hopf": critical_speed(PAPER),
            "connection": connection,
            "fits": fits,
            "apart": apart.max(skipna=False).clip(lower=KEPT),
            "held": held,
            "followed": followed.set_index("case"),
            "law": law,
            "growth": np.log(passage.LOST / passage.SMALL),
            "stable": stable,
            "late": late,
            "smoothing": Dissipation().rolling_smoothing,
            "answers": {
                "swings": grade(yes=stable == len(cycles), partly=stable > 0),
                "lost": grade(yes=(late < SOON).all(), partly=(late < SOON).any()),
            },
        },
        tables={
            "cycles": _frame(tables.motion_table(cycles)),
            "some-cycles": _frame(tables.motion_table(cycles[1::5])),
            "rotations": _frame(tables.motion_table(rotations, "rotating")),
            "some-rotations": _frame(tables.motion_table(rotations[::5], "rotating")),
            "held": held.replace({"stable": tables.WORDS})[["case", *HELD]].rename(columns=HEADS),
            "engine": engine[["case", "source", *SAME_CYCLE]].rename(columns=HEADS),
            "connections": connections[["case", "spin", "predicted", *tables.SADDLE]].rename(
                columns=HEADS | tables.SADDLE | CONNECTION
            ),
            "passages": _frame(passage.passage_table(_named(passages))),
        },
        figures={
            "bifurcations": lambda: _bifurcations(cycles, connection.spin, rows),
            "periods": lambda: _family(cycles, connection.spin, *DRAWN),
            "passages": lambda: _passages(followed),
        },
        checks=[*_checks(rows, fits, apart, law.exponent)],
    )


def _motions(rows: pd.DataFrame, case: str) -> list[Row]:
    """Rows of a case, fits and folds left out."""
    found = rows[(rows.case == case) & (rows.kind == "motion")]
    return found.to_dict("records")


def _frame(table: Table) -> pd.DataFrame:
    return pd.DataFrame(table.records())


def _named(passages: pd.DataFrame) -> list[tuple[str, Row]]:
    return [(each["case"], each) for each in passages.to_dict("records")]


def _passages(followed: pd.DataFrame) -> Any:
    return figures.passage_diagram(_named(followed[followed.source == "in-house"]))


def _family(cycles: list[Row], end: float, *names: str) -> Any:
    """What is told of cycles over their spins, from the Hopf point to the connection."""
    hopf = critical_speed(PAPER)
    born = {"spin": hopf.spin, "amplitude": 0.0, "period": 2.0 * np.pi / hopf.frequency}
    born |= {"multiplier": 1.0, "log10_strong": np.nan, "stable": cycles[0]["stable"]}
    return figures.diagram([born, *cycles], names, marks={"heteroclinic": end})


def _bifurcations(cycles: list[Row], connection: float, rows: Rows) -> Any:
    """Beside amplitudes over spin the stationary motions between them, and cycles of others."""
    figure = _family(cycles, connection, "amplitude")
    hopf = critical_speed(PAPER).spin
    families, engine = rows[measured.FAMILIES.name], rows[measured.ENGINE.name]
    slow = families[families.case == measured.SLOW]
    engine = engine[(engine.source == "engine") & engine.case.str.startswith("Model 4")]
    (axes,) = figure.axes
    low, high = axes.get_xlim()
    for value, end, word in ((0.0, hopf, "unstable"), (np.pi, high, None)):
        axes.plot([low, end], [value] * 2, "--", color=COLOURS[figures.UNSTABLE], label=word)
    axes.plot([hopf, high], [0.0, 0.0], color=COLOURS[figures.STABLE])
    axes.annotate("inverted spinning", (0.05 * high + 0.95 * low, 0.08))
    axes.annotate("noninverted spinning", (high, np.pi - 0.22), ha="right")
    axes.plot(hopf, 0.0, "D", color="black", label="Hopf point", zorder=5)
    axes.plot(slow.spin, slow.amplitude, ":", color=COLOURS[3], label="slow manifold")
    axes.plot(engine.spin, engine.amplitude, label="engine", **ENGINE)
    axes.set(xlim=(low, high))
    angle_axis(axes)
    legend_above(axes, columns=3)
    return figure


def _apart(engine: pd.DataFrame) -> pd.DataFrame:
    """How far cycles of both sides are apart, not a number where one is missing."""
    values = engine.set_index(["source", "case"])[[*SAME_CYCLE]]
    return (values.loc["engine"] - values.loc["in-house"]).abs()


# --- Checks -------------------------------------------------------------------------------------


def _checks(
    rows: Rows, fits: pd.DataFrame, apart: pd.DataFrame, power_of_decay: float
) -> Iterator[Check]:
    connections, passages = rows[measured.CONNECTIONS.name], rows[measured.PASSAGES.name]
    for name, limit in SAME_CYCLE.items():
        yield at_most(f"cycles: {name}, engine", largest(apart[name]), limit)
    birth, end = fits.birth, fits.end
    yield at_most("cycles: end at the connection", end.off, SAME)
    ratios = {
        "spin over amplitude²": birth.fitted_curvature / birth.curvature,
        "power of the amplitude": birth.fitted_exponent / 2.0,
        "period over ln(π − amplitude)": end.by_amplitude / end.predicted_by_amplitude,
    }
    for name, ratio in ratios.items():
        yield at_most(f"cycles: {name}, fit over theory less 1", abs(ratio - 1.0), FIT)
    number = len(measured.disks_and_friction())
    yield equal("connections: found", int(connections.spin.notna().sum()), number)
    yield at_most("connections: bracket", largest(connections.bracket), SAME)
    lost, number = int(passages.lost.notna().sum()), len(measured.passages())
    yield equal("passages: lost", lost, number)
    named = passages.set_index("case")
    sides = named.reindex([measured.DISSIPATED, f"{measured.DISSIPATED}, engine"])
    for name in ("crossing", "lost", "lowest_spin"):
        yield at_most(f"passage: {name}, engine", float(np.ptp(sides[name])), SAME_PASSAGE)
    yield at_most("passage: power of the rate of decay", abs(power_of_decay - 0.5), ROOT)
