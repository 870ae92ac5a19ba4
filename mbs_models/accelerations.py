"""The engine's own accelerations: at an instant, as a motion that SciPy steps, and linearised.

States of that motion are the coordinates and rates that the constraints leave free, with alpha and
the spin, in the paper's coordinates: the others follow from these, so that no constraint drifts.
The accelerations are those of the scene's own formulation.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from math import cos, hypot, sin, sqrt

import exudyn as exu
import numpy as np
import numpy.typing as npt

from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.problem.checks import Array, instance
from analysis.problem.choices import Method
from analysis.problem.constraints import demanded, independent_coordinates, prescribed
from analysis.problem.contact import FULL_GRIP, PenaltyContact
from analysis.problem.limits import LEAST_TILT
from analysis.problem.scenario import Scenario, require_lasting
from analysis.problem.start import COORDINATES, State
from analysis.solve.effort import longest_step
from analysis.solve.stepping import InitialValueProblem
from analysis.solve.watch import StateFunction, of_states
from mbs_models.effort import stepping_integrator
from mbs_models.endings import LOCAL
from mbs_models.friction import slip_velocity
from mbs_models.probe import Probe
from mbs_models.scene import CLASSES, Scene, build
from mbs_models.solving import solving, stepping

_NAMES = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES))
"""What tells a whole state: coordinates, and then rates."""

_LOW = 0.05
"""Sine of the inclination below which accelerations are taken with more care: rounding in those of
alpha and gamma grows with one over its square."""

BENDING = 1e-4
"""Part of the finest speed of friction over which its slope hardly changes,"""

DIFFERENCES = (1e-12, 1e-8)
"""and bounds of the differences that Jacobians are taken from."""

ComplexArray = npt.NDArray[np.complex128]

CHANGE = 1e-3
"""Part of the size of a disk, and of its turning, by which differences change its motion: by less
they would lose digits to the engine's rounding;"""

YIELDING = 6e-6
"""and on a penalty contact, whose force is stiff and known to more digits."""

AT_NO_SLIP, SLIPPING, SLIDING = 1e-5, 1e-6, 3e-3
"""Parts of the finest speed of friction: at which the slope at no slip is taken, where it hardly
bends; from which on a disk slides; and by which its slip may be changed,"""

PART_OF_SLIP = 0.05
"""if that is less than this part of it: no slip, where friction has its kink, is not near."""

UPRIGHT = 1e-9
"""Cosines of beta and gamma up to which a disk spins upright: nothing then changes its spin."""

TOO_LOW = "too low"
"""Why a motion ends where a disk is about to pass by flat so closely that Euler angles fail."""

_Solved = tuple[list[float], list[float], Array, Array]
"""Coordinates, rates, and the engine's accelerations and multipliers."""


