"""Eigenvalues of the stationary spinning motions, taken from the engine."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, choice, number
from analysis.data.disk import STEEL_DISK, Disk
from analysis.data.friction import FrictionLaw, SmoothCoulomb
from analysis.data.state import Level, State, consistent_start
from mbs_models.build import build
from mbs_models.probe import acceleration
from mbs_models.quiet import quiet
from mbs_models.scene import Formulation, Scene, default_formulation

Motion = Literal["inverted", "noninverted"]
MOTIONS: tuple[Motion, ...] = get_args(Motion)

ComplexArray = npt.NDArray[np.complex128]


def stationary_scene(
    level: Level,
    spin: float,
    *,
    motion: Motion = "inverted",
    formulation: Formulation | None = None,
    disk: Disk = STEEL_DISK,
    friction: FrictionLaw | None = None,
) -> Scene:
    """Scene that starts on inverted or noninverted spinning, Eq. (5).

    Parameters
    ----------
    level : {1, 2, 3, 4}
    spin : float
        Spinning speed in rad/s.
    motion : {"inverted", "noninverted"}
        Centre of gravity above or below the geometric centre.
    formulation, disk, friction
        See `Scene`.

    Raises
    ------
    ValueError
        If an argument is out of range.
    """
    choice("motion", motion, MOTIONS)
    gamma = pi / 2 if motion == "inverted" else -pi / 2
    start = consistent_start(level, disk, beta=pi / 2, gamma=gamma, spin=number("spin", spin))
    friction = friction if friction is not None else SmoothCoulomb()
    return Scene(
        level=level,
        formulation=formulation or default_formulation(level, friction),
        disk=disk,
        friction=friction,
        start=start,
    )


def eigenvalues(scene: Scene) -> ComplexArray:
    """Eigenvalues of a scene about its stationary start, in 1/s.

    The engine's accelerations are differentiated along the constraint manifold in independent
    coordinates. The neutral directions alpha and its rate are left out: the equations do not
    depend on alpha, and a stationary motion exists for every spin, so that both would only add
    eigenvalues of zero.

    Parameters
    ----------
    scene : Scene
        As `stationary_scene` makes it.

    Returns
    -------
    ndarray, complex, shape (8,), (4,), (3,) or (3,)
        For Model 1 (x, y, beta, gamma and their rates), Model 2 (beta, gamma and their rates),
        Models 3 and 4 (beta, gamma, rate of beta).
    """
    return np.linalg.eigvals(state_matrix(scene)).astype(complex)


def state_matrix(scene: Scene) -> Array:
    """State matrix behind `eigenvalues`, shape (n, n); see there."""
    chart = _chart(scene)
    columns = [
        _derivative(chart.rates, chart.origin, index, step)
        for index, step in enumerate(chart.steps)
    ]
    return np.column_stack(columns)


def stock_eigenvalues(scene: Scene) -> ComplexArray:
    """What the engine's own `ComputeODE2Eigenvalues` says about a scene, shape (n,).

    Right for the contact tree, whose eigenvalues of the neutral direction alpha (two zeros) are
    removed. For scenes with constraints it leaves out how the constraint forces turn with the
    disk, and it does not hold for nonholonomic constraints; there it is returned as it comes.
    """
    model = build(scene)
    with quiet():
        values, _ = model.system.ComputeODE2Eigenvalues(
            computeComplexEigenvalues=True, useAbsoluteValues=False
        )
    result = np.asarray(values, dtype=complex)
    if scene.formulation == "contact-tree":
        result = result[np.argsort(np.abs(result))][2:]
    return result


@dataclass(frozen=True, slots=True, eq=False)
class _Chart:
    """Independent coordinates near a stationary motion: their origin, rates and steps."""

    origin: Array
    rates: Callable[[Array], Array]
    steps: Array


def _chart(scene: Scene) -> _Chart:
    level, disk = scene.level, scene.disk
    spin = scene.start.rates[3]
    beta, gamma = scene.start.coordinates[4:6]
    r = disk.radius
    # Steps keep the slip below a thousandth of its finest speed, since the friction law's
    # derivative has a kink at zero slip, and below 1e-4 of the size of the disk and of a turn.
    slip = 1e-3 * scene.friction.finest_speed
    turning = abs(spin) + 1.0
    length, angle = min(1e-4 * r, slip / turning), min(1e-4, slip / (turning * r))
    speed, rate = slip, slip / r

    def accelerations(state: State) -> Array:
        return acceleration(scene, state)[0]

    if level == 1:

        def sliding(v: Array) -> Array:
            x, y, b, c, xd, yd, bd, cd = v
            state = State(
                coordinates=(x, y, r * sin(b), 0.0, b, c),
                rates=(xd, yd, r * cos(b) * bd, spin, bd, cd),
            )
            return np.concatenate((v[4:], accelerations(state)[[0, 1, 4, 5]]))

        steps = (length, length, angle, angle, speed, speed, rate, rate)
        return _Chart(np.array((0, 0, beta, gamma, 0, 0, 0, 0.0)), sliding, np.array(steps))
    if level == 2:

        def pivoting(v: Array) -> Array:
            b, c, bd, cd = v.tolist()
            state = consistent_start(
                level, disk, beta=b, gamma=c, spin=spin, beta_rate=bd, gamma_rate=cd
            )
            return np.concatenate((v[2:], accelerations(state)[4:]))

        return _Chart(
            np.array((beta, gamma, 0, 0.0)), pivoting, np.array((angle, angle, rate, rate))
        )

    def rolling(v: Array) -> Array:
        b, c, bd = v.tolist()
        state = consistent_start(level, disk, beta=b, gamma=c, spin=spin, beta_rate=bd)
        return np.array((bd, state.rates[5], accelerations(state)[4]))

    return _Chart(np.array((beta, gamma, 0.0)), rolling, np.array((angle, angle, rate)))


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
