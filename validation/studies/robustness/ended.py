"""Motions that end by themselves, most of them sampled at their two ends alone."""

from collections.abc import Callable, Iterator
from math import pi
from typing import Any

import numpy as np

from analysis import LEVELS, LOADS, MODELS, Scenario, SmoothCoulomb, Start, State
from validation.studies.robustness.problems import Problem

AXIS = "ended by a condition, or a pull"

DIGITS = (3, 8, 5, 6, 7, 4)
"""Of the accuracy in rad that the random motions ask for in turn."""

RANDOM = 24
"""Number of random motions."""

FEW = 0.7
"""Part of the random motions that is sampled at its two ends alone."""

SEED = 5
"""Of the random starts."""

Condition = str | Callable[[State], float]


def passes_sideways(state: State) -> float:
    """Negative from where the centre of gravity comes to the side: gamma passes 0 upwards."""
    return float(-np.sin(state.coordinates[5]))


def falls_low(state: State) -> float:
    """Negative where the disk leans so far that its centre is below 0.85 of its radius."""
    return float(np.sin(state.coordinates[4]) - 0.85)


CONDITIONS: tuple[Condition | None, ...] = ("inverted", "lost", passes_sideways, falls_low, None)
"""Of the random motions in turn; None for a contact that would pull."""


def ended() -> Iterator[Problem]:
    """Known hard ones, then random ones of every model, condition, tolerance and sampling."""
    for spin, gamma, beta, digits in (
        (45.2112, -1.467538, 1.356142, 8),
        (45.2112, -1.467538, 1.356142, 6),
        (59.3464, -1.570456, 1.35434, 6),
        (37.25768, -1.761848, 1.823287, 8),
        (10.0, -1.5, 0.9, 6),
    ):
        start = Start(spin=spin, gamma=gamma, beta=beta)
        yield _problem(Scenario(constraints=MODELS[4], start=start), "inverted", digits)
    # The contact would pull for two milliseconds, far from the next sample.
    for spin, digits in ((139.0, 8), (140.0, 3)):
        yield _problem(Scenario(start=Start(spin=spin)), None, digits, end=1.0)
    rising = Scenario(constraints=MODELS[4], start=Start(beta=0.63878, beta_rate=5.14286))
    yield _problem(rising, None, 6, samples=31, end=0.3)
    rng = np.random.default_rng(SEED)
    for number in range(RANDOM):
        yield _drawn(rng, number)


def _drawn(rng: np.random.Generator, number: int) -> Problem:
    """A random start, so that the condition is met in most of them."""
    condition = CONDITIONS[number % 5]
    # What is lost or falls is up at first, and slow.
    slow = condition in ("lost", falls_low)
    low, high = (5.0, 25.0) if slow else (35.0, 60.0) if condition else (100.0, 300.0)
    beta = rng.uniform(1.1, pi - 1.1)
    gamma = (pi / 2 if slow else -pi / 2) + rng.uniform(-0.6, 0.6)
    friction = SmoothCoulomb(
        coefficient=rng.uniform(0.2, 0.5), load=LOADS[int(rng.integers(len(LOADS)))]
    )
    start = Start(beta=beta, gamma=gamma, spin=round(rng.uniform(low, high), 3))
    return _problem(
        Scenario(constraints=MODELS[LEVELS[number % 4]], start=start, friction=friction),
        condition,
        DIGITS[number % len(DIGITS)],
        samples=2 if rng.random() < FEW else 101,
        end=1.5 if condition else 0.25,
        cover="fastest" if number % 7 else "first",
    )


def _problem(
    scenario: Scenario,
    condition: Condition | None,
    digits: int,
    samples: int = 2,
    end: float = 1.5,
    **asked: Any,
) -> Problem:
    name = condition or "pull" if isinstance(condition, str | None) else condition.__name__
    spin = f"{scenario.initial_state.rates[3]:.4g} rad/s"
    sampled = " sampled" if samples > 2 else ""
    return Problem(
        axis=AXIS,
        label=f"{name.replace('_', ' ')} {spin} 1e-{digits}{sampled}",
        scenario=scenario,
        end=end,
        samples=samples,
        tolerance=10.0**-digits,
        stop_when=(condition,) if condition else (),
        **{"cover": "fastest", **asked},
    )
