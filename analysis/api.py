"""The public names of `analysis`."""

from analysis.motion.endings import CONDITIONS, Condition, Ending, StopWhen
from analysis.motion.inversion import Inversion, Inversions
from analysis.motion.outcomes import OutcomeTable
from analysis.motion.spatial_motion import Phases, SpatialMotion
from analysis.motion.stored_runs import StoredRun, load_run
from analysis.motion.trajectory import Trajectory
from analysis.problem.bodies import BODIES, EllipticDisk, Sphere
from analysis.problem.body import Body
from analysis.problem.checks import TimeLimitError, ToleranceError
from analysis.problem.choices import FORMULATIONS, METHODS, Formulation, Method
from analysis.problem.constraints import (
    MODELS,
    MULTIPLIERS,
    POSSIBLE_SETS,
    ConstraintSet,
    multiplier_names,
)
from analysis.problem.contact import (
    CAUSES,
    GRAVITY,
    Dissipation,
    PenaltyContact,
    RestCriterion,
    Table,
)
from analysis.problem.disk import (
    CENTRED_DISK,
    DISKS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Hole,
    Plate,
    PointMass,
)
from analysis.problem.friction import (
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
from analysis.problem.quantities import CONSTRAINTS, LEVELS, LOADS, Constraint, Level, Load
from analysis.problem.scenario import Scenario
from analysis.problem.scenario_file import load_scenario, scenario_text
from analysis.problem.start import COORDINATES, MOTIONS, FlatError, Motion, Start, State
from analysis.problem.variations import Ensemble
from analysis.simulation.energies import (
    constraint_drift,
    contact_forces,
    energies,
    energy_residual,
    power,
)
from analysis.simulation.ensemble import Outcome, simulate_many
from analysis.simulation.formulations import formulations
from analysis.simulation.outcomes import outcomes
from analysis.simulation.simulate import simulate
from analysis.simulation.to_rest import REST_METHODS, RestMethod, simulate_to_rest
from analysis.simulation.trajectories import Trajectories
from analysis.solve.watch import Progress

__all__ = [
    "BODIES",
    "CAUSES",
    "CENTRED_DISK",
    "CONDITIONS",
    "CONSTRAINTS",
    "COORDINATES",
    "DISKS",
    "FORMULATIONS",
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
    "Formulation",
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
    "formulations",
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