class AccelerationProblem:
    """The motion of a scene as an initial value problem, and the way back from its states.

    Parameters
    ----------
    scene : Scene
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.
    slip_part : float
        See `free_slip_force`.

    Raises
    ------
    ValueError
        If the start breaks a constraint, or makes constraints depend on each other.

    Attributes
    ----------
    scene : Scene
    names : tuple of str
        The coordinates and rates that determine all others, in the order of a state.
    quick : bool
        Whether accelerations may be noisier for the sake of speed; see `Probe.solved`.
    conditions : mapping
    model : Model
    system : exudyn.MainSystem
    probe : Probe
    """

    def __init__(
        self, scene: Scene, conditions: Mapping[str, Condition], slip_part: float = 1.0
    ) -> None:
        self.quick = True
        self.scenario = scenario = scene.scenario
        self.scene, self.model = scene, CLASSES[scene.built_as](scenario, slip_part)
        self.system = self.model.system
        self.probe = Probe(self.model)
        try:
            self.probe.check_start()
        except ValueError:
            self.model.close()
            raise
        names: tuple[str, ...] = _NAMES
        if scenario.contact is None:
            free = ("alpha", *independent_coordinates(scenario.constraints), "alpha_rate")
            kept = [f"{name}_rate" for name in prescribed(scenario.constraints).values()]
            names = tuple(name for name in free if name not in kept)
        self.names = names
        # Where they stand among the six coordinates and the six rates.
        self._free = [_NAMES.index(name) for name in names]
        self._tilt = names.index("beta")
        self._angles = [self._tilt, names.index("gamma")]
        self.conditions = conditions
        self._last: tuple[Array, _Solved] | None = None
        self._start = scenario.initial_state.vector.tolist()
        # What is left of residuals would begin a run of the engine with an impulse: the contact
        # force of the trapezoidal rule keeps that as an oscillation of first order in the step.
        self.probe.move_to(*self._whole(scenario.initial_state.vector[self._free]))
        data = self.system.systemData
        data.SetODE2Coordinates(data.GetODE2Coordinates(), exu.ConfigurationType.Initial)
        data.SetODE2Coordinates_t(data.GetODE2Coordinates_t(), exu.ConfigurationType.Initial)

    @property
    def method(self) -> Method:
        """With which an ending is located."""
        return stepping_integrator(self.scene, np.array([0.0, 1.0]), LOCAL).method

    def starting_at(self, record: Array) -> InitialValueProblem:
        """The problem from coordinates and rates on; to be solved within `solving`."""
        scenario = self.scenario
        self._start = record[:12].tolist()
        endings: dict[str, StateFunction] = {FLAT: lambda x: sin(x[self._tilt]) - LEAST_TILT}
        if scenario.may_pull:
            endings[CONTACT_WOULD_PULL] = self._normal_force
        endings |= of_states(self.conditions, self._whole)
        return InitialValueProblem(
            self._derivative,
            record[self._free],
            longest_step(scenario),
            endings,
            self._angles,
            self._kinks(),
            float(np.clip(BENDING * scenario.finest_slip, *DIFFERENCES)),
            kinked_load=scenario.kinked_load,
        )

    def samples(self, states: Array) -> Array:
        """Coordinates, rates and constraint forces, shape (n, 12 + k), from n states."""
        found = [self._solved(state) for state in states]
        values = np.array([(*z, *u) for z, u, _, _ in found])
        return np.column_stack((values, self.forces(found)))

    def forces(self, found: Sequence[_Solved]) -> Array:
        """Constraint forces, shape (n, k)."""
        z, u, second, algebraic = (np.array(each) for each in zip(*found, strict=True))
        return self.model.multipliers(second if self.model.closes_contact else algebraic, z, u)

    def _whole(self, values: Array) -> tuple[list[float], list[float]]:
        """Coordinates and rates, six floats each, from the free ones."""
        found = self._start.copy()
        for place, value in zip(self._free, values.tolist()):  # noqa: B905 - called so often
            found[place] = value
        if self.scenario.contact is None:
            x, y, _, alpha, beta, gamma, xd, yd, _, spin, bd, gd = found
            disk, constraints = self.scenario.disk, self.scenario.constraints
            x, y, xd, yd, bd, gd = demanded(
                constraints, disk, (beta, gamma, spin), (x, y, xd, yd, bd, gd)
            )
            if disk.is_round_disk:
                r = disk.radius
                z, zd = r * sin(beta), r * cos(beta) * bd
            else:
                z, per_beta, per_gamma = disk.clearance(beta, gamma)
                zd = per_beta * bd + per_gamma * gd
            found = [x, y, z, alpha, beta, gamma, xd, yd, zd, spin, bd, gd]
        return found[:6], found[6:]

    def _solved(self, state: Array) -> _Solved:
        """Coordinates, rates, the engine's accelerations and its multipliers in a state."""
        if self._last is None or state is not self._last[0]:
            z, u = self._whole(state)
            self.probe.move_to(z, u)
            solved = self.probe.solved(quick=self.quick and abs(sin(z[4])) > _LOW)
            self._last = state, (z, u, *solved)
        return self._last[1]

    def _derivative(self, _: float, state: Array) -> list[float]:
        z, u, second, _unused = self._solved(state)
        rates = (*u, *self.model.decode_accelerations(second, z, u))
        return [rates[place] for place in self._free]

    def height_over(self, lowest: float, state: Array) -> float:
        """Negative where a disk leans by less than this sine and is to pass by flat."""
        z, u = self._whole(state)
        leaning = sin(z[4])
        # So low, it turns on about a level axis, as if nothing acted on it.
        turning, across = leaning * abs(u[3]), hypot(u[4], leaning * u[3])
        return max(leaning - lowest, LEAST_TILT * across - leaning * turning)

    def _normal_force(self, state: Array) -> float:
        found = self._solved(state)
        if self.model.joints.contact_equation is not None:
            return self.model.joints.contact_force(found[3])
        return self.scenario.pressing_force(float(self.forces([found])[0, 0]))

    def _kinks(self) -> Callable[[Array], Sequence[float]]:
        """Slip in the one direction that is not held, or how a contact that may open presses."""
        scenario = self.scenario
        if scenario.contact is not None:
            return (lambda _: ()) if scenario.may_pull else self._touching(scenario.contact)
        held = [f"no-slip-{way}" in scenario.constraints for way in ("along", "across")]
        if not scenario.rubs or sum(held) != 1:
            return lambda _: ()
        radius, direction = scenario.disk.radius, int(held[0])
        return lambda state: slip_velocity(radius, *self._whole(state))[direction : direction + 1]

    def _touching(self, contact: PenaltyContact) -> Callable[[Array], Sequence[float]]:
        """What presses, and what does beyond a friction that is faded out, over the weight.

        Forces jump or bend where one of them changes its sign.
        """
        clearance, thickness = self.scenario.disk.clearance, contact.half_thickness
        weight, count = self.scenario.weight, 1 + self.scenario.friction_fades
        stiffness, damping = contact.stiffness / weight, contact.damping / weight

        def numbers(state: Array) -> list[float]:
            z, u = self._whole(state)
            below, per_beta, per_gamma = clearance(z[4], z[5], thickness)
            spring = stiffness * (below - z[2])
            both = spring + damping * (per_beta * u[4] + per_gamma * u[5] - u[2])
            return [min(spring, both), (both if spring > 0.0 else 0.0) - FULL_GRIP][:count]

        return numbers


