"""Eigenvalues of the stationary spinning motions, taken from the engine."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analysis.data.admissible import independent_coordinates
from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.data.start import Start
from analysis.data.state import COORDINATES, State
from mbs_models.probe import Probe
from mbs_models.scene import Scene, build
from mbs_models.solving import solving

ComplexArray = npt.NDArray[np.complex128]


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
    chart = _chart(Scene.of(scene))
    columns = [
        _derivative(chart.rates, chart.origin, index, step)
        for index, step in enumerate(chart.steps)
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


@dataclass(frozen=True, slots=True, eq=False)
class _Chart:
    """Independent coordinates near a stationary motion: their origin, rates and steps."""

    origin: Array
    rates: Callable[[Array], Array]
    steps: Array


def _chart(scene: Scene) -> _Chart:
    scenario = scene.scenario
    scenario.require_plain("the linearisation of a spinning motion")
    if scenario.contact is not None:
        raise ValueError("contact must be left out: a penalty contact is not linearised")
    disk, constraints = scenario.disk, scenario.constraints
    start = scenario.initial_state
    spin = start.rates[3]
    names = independent_coordinates(constraints)
    places = [COORDINATES.index(name.removesuffix("_rate")) for name in names]
    moves = np.array([name.endswith("_rate") for name in names])
    # Steps keep the slip below 0.3 % of its finest speed, since the friction law's
    # derivative has a kink at zero slip, and below 3e-4 of the size of the disk and of a turn.
    # Shorter ones would lose digits to the engine's rounding.
    slip = 3e-3 * scenario.friction.finest_speed
    turning = abs(spin) + 1.0
    length = min(3e-4 * disk.radius, slip / turning)
    angle = min(3e-4, slip / (turning * disk.radius))
    steps = {"x": length, "y": length, "beta": angle, "gamma": angle}
    steps |= {"x_rate": slip, "y_rate": slip}
    steps |= {"beta_rate": slip / disk.radius, "gamma_rate": slip / disk.radius}

    accelerations = _accelerations(scene)

    def rates(values: Array) -> Array:
        fields = dict(zip(names, values.tolist(), strict=True))
        state = Start(spin=spin, **fields).state(constraints, disk)
        first, second = np.array(state.rates)[places], accelerations(state)[places]
        return np.where(moves, second, first)

    coordinates = np.array(start.coordinates)[places]
    origin = np.where(moves, np.array(start.rates)[places], coordinates)
    largest = float(np.max(np.abs(rates(origin))))
    if largest > 1e-6 * turning**2:
        raise ValueError(
            "start must be a stationary motion to linearise about, got one with rates or "
            f"accelerations of up to {largest:.3g}"
        )
    return _Chart(origin, rates, np.array([steps[name] for name in names]))


def _accelerations(scene: Scene) -> Callable[[State], Array]:
    """Accelerations of a scene at states of the same spin, with one model."""
    model = build(scene)
    probe = Probe(model)

    def at(state: State) -> Array:
        probe.move_to(state.coordinates, state.rates)
        return model.decode_accelerations(probe.solve()[0], state.coordinates, state.rates)

    return at


def _derivative(rates: Callable[[Array], Array], origin: Array, index: int, step: float) -> Array:
    """Derivative by one coordinate: central differences, extrapolated in powers 1, 2, 3.

    Odd powers appear because the friction law's kink sits at the origin.
    """
    direction = np.zeros_like(origin)
    direction[index] = 1.0
    row: list[Array] = []
    for halving in range(3):
        h = step / 2.0**halving
        new = [(rates(origin + h * direction) - rates(origin - h * direction)) / (2 * h)]
        for power, coarse in enumerate(row, start=1):
            new.append(new[-1] + (new[-1] - coarse) / (2.0**power - 1.0))
        row = new
    return row[-1]
