"""What is modelled: coordinates, the four models, the formulations and all parameters."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from analysis import (
    GRAVITY,
    MODELS,
    STEEL_DISK,
    PenaltyContact,
    RestCriterion,
    Scenario,
    SmoothCoulomb,
    Start,
)
from analysis.data.disk import STEEL_RING
from validation.kit.page import Section
from validation.kit.tables import Cell, Table
from validation.studies.coordinates import sketch
from validation.studies.rest.runs import CASES


def models() -> Table:
    """The paper's models."""
    rows = [
        ["Model 1", "the disk stays on the table: g_N = 0", "rolling joint along its normal",
         "(79), (80)"],
        ["Model 2", "centre of gravity fixed horizontally: g_S = 0", "spherical joint in x and y",
         "(92)"],
        ["Model 3", "no slip along the edge: γ_x = 0",
         "rolling joint also along its forward axis", "(92)"],
        ["Model 4", "constant spin", "coordinate constraint on the spin",
         "(92), reduced: (102)"],
    ]  # fmt: skip
    return Table(
        name="models",
        title="The four models: each takes over the constraints of the one before",
        columns=("model", "constraint added", "in the engine", "in-house: equations of the paper"),
        rows=rows,
        note="The contact is ideal and never leaves the table. In the section on the way to rest "
        "it is a stiff, damped spring instead, which only pushes. The full system is Model 1, the "
        "reduced system Model 4.",
    )


def formulations() -> Table:
    """The ways in which the engine builds a model, and the in-house one."""
    rows = [
        ["contact-tree", "kinematic tree that starts at the contact point: α, x, y, β, γ",
         "none (Model 1 only)", "fastest by far"],
        ["euler-tree", "kinematic tree in the paper's coordinates: α, x, y, z, β, γ",
         "contact, and those of the model", "smallest error at a given step, Models 2 to 4"],
        ["floating", "free rigid body with Euler parameters", "contact, and those of the model",
         "what most users would write; regular in every attitude"],
        ["floating-lie", "the same with a rotation vector on the Lie group",
         "contact, and those of the model", "comparison with floating"],
        ["in-house, index 1", "the paper's coordinates, constraints differentiated twice",
         "none; drift is measured", "independent check: NumPy and SciPy alone"],
        ["in-house, reduced", "β and γ and their rates", "none (Model 4 only)",
         "the paper's reduced system"],
    ]  # fmt: skip
    return Table(
        name="formulations",
        title="How they are built: four ways in Exudyn, two in-house",
        columns=("way", "coordinates", "constraints left to the solver", "good for"),
        rows=rows,
    )


def parameters() -> Table:
    """Every parameter of the runs, unless a section names another."""
    friction, start = SmoothCoulomb(), Start()
    ring = {"radius": "r", "hole_radius": "a", "hole_distance": "b", "thickness": "h"}
    rows: list[list[Cell]] = [
        *(
            _row("disk", name.replace("_", " "), symbol, 1e3 * STEEL_RING[name], "mm")
            for name, symbol in ring.items()
        ),
        ["disk", "density", "ρ", STEEL_RING["density"], "kg/m³"],
        ["disk, from these", "mass", "m", STEEL_DISK.mass, "kg"],
        ["disk, from these", "eccentricity", "e", 1e3 * STEEL_DISK.eccentricity, "mm"],
        *(
            _row(
                "disk, from these",
                f"moment of inertia about G, {axis}",
                symbol,
                1e6 * value,
                "10⁻⁶ kg m²",
            )
            for axis, symbol, value in (
                ("x", "A", STEEL_DISK.inertia_x),
                ("y", "B", STEEL_DISK.inertia_y),
                ("z", "C", STEEL_DISK.inertia_z),
            )
        ),
        ["table", "gravity", "g", GRAVITY, "m/s²"],
        ["friction", "coefficient", "μ", friction.coefficient, "1"],
        ["friction", "smoothing: slip speed at half the force", "ε", friction.smoothing, "m/s"],
        ["friction", "load: the weight, or the contact force where named", "", "m g or λ_N", "N"],
        ["start (Table 3)", "inclination", "β", start.beta, "rad"],
        ["start (Table 3)", "rotation: −π/2 + 0.1", "γ", start.gamma, "rad"],
        ["start (Table 3)", "spin", "α̇", start.spin, "rad/s"],
        ["start (Table 3)", "rate of γ: −α̇ cos β", "γ̇", 0.0, "rad/s"],
        ["start (Table 3)", "centre, Models 2 to 4: −e cos γ", "x̄", _start_x(), "mm"],
        *_rest_rows(),
    ]
    return Table(
        name="parameters",
        title="All parameters",
        columns=("of", "parameter", "symbol", "value", "unit"),
        rows=rows,
        note="What is not named is zero at the start. Sections that vary a parameter say so.",
        folded=False,
        digits=6,
    )


def _row(*cells: Cell) -> list[Cell]:
    return list(cells)


def _start_x() -> float:
    return 1e3 * float(Scenario(constraints=MODELS[2]).initial_state.coordinates[0])


def _rest_rows() -> list[list[Cell]]:
    contact, criterion = PenaltyContact.rounded(STEEL_DISK), RestCriterion()
    names = {
        "rolling_dry": ("coefficient of dry rolling resistance", "1"),
        "rolling_viscous": ("coefficient of viscous rolling resistance", "s/m"),
        "pivoting": ("lever of pivoting friction", "m"),
        "air_drag": ("density times drag coefficient of the air", "kg/m³"),
    }
    rows: list[list[Cell]] = [
        ["contact, to rest", "stiffness", "", contact.stiffness, "N/m"],
        ["contact, to rest", "damping", "", contact.damping, "N s/m"],
        ["contact, to rest", "half thickness of the rim", "", 1e3 * contact.half_thickness, "mm"],
    ]
    for case, dissipation in CASES.items():
        rows += [
            [f"to rest, {case}", words, "", getattr(dissipation, name), unit]
            for name, (words, unit) in names.items()
            if getattr(dissipation, name)
        ]
    dry = next(each for each in CASES.values() if each.rolling_dry)
    rows += [
        [
            "to rest",
            "smoothing of dry rolling: contour speed at half of it",
            "",
            dry.rolling_smoothing,
            "m/s",
        ],
        [
            "to rest",
            "smoothing of pivoting: spin at half of it",
            "",
            dry.pivoting_smoothing,
            "rad/s",
        ],
        *(
            ["called at rest", f"{field.name} within", "", getattr(criterion, field.name), unit]
            for field, unit in zip(fields(criterion), ("J", "m", "s"), strict=True)
        ),
    ]
    return rows


def section(_results: Mapping[Any, Any]) -> Section:
    """Section of the report; no job is behind it."""
    return Section(
        name="modelled",
        title="What is modelled",
        paragraphs=[
            (
                "One rigid disk in permanent contact with a table, under gravity and friction at "
                "the contact point. Friction follows the paper's law: the force is "
                "μ · load · slip / (|slip| + ε), against the slip velocity of the contact point."
            ),
        ],
        drawings=[sketch()],
        tables=[models(), formulations(), parameters()],
    )
