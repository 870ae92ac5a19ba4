"""The public names of `analysis`."""

from analysis.data.bodies import BODIES, EllipticDisk, Sphere
from analysis.data.body import Body
from analysis.data.checks import TimeLimitError, ToleranceError
from analysis.data.constraint_set import (
    MODELS,
    MULTIPLIERS,
    POSSIBLE_SETS,
    ConstraintSet,
    multiplier_names,
)
from analysis.data.contact import PenaltyContact
from analysis.data.disk import (
    CENTRED_DISK,
    DISKS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Hole,
    Plate,
    PointMass,
)
from analysis.data.dissipation import CAUSES, Dissipation, RestCriterion
from analysis.data.endings import CONDITIONS, Condition, Ending, StopWhen
from analysis.data.ensemble import Ensemble
from analysis.data.friction import (
    LAWS,
    AnisotropicCoulomb,
    FrictionLaw,
    LubricatedCoulomb,
    PowerLawCoulomb,
    SmoothCoulomb,
    Stribeck,
    TanhCoulomb,
    ViscousFriction,
)
from analysis.data.inversion import Inversion, Inversions
from analysis.data.outcomes import OutcomeTable
from analysis.data.phases import Phases
from analysis.data.quantities import CONSTRAINTS, LEVELS, LOADS, Constraint, Level, Load
from analysis.data.scenario import Scenario
from analysis.data.scenario_file import load_scenario
from analysis.data.scenario_text import scenario_text
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.start import MOTIONS, Motion, Start
from analysis.data.state import COORDINATES, FlatError, State
from analysis.data.stored_runs import StoredRun, load_run
from analysis.data.table import GRAVITY, Table
from analysis.data.trajectory import Trajectory
from analysis.data.watch import Progress
from analysis.models.balance import (
    constraint_drift,
    contact_forces,
    energies,
    energy_residual,
    power,
)
from analysis.models.ensemble import Outcome, simulate_many
from analysis.models.forms import FORMS, Form
from analysis.models.outcomes import outcomes
from analysis.models.simulation import simulate
from analysis.models.trajectories import Trajectories
from analysis.rest.to_rest import REST_METHODS, RestMethod, simulate_to_rest
from analysis.solve.stepping import METHODS, Method

__all__ = [
    "BODIES",
    "CAUSES",
    "CENTRED_DISK",
    "CONDITIONS",
    "CONSTRAINTS",
    "COORDINATES",
    "DISKS",
    "FORMS",
    "GRAVITY",
    "LAWS",
    "LEVELS",
    "LOADS",
    "METHODS",
    "MODELS",
    "MOTIONS",
    "MULTIPLIERS",
    "POSSIBLE_SETS",
    "REST_METHODS",
    "ROUNDED_STEEL_DISK",
    "STEEL_DISK",
    "AnisotropicCoulomb",
    "Body",
    "Condition",
    "Constraint",
    "ConstraintSet",
    "Disk",
    "Dissipation",
    "EllipticDisk",
    "Ending",
    "Ensemble",
    "FlatError",
    "Form",
    "FrictionLaw",
    "Hole",
    "Inversion",
    "Inversions",
    "Level",
    "Load",
    "LubricatedCoulomb",
    "Method",
    "Motion",
    "Outcome",
    "OutcomeTable",
    "PenaltyContact",
    "Phases",
    "Plate",
    "PointMass",
    "PowerLawCoulomb",
    "Progress",
    "RestCriterion",
    "RestMethod",
    "Scenario",
    "SmoothCoulomb",
    "SpatialMotion",
    "Sphere",
    "Start",
    "State",
    "StopWhen",
    "StoredRun",
    "Stribeck",
    "Table",
    "TanhCoulomb",
    "TimeLimitError",
    "ToleranceError",
    "Trajectories",
    "Trajectory",
    "ViscousFriction",
    "constraint_drift",
    "contact_forces",
    "energies",
    "energy_residual",
    "load_run",
    "load_scenario",
    "multiplier_names",
    "outcomes",
    "power",
    "scenario_text",
    "simulate",
    "simulate_many",
    "simulate_to_rest",
]
