"""In-house mechanics of the tippedisk, independent of the multibody engine.

Source of all equation numbers: S. Sailer and R. I. Leine, "Model reduction of the tippedisk: a
path to the full analysis", Nonlinear Dynamics 105 (2021).
"""

from analysis.data.checks import TimeLimitError, ToleranceError
from analysis.data.contact import PenaltyContact
from analysis.data.disk import CENTRED_DISK, DISKS, GRAVITY, ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.data.dissipation import CAUSES, Dissipation, RestCriterion
from analysis.data.friction import (
    LAWS,
    LOADS,
    FrictionLaw,
    Load,
    SmoothCoulomb,
    Stribeck,
    TanhCoulomb,
    ViscousFriction,
)
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.state import (
    COORDINATES,
    LEVELS,
    MULTIPLIERS,
    FlatError,
    Level,
    State,
    consistent_start,
    multiplier_names,
)
from analysis.data.trajectory import Ending, Trajectory
from analysis.data.watch import Progress
from analysis.models.balance import constraint_drift, energies, energy_residual, power
from analysis.models.integration import METHODS, Method
from analysis.models.inversion import Inversion, find_inversion, judge_inversion
from analysis.models.simulation import FORMS, Form, simulate
from analysis.rest.phases import Phases, find_phases
from analysis.rest.to_rest import REST_METHODS, RestMethod, simulate_to_rest

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
