"""How the nonlinear equations of an implicit step are solved."""

from dataclasses import dataclass
from math import sqrt
from typing import Any

import exudyn as exu
import numpy as np

from analysis.data.checks import positive, switch
from analysis.data.state import COORDINATES
from mbs_models.model import Model
from mbs_models.probe import Probe

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
        below, where rounding lies (`force_rounding`).

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
        newton.absoluteTolerance = max(wanted, force_rounding(model))


def force_rounding(model: Model) -> float:
    """Residual in N that rounding leaves, below which Newton's iteration cannot get.

    The last digits of the forces: the weight, and what turns a disk as fast as the start, or
    a fall from upright, makes it turn. A stiff contact turns the last digit of a height into
    a force, and steep friction that of a slip speed. The engine adds the residuals of the
    algebraic equations, whatever their unit: speeds, that of the spin, and the norm of the
    Euler parameters, which is one. On a light disk their last digits are larger than those
    of the forces.
    """
    scenario = model.scenario
    disk, friction, contact = scenario.disk, scenario.friction, scenario.contact
    gravity, rates = scenario.table.gravity, model.start.rates[3:]
    fastest = sqrt(sum(rate * rate for rate in rates) + gravity / disk.radius)
    rim_speed = disk.radius * fastest
    largest = [disk.mass * (gravity + rim_speed * fastest)]
    largest += model.own_equations
    if model.has_constraints(scenario):
        largest.append(rim_speed)
        largest += [abs(model.start.rates[COORDINATES.index(name)]) for name in model.held_rates]
    lost = friction.slope(scenario.weight) * rim_speed
    if contact is not None:
        lost += contact.stiffness * disk.radius
    return 4.0 * float(np.finfo(float).eps) * max(lost, *largest)


def complete_jacobian(model: Model) -> None:
    """Add to the engine's Jacobian how friction grows with the contact force.

    The engine differentiates user functions by coordinates and velocities alone. Without this
    column, friction with the contact force as its load converges by a constant factor for each
    iteration, however short the step.
    """
    contact, scenario = model.contact_equation, model.scenario
    if contact is None or scenario.friction.load != "contact" or not scenario.rubs:
        return
    data, probe = model.system.systemData, Probe(model)

    def column(*_unused: Any) -> Any:
        forces = probe.forces_per_newton(contact).tolist()
        size = len(forces) + len(data.GetAECoordinates())
        entries = [[row, len(forces) + contact, force] for row, force in enumerate(forces)]
        matrix = exu.MatrixContainer()
        # Written into a dense matrix, the engine fails.
        matrix.SetWithSparseMatrix(entries, size, size, useDenseMatrix=False)
        return matrix

    model.system.SetSystemJacobianUserFunction(column)
