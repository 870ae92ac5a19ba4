"""Runs of the engine's own integrators over all times asked for, span by span.

A span holds evenly spaced times; each is one run.
"""

import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import sin
from typing import Any

import numpy as np

from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.state import COORDINATES, FlatError, State, check_upright
from analysis.data.watch import Watch
from mbs_models import sampled
from mbs_models.endings import Records, of_records, pulling_times
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.runs import EngineError, Samples, Start, run, settle
from mbs_models.sampled import Sampled, leaning, state_of
from mbs_models.scene import Scene, build

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Samples of a span; the last at `last` if it has ended early."""

    values: Array
    ended: str | None
    last: float


class _Stop:
    """Ends a run where the contact's constraint pulls, a condition holds or time is over.

    Attributes
    ----------
    reason : str or None
        Why it ended it, if not for the time.
    """

    def __init__(
        self,
        model: Model,
        watch: Watch,
        span: tuple[float, float],
        conditions: Mapping[str, Condition],
        *,
        must_not_pull: bool,
    ) -> None:
        self._model, self._watch, self._span = model, watch, span
        self._pulls = must_not_pull and model.contact_equation is not None
        self._says = of_records(conditions)
        self._armed: set[str] = set()
        self._angles = np.array(model.start.coordinates)[sampled.TURNING]
        self.reason: str | None = None

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to look at after a step."""
        return not (self._pulls or self._says) and self._watch.is_idle

    def __call__(self, moment: float) -> bool:
        if self._pulls and self._model.pulls():
            self.reason = CONTACT_WOULD_PULL
        elif self._says:
            self.reason = self._first()
        begin, end = self._span
        return self.reason is not None or self._watch.is_over(begin + moment, end)

    def _first(self) -> str | None:
        """A condition of the user's that has turned negative."""
        row = np.hstack(self._model.decode(self._model.record()[None]))[0]
        row[sampled.TURNING] += _whole_turns(self._angles - row[sampled.TURNING])
        self._angles = row[sampled.TURNING]
        if leaning(row) < LEAST_TILT:
            return FLAT
        for reason, says in self._says.items():
            if says(row) >= 0.0:
                self._armed.add(reason)
            elif reason in self._armed:
                return reason
        return None


