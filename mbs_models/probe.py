"""Equations of motion and constraints, read from the engine in any state and solved."""

from math import inf, sin

import exudyn as exu
import numpy as np
from scipy.linalg.lapack import dgesv

from analysis.problem.checks import Array
from analysis.problem.limits import CONTACT_JAMS, JAMMING, LEAST_TILT
from mbs_models.model import Floats, Model
from mbs_models.solving import SingularError, quiet

_FINE = 5e-3, (1, -1, 2, -2, 3, -3), np.array((45, -45, -9, 9, 1, -1)) / 60.0
"""Step in rad of the differences by time, where their truncation and rounding balance, and their
nodes and weights;"""

_QUICK = 1e-5, (1, -1), np.array((0.5, -0.5))
"""and those of two values."""

_MET = 1e-9
"""Residual up to which a start meets a constraint, in m, and in m/s for a spin up to 1 rad/s."""

_DEPENDENT = 1e-12
"""Part of what a constraint holds below which the others leave nothing of it."""

_PART = 1e-6
"""Part of a contact force over which friction is differentiated by it."""

_SECANTS, _MOST = 20, 5000
"""Steps towards a contact force that friction is not in proportion to: from which on every other
one goes to the middle, so that all of them suffice;"""

_STRONGEST = 1e24
"""the largest one in N that is looked for,"""

_BALANCED = 1e-14
"""and what may be left, over the sum of what it is made of."""


