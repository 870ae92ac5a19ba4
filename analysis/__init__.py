"""In-house mechanics of the tippedisk, independent of the multibody engine.

Source of all equation numbers: S. Sailer and R. I. Leine, "Model reduction of the tippedisk: a
path to the full analysis", Nonlinear Dynamics 105 (2021).
"""

from analysis.balance import constraint_drift, energies, energy_residual, power
from analysis.checks import ToleranceError
from analysis.disk import DISKS, GRAVITY, ROUNDED_STEEL_DISK, STEEL_DISK, Disk
from analysis.friction import LOADS, Load, SmoothCoulomb
from analysis.simulation import FORMS, METHODS, Form, Method, simulate
from analysis.state import (
    COORDINATES,
    LEVELS,
    MULTIPLIERS,
    Level,
    State,
    consistent_start,
    multiplier_names,
)
from analysis.trajectory import Trajectory

__all__ = [
    "COORDINATES",
    "DISKS",
    "FORMS",
    "GRAVITY",
    "LEVELS",
    "LOADS",
    "METHODS",
    "MULTIPLIERS",
    "ROUNDED_STEEL_DISK",
    "STEEL_DISK",
    "Disk",
    "Form",
    "Level",
    "Load",
    "Method",
    "SmoothCoulomb",
    "State",
    "ToleranceError",
    "Trajectory",
    "consistent_start",
    "constraint_drift",
    "energies",
    "energy_residual",
    "multiplier_names",
    "power",
    "simulate",
]