class _Spans:
    """Runs span after span.

    Attributes
    ----------
    counts, setup_seconds, seconds
        See `Sampled`.
    moments, forces : list of floats
        Times and normal forces of all records, if the contact may pull.
    """

    def __init__(
        self,
        integrator: Integrator,
        end: float,
        conditions: Mapping[str, Condition],
        *,
        allow_pulling: bool,
        watch: Watch,
    ) -> None:
        self._integrator, self._end, self._conditions = integrator, end, conditions
        self._allow, self._watch = allow_pulling, watch
        self.counts: Counter[str] = Counter()
        self.setup_seconds = self.seconds = 0.0
        self.moments: list[float] = []
        self.forces: list[float] = []

    def run(
        self,
        scene: Scene,
        begin: float,
        intervals: int,
        spacing: float,
        substeps: int,
        *,
        halvings: int = 0,
    ) -> Block:
        """Samples of one span, with so many steps between them, halved."""
        model = self._build(scene)
        start = None if self.moments else self._checked_start(model)
        finer, substeps = self._fineness(model, spacing, substeps, halvings)
        period = spacing / finer
        must_not_pull = self._must_not_pull(model)
        stop = _Stop(
            model,
            self._watch,
            (begin, self._end),
            self._conditions,
            must_not_pull=must_not_pull,
        )
        samples, failure = self._recorded(
            model,
            start=start,
            spacing=period,
            intervals=intervals * finer,
            substeps=substeps,
            stop=None if stop.is_idle else stop,
        )
        values = _values(model, samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lowest = int(np.argmin(leaning(values)))
        self._watch.flattest = (float(moments[lowest]), float(leaning(values[lowest])))
        if not model.has_euler_angles:
            upright = int(np.argmin(np.append(leaning(values) >= LEAST_TILT, False)))
            _unwrap(values[:upright], moments[:upright], model.start)
        found = Records(
            scene=scene,
            values=values,
            period=period,
            broke_off=failure is not None,
            stopped_by=stop.reason,
            beyond=(samples.stopped or 0.0) - period * (len(values) - 1),
        ).first_ending(self._conditions, must_not_pull=must_not_pull, work=self.counts)
        if found is not None:
            moments = np.append(moments[: found.row + 1], moments[found.row] + found.moment)
            values = np.vstack((values[: found.row + 1], found.values))
        elif failure is not None:
            raise _failed(failure, begin, moments, values) from failure
        check_upright(moments, values[:, sampled.COORDINATES])
        self.moments += moments.tolist()
        self.forces += values[:, sampled.NORMAL_FORCE].tolist()
        kept = np.arange(0, len(values), finer)
        if found is not None and kept[-1] != len(values) - 1:
            kept = np.append(kept, len(values) - 1)
        ended = None if found is None else found.reason
        if ended is None and len(values) <= intervals * finer:
            ended = TIME_LIMIT
        return Block(values[kept], ended, float(moments[kept[-1]]))

    def _recorded(self, model: Model, **how: Any) -> tuple[Samples, EngineError | None]:
        """What a run has recorded, and why it broke off if it did."""
        if not self._watch.steps_left:
            raise self._watch.given_up(self._integrator.name)
        failure: EngineError | None = None
        try:
            samples = run(model, self._integrator, most=self._watch.steps_left, **how)
        except EngineError as error:
            if error.samples is None:
                raise
            failure, samples = error, error.samples
        self.counts.update(samples.counts)
        taken = samples.counts["steps"] + samples.counts.get("rejected_steps", 0)
        self._watch.steps += taken
        self.seconds += samples.seconds
        return samples, failure

    def _checked_start(self, model: Model) -> Start:
        """Raise if the start breaks a constraint, or needs a contact that pulls and must not."""
        probe = Probe(model)
        probe.check_start()
        start = settle(model, probe)
        if self._must_not_pull(model):
            force = float(probe.multipliers(*start)[0])
            if force < 0.0:
                raise ValueError(
                    f"start needs a contact that pulls, with a normal force of {force:.3g} N; "
                    "allow_pulling lets it"
                )
        return start

    def _must_not_pull(self, model: Model) -> bool:
        return model.may_pull and not self._allow

    def _build(self, scene: Scene) -> Model:
        begin = time.process_time()
        model = build(scene)
        self.setup_seconds += time.process_time() - begin
        return model

    def _fineness(
        self, model: Model, spacing: float, substeps: int, halvings: int
    ) -> tuple[int, int]:
        """Records per sample, and steps per record.

        Less than about a radian lies between two records, so that neither turns nor a contact
        that pulls are missed. That is estimated from the rates at the start, and from those that
        the fall of the disk can add. Runs of which each has half the step of the one before have
        the same records, as far as the first has the steps: endings are located from there, and
        else could not be extrapolated.
        """
        fall = np.sqrt(model.scenario.table.gravity / model.scenario.disk.radius)
        fastest = 2.0 * (sum(abs(rate) for rate in model.start.rates[3:]) + fall)
        needed = int(np.ceil(fastest * spacing))
        if self._integrator.controls_step:
            return needed, int(np.ceil((substeps << halvings) / needed))
        divisors = (k for k in range(needed, substeps) if substeps % k == 0)
        finer, steps = next(divisors, substeps), substeps << halvings
        while finer < min(needed, steps):
            finer *= 2
        return finer, steps // finer


def _failed(
    failure: EngineError, begin: float, moments: Array, values: Array
) -> EngineError | FlatError:
    """What to say of a run that broke off."""
    place = f"span from t = {begin:.6g} s"
    tilt = float(values[-1, sampled.BETA])
    if sin(tilt) < NEARLY_FLAT:
        return FlatError(
            f"{failure} ({place}); the disk lies nearly flat, at beta = {tilt:.3g} rad",
            float(moments[-1]),
        )
    return EngineError(f"{failure} ({place})")


def _values(model: Model, samples: Samples) -> Array:
    """Co-rotating coordinates, their rates and the constraint forces, shape (n, 12 + k)."""
    coordinates, rates = model.decode(samples.records)
    forces = model.multipliers(samples.records, samples.algebraic, coordinates, rates)
    return np.column_stack((coordinates, rates, forces))


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _unwrap(values: Array, moments: Array, start: State) -> None:
    """Make alpha and gamma continuous in place, from where they start.

    Their mean rates predict each sample, so that coarse sampling of a fast spin does not lose
    turns. A sample half a turn off its prediction cannot be told from the next.
    """
    for column in sampled.TURNING:
        angle, rate = values[:, column], values[:, 6 + column]
        angle += _whole_turns(start.coordinates[column] - angle[:1])
        predicted = 0.5 * np.diff(moments) * (rate[1:] + rate[:-1])
        turns = _whole_turns(predicted - np.diff(angle))
        doubt = np.abs(predicted - np.diff(angle) - turns)
        if np.any(doubt > 0.5 * np.pi):
            raise EngineError(
                f"the turns of {COORDINATES[column]} cannot be followed after sample "
                f"{int(np.argmax(doubt))}: the disk lies flat, or the samples are too far apart"
            )
        angle[1:] += np.cumsum(turns)


def run_over(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    step: float,
    halvings: int = 0,
    *,
    stop_when: Mapping[str, Condition] | None = None,
    allow_pulling: bool = False,
    watch: Watch | None = None,
) -> Sampled:
    """Run over all times, with steps of at most `step` that are then halved so often.

    Raises
    ------
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes so close to lying flat that the Euler angles cannot be followed.
    TimeLimitError
        If the watch calls time before the second sample.
    """
    spans = _Spans(
        integrator,
        float(times[-1]),
        stop_when or {},
        allow_pulling=allow_pulling,
        watch=watch or Watch(),
    )
    blocks: list[Block] = []
    longest = 0.0
    for first, intervals, spacing in even_spans(times):
        if blocks:
            scene = scene.starting_at(state_of(blocks[-1].values[-1]))
        substeps = max(1, int(np.ceil(spacing / step - 1e-9)))
        longest = max(longest, spacing / (substeps << halvings))
        block = spans.run(
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
    return Sampled(
        reached,
        values,
        longest,
        spans.counts,
        spans.setup_seconds,
        spans.seconds,
        blocks[-1].ended,
        pulling_times(spans.moments, spans.forces) if allow_pulling else (),
    )


def even_spans(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each span."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length