class Probe:
    """Reads equations of motion and constraints of a model in the engine's current state.

    Parameters
    ----------
    model : Model
        Its current state is set to its initial state.

    Attributes
    ----------
    load_equation : int or None
        Number of the contact's equation, if friction depends on its multiplier: minus the load.
    """

    def __init__(self, model: Model) -> None:
        self._model, self._system = model, model.system
        self._pace = _pace(model.start.coordinates, model.start.rates)
        self._solver = exu.MainSolverImplicitSecondOrder()
        self._solver.InitializeSolver(self._system, quiet())
        self._size = self._solver.GetODE2size()
        self._equations = self._solver.GetAEsize()
        self._zeros = np.zeros(2 * (self._size + self._equations,))
        scenario = model.scenario
        feeds_back = scenario.friction.load == "contact" and scenario.rubs
        self.load_equation = model.joints.contact_equation if feeds_back else None

    def move_to(self, coordinates: Floats, rates: Floats) -> None:
        """Move to another state that meets the constraints, in co-rotating coordinates."""
        self.put(*self._model.encode(coordinates, rates))
        self._pace = _pace(coordinates, rates)

    def put(self, position: list[float], velocity: list[float]) -> None:
        """Move to coordinates and velocities of the engine."""
        data = self._system.systemData
        data.SetODE2Coordinates(position)
        data.SetODE2Coordinates_t(velocity)

    def check_start(self) -> None:
        """Raise `ValueError` if the model's start breaks a constraint, or they are dependent."""
        model = self._model
        if model.scenario.contact is not None:
            # A penalty contact is no constraint.
            return
        _, _, centre, _, beta, gamma = model.start.coordinates
        _, _, rise, spin, fall, roll = model.start.rates
        clearance, per_tilt, per_turn = model.scenario.disk.clearance(beta, gamma)
        lift = rise - per_tilt * fall - per_turn * roll
        for level, unit, allowed, gap in (
            ("position", "m", _MET, centre - clearance),
            ("velocity", "m/s", _MET * max(1.0, abs(spin)), lift),
        ):
            residuals = self._residuals(velocity=level == "velocity")
            # Of those on position level, the engine tells that of the centre of gravity alone.
            found = {
                name: float(np.linalg.norm(residuals[rows]))
                for name, rows in model.joints.equations.items()
                if level == "velocity" or name == "fixed-cog"
            }
            for constraint, value in ({"contact": gap} | found).items():
                if abs(value) > allowed:
                    raise ValueError(
                        f"start breaks the constraint '{constraint}' of {model.scenario.name} on "
                        f"{level} level by {value:.3e} {unit}, allowed is {allowed:.1e}"
                    )
        rows = self._saddle_matrix()[self._size :, : self._size]
        # The engine has equations of what a joint leaves free, too.
        sizes = np.linalg.norm(rows, axis=1, keepdims=True)
        rows, sizes = (each[sizes[:, 0] > 0.0] for each in (rows, sizes))
        if np.min(np.linalg.svd(rows / sizes, compute_uv=False), initial=1.0) < _DEPENDENT:
            raise ValueError(
                f"start must be one where the constraints of {model.scenario.name} do not depend "
                f"on each other, as they do at beta = {beta:g} and gamma = {gamma:g} rad"
            )

    def solved(self, *, quick: bool = False) -> tuple[Array, Array]:
        """Second derivatives of the engine's coordinates, shape (n,), and multipliers, (m,).

        To be called within `solving`.

        Parameters
        ----------
        quick : bool
            Take the residuals' rate from two values instead of six. That leaves an error and
            a noise of some 1e-11 of what turning accelerates; more where rotations are composed.
        """
        n, m = self._size, self._equations
        matrix = self._saddle_matrix()
        if not m:
            return _solution(matrix, self._forces()), np.zeros(0)
        right = np.zeros(n + m)
        right[n:] = -self._residual_rate(quick=quick)
        if self.load_equation is None:
            right[:n] = self._forces()
            solution = _solution(matrix, right)
        else:
            solution = self._under_load(matrix, right, n + self.load_equation)
        return solution[:n], solution[n:]

    def _saddle_matrix(self) -> Array:
        """Mass matrix with the velocity-level constraint Jacobian, shape (n + m, n + m)."""
        n, solver = self._size, self._solver
        solver.ComputeMassMatrix(self._system)
        if not self._equations:
            return solver.GetSystemMassMatrix()
        # The engine adds to whatever the matrix holds.
        solver.SetSystemJacobian(self._zeros)
        solver.ComputeJacobianAE(self._system, 1.0, 1.0, 1.0, False)
        matrix: Array = solver.GetSystemJacobian()
        matrix[:n, :n] = solver.GetSystemMassMatrix()
        return matrix

    def _under_load(self, matrix: Array, right: Array, row: int) -> Array:
        """Solution with friction under the contact force that itself depends on it.

        A contact that pulls rubs with no load. Where friction is not in proportion to its load, by
        secants from the load without friction, or towards the middle of the loads that are known
        to be too small and too large: the excess of the contact force is to vanish.

        Parameters
        ----------
        matrix : ndarray, shape (n + m, n + m)
        right : ndarray, shape (n + m,)
            Everything but the forces.
        row : int
            That of the contact's multiplier, which is minus the force.
        """
        n = self._size
        right[:n] = self._forces_under(0.0)
        if self._model.scenario.friction.IS_PROPORTIONAL:
            # One newton would be lost among the forces of a heavy disk.
            weight, both = self._model.scenario.weight, np.zeros((right.size, 2))
            both[:, 0] = right
            both[:n, 1] = (self._forces_under(weight) - right[:n]) / weight
            without, change = _solution(matrix, both).T
            if (feedback := -float(change[row])) > JAMMING:
                raise SingularError(
                    f"the engine's equations of motion are singular where {CONTACT_JAMS}: each "
                    f"newton of its force calls for {feedback:.3g} N of it through friction"
                )
            return without - min(0.0, float(without[row])) / (1.0 - feedback) * change
        inverse = np.linalg.inv(matrix)
        parts = np.abs(inverse[row])

        def under(load: float) -> tuple[Array, float]:
            right[:n] = self._forces_under(load)
            found = inverse @ right
            return found, -float(found[row]) - load

        (without, less), before = under(0.0), 0.0
        if less <= 0.0:
            return without
        low, high, load = 0.0, inf, less
        for count in range(_MOST):
            solution, more = under(load)
            # Of a contact that lets go, the force is small and not the sizes that cancel in it.
            if abs(more) <= _BALANCED * float(parts @ np.abs(right)):
                # But for rounding, by which a contact that all but lets go would pull.
                solution[row] = -load
                return solution
            low, high = (load, high) if more > 0.0 else (low, load)
            found = load + (load - before) * more / (less - more) if more != less else inf
            before, less = load, more
            # With a force that at first grows faster than its load, secants lead away, and where
            # it goes with a small power of the load, nowhere.
            is_secant = low < found < high and (count < _SECANTS or count % 2)
            load = found if is_secant else min(2.0 * load, 0.5 * (low + high))
            if load in (low, high) or load > _STRONGEST:
                break
        raise SingularError(
            "the engine's equations of motion have no contact force under which friction calls "
            f"for itself: {more:.3g} N are left under {load:.6g} N"
        )

    def _forces(self) -> Array:
        self._solver.ComputeODE2RHS(self._system)
        return self._solver.GetSystemResidual()[: self._size]

    def _forces_under(self, load: float) -> Array:
        """Forces under this load in N, which the contact's multiplier keeps."""
        data = self._system.systemData
        algebraic = np.array(data.GetAECoordinates())
        algebraic[self.load_equation] = -load
        data.SetAECoordinates(algebraic.tolist())
        return self._forces()

    def forces_per_newton(self) -> Array:
        """Change of the forces for each newton of contact force, shape (n,); none if it pulls."""
        data = self._system.systemData
        present = data.GetAECoordinates()
        load = self._model.joints.contact_force(present)
        if load < 0.0:
            return np.zeros(self._size)
        little = _PART * max(load, _PART * self._model.scenario.weight)
        less, more = max(0.0, load - little), load + little
        change = self._forces_under(more) - self._forces_under(less)
        data.SetAECoordinates(present)
        return change / (more - less)

    def _residuals(self, *, velocity: bool = True) -> Array:
        self._solver.ComputeAlgebraicEquations(self._system, velocity)
        return self._solver.GetSystemResidual()[self._size :]

    def _residual_rate(self, *, quick: bool) -> Array:
        """Rate of the velocity-level residuals along the motion at constant velocities.

        Central differences of sixth order over engine coordinates, or of second if quick. A step
        turns the disk by no more than their step in rad, and tilts it by no more than this part of
        the way to lying flat, where the direction of the contact is singular.
        """
        data = self._system.systemData
        position, velocity = data.GetODE2Coordinates(), data.GetODE2Coordinates_t()
        if (known := self._model.residual_rate(position, velocity)) is not None:
            return known
        length, nodes, weights = _QUICK if quick else _FINE
        step, found = length / self._pace, []
        for node in nodes:
            data.SetODE2Coordinates(self._model.moved(position, velocity, node * step))
            found.append(self._residuals())
        data.SetODE2Coordinates(position)
        return weights.dot(found) / step


def _solution(matrix: Array, right: Array) -> Array:
    """Solution of a linear system, a tenth as long under way as by `numpy.linalg.solve`."""
    *_, solution, fault = dgesv(matrix, right)
    if fault:
        raise SingularError("the system matrix is singular")
    return solution


def _pace(coordinates: Floats, rates: Floats) -> float:
    """Rate in 1/s at which the disk turns or falls, whichever is faster; 1 if it is slower."""
    _, _, _, spin, fall, roll = map(abs, rates)
    return max(1.0, spin, roll, fall / max(abs(sin(coordinates[4])), LEAST_TILT))
