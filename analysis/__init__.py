"""In-house mechanics of the tippedisk, independent of the multibody engine.

Source of all equation numbers: S. Sailer and R. I. Leine, "Model reduction of the tippedisk: a
path to the full analysis", Nonlinear Dynamics 105 (2021).
"""

from analysis.balance import constraint_drift, energies, energy_residual, power
from analysis.checks import TimeLimitError, ToleranceError
from analysis.contact import PenaltyContact
from analysis.disk import CENTRED_DISK, DISKS, GRAVITY, ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.dissipation import CAUSES, Dissipation, RestCriterion
from analysis.friction import (
    LAWS,
    LOADS,
    FrictionLaw,
    Load,
    SmoothCoulomb,
    Stribeck,
    TanhCoulomb,
    ViscousFriction,
)
from analysis.integration import METHODS, Method
from analysis.inversion import Inversion, find_inversion, judge_inversion
from analysis.phases import Phases, find_phases
from analysis.rest import REST_METHODS, RestMethod, simulate_to_rest
from analysis.simulation import FORMS, Form, simulate
from analysis.spatial_motion import SpatialMotion
from analysis.state import (
    COORDINATES,
    LEVELS,
    MULTIPLIERS,
    FlatError,
    Level,
    State,
    consistent_start,
    multiplier_names,
)
from analysis.trajectory import Ending, Trajectory
from analysis.watch import Progress

__all__ = [
    "CAUSES",
    "CENTRED_DISK",
    "COORDINATES",
    "DISKS",
    "FORMS",
    "GRAVITY",
    "LAWS",
    "LEVELS",
    "LOADS",
    "METHODS",
    "MULTIPLIERS",
    "REST_METHODS",
    "ROUNDED_STEEL_DISK",
    "STEEL_DISK",
    "Disk",
    "Dissipation",
    "Ending",
    "FlatError",
    "Form",
    "FrictionLaw",
    "Inversion",
    "Level",
    "Load",
    "Method",
    "PenaltyContact",
    "Phases",
    "Progress",
    "RestCriterion",
    "RestMethod",
    "SmoothCoulomb",
    "SpatialMotion",
    "State",
    "Stribeck",
    "TanhCoulomb",
    "TimeLimitError",
    "ToleranceError",
    "Trajectory",
    "ViscousFriction",
    "consistent_start",
    "constraint_drift",
    "energies",
    "energy_residual",
    "find_inversion",
    "find_phases",
    "judge_inversion",
    "multiplier_names",
    "power",
    "simulate",
    "simulate_to_rest",
]
