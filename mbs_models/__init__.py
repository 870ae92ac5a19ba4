"""The tippedisk built from Exudyn's own bodies, markers, joints and constraints."""

import sys
from contextlib import redirect_stdout

try:
    # Where it is the build without range checks, it says so, and standard output may be JSON.
    with redirect_stdout(sys.stderr):
        import exudyn as _exudyn  # noqa: F401
except ImportError as error:
    # It loads OpenGL even where it draws nothing.
    _lacking = "; install that, libgl1 on Debian" if "libGL" in str(error) else ""
    raise ImportError(f"exudyn cannot be loaded: {error}{_lacking}") from error

from analysis.problem.choices import ACCELERATED, INTEGRATORS, IntegratorName
from analysis.problem.choices import ENGINE_FORMULATIONS as FORMULATIONS
from analysis.problem.choices import EngineFormulation as Formulation
from mbs_models.accelerations import acceleration, eigenvalues, state_matrix, stock_eigenvalues
from mbs_models.integrators import Integrator, Newton, integrators
from mbs_models.model import Model
from mbs_models.rest import simulate_to_rest
from mbs_models.runs import settle
from mbs_models.scene import Scene, build, formulations
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
    "Model",
    "Newton",
    "Scene",
    "acceleration",
    "build",
    "eigenvalues",
    "formulations",
    "integrators",
    "settle",
    "simulate",
    "simulate_to_rest",
    "state_matrix",
    "stock_eigenvalues",
]
