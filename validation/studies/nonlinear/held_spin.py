"""Cycles of any constraint set at constant spin, on either side, by shooting with differences.

Nothing but runs of `validation.run.run` is used: the monodromy matrix comes from starts displaced
along the constraint manifold. All models are odd about inverted spinning, so half a period leads
to the mirror image.

A cycle is told by its spin in rad/s, half its period in s, the largest deviation of gamma from
pi/2 in rad (its amplitude), and the state there: the rate of beta in rad/s and, where they are
free, the deviation of beta from pi/2 in rad and the velocity of the geometric centre in m/s.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from analysis import MODELS, ConstraintSet, Scenario, Start, Trajectory
from analysis.nonlinear.collocation import NoCycleError
from analysis.nonlinear.motions import PeriodicMotion, is_stable
from analysis.problem.checks import Array
from analysis.problem.choices import Source
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

_ACCURACY: dict[Source, dict[str, Any]] = {
    "in-house": {"local_tolerance": 1e-11},
    "engine": {"tolerance": 1e-9, "formulation": "floating"},
}

_STEP = 1e-4
"""Of the differences, in rad, rad/s, m/s and s."""

_SPACING = 2e-3
"""Of the samples in s from which the rates at the end are taken."""

_ITERATIONS = 12
_CONVERGED = 1e-7
"""Last step of Newton's method, relative to the unknowns, those of the state to the amplitude."""


Cycle = dict[str, Any]
"""A periodic motion at constant spin, by the names of `find`."""


def beginning(cycle: PeriodicMotion) -> Array:
    """What tells a cycle of the reduced system."""
    return np.array((cycle.spin, cycle.period / 2.0, cycle.value, *cycle.states[0, 2:]))


def family(name: str, amplitudes: Sequence[float]) -> list[Cycle]:
    """Cycles of a model of `HELD` from its Hopf point of slow frequency on, in-house.

    Parameters
    ----------
    name : str
        One of `HELD`.
    amplitudes : sequence of float
        Rising, in rad.
    """
    scenario = Scenario(constraints=HELD[name])
    hopf = critical_speeds(scenario, (29.0, 31.5)).crossings[-1]
    born = np.zeros(1 + _size(scenario.constraints))
    born[[SPIN, HALF_PERIOD]] = hopf.spin, np.pi / hopf.frequency
    line, found = [born, born + np.eye(born.size)[AMPLITUDE]], list[Cycle]()
    for amplitude in amplitudes:
        step = (line[1] - line[0]) / (line[1] - line[0])[AMPLITUDE]
        guess = line[1] + (amplitude - line[1][AMPLITUDE]) * step
        found.append(find(scenario, guess, source="in-house", fixed=AMPLITUDE))
        line = [born, *(each["unknowns"] for each in found)][-2:]
    return found


