"""Cycles of any constraint set at constant spin, on either side, by shooting with differences.

Nothing but runs of `validation.run.run` is used: the monodromy matrix comes from starts displaced
along the constraint manifold. All models are odd about inverted spinning, so half a period leads
to the mirror image.

A cycle is told by its spin in rad/s, half its period in s, the largest deviation of gamma from
pi/2 in rad (its amplitude), and the state there: the rate of beta in rad/s and, where they are
free, the deviation of beta from pi/2 in rad and the velocity of the geometric centre in m/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis import MODELS, ConstraintSet, Scenario, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.trajectory import Source
from analysis.nonlinear.motions import PeriodicMotion, is_stable
from analysis.stability.critical import critical_speeds
from validation.run import run

SPIN, HALF_PERIOD, AMPLITUDE = range(3)
"""Places of what tells a cycle; the state follows."""

HELD: dict[str, ConstraintSet] = {
    "Model 1 at held spin": ("contact", "constant-spin"),
    "Model 2 at held spin": ("contact", "fixed-cog", "constant-spin"),
    "Model 4": MODELS[4],
}
"""Model 3 at held spin is Model 4."""

FORMULATION = "floating"
"""That of the engine."""

_ACCURACY: dict[Source, dict[str, Any]] = {
    "in-house": {"local_tolerance": 1e-11},
    "engine": {"tolerance": 1e-8, "formulation": FORMULATION},
}

_STEP = 1e-4
"""Of the differences, in rad, rad/s, m/s and s."""

_SPACING = 2e-3
"""Of the samples in s from which the rates at the end are taken."""

_ITERATIONS = 12
_CONVERGED = 1e-6

Ends = Callable[[Array], tuple[Array, Array]]
"""From what tells a cycle to the state half a period later, and its rate."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldCycle:
    """A periodic motion at constant spin.

    Parameters
    ----------
    unknowns : ndarray, shape (k + 3,)
        What tells it; see above.
    residual : float
        Last step of Newton's method, relative to the unknowns.
    spin, period, amplitude : float
        In rad/s, s and rad.
    multiplier : float
        Size of the largest Floquet multiplier over a whole period.
    half_multiplier : float
        The largest real one over half a period, with the mirror image.
    complex_multiplier : float or None
        Size of the largest complex pair over half a period, if there is one.
    """

    unknowns: Array
    residual: float
    spin: float
    period: float
    amplitude: float
    multiplier: float
    half_multiplier: float
    complex_multiplier: float | None

    @property
    def stable(self) -> bool | None:
        """Whether all multipliers lie inside the unit circle; None if too close to tell."""
        return is_stable(self.multiplier)

    def told(self) -> dict[str, Any]:
        """What tables and files tell of it, as plain data by names."""
        own = ("amplitude", "half_multiplier", "complex_multiplier")
        names = (*own, "spin", "period", "multiplier", "stable")
        return {name: getattr(self, name) for name in names}


class NoHeldCycleError(ArithmeticError):
    """Shooting has not converged."""


def beginning(cycle: PeriodicMotion) -> Array:
    """What tells a cycle of the reduced system."""
    return np.array((cycle.spin, cycle.period / 2.0, cycle.value, *cycle.states[0, 2:]))


def family(name: str, amplitudes: Sequence[float]) -> list[HeldCycle]:
    """Cycles of a model of `HELD` from its Hopf point of slow frequency on, in-house.

    Parameters
    ----------
    name : str
        One of `HELD`.
    amplitudes : sequence of float
        Rising, in rad.
    """
    scenario = Scenario(constraints=HELD[name])
    born, direction = birth(scenario)
    found: list[HeldCycle] = []
    line = [born, born + direction]
    for amplitude in amplitudes:
        step = (line[1] - line[0]) / (line[1] - line[0])[AMPLITUDE]
        guess = line[1] + (amplitude - line[1][AMPLITUDE]) * step
        found.append(find(scenario, guess, source="in-house", fixed=AMPLITUDE))
        line = [born, *(each.unknowns for each in found)][-2:]
    return found


