"""The tippedisk built from Exudyn's own bodies, markers, joints and constraints."""

from mbs_models.contact import PenaltyContact
from mbs_models.integrators import (
    INTEGRATORS,
    EngineError,
    Integrator,
    IntegratorName,
    Newton,
    integrators,
)
from mbs_models.linearization import (
    MOTIONS,
    Motion,
    eigenvalues,
    state_matrix,
    stationary_scene,
    stock_eigenvalues,
)
from mbs_models.probe import acceleration
from mbs_models.rest import simulate_rest
from mbs_models.rest_scene import RestScene
from mbs_models.scene import FORMULATIONS, Formulation, Scene, formulations
from mbs_models.simulation import simulate

__all__ = [
    "FORMULATIONS",
    "INTEGRATORS",
    "MOTIONS",
    "EngineError",
    "Formulation",
    "Integrator",
    "IntegratorName",
    "Motion",
    "Newton",
    "PenaltyContact",
    "RestScene",
    "Scene",
    "acceleration",
    "eigenvalues",
    "formulations",
    "integrators",
    "simulate",
    "simulate_rest",
    "state_matrix",
    "stationary_scene",
    "stock_eigenvalues",
]
