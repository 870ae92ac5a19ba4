"""How the nonlinear equations of an implicit step are solved."""

from dataclasses import dataclass
from typing import Any

import exudyn as exu

from analysis.data.checks import positive, switch
from mbs_models.model import Model

MOST_ITERATIONS = 100
"""Iterations after which a step fails.

The engine's Jacobian leaves out how constraint forces turn with the disk, so that long steps
converge by a constant factor each, and need more than the engine's 25.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Newton:
    """How the nonlinear equations of an implicit step are solved.

    Parameters
    ----------
    modified : bool
        Keep the Jacobian for several iterations and steps instead of renewing it every time.
    relative : float
        Iterations end when the residual has fallen by this factor, positive.
    absolute : float, optional
        Or when it is below this part of the disk's weight, positive; by default, and never
        below, where rounding lies (`Model.force_rounding`).

    Raises
    ------
    ValueError
        If a tolerance is not positive.
    """

    modified: bool = True
    relative: float = 1e-12
    absolute: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "modified", switch("modified", self.modified))
        object.__setattr__(self, "relative", positive("relative", self.relative))
        if self.absolute is not None:
            object.__setattr__(self, "absolute", positive("absolute", self.absolute))

    def apply(self, settings: Any, model: Model) -> None:
        """Write the options into the engine's settings of its time integration."""
        newton = settings.newton
        newton.useModifiedNewton = self.modified
        newton.maxIterations = MOST_ITERATIONS
        newton.relativeTolerance = self.relative
        wanted = (self.absolute or 0.0) * model.scenario.weight
        newton.absoluteTolerance = max(wanted, model.force_rounding)


def complete_jacobian(model: Model) -> None:
    """Add to the engine's Jacobian how friction grows with the contact force.

    The engine differentiates user functions by coordinates and velocities alone. Without this
    column, friction with the contact force as its load converges by a constant factor for each
    iteration, however short the step.
    """
    contact = model.contact_equation
    scenario = model.scenario
    if contact is None or scenario.friction.load != "contact" or not scenario.rubs:
        return
    data = model.system.systemData
    equations = len(data.GetAECoordinates())

    def column(*_unused: Any) -> Any:
        forces = [0.0] * data.ODE2Size() if model.pulls() else model.friction_per_newton()
        size = len(forces) + equations
        entries = [[row, len(forces) + contact, force] for row, force in enumerate(forces)]
        matrix = exu.MatrixContainer()
        # Written into a dense matrix, the engine fails.
        matrix.SetWithSparseMatrix(entries, size, size, useDenseMatrix=False)
        return matrix

    model.system.SetSystemJacobianUserFunction(column)
