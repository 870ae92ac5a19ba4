"""The tippedisk built from Exudyn's own bodies, markers, joints and constraints."""

from mbs_models.accelerations import acceleration, eigenvalues, state_matrix, stock_eigenvalues
from mbs_models.integrators import (
    ACCELERATED,
    INTEGRATORS,
    Integrator,
    IntegratorName,
    Newton,
    integrators,
)
from mbs_models.model import FORMULATIONS, Formulation
from mbs_models.rest import simulate_to_rest
from mbs_models.scene import Scene, formulations
from mbs_models.simulation import simulate
from mbs_models.solving import EngineError

__all__ = [
    "ACCELERATED",
    "FORMULATIONS",
    "INTEGRATORS",
    "EngineError",
    "Formulation",
    "Integrator",
    "IntegratorName",
    "Newton",
    "Scene",
    "acceleration",
    "eigenvalues",
    "formulations",
    "integrators",
    "simulate",
    "simulate_to_rest",
    "state_matrix",
    "stock_eigenvalues",
]