def find(scenario: Scenario, guess: Array, *, source: Source, fixed: int = SPIN) -> HeldCycle:
    """Find a cycle by Newton's method.

    Parameters
    ----------
    scenario : Scenario
        With one of the sets of `HELD`; its start is not looked at.
    guess : ndarray, shape (k + 3,)
        What tells the cycle, nearly.
    source : {"engine", "in-house"}
    fixed : {SPIN, AMPLITUDE}
        What is given; the other one is found.

    Raises
    ------
    NoHeldCycleError
        If it does not converge.
    ArithmeticError
        If a run fails.
    """

    def ends(unknowns: Array) -> tuple[Array, Array]:
        return _end(scenario, unknowns, source)

    unknowns = np.array(guess, dtype=float)
    free = np.arange(unknowns.size) != fixed
    last = np.inf
    for _ in range(_ITERATIONS):
        end, rates = ends(unknowns)
        slopes = _slopes(ends, unknowns, rates, idle=SPIN if fixed == SPIN else None)
        residual = end + np.append(0.0, unknowns[AMPLITUDE:])
        step = np.zeros_like(unknowns)
        matrix = _mirrored(slopes)[:, free]
        step[free] = np.linalg.lstsq(matrix, -residual, rcond=None)[0]
        unknowns = unknowns + step
        last = float(np.max(np.abs(step[:3] / unknowns[:3])))
        if last < _CONVERGED:
            return _cycle(unknowns, slopes, rates, last)
        if not last < 0.5:
            break
    raise NoHeldCycleError(
        f"no cycle of {scenario.name} found near an amplitude of {guess[AMPLITUDE]:.6g} rad at "
        f"{guess[SPIN]:.6g} rad/s: the last step was {last:.1e} of the unknowns"
    )


def _cycle(unknowns: Array, slopes: Array, rates: Array, residual: float) -> HeldCycle:
    """The cycle with its multipliers over half a period, without that along the motion."""
    # The map between largest gammas: what displacing changes, less what time makes good.
    poincare = slopes[1:, 2:] - np.outer(rates[1:], slopes[0, 2:]) / rates[0]
    values = np.linalg.eigvals(-poincare).astype(complex)
    real = values[np.abs(values.imag) <= 1e-6].real
    pairs = np.abs(values[np.abs(values.imag) > 1e-6])
    spin, half, amplitude = unknowns[:3].tolist()
    return HeldCycle(
        unknowns=unknowns,
        residual=residual,
        spin=spin,
        period=2.0 * half,
        amplitude=amplitude,
        multiplier=float(np.max(np.abs(values))) ** 2,
        half_multiplier=float(real[np.argmax(np.abs(real))]),
        complex_multiplier=float(np.max(pairs)) if pairs.size else None,
    )


def _slopes(ends: Ends, unknowns: Array, rates: Array, idle: int | None = None) -> Array:
    """Derivatives of the end by the unknowns, not a number for one that nobody needs.

    That by the duration is known from the rates.
    """
    known = {HALF_PERIOD: rates, idle: np.full_like(rates, np.nan)}
    columns = []
    for index, step in enumerate(_STEP * np.eye(unknowns.size)):
        if index in known:
            columns.append(known[index])
        else:
            apart = ends(unknowns + step)[0] - ends(unknowns - step)[0]
            columns.append(apart / (2.0 * _STEP))
    return np.column_stack(columns)


def _mirrored(slopes: Array) -> Array:
    """The same of the end plus the start, which vanish together where one mirrors the other."""
    result = slopes.copy()
    result[1:, AMPLITUDE:] += np.eye(len(slopes) - 1)
    return result


def birth(scenario: Scenario) -> tuple[Array, Array]:
    """What tells a cycle of no amplitude where they are born, and its change with each rad."""
    hopf = critical_speeds(scenario, (29.0, 31.5)).crossings[-1]
    size = _size(scenario.constraints)
    rest = np.array((hopf.spin, np.pi / hopf.frequency, *np.zeros(size - 1)))

    def ends(unknowns: Array) -> tuple[Array, Array]:
        return _end(scenario, unknowns, "in-house")

    slopes = _mirrored(_slopes(ends, rest, np.zeros(size)))[:, AMPLITUDE:]
    direction = np.linalg.svd(slopes)[2][-1]
    return rest, np.array((0.0, 0.0, *direction / direction[0]))


def _end(scenario: Scenario, unknowns: Array, source: Source) -> tuple[Array, Array]:
    """State after half a period, as `states` tells it, and its rate."""
    spin, duration = unknowns[:2].tolist()
    begin = start_of(scenario.constraints, spin, unknowns[AMPLITUDE:])
    times = np.append(0.0, duration + _SPACING * np.arange(-2.0, 3.0))
    motion = run(replace(scenario, start=begin), times, source=source, **_ACCURACY[source])
    if motion.ending is not None:
        raise NoHeldCycleError(f"a run ends on the way: {motion.ending}")
    values = states(motion)[1:]
    weights = np.array((1.0, -8.0, 0.0, 8.0, -1.0)) / (12.0 * _SPACING)
    return values[2], weights @ values


def start_of(constraints: ConstraintSet, spin: float, values: Array) -> Start:
    """Start with the largest gamma, from its deviation and the state there."""
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
    behind the deviation of gamma what tells a state.
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
