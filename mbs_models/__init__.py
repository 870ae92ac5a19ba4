"""The tippedisk built from Exudyn's own bodies, markers, joints and constraints."""

from mbs_models.integrators import INTEGRATORS, EngineError, IntegratorName, integrators
from mbs_models.probe import acceleration
from mbs_models.scene import FORMULATIONS, Formulation, Scene, formulations
from mbs_models.simulation import simulate

__all__ = [
    "FORMULATIONS",
    "INTEGRATORS",
    "EngineError",
    "Formulation",
    "IntegratorName",
    "Scene",
    "acceleration",
    "formulations",
    "integrators",
    "simulate",
]
