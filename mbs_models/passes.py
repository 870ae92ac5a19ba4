"""Passes of the engine over all times asked for, with steps of one size."""

import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, sin
from typing import NamedTuple

import numpy as np

from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT, Condition
from analysis.data.state import COORDINATES, FlatError, State, check_upright
from analysis.data.watch import Watch
from mbs_models.build import build
from mbs_models.integrators import Integrator
from mbs_models.lookout import Records, Says, Stop, conditions_of, first_ending, state_of
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.pulling import pulling_times
from mbs_models.runs import EngineError, Samples, Start, run, settle
from mbs_models.scene import Scene

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


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
        Why it ended before the last time asked for; see `Ending`.
    value : float
        What the condition that has ended it says there.
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
    value: float = 0.0
    pulling: tuple[tuple[float, float], ...] = ()


def one_pass(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    step: float,
    halvings: int = 0,
    *,
    allow_pulling: bool = False,
    conditions: Mapping[str, Condition] | None = None,
    watch: Watch | None = None,
) -> Pass:
    """One pass over all times, with steps of at most `step` that are then halved so often.

    It ends early where one of the conditions, by their reasons, turns negative.

    Raises
    ------
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes to lie flat.
    TimeLimitError
        If the watch calls time before the second sample.
    """
    runner = _Runner(
        integrator,
        float(times[-1]),
        allow_pulling=allow_pulling,
        conditions=conditions or {},
        watch=watch or Watch(),
    )
    blocks: list[_Block] = []
    longest = 0.0
    for first, intervals, spacing in _even_stretches(times):
        if blocks:
            scene = scene.starting_at(state_of(blocks[-1].values[-1]))
        substeps = max(1, int(np.ceil(spacing / step - 1e-9))) << halvings
        longest = max(longest, spacing / substeps)
        block = runner.stretch(scene, float(times[first]), intervals, spacing, substeps)
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
        blocks[-1].value,
        pulling_times(runner.moments, runner.forces) if allow_pulling else (),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Samples of a stretch of even spacing; the last at `last` if it has ended early."""

    values: Array
    ended: str | None
    last: float
    value: float = 0.0


class _Lost(NamedTuple):
    """First sample at which the turns of an angle cannot be followed."""

    row: int
    coordinate: str


class _Runner:
    """Runs stretch after stretch of a pass.

    Attributes
    ----------
    counts, setup_seconds, seconds
        See `Pass`.
    moments, forces : list of floats
        Times and normal forces of all records, if the contact may pull.
    """

    def __init__(
        self,
        integrator: Integrator,
        end: float,
        *,
        allow_pulling: bool,
        conditions: Mapping[str, Condition],
        watch: Watch,
    ) -> None:
        self._integrator, self._end = integrator, end
        self._allow, self._named, self._watch = allow_pulling, conditions, watch
        self.counts: Counter[str] = Counter()
        self.setup_seconds = self.seconds = 0.0
        self.moments: list[float] = []
        self.forces: list[float] = []

    def stretch(
        self, scene: Scene, begin: float, intervals: int, spacing: float, substeps: int
    ) -> _Block:
        """Samples of one stretch of even spacing."""
        model = self._build(scene)
        conditions = conditions_of(model, self._named, allow_pulling=self._allow)
        start = None if self.moments else self._checked_start(model, conditions)
        finer, substeps = self._fineness(model, spacing, substeps)
        period = spacing / finer
        stop = Stop(model, conditions, self._watch, begin, self._end)
        failure: EngineError | None = None
        try:
            samples = run(
                model,
                self._integrator,
                spacing=period,
                intervals=intervals * finer,
                substeps=substeps,
                start=start,
                stop=None if stop.is_idle else stop,
            )
        except EngineError as error:
            if error.samples is None:
                raise
            failure, samples = error, error.samples
        self._count(samples)
        values = _values(model, samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lost = None if model.has_euler_angles else _unwrap(values, moments, model.start)
        known = values if lost is None else values[: lost.row]
        stopped = stop.reason, (samples.stopped or 0.0) - period * (len(values) - 1)
        if failure is not None:
            stopped = FLAT, _time_until_flat(known[-1])

        def after(state: State, duration: float, records: int) -> Array:
            return self._after(scene.starting_at(state), duration, records * substeps)

        records = Records(known, moments[: len(known)], period)
        found = first_ending(conditions, records, stopped, after)
        if found is not None:
            moments, values = found.moments, found.values
        else:
            self._check(values, moments, failure, lost, begin)
        self.moments += moments.tolist()
        self.forces += values[:, 12].tolist()
        kept = np.arange(0, len(values), finer)
        if found is not None and kept[-1] != len(values) - 1:
            kept = np.append(kept, len(values) - 1)
        last = float(moments[kept[-1]])
        if found is not None:
            return _Block(values[kept], found.reason, last, found.value)
        return _Block(values[kept], TIME_LIMIT if len(values) <= intervals * finer else None, last)

    def _check(
        self,
        values: Array,
        moments: Array,
        failure: EngineError | None,
        lost: "_Lost | None",
        begin: float,
    ) -> None:
        """Raise if a stretch has failed, or holds an attitude that cannot be told."""
        check_upright(moments, values[:, :6])
        if failure is not None:
            place = f"stretch from t = {begin:.6g} s"
            tilt = float(values[-1, 4])
            if sin(tilt) < NEARLY_FLAT:
                raise FlatError(
                    f"{failure} ({place}); the disk lies nearly flat, at beta = {tilt:.3g} rad",
                    float(moments[-1]),
                ) from failure
            raise EngineError(f"{failure} ({place})") from failure
        if lost is not None:
            raise EngineError(
                f"the turns of {lost.coordinate} cannot be followed after sample {lost.row - 1}: "
                "the disk lies flat, or the samples are too far apart"
            )

    def _checked_start(self, model: Model, conditions: Mapping[str, Says]) -> Start:
        """Raise if the start breaks a constraint, or needs a contact that pulls and must not."""
        probe = Probe(model)
        probe.check_start()
        start = settle(model, probe)
        if CONTACT_WOULD_PULL in conditions:
            force = float(probe.multipliers(*start)[0])
            if force < 0.0:
                raise ValueError(
                    f"start needs a contact that pulls, with a normal force of {force:.3g} N; "
                    "allow_pulling lets it"
                )
        return start

    def _after(self, scene: Scene, duration: float, steps: int) -> Array:
        """Values that a short run of so many steps ends with, shape (12 + k,)."""
        model = self._build(scene)
        samples = run(model, self._integrator, spacing=duration, intervals=1, substeps=steps)
        self._count(samples)
        values = _values(model, samples)
        if not model.has_euler_angles:
            _unwrap(values, np.array((0.0, duration)), model.start)
        result: Array = values[-1]
        return result

    def _build(self, scene: Scene) -> Model:
        begin = time.process_time()
        model = build(scene)
        self.setup_seconds += time.process_time() - begin
        return model

    def _count(self, samples: Samples) -> None:
        self.counts.update(samples.counts)
        self.seconds += samples.seconds

    def _fineness(self, model: Model, spacing: float, substeps: int) -> tuple[int, int]:
        """Records per sample, and steps per record.

        Less than about a radian lies between two records, so that neither turns nor a contact
        that pulls are missed. That is estimated from the rates at the start, and from those that
        the fall of the disk can add.
        """
        fall = np.sqrt(model.scenario.table.gravity / model.scenario.disk.radius)
        fastest = 2.0 * (sum(abs(rate) for rate in model.start.rates[3:]) + fall)
        needed = int(np.ceil(fastest * spacing))
        if self._integrator.controls_step:
            return needed, int(np.ceil(substeps / needed))
        divisors = (k for k in range(1, substeps) if k >= needed and substeps % k == 0)
        finer = next(divisors, substeps)
        return finer, substeps // finer


def _time_until_flat(row: Array) -> float:
    """Time in s in which a disk falls beyond flat at its present rate, 0 if it rises."""
    beta, rate = float(row[4]), float(row[10])
    left = beta / -rate if rate < 0.0 else (pi - beta) / rate if rate > 0.0 else 0.0
    return 1.2 * max(0.0, left)


def _values(model: Model, samples: Samples) -> Array:
    """Co-rotating coordinates, their rates and the constraint forces, shape (n, 12 + k)."""
    coordinates, rates = model.decode(samples.records)
    forces = model.multipliers(samples.records, samples.algebraic, coordinates, rates)
    return np.column_stack((coordinates, rates, forces))


def _even_stretches(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each stretch of even spacing."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _unwrap(values: Array, moments: Array, start: State) -> _Lost | None:
    """Make alpha and gamma continuous in place, from where they start, as far as possible.

    Their mean rates predict each sample, so that coarse sampling of a fast spin does not lose
    turns. A sample half a turn off its prediction cannot be told from the next.
    """
    lost: list[_Lost] = []
    for column in (3, 5):
        angle, rate = values[:, column], values[:, 6 + column]
        angle += _whole_turns(start.coordinates[column] - angle[:1])
        predicted = 0.5 * np.diff(moments) * (rate[1:] + rate[:-1])
        turns = _whole_turns(predicted - np.diff(angle))
        doubt = np.abs(predicted - np.diff(angle) - turns) > 0.5 * np.pi
        if np.any(doubt):
            lost.append(_Lost(1 + int(np.argmax(doubt)), COORDINATES[column]))
        angle[1:] += np.cumsum(turns)
    return min(lost, default=None)
