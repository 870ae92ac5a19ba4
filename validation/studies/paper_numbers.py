"""Numbers the paper prints about the disk and its start, and misprints that matter."""

from collections.abc import Mapping
from typing import Any

from analysis import GRAVITY, MODELS, ROUNDED_STEEL_DISK, STEEL_DISK, Scenario
from validation.kit.report import Section
from validation.kit.tables import Cell, Table

COLUMNS = ("quantity", "unit", "paper", "here", "difference in %", "explanation")


def disk_numbers() -> Table:
    """Dimensions and inertia, Table 1, and the start, Table 3."""
    disk, rounded = STEEL_DISK, ROUNDED_STEEL_DISK
    rows: list[tuple[str, str, float, float, str]] = [
        ("m", "kg", rounded.mass, disk.mass, "ring of density 7700 kg/m³, rounded in print"),
        ("e", "m", rounded.eccentricity, disk.eccentricity, "from radii and distance of the hole"),
        ("A", "kg m²", rounded.inertia_x, disk.inertia_x, "rounded in print"),
        ("B", "kg m²", rounded.inertia_y, disk.inertia_y, "rounded in print"),
        ("C", "kg m²", rounded.inertia_z, disk.inertia_z, "rounded in print"),
    ]
    start = Scenario(constraints=MODELS[2]).initial_state
    cells: list[list[Cell]] = [
        [quantity, unit, paper, here, 100.0 * (here - paper) / paper, explanation]
        for quantity, unit, paper, here, explanation in rows
    ]
    cells += [
        [
            "x at the start (Table 3), Models 2 to 4",
            "m",
            0.0,
            start.coordinates[0],
            None,
            "zero breaks g_S = 0 by e cos(gamma) = 0.25 mm; moved onto the constraint",
        ],
        [
            "g",
            "m/s²",
            None,
            GRAVITY,
            None,
            "not printed; 9.81 gives the printed critical speed of 30.92 rad/s",
        ],
    ]
    return Table(
        name="disk-numbers",
        title="Numbers of Tables 1 and 3",
        columns=COLUMNS,
        rows=cells,
        note="The printed results of the paper come from the unrounded disk: that is the default "
        "here, and Table 1 is kept as 'steel-rounded'.",
    )


def misprints() -> Table:
    """Where the printed equations differ from what a derivation gives."""
    rows = [
        ["(54), (53)", "B_C, D_C = -d [...]", "+d [...]", "friction would feed energy in"],
        ["(74)", "-r β̇² cos β", "-r β̈ cos β", "derivative of z - r sin β"],
        ["(86)", "e_x = e_z × e_x", "e_y = e_z × e_x", "wrong index"],
        ["(97)", "second entry ... sin γ", "... cos γ", "the constraint (83) demands it"],
        ["Table 2", "constant spin: Model 3", "Model 4", "Sect. 4.4, 4.5"],
        ["Table 3", "x = 0", "x = -e cos γ", "g_S = 0 in Models 2 to 4"],
    ]
    return Table(
        name="misprints",
        title="Misprints that matter, each found by a derivation (see the tests)",
        columns=("place", "printed", "right", "why"),
        rows=rows,
    )


def section(_results: Mapping[Any, Any]) -> Section:
    """Section of the report; no job is behind it."""
    return Section(
        name="numbers",
        title="The numbers the paper prints",
        tables=[disk_numbers(), misprints()],
    )
