"""The engine's own accelerations and multipliers at a given state."""

from dataclasses import replace

import exudyn as exu
import numpy as np

from analysis.checks import Array
from analysis.state import State
from mbs_models.build import build
from mbs_models.model import Model
from mbs_models.scene import Scene
from mbs_models.trees import ContactTree


def acceleration(scene: Scene, state: State | None = None) -> tuple[Array, Array]:
    """Accelerations and multipliers of a scene, taken from the engine.

    Mass matrix, right-hand side, constraint Jacobian and the change of the velocity-level
    constraint residual along the motion come from the engine; one linear solve joins them.
    (The engine's linearised-system functions leave out the constraint forces, so they do not
    serve here.)

    Parameters
    ----------
    scene : Scene
    state : State, optional
        Any state that meets the constraints; by default the start of the scene.

    Returns
    -------
    accelerations : ndarray, shape (6,)
        Second derivatives of the co-rotating coordinates.
    multipliers : ndarray, shape (k,)
        Constraint forces in the order of `multiplier_names(scene.level)`.

    Raises
    ------
    ValueError
        If the state breaks a constraint.
    """
    model = build(scene if state is None else replace(scene, start=state))
    probe = Probe(model)
    probe.check_start()
    second_derivatives, algebraic = probe.solve()
    accelerations = model.decode_accelerations(second_derivatives)
    if isinstance(model, ContactTree):
        return accelerations, np.array([model.normal_force(second_derivatives)])
    coordinates, rates = model.decode(model.record()[None])
    return accelerations, model.multipliers(algebraic[None], coordinates, rates)[0]


class Probe:
    """Reads equations of motion and constraints of a model in the engine's current state.

    Parameters
    ----------
    model : Model
        Its current state is set to its initial state.
    """

    def __init__(self, model: Model) -> None:
        settings = exu.SimulationSettings()
        settings.timeIntegration.verboseMode = 0
        settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
        settings.solution.file.write = False
        self._model = model
        self._system = model.system
        self._solver = exu.MainSolverImplicitSecondOrder()
        self._solver.InitializeSolver(self._system, settings)
        self._size = self._solver.GetODE2size()
        self._equations = self._solver.GetAEsize()

    def set_state(self, position: Array, velocity: Array) -> None:
        """Move to other engine coordinates and their derivatives, each shape (n,)."""
        self._system.systemData.SetODE2Coordinates(position.tolist())
        self._system.systemData.SetODE2Coordinates_t(velocity.tolist())

    def check_start(self, tolerance: float = 1e-9) -> None:
        """Raise `ValueError` if the model's start breaks a constraint.

        Parameters
        ----------
        tolerance : float
            Largest residual let through in m, and in m/s for a spin up to 1 rad/s.
        """
        scene = self._model.scene
        for residual in self._model.start_residuals(self._velocity_residuals()):
            unit, allowed = "m", tolerance
            if residual.level == "velocity":
                unit, allowed = "m/s", tolerance * max(1.0, abs(scene.start.rates[3]))
            if abs(residual.value) > allowed:
                raise ValueError(
                    f"start breaks the constraint '{residual.constraint}' of Model {scene.level} "
                    f"on {residual.level} level by {residual.value:.3e} {unit}, allowed is "
                    f"{allowed:.1e}"
                )

    def solve(self) -> tuple[Array, Array]:
        """Second derivatives of the engine's coordinates, shape (n,), and multipliers, (m,)."""
        n, m = self._size, self._equations
        matrix = np.zeros((n + m, n + m))
        right = np.zeros(n + m)
        self._solver.ComputeMassMatrix(self._system)
        matrix[:n, :n] = self._solver.GetSystemMassMatrix()
        right[:n] = self._forces()
        if m:
            # The engine adds to whatever the matrix holds.
            self._solver.SetSystemJacobian(np.zeros((n + m, n + m)))
            self._solver.ComputeJacobianAE(self._system, 1.0, 1.0, 1.0, False)
            jacobian = np.array(self._solver.GetSystemJacobian())
            matrix[n:] = jacobian[n:]
            matrix[:n, n:] = jacobian[:n, n:]
            right[n:] = -self._residual_rate()
        contact = self._model.contact_equation
        friction = self._model.scene.friction
        if contact is not None and friction.load == "contact" and friction.coefficient:
            matrix[:n, n + contact] -= self._force_per_multiplier(contact)
        solution = np.linalg.solve(matrix, right)
        return solution[:n], solution[n:]

    def _forces(self) -> Array:
        self._solver.ComputeODE2RHS(self._system)
        return np.array(self._solver.GetSystemResidual())[: self._size]

    def _force_per_multiplier(self, equation: int) -> Array:
        """Change of the forces with a contact multiplier, in which the friction is linear."""
        data = self._system.systemData
        algebraic = np.array(data.GetAECoordinates())
        forces = []
        for value in (-1.0, 0.0):
            algebraic[equation] = value
            data.SetAECoordinates(algebraic.tolist())
            forces.append(self._forces())
        return forces[1] - forces[0]

    def _velocity_residuals(self) -> Array:
        if not self._equations:
            return np.zeros(0)
        self._solver.ComputeAlgebraicEquations(self._system, True)
        return np.array(self._solver.GetSystemResidual())[self._size :]

    def _residual_rate(self) -> Array:
        """Rate of the velocity-level residuals along the motion at constant velocities.

        Central differences of fourth order over engine coordinates; a step moves none of them by
        more than 1e-4, where truncation and rounding balance.
        """
        data = self._system.systemData
        position = np.array(data.GetODE2Coordinates())
        rates = self._model.coordinate_rates()
        step = 1e-4 / max(1.0, float(np.max(np.abs(rates))))

        def residuals(steps: float) -> Array:
            data.SetODE2Coordinates((position + steps * step * rates).tolist())
            return self._velocity_residuals()

        near, far = residuals(1) - residuals(-1), residuals(2) - residuals(-2)
        data.SetODE2Coordinates(position.tolist())
        return (8 * near - far) / (12 * step)
