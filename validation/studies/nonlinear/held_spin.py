"""Cycles of any constraint set at constant spin, on either side, by shooting with differences.

Nothing but runs of `validation.run.run` is used: the monodromy matrix comes from starts displaced
along the constraint manifold. All models are odd about inverted spinning, so half a period leads
to the mirror image.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from analysis import MODELS, ConstraintSet, Scenario, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.trajectory import Source
from analysis.nonlinear.cycle import is_stable
from validation.run import run

Fixed = Literal["spin", "amplitude"]

HELD: dict[str, ConstraintSet] = {
    "Model 1 at held spin": ("contact", "constant-spin"),
    "Model 2 at held spin": ("contact", "fixed-cog", "constant-spin"),
    "Model 4": MODELS[4],
}
"""Model 3 at held spin is Model 4."""

_ACCURACY: dict[Source, dict[str, Any]] = {
    "in-house": {"local_tolerance": 1e-11},
    "engine": {"tolerance": 1e-8},
}

_STEP = 1e-4
"""Of the differences, in rad, rad/s, m/s and s."""

_SPACING = 2e-3
"""Of the samples in s from which the rates at the end are taken."""

_ITERATIONS = 12
_CONVERGED = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldCycle:
    """A periodic motion at constant spin.

    Parameters
    ----------
    constraints : tuple of str
    source : {"engine", "in-house"}
    spin : float
        In rad/s.
    amplitude : float
        Largest deviation of gamma from pi/2 in rad, as of `analysis.nonlinear.cycle.Cycle`.
    period : float
        In s.
    start : ndarray, shape (k,)
        Where gamma is largest: rate of beta in rad/s and, where they are free, deviation of beta
        from pi/2 in rad and velocity of the geometric centre in m/s.
    half_multipliers : ndarray, complex, shape (k + 1,)
        Multipliers over half a period with the mirror image, without that along the motion;
        falling in size.
    residual : float
        Last step of Newton's method, relative to the unknowns.
    """

    constraints: ConstraintSet
    source: Source
    spin: float
    amplitude: float
    period: float
    start: Array
    half_multipliers: npt.NDArray[np.complex128]
    residual: float

    @property
    def multiplier(self) -> float:
        """Size of the largest Floquet multiplier over a whole period."""
        return float(abs(self.half_multipliers[0])) ** 2

    @property
    def stable(self) -> bool | None:
        """Whether all of them lie inside the unit circle; None if too close to tell."""
        return is_stable(self.multiplier)


class NoHeldCycleError(ArithmeticError):
    """Shooting has not converged."""


def find(
    scenario: Scenario,
    start: Mapping[str, Any],
    *,
    source: Source,
    fixed: Fixed = "spin",
    formulation: str | None = None,
) -> HeldCycle:
    """Find a cycle by Newton's method.

    Parameters
    ----------
    scenario : Scenario
        With one of the sets of `HELD`; its start is not looked at.
    start : mapping
        Where to begin: spin, amplitude, period and start as in `HeldCycle`.
    source : {"engine", "in-house"}
    fixed : {"spin", "amplitude"}
        What is given; the other one is found.
    formulation : str, optional
        See `validation.run.run`.

    Raises
    ------
    NoHeldCycleError
        If it does not converge.
    ArithmeticError
        If a run fails.
    """

    def ends(unknowns: Array) -> tuple[Array, Array]:
        return _end(scenario, unknowns, source, formulation)

    unknowns = np.array((start["spin"], start["period"] / 2, start["amplitude"], *start["start"]))
    free = np.arange(unknowns.size) != (0 if fixed == "spin" else 2)
    last = np.inf
    for _ in range(_ITERATIONS):
        end, rates = ends(unknowns)
        displaced = [_displaced(ends, unknowns, index) for index in range(unknowns.size)]
        slopes = np.column_stack((displaced[0], rates, *displaced[2:]))
        mirror = np.zeros_like(slopes)
        mirror[1:, 2:] = np.eye(unknowns.size - 2)
        residual = end + np.append(0.0, unknowns[2:])
        step = np.zeros_like(unknowns)
        step[free] = np.linalg.lstsq((slopes + mirror)[:, free], -residual, rcond=None)[0]
        unknowns = unknowns + step
        last = float(np.max(np.abs(step[:3] / unknowns[:3])))
        if last < _CONVERGED:
            # The map between largest gammas: what displacing changes, less what time makes good.
            poincare = slopes[1:, 2:] - np.outer(rates[1:], slopes[0, 2:]) / rates[0]
            values = np.linalg.eigvals(-poincare).astype(complex)
            return HeldCycle(
                constraints=scenario.constraints,
                source=source,
                spin=float(unknowns[0]),
                amplitude=float(unknowns[2]),
                period=2.0 * float(unknowns[1]),
                start=unknowns[3:],
                half_multipliers=values[np.argsort(-np.abs(values))],
                residual=last,
            )
        if not last < 0.5:
            break
    raise NoHeldCycleError(
        f"no cycle of {scenario.name} found near an amplitude of {start['amplitude']:.6g} rad at "
        f"{start['spin']:.6g} rad/s: the last step was {last:.1e} of the unknowns"
    )


def _displaced(ends: Any, unknowns: Array, index: int) -> Array:
    """Derivative of the end by an unknown; that by the duration is known from the rates."""
    if index == 1:
        return np.zeros(unknowns.size - 1)
    size = np.zeros_like(unknowns)
    size[index] = _STEP
    result: Array = (ends(unknowns + size)[0] - ends(unknowns - size)[0]) / (2.0 * _STEP)
    return result


def _end(
    scenario: Scenario, unknowns: Array, source: Source, formulation: str | None
) -> tuple[Array, Array]:
    """State after the given duration, as `states` tells it, and its rate."""
    spin, duration = unknowns[:2].tolist()
    begin = start_of(scenario.constraints, spin, unknowns[2:])
    times = np.append(0.0, duration + _SPACING * np.arange(-2.0, 3.0))
    motion = run(
        replace(scenario, start=begin),
        times,
        source=source,
        formulation=formulation,
        **_ACCURACY[source],
    )
    if motion.ending is not None:
        raise NoHeldCycleError(f"a run ends on the way: {motion.ending}")
    values = states(motion)[1:]
    weights = np.array((1.0, -8.0, 0.0, 8.0, -1.0)) / (12.0 * _SPACING)
    return values[2], weights @ values


def start_of(constraints: ConstraintSet, spin: float, values: Array) -> Start:
    """Start with the largest gamma from its deviation, and `start` of a `HeldCycle`."""
    deviation, beta_rate, *free = values.tolist()
    given = dict(zip(("beta", "x_rate", "y_rate"), free, strict=False))
    if _slips_along(constraints):
        given |= {"beta": np.pi / 2 + given["beta"], "gamma_rate": 0.0}
    if "fixed-cog" not in constraints:
        given |= {"x": 0.0, "y": 0.0}
    return Start(gamma=np.pi / 2 + deviation, spin=spin, beta_rate=beta_rate, **given)


def _slips_along(constraints: ConstraintSet) -> bool:
    """Whether the rate of gamma is free; otherwise gamma is largest where the disk is upright."""
    return "no-slip-along" not in constraints


def _size(constraints: ConstraintSet) -> int:
    """How many numbers `states` tells a state by."""
    if not _slips_along(constraints):
        return 3
    return 4 if "fixed-cog" in constraints else 6


def states(motion: Trajectory) -> Array:
    """What is zero where gamma is largest, its deviation, and the rest, shape (n, k + 2).

    First the rate of gamma or, where there is no slip along the edge, the deviation of beta;
    behind the deviation of gamma the numbers of `start` in a `HeldCycle`.
    """
    x, y = motion.coordinate("x"), motion.coordinate("y")
    spin, beta = motion.rate("alpha"), motion.coordinate("beta") - np.pi / 2
    constraints = motion.scenario.constraints
    columns = (
        motion.rate("gamma") if _slips_along(constraints) else beta,
        motion.coordinate("gamma") - np.pi / 2,
        motion.rate("beta"),
        beta,
        # In the turning frame, but of the resting one: where the disk is does not matter.
        motion.rate("x") - spin * y,
        motion.rate("y") + spin * x,
    )
    return np.column_stack(columns[: _size(constraints)])


def small_cycle(
    scenario: Scenario, spin: float, frequency: float, amplitude: float
) -> dict[str, Any]:
    """Where to begin near a Hopf point: half a period of the linear motion leads to its mirror.

    Parameters
    ----------
    scenario : Scenario
    spin, frequency : float
        Of the Hopf point in rad/s.
    amplitude : float
        In rad.
    """
    size = _size(scenario.constraints)
    rest = np.append((spin, np.pi / frequency), np.zeros(size - 1))

    def ends(unknowns: Array) -> tuple[Array, Array]:
        return _end(scenario, unknowns, "in-house", None)

    slopes = np.column_stack([_displaced(ends, rest, index) for index in range(2, size + 1)])
    slopes[1:] += np.eye(size - 1)
    direction = np.linalg.svd(slopes)[2][-1]
    return {
        "spin": spin,
        "period": 2.0 * np.pi / frequency,
        "amplitude": amplitude,
        "start": direction[1:] / direction[0] * amplitude,
    }