def find(scenario: Scenario, guess: Array, *, source: Source, fixed: int = SPIN) -> Cycle:
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

    Returns
    -------
    dict
        - `unknowns`, shape (k + 3,): what tells it; see above;
        - `spin`, `period` and `amplitude` in rad/s, s and rad;
        - `multiplier`: size of the largest Floquet multiplier over a whole period;
        - `half_multiplier`: the largest real one over half a period, with the mirror image;
        - `complex_multiplier`: size of the largest complex pair over half a period, None if there
          is none;
        - `stable`: whether all multipliers lie inside the unit circle, None if too close to tell.

    Raises
    ------
    NoCycleError
        If it does not converge.
    ArithmeticError
        If a run fails.
    """
    unknowns = np.array(guess, dtype=float)
    free = np.arange(unknowns.size) != fixed
    # What time changes is known from the rates; and a spin that is given changes nothing.
    known = {HALF_PERIOD, SPIN} if fixed == SPIN else {HALF_PERIOD}
    last = np.inf
    for _ in range(_ITERATIONS):
        end, rates = _end(scenario, unknowns, source)
        slopes = np.zeros((end.size, unknowns.size))
        slopes[:, HALF_PERIOD] = rates
        for place in set(range(unknowns.size)) - known:
            step = _STEP * np.eye(unknowns.size)[place]
            ahead, behind = (
                _end(scenario, each, source)[0] for each in (unknowns + step, unknowns - step)
            )
            slopes[:, place] = (ahead - behind) / (2.0 * _STEP)
        # The end is the mirror image of the beginning.
        closing, residual = slopes.copy(), end + np.append(0.0, unknowns[AMPLITUDE:])
        closing[1:, AMPLITUDE:] += np.eye(end.size - 1)
        step = np.zeros_like(unknowns)
        step[free] = np.linalg.lstsq(closing[:, free], -residual, rcond=None)[0]
        unknowns = unknowns + step
        steps = np.abs(step) / np.maximum(np.abs(unknowns), unknowns[AMPLITUDE])
        last = float(np.max(steps))
        if last < _CONVERGED:
            return _cycle(unknowns, slopes)
        if not np.max(steps[:3]) < 0.5:
            break
    raise NoCycleError(
        f"no cycle of {scenario.name} found near an amplitude of {guess[AMPLITUDE]:.6g} rad at "
        f"{guess[SPIN]:.6g} rad/s: the last step was {last:.1e} of the unknowns"
    )


def _cycle(unknowns: Array, slopes: Array) -> Cycle:
    """The cycle with its multipliers over half a period, without that along the motion."""
    # The map between largest gammas: what displacing changes, less what time makes good.
    rates, moving = slopes[:, HALF_PERIOD], slopes[:, AMPLITUDE:]
    poincare = moving[1:] - np.outer(rates[1:], moving[0]) / rates[0]
    values = np.linalg.eigvals(-poincare).astype(complex)
    real = values[np.abs(values.imag) <= 1e-6].real
    pairs = np.abs(values[np.abs(values.imag) > 1e-6])
    multiplier = float(np.max(np.abs(values))) ** 2
    return {
        "unknowns": unknowns,
        "spin": float(unknowns[SPIN]),
        "period": 2.0 * float(unknowns[HALF_PERIOD]),
        "amplitude": float(unknowns[AMPLITUDE]),
        "multiplier": multiplier,
        "half_multiplier": float(real[np.argmax(np.abs(real))]),
        "complex_multiplier": float(np.max(pairs)) if pairs.size else None,
        "stable": is_stable(multiplier),
    }


def _end(scenario: Scenario, unknowns: Array, source: Source) -> tuple[Array, Array]:
    """State after half a period, as `states` tells it, and its rate."""
    spin, duration = unknowns[:2].tolist()
    begin = start_of(spin, unknowns[AMPLITUDE:])
    times = np.append(0.0, duration + _SPACING * np.arange(-2.0, 3.0))
    motion = run(replace(scenario, start=begin), times, source=source, **_ACCURACY[source])
    if motion.ending is not None:
        raise NoCycleError(f"a run ends on the way: {motion.ending}")
    values = states(motion)[1:]
    weights = np.array((1.0, -8.0, 0.0, 8.0, -1.0)) / (12.0 * _SPACING)
    return values[2], weights @ values


def start_of(spin: float, values: Array) -> Start:
    """Start with the largest gamma, from its deviation and the state there."""
    deviation, beta_rate, *free = values.tolist()
    given: dict[str, float] = {}
    if free:
        given |= {"beta": np.pi / 2 + free[0], "gamma_rate": 0.0}
    if free[1:]:
        given |= {"x": 0.0, "y": 0.0, "x_rate": free[1], "y_rate": free[2]}
    return Start(gamma=np.pi / 2 + deviation, spin=spin, beta_rate=beta_rate, **given)


def _size(constraints: ConstraintSet) -> int:
    """How many numbers `states` tells a state by."""
    if "no-slip-along" in constraints:
        return 3
    return 4 if "fixed-cog" in constraints else 6


def states(motion: Trajectory) -> Array:
    """What is zero where gamma is largest, its deviation, and the rest, shape (n, k + 2).

    First the rate of gamma or, where there is no slip along the edge, the deviation of beta: then
    gamma is largest where the disk is upright. Behind the deviation of gamma what tells a state.
    """
    x, y = motion.coordinate("x"), motion.coordinate("y")
    spin, beta = motion.rate("alpha"), motion.coordinate("beta") - np.pi / 2
    size = _size(motion.scenario.constraints)
    columns = (
        beta if size == 3 else motion.rate("gamma"),
        motion.coordinate("gamma") - np.pi / 2,
        motion.rate("beta"),
        beta,
        # In the turning frame, but of the resting one: where the disk is does not matter.
        motion.rate("x") - spin * y,
        motion.rate("y") + spin * x,
    )
    return np.column_stack(columns[:size])
