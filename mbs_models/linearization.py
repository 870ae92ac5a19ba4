"""Eigenvalues of the stationary spinning motions, taken from the engine."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario
from mbs_models.accelerations import AccelerationProblem
from mbs_models.scene import Scene, build
from mbs_models.solving import solving

ComplexArray = npt.NDArray[np.complex128]

NEUTRAL = ("alpha", "alpha_rate")
"""What stationary motions exist for any value of."""


def eigenvalues(scene: Scene | Scenario) -> ComplexArray:
    """Eigenvalues of a scene about its stationary start, in 1/s.

    The engine's accelerations are differentiated along the constraint manifold in independent
    coordinates. The neutral directions alpha and its rate are left out: the equations do not
    depend on alpha, and a stationary motion exists for every spin, so that both would only add
    eigenvalues of zero.

    Parameters
    ----------
    scene : Scene or Scenario
        A scenario stands for its default scene. On a horizontal table with the ideal contact,
        such as one with `Start.stationary`.

    Returns
    -------
    ndarray, complex, shape (n,)
        In the coordinates of `independent_coordinates`: 8 for Model 1, 4 for Model 2, 3 for
        Models 3 and 4.

    Raises
    ------
    ValueError
        If the table leans, the contact is one of penalty, or the start is not stationary.

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
    scenario.require_plain("the linearisation of a spinning motion")
    if scenario.contact is not None:
        raise ValueError("contact must be left out: a penalty contact is not linearised")
    motion = AccelerationProblem(scene, {})
    motion.quick = False
    problem = motion.starting_at(scenario.initial_state.vector)
    places = [number for number, name in enumerate(motion.names) if name not in NEUTRAL]
    turning = abs(scenario.initial_state.rates[3]) + 1.0

    def rates(state: Array) -> Array:
        return np.asarray(problem.right_hand_side(0.0, state))[places]

    with solving(motion.system):
        largest = float(np.max(np.abs(rates(problem.start))))
        if largest > 1e-6 * turning**2:
            raise ValueError(
                "start must be a stationary motion to linearise about, got one with rates or "
                f"accelerations of up to {largest:.3g}"
            )
        steps = _steps(scenario, turning)
        columns = [
            _derivative(rates, problem.start, place, steps[motion.names[place]])
            for place in places
        ]
    return np.column_stack(columns)


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
    model = build(Scene.of(scene))
    with solving(model.system):
        values, _ = model.system.ComputeODE2Eigenvalues(
            computeComplexEigenvalues=True, useAbsoluteValues=False
        )
    result = np.asarray(values, dtype=complex)
    if model.closes_contact:
        result = result[np.argsort(np.abs(result))][2:]
    return result


def _steps(scenario: Scenario, turning: float) -> dict[str, float]:
    """Steps of the differences by coordinate, from the rate in 1/s at which the disk turns.

    They keep the slip below 0.3 % of its finest speed, since the friction law's derivative has a
    kink at zero slip, and below 3e-4 of the size of the disk and of a turn. Shorter ones would
    lose digits to the engine's rounding.
    """
    radius = scenario.disk.radius
    slip = 3e-3 * scenario.friction.finest_speed
    length, angle = min(3e-4 * radius, slip / turning), min(3e-4, slip / (turning * radius))
    lengths, angles = dict.fromkeys(("x", "y"), length), dict.fromkeys(("beta", "gamma"), angle)
    speeds = dict.fromkeys(("x_rate", "y_rate"), slip)
    return lengths | angles | speeds | dict.fromkeys(("beta_rate", "gamma_rate"), slip / radius)


def _derivative(rates: Callable[[Array], Array], origin: Array, index: int, step: float) -> Array:
    """Derivative by one coordinate: central differences, extrapolated in powers 1 and 2.

    Odd powers appear because the friction law's kink sits at the origin.
    """

    def slope(length: float) -> Array:
        change = length * np.eye(origin.size)[index]
        return (rates(origin + change) - rates(origin - change)) / (2.0 * length)

    return (slope(step) - 6.0 * slope(step / 2.0) + 8.0 * slope(step / 4.0)) / 3.0
