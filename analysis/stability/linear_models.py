"""Models 1 to 4 linearised numerically about spinning, along their constraint manifolds.

Independent of the matrices of `linear_full` and `linear_reduced`: the nonlinear index-1 system is
evaluated at states that meet every constraint, written in independent coordinates and rates, and
differenced.

Two directions are neutral and taken out knowingly. The accelerations do not contain alpha, so it
is no state at all. A change of the spin leads to the neighbouring stationary motion: its column
of the Jacobian is zero (checked), its eigenvalue is zero, and what remains is

- Model 1: x, y, beta, gamma and their rates, the 8 eigenvalues of Eq. (55);
- Model 2: beta, gamma and their rates, because the fixed centre of gravity ties x and y to them;
- Models 3, 4: beta, gamma and the rate of beta, the 3 of Eq. (111): without tangential slip the
  rate of gamma is -spin cos(beta). The torque that holds the spin of Model 4 is of second order,
  so the two have the same spectrum.
"""

from itertools import pairwise
from math import pi

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, choice
from analysis.data.disk import Disk
from analysis.data.friction import FrictionLaw
from analysis.data.state import COORDINATES, LEVELS, Level, consistent_start
from analysis.models import index1
from analysis.stability.linear_full import MOTIONS, Motion, spin_array

MODEL_STATES: dict[Level, tuple[str, ...]] = {
    1: ("x", "y", "beta", "gamma", "x_rate", "y_rate", "beta_rate", "gamma_rate"),
    2: ("beta", "gamma", "beta_rate", "gamma_rate"),
    3: ("beta", "gamma", "beta_rate"),
    4: ("beta", "gamma", "beta_rate"),
}
"""States of the linearised models, in order."""

_HALVINGS = 6
_LARGEST_STEP = 0.02
_LARGEST_SLIP = 0.1


def model_matrices(
    level: Level,
    disk: Disk,
    friction: FrictionLaw,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
) -> Array:
    """State matrices of Model `level`, shape (n, k, k), k = 8, 4, 3, 3 for the levels 1 to 4.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    disk : Disk
    friction : FrictionLaw
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, or the level or the motion is unknown.
    ArithmeticError
        If a change of the spin is not neutral.
    """
    choice("level", level, LEVELS)
    choice("motion", motion, MOTIONS)
    return np.array(
        [_state_matrix(level, disk, friction, spin, motion) for spin in spin_array(spins).tolist()]
    )


def _state_matrix(
    level: Level, disk: Disk, friction: FrictionLaw, spin: float, motion: Motion
) -> Array:
    """Jacobian at one spin with the column and the row of the spin taken out."""
    names = (*MODEL_STATES[level], "alpha_rate")
    rest = np.zeros(len(names))
    rest[names.index("beta")] = pi / 2
    rest[names.index("gamma")] = pi / 2 if motion == "inverted" else -pi / 2
    rest[-1] = spin
    columns = []
    for index, name in enumerate(names):
        step = np.zeros(len(names))
        step[index] = _first_step(disk, friction, spin, is_rate=name.endswith("_rate"))
        if name[0] in "xy":
            step[index] *= disk.radius
        columns.append(_slope(level, disk, friction, rest, step) / step[index])
    jacobian = np.column_stack(columns)
    if np.max(np.abs(jacobian[:, -1])) > 1e-6 * max(1.0, float(np.max(np.abs(jacobian)))):
        raise ArithmeticError(
            f"a change of the spin {spin:g} rad/s of Model {level} is not neutral"
        )
    return jacobian[:-1, :-1]


def _first_step(disk: Disk, friction: FrictionLaw, spin: float, *, is_rate: bool) -> float:
    """Step that slips by a tenth of the law's finest speed at most; lengths count in radii."""
    slip_per_step = 2 * disk.radius * (1.0 if is_rate else abs(spin))
    by_slip = _LARGEST_SLIP * friction.finest_speed
    if by_slip >= slip_per_step * _LARGEST_STEP:
        return _LARGEST_STEP
    return by_slip / slip_per_step


def _slope(level: Level, disk: Disk, friction: FrictionLaw, rest: Array, step: Array) -> Array:
    """Derivative of the rates of the states along `step`, by differences over parts of it.

    The friction law has a kink in its second derivative at zero slip, so central differences err
    in all powers of the step, not only in the even ones; extrapolating to step 0 with a
    polynomial in the step takes them away.
    """
    values: list[Array] = []
    for part in 0.5 ** np.arange(_HALVINGS):
        ahead = _rates(level, disk, friction, rest + part * step)
        behind = _rates(level, disk, friction, rest - part * step)
        values.append((ahead - behind) / (2 * part))
    for order in range(1, _HALVINGS):
        factor = 2.0**order
        values = [(factor * fine - rough) / (factor - 1.0) for rough, fine in pairwise(values)]
    return values[0]


def _rates(level: Level, disk: Disk, friction: FrictionLaw, state: Array) -> Array:
    """Time derivative of the independent states, the spin last, from the index-1 system."""
    names = (*MODEL_STATES[level], "alpha_rate")
    given = dict(zip(names, state.tolist(), strict=True))
    start = consistent_start(
        level,
        disk,
        beta=given["beta"],
        gamma=given["gamma"],
        spin=given["alpha_rate"],
        beta_rate=given["beta_rate"],
        gamma_rate=given.get("gamma_rate"),
    )
    z, u = list(start.coordinates), list(start.rates)
    if level == 1:
        z[:2], u[:2] = (given["x"], given["y"]), (given["x_rate"], given["y_rate"])
    acceleration = index1.accelerations(level, disk, friction, z, u)[0]
    return np.array(
        [
            acceleration[COORDINATES.index(name.removesuffix("_rate"))]
            if name.endswith("_rate")
            else u[COORDINATES.index(name)]
            for name in names
        ]
    )