def acceleration(scene: Scene | Scenario, state: State | None = None) -> tuple[Array, Array]:
    """Accelerations and multipliers of a scene, taken from the engine.

    Mass matrix, right-hand side, constraint Jacobian and the change of the velocity-level
    constraint residual along the motion come from the engine; one linear solve joins them.
    (The engine's linearised-system functions leave out the constraint forces, so they do not
    serve here.)

    Down to a tilt of 1e-3 rad the forces hold to 1e-7 of the largest of them and the weight. The
    accelerations of alpha and gamma lose digits as the disk comes to lie flat, where these angles
    end: to 1e-10 of the largest over the tilt's square.

    Parameters
    ----------
    scene : Scene or Scenario
        A scenario stands for its default scene.
    state : State, optional
        Any state that meets the constraints; by default the start of the scene.

    Returns
    -------
    accelerations : ndarray, shape (6,)
        Second derivatives of the co-rotating coordinates.
    multipliers : ndarray, shape (k,)
        Constraint forces in the order of `multiplier_names(scene.scenario.constraints)`.

    Raises
    ------
    ValueError
        If the state breaks a constraint, or makes constraints depend on each other.
    EngineError
        If the contact jams there, so that there is no solution.

    Examples
    --------
    >>> from mbs_models import Scene, acceleration
    >>> accelerations, multipliers = acceleration(Scene())
    >>> accelerations.shape, multipliers.shape
    ((6,), (1,))
    """
    scene = Scene.of(scene)
    if state is not None:
        scene = scene.starting_at(instance("state", state, State))
    motion = AccelerationProblem(scene, {})
    with closing(motion.model) as model, stepping(motion.system):
        second_derivatives, algebraic = motion.probe.solved()
        z, u = model.start.coordinates, model.start.rates
        forces = motion.forces([(list(z), list(u), second_derivatives, algebraic)])
        return np.array(model.decode_accelerations(second_derivatives, z, u)), forces[0]


def eigenvalues(scene: Scene | Scenario) -> ComplexArray:
    """Eigenvalues of a scene about its stationary start, in 1/s.

    The engine's accelerations are differentiated along the constraint manifold in independent
    coordinates. The neutral directions alpha and its rate are left out: the equations do not
    depend on alpha, and where the spin is free, a stationary motion exists for neighbouring ones,
    so that both would only add eigenvalues of zero. A tilted one changes with the spin: what is
    told is how a motion departs from the one at its own spin.

    Parameters
    ----------
    scene : Scene or Scenario
        A scenario stands for its default scene. On a horizontal table, such as one with
        `Start.stationary`.

    Returns
    -------
    ndarray, complex, shape (n,)
        As many as there are independent coordinates and velocities: 8 for Model 1, 4 for Model 2,
        3 for Models 3 and 4, and 10 on a penalty contact.

    Raises
    ------
    ValueError
        If the table leans, the spin decays by dissipation, or the start is not stationary.
    EngineError
        If the contact jams there.

    Examples
    --------
    >>> from analysis import MODELS, Scenario, Start
    >>> from mbs_models import Scene, eigenvalues
    >>> spinning = Start.stationary(31.0)
    >>> found = eigenvalues(Scene(Scenario(constraints=MODELS[4], start=spinning)))
    >>> bool(found.real.max() < 0.0)  # above 30.92 rad/s, Model 4 is stable upside down
    True
    """
    return np.linalg.eigvals(state_matrix(scene)).astype(complex)


