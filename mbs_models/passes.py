"""Passes of the engine over all times asked for, with steps of one size."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import Condition
from analysis.data.watch import Watch
from mbs_models.endings import pulling_times, state_of
from mbs_models.integrators import Integrator
from mbs_models.scene import Scene
from mbs_models.stretches import Block, Runner


@dataclass(frozen=True, slots=True, eq=False)
class Pass:
    """One pass over all times: what came out and what it took.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Those asked for, up to where the pass ended, and the time of that ending.
    values : ndarray, shape (n, 12 + k)
        Co-rotating coordinates, their rates, and the constraint forces.
    step : float
        Longest step in s, or the limit of step control.
    counts : Counter
        See `Samples`.
    setup_seconds : float
        Processor time that building the scene took.
    seconds : float
        Processor time that the engine's solver took.
    ended : str or None
        Why it ended before the last time asked for.
    pulling : tuple of pairs of floats
        Times in s between which the contact has pulled.
    """

    times: Array
    values: Array
    step: float
    counts: Counter[str]
    setup_seconds: float = 0.0
    seconds: float = 0.0
    ended: str | None = None
    pulling: tuple[tuple[float, float], ...] = ()

    def with_work(self, counts: Counter[str]) -> "Pass":
        """The same with the work of passes before it."""
        return replace(self, counts=self.counts + counts)


class Reached(NamedTuple):
    """A pass, the integrator that has led there, and its estimated error in rad."""

    result: Pass
    integrator: Integrator
    estimate: float | None = None


def one_pass(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    step: float,
    halvings: int = 0,
    *,
    stop_when: Mapping[str, Condition] | None = None,
    allow_pulling: bool = False,
    watch: Watch | None = None,
) -> Pass:
    """One pass over all times, with steps of at most `step` that are then halved so often.

    Raises
    ------
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes so close to lying flat that the Euler angles cannot be followed.
    TimeLimitError
        If the watch calls time before the second sample.
    """
    runner = Runner(
        integrator,
        float(times[-1]),
        stop_when or {},
        allow_pulling=allow_pulling,
        watch=watch or Watch(),
    )
    blocks: list[Block] = []
    longest = 0.0
    for first, intervals, spacing in _even_stretches(times):
        if blocks:
            scene = scene.starting_at(state_of(blocks[-1].values[-1]))
        substeps = max(1, int(np.ceil(spacing / step - 1e-9)))
        longest = max(longest, spacing / (substeps << halvings))
        block = runner.stretch(
            scene, float(times[first]), intervals, spacing, substeps, halvings=halvings
        )
        blocks.append(block)
        if block.ended is not None:
            break
    values = np.concatenate([blocks[0].values, *(block.values[1:] for block in blocks[1:])])
    if len(values) < 2:
        raise TimeLimitError("time limit met before the first sample after the start")
    reached = np.append(times[: len(values) - 1], blocks[-1].last)
    if blocks[-1].ended is None:
        reached = times
    return Pass(
        reached,
        values,
        longest,
        runner.counts,
        runner.setup_seconds,
        runner.seconds,
        blocks[-1].ended,
        pulling_times(runner.moments, runner.forces) if allow_pulling else (),
    )


def _even_stretches(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each stretch of even spacing."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length
