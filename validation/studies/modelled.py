"""What is modelled: coordinates, the four models, the formulations and all parameters."""

from dataclasses import fields

import pandas as pd

from analysis import (
    GRAVITY,
    LEVELS,
    MODELS,
    STEEL_DISK,
    Level,
    PenaltyContact,
    RestCriterion,
    Scenario,
    SmoothCoulomb,
    Start,
)
from analysis.data.disk import STEEL_RING
from analysis.models.forms import FORMS
from mbs_models import FORMULATIONS, Scene, formulations
from validation.page.content import Content, Rows
from validation.studies.rest.runs import CASES
from validation.study import Study, equal

TITLE = "What is modelled"
STUDIES: tuple[Study, ...] = ()

ADDED: dict[Level, tuple[str, str, str]] = {
    1: ("the disk stays on the table: g_N = 0", "rolling joint along its normal", "(79), (80)"),
    2: ("centre of gravity fixed horizontally: g_S = 0", "spherical joint in x and y", "(92)"),
    3: ("no slip along the edge: γ_x = 0", "rolling joint also along its forward axis", "(92)"),
    4: ("constant spin", "coordinate constraint on the spin", "(92), reduced: (102)"),
}
"""By model: the constraint that it adds, how the engine has it, and the paper's equations."""

WAYS = {
    "contact-tree": (
        "kinematic tree that starts at the contact point: α, x, y, β, γ",
        "without constraints, so that explicit solvers apply",
    ),
    "euler-tree": (
        "kinematic tree in the paper's coordinates: α, x, y, z, β, γ",
        "the paper's coordinates under all constraints",
    ),
    "floating": (
        "free rigid body with Euler parameters",
        "what most users would write; regular in every attitude",
    ),
    "floating-lie": (
        "the same with a rotation vector on the Lie group",
        "comparison with floating",
    ),
    "index-1": (
        "the paper's coordinates, constraints differentiated twice",
        "independent check: NumPy and SciPy alone",
    ),
    "reduced": ("β and γ and their rates", "the paper's reduced system"),
    "free-body": (
        "free rigid body with Euler parameters on a penalty contact",
        "independent check of the way to rest",
    ),
}
"""By formulation: its coordinates, and what it is there for."""

INHOUSE = {"index-1": LEVELS, "reduced": LEVELS[-1:]}
"""Models of the in-house formulations."""

UNITS = {
    "rolling_dry": "1",
    "rolling_viscous": "s/m",
    "pivoting": "m",
    "air_drag": "kg/m³",
    "rolling_smoothing": "m/s",
    "pivoting_smoothing": "rad/s",
}
"""Of what may take energy."""

COLUMNS = ["of", "parameter", "symbol", "value", "unit"]


def present(rows: Rows) -> Content:
    """The tables; nothing is measured."""
    del rows
    return Content(
        tables={
            "models": pd.DataFrame(
                [(f"Model {level}", *ADDED[level]) for level in LEVELS],
                columns=["model", "constraint added", "in the engine", "in-house: equations"],
            ),
            "formulations": formulation_table(),
            "disk": disk(),
            "motion": motion(),
            "rest": rest(),
        },
        checks=[
            equal("modelled: formulations", sorted(WAYS), sorted((*FORMULATIONS, *FORMS))),
        ],
    )


def formulation_table() -> pd.DataFrame:
    """The ways in which the engine builds a model, and the in-house ones."""
    scenarios = {level: Scenario(constraints=MODELS[level]) for level in LEVELS}
    found = []
    for way, (coordinates, purpose) in WAYS.items():
        scenes = [
            (level, Scene(scenario, each))
            for level, scenario in scenarios.items()
            for each in formulations(scenario)
            if each == way
        ]
        built = [level for level, _ in scenes] or INHOUSE.get(way, ())
        tied = [level for level, scene in scenes if scene.has_constraints]
        found.append(
            {
                "way": way,
                "side": "engine" if way in FORMULATIONS else "in-house",
                "coordinates": coordinates,
                "models": ", ".join(map(str, built)) or "–",
                "with constraints": ", ".join(map(str, tied)) or "–",
                "for": purpose,
            }
        )
    return pd.DataFrame(found)


def disk() -> pd.DataFrame:
    """Geometry and density, and what follows from them."""
    ring = {"radius": "r", "hole_radius": "a", "hole_distance": "b", "thickness": "h"}
    moments = {"x": ("A", STEEL_DISK.inertia_x), "y": ("B", STEEL_DISK.inertia_y),
               "z": ("C", STEEL_DISK.inertia_z)}  # fmt: skip
    rows = [
        *(("given", n.replace("_", " "), s, 1e3 * STEEL_RING[n], "mm") for n, s in ring.items()),
        ("given", "density", "ρ", STEEL_RING["density"], "kg/m³"),
        ("from these", "mass", "m", STEEL_DISK.mass, "kg"),
        ("from these", "eccentricity", "e", 1e3 * STEEL_DISK.eccentricity, "mm"),
        *(
            ("from these", f"moment of inertia about G, {axis}", symbol, 1e6 * value, "10⁻⁶ kg m²")
            for axis, (symbol, value) in moments.items()
        ),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def motion() -> pd.DataFrame:
    """Table, friction and start of the runs, unless a section names another."""
    friction, start = SmoothCoulomb(), Start()
    centre = 1e3 * Scenario(constraints=MODELS[2]).initial_state.coordinates[0]
    rows = [
        ("table", "gravity", "g", GRAVITY, "m/s²"),
        ("friction", "coefficient", "μ", friction.coefficient, "1"),
        ("friction", "smoothing: slip speed at half the force", "ε", friction.smoothing, "m/s"),
        ("start (Table 3)", "inclination", "β", start.beta, "rad"),
        ("start (Table 3)", "rotation: −π/2 + 0.1", "γ", start.gamma, "rad"),
        ("start (Table 3)", "spin", "α̇", start.spin, "rad/s"),
        ("start (Table 3)", "rate of γ: −α̇ cos β", "γ̇", 0.0, "rad/s"),
        ("start (Table 3)", "centre, Models 2 to 4: −e cos γ", "x̄", centre, "mm"),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def rest() -> pd.DataFrame:
    """Contact, dissipation and criterion on the way to rest."""
    contact, criterion = PenaltyContact.rounded(STEEL_DISK), RestCriterion()
    rows = [
        ("contact", "stiffness", "", contact.stiffness, "N/m"),
        ("contact", "damping", "", contact.damping, "N s/m"),
        ("contact", "half thickness of the rim", "", 1e3 * contact.half_thickness, "mm"),
        *(
            (case, name.replace("_", " "), "", getattr(losses, name), unit)
            for case, losses in CASES.items()
            for name, unit in UNITS.items()
        ),
        *(
            ("at rest within", field.name, "", getattr(criterion, field.name), unit)
            for field, unit in zip(fields(criterion), ("J", "m", "s"), strict=True)
        ),
    ]
    return pd.DataFrame(rows, columns=COLUMNS)