def state_matrix(scene: Scene | Scenario) -> Array:
    """State matrix behind `eigenvalues`, shape (n, n); see there.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> from mbs_models import Scene, state_matrix
    >>> state_matrix(Scene(Scenario(start=Start.stationary(31.0)))).shape
    (8, 8)
    """
    scene = Scene.of(scene)
    scenario = scene.scenario
    require_lasting(scenario, "the linearisation of a spinning motion")
    change = CHANGE
    if scenario.contact is not None:
        # Differences may be larger than the penetration, and the contact is not to open.
        held = replace(scenario.contact, bilateral=True)
        scene, change = replace(scene, scenario=replace(scenario, contact=held)), YIELDING
    state, disk, bending = scenario.initial_state, scenario.disk, scenario.finest_slip
    turning = abs(state.rates[3]) + sqrt(scenario.fall)
    speed = change * disk.radius * turning
    loss = scenario.dissipation
    finest = min(bending, loss.rolling_smoothing) if loss.rolling_dry else bending
    part, rim_speed = min(1.0, AT_NO_SLIP * finest / speed), speed
    # A disk that slides is linearised there, where friction has another slope than at no slip.
    slip = hypot(*slip_velocity(disk.radius, state.coordinates, state.rates))
    if disk.is_round_disk and slip > SLIPPING * bending:
        part, rim_speed = 1.0, min(SLIDING * bending, PART_OF_SLIP * slip, speed)
    motion = AccelerationProblem(scene, {}, part)
    motion.quick = False
    with closing(motion.model), stepping(motion.system):
        return _linearised(motion, turning, rim_speed)


def stock_eigenvalues(scene: Scene | Scenario) -> ComplexArray:
    """What the engine's own `ComputeODE2Eigenvalues` says about a scene, shape (n,).

    Right for the contact tree, whose eigenvalues of the neutral direction alpha (two zeros) are
    removed. For scenes with constraints it leaves out how the constraint forces turn with the
    disk, and it does not hold for nonholonomic constraints; there it is returned as it comes.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> from mbs_models import Scene, stock_eigenvalues
    >>> scenario = Scenario(start=Start.stationary(31.0))
    >>> stock_eigenvalues(Scene(scenario, "contact-tree")).shape
    (8,)
    """
    with closing(build(Scene.of(scene))) as model, solving(model.system):
        values, _ = model.system.ComputeODE2Eigenvalues(
            computeComplexEigenvalues=True, useAbsoluteValues=False
        )
    result = np.asarray(values, dtype=complex)
    if model.closes_contact:
        result = result[np.argsort(np.abs(result))][2:]
    return result


def _linearised(motion: AccelerationProblem, turning: float, speed: float) -> Array:
    """State matrix, shape (n, n); `ValueError` if the start is not stationary.

    By central differences, extrapolated in powers 1 and 2: odd ones appear because friction has a
    kink at no slip.

    Parameters
    ----------
    motion : AccelerationProblem
    turning : float
        Rate in 1/s at which the disk turns.
    speed : float
        By which the rim is moved in m/s; by the way that it turns through by that, too.
    """
    scenario = motion.scenario
    tilt, turn = scenario.initial_state.coordinates[4:]
    is_upright = max(abs(cos(tilt)), abs(cos(turn))) < UPRIGHT
    neutral = ("alpha", "alpha_rate") if is_upright else ("alpha",)
    places = [number for number, name in enumerate(motion.names) if name not in neutral]
    problem = motion.starting_at(scenario.initial_state.vector)

    def rates(change: Array) -> Array:
        return np.asarray(problem.right_hand_side(0.0, problem.start + change))[places]

    largest = float(np.max(np.abs(rates(0.0 * problem.start))))
    if largest > 1e-6 * turning**2:
        raise ValueError(
            "start must be a stationary motion to linearise about, got one with rates or "
            f"accelerations of up to {largest:.3g}"
        )
    columns = []
    for place in places:
        name = motion.names[place]
        step = speed if name.endswith("_rate") else speed / turning
        step /= 1.0 if name[0] in "xy" else scenario.disk.radius
        change = step * np.eye(problem.start.size)[place]
        slopes = [
            (rates(part * change) - rates(-part * change)) / (2.0 * part * step)
            for part in (1.0, 0.5, 0.25)
        ]
        columns.append(np.dot((1.0, -6.0, 8.0), slopes) / 3.0)
    matrix, names = np.column_stack(columns), [motion.names[place] for place in places]
    return (
        _beside_neighbours(matrix, names.index("alpha_rate")) if "alpha_rate" in names else matrix
    )


def _beside_neighbours(matrix: Array, spin: int) -> Array:
    """State matrix of what departs from the stationary motion at the present spin.

    Parameters
    ----------
    matrix : ndarray, shape (n + 1, n + 1)
        With the spin among the states, which itself departs.
    spin : int
        Where it stands.

    Returns
    -------
    ndarray, shape (n, n)
    """
    others = np.delete(np.arange(len(matrix)), spin)
    inner = matrix[np.ix_(others, others)]
    # How the others change from one stationary motion to the next.
    along, *_ = np.linalg.lstsq(inner, -matrix[others, spin], rcond=UPRIGHT)
    return inner - np.outer(along, matrix[spin, others])
