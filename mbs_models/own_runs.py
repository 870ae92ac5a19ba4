"""Runs of the engine's own integrators over all times asked for, span by span.

A span holds evenly spaced times; each is one run.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import sin

import numpy as np

from analysis.data import frames
from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.state import COORDINATES, FlatError, check_upright
from analysis.data.watch import Watch
from mbs_models import sampled
from mbs_models.accelerations import AccelerationProblem
from mbs_models.effort import stepping_integrator
from mbs_models.endings import LOCAL, Motion, Place, dips, first_ending, pulling_times
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.runs import Samples, Start, record, settle
from mbs_models.sampled import Sampled, leaning, state_of
from mbs_models.scene import Scene, build
from mbs_models.solving import EngineError

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


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
    counts: Counter[str] | None = None,
) -> Sampled:
    """Run over all times, with steps of at most `step` that are then halved so often.

    The work is added to `counts`; other arguments are those of `mbs_models.simulate`.

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
        scene,
        integrator,
        times,
        stop_when or {},
        allow_pulling=allow_pulling,
        watch=watch or Watch(),
        counts=Counter() if counts is None else counts,
    )
    longest = 0.0
    for first, intervals, spacing in even_spans(times):
        substeps = max(1, int(np.ceil(spacing / step - 1e-9)))
        longest = max(longest, spacing / (substeps << halvings))
        spans.run(float(times[first]), intervals, spacing, substeps, halvings)
        if spans.ended is not None:
            break
    return spans.sampled(longest)


def even_spans(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each span."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length


class _Stop:
    """Ends a run where the contact's constraint pulls, a condition holds or time is over.

    Parameters
    ----------
    model : Model
    here : ndarray, shape (12 + k,)
        Sample at which the run begins.
    conditions : mapping
    must_not_pull : bool
    is_over : callable
        From a time in the run in s to whether somebody ends it there; None if nobody does.

    Attributes
    ----------
    reason : str or None
        Why it ended it, if not for the time.
    """

    def __init__(
        self,
        model: Model,
        here: Array,
        conditions: Mapping[str, Condition],
        must_not_pull: bool,
        is_over: Callable[[float], bool] | None,
    ) -> None:
        self._model, self._conditions, self._is_over = model, conditions, is_over
        self._pulls = must_not_pull and model.contact_equation is not None
        self._armed: set[str] = set()
        self._angles = here[sampled.TURNING]
        self.reason: str | None = None

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to look at after a step."""
        return not (self._pulls or self._conditions) and self._is_over is None

    def __call__(self, moment: float) -> bool:
        if self._pulls and self._model.pulls():
            self.reason = CONTACT_WOULD_PULL
        elif self._conditions:
            self.reason = self._first()
        return self.reason is not None or (self._is_over is not None and self._is_over(moment))

    def _first(self) -> str | None:
        """A condition of the user's that has turned negative."""
        row = np.hstack(self._model.decode(self._model.record()[None]))[0]
        row[sampled.TURNING] += _whole_turns(self._angles - row[sampled.TURNING])
        self._angles = row[sampled.TURNING]
        if leaning(row) < LEAST_TILT:
            return FLAT
        for reason, condition in self._conditions.items():
            if condition(state_of(row)) >= 0.0:
                self._armed.add(reason)
            elif reason in self._armed:
                return reason
        return None


class _Spans:
    """Runs of a scene span after span, and what they have recorded.

    Parameters
    ----------
    scene, integrator, times, conditions, allow_pulling, watch, counts
        See `run_over`.

    Attributes
    ----------
    ended : str or None
        Why the last span ended early, if it did.
    """

    def __init__(
        self,
        scene: Scene,
        integrator: Integrator,
        times: Array,
        conditions: Mapping[str, Condition],
        *,
        allow_pulling: bool,
        watch: Watch,
        counts: Counter[str],
    ) -> None:
        self._scene, self._integrator, self._times = scene, integrator, times
        self._conditions, self._watch, self._counts = conditions, watch, counts
        self._allow = allow_pulling
        self._model = build(scene)
        self._must_not_pull = self._model.may_pull and not allow_pulling
        # The last sample: where the next span begins.
        self._here = scene.scenario.initial_state.vector
        self._start = self._checked_start()
        self._moments: list[Array] = []
        self._forces: list[Array] = []
        self._kept: list[Array] = []
        self._seconds, self._last = 0.0, 0.0
        self.ended: str | None = None

    def _checked_start(self) -> Start:
        """Raise if the start breaks a constraint, or needs a contact that pulls and must not."""
        probe = Probe(self._model)
        probe.check_start()
        start = settle(self._model, probe)
        if self._must_not_pull:
            force = float(probe.multipliers(*start)[0])
            if force < 0.0:
                raise ValueError(
                    f"start needs a contact that pulls, with a normal force of {force:.3g} N; "
                    "allow_pulling lets it"
                )
        return start

    def run(
        self, begin: float, intervals: int, spacing: float, substeps: int, halvings: int
    ) -> None:
        """Run over one span, with so many steps between its samples, halved."""
        if self._kept:
            self._scene = self._scene.starting_at(state_of(self._here))
            self._model = build(self._scene)
        finer, substeps = self._fineness(spacing, substeps, halvings)
        period = spacing / finer
        stop = self._stop(begin)
        samples = self._recorded(begin, period, intervals * finer, substeps, stop)
        values = self._values(samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lowest = int(np.argmin(leaning(values)))
        self._watch.flattest = (float(moments[lowest]), float(leaning(values[lowest])))
        self._unwrap(values, moments)
        found = first_ending(
            self._places(values, samples, stop.reason, period),
            period,
            partial(self._motion_from, values, period),
            allow_pulling=not self._must_not_pull,
            work=self._counts,
        )
        if found is not None:
            self.ended, size = found.reason, found.row + 1
            moments, values = moments[:size], values[:size]
            if found.moment > 0.0:
                moments = np.append(moments, moments[-1] + found.moment)
                values = np.vstack((values, found.values))
        elif samples.failure is not None:
            raise _failed(samples.failure, moments, values)
        elif len(values) <= intervals * finer:
            self.ended = TIME_LIMIT
        check_upright(moments, values[:, sampled.COORDINATES])
        self._moments.append(moments)
        self._forces.append(values[:, sampled.NORMAL_FORCE])
        kept = np.arange(0, len(values), finer)
        if found is not None and kept[-1] != len(values) - 1:
            kept = np.append(kept, len(values) - 1)
        self._kept.append(values[kept[bool(self._kept) :]])
        self._here, self._last = values[kept[-1]], float(moments[kept[-1]])

    def sampled(self, longest: float) -> Sampled:
        """The motion over all spans, with the length of its longest step in s."""
        values, times = np.concatenate(self._kept), self._times
        if len(values) < 2:
            raise TimeLimitError("time limit met before the first sample after the start")
        if self.ended is not None:
            times = np.append(times[: len(values) - 1], self._last)
        moments, forces = np.concatenate(self._moments), np.concatenate(self._forces)
        return Sampled(
            times=times,
            values=values,
            integrator=self._integrator,
            step=longest,
            seconds=self._seconds,
            ended=self.ended,
            pulling=pulling_times(moments, forces) if self._allow else (),
        )

    def _fineness(self, spacing: float, substeps: int, halvings: int) -> tuple[int, int]:
        """Records per sample, and steps per record.

        Less than about a radian lies between two records, so that neither turns nor a contact
        that pulls are missed. That is estimated from the rates at the start, and from those that
        the fall of the disk can add. Runs of which each has half the step of the one before have
        the same records, as far as the first has the steps: endings are located from there, and
        else could not be extrapolated.
        """
        scenario = self._scene.scenario
        fall = np.sqrt(scenario.table.gravity / scenario.disk.radius)
        fastest = 2.0 * (float(np.sum(np.abs(self._here[9:12]))) + fall)
        needed = int(np.ceil(fastest * spacing))
        if self._integrator.controls_step:
            return needed, int(np.ceil((substeps << halvings) / needed))
        divisors = (k for k in range(needed, substeps) if substeps % k == 0)
        finer, steps = next(divisors, substeps), substeps << halvings
        while finer < min(needed, steps):
            finer *= 2
        return finer, steps // finer

    def _recorded(
        self, begin: float, period: float, intervals: int, substeps: int, stop: "_Stop"
    ) -> Samples:
        """What a run from the last sample on has recorded."""
        if not self._watch.steps_left:
            raise self._watch.given_up(self._integrator.name)
        samples = record(
            self._model,
            self._integrator,
            spacing=period,
            intervals=intervals,
            substeps=substeps,
            begin=begin,
            start=None if self._kept else self._start,
            stop=None if stop.is_idle else stop,
            most=self._watch.steps_left,
        )
        self._counts.update(samples.counts)
        self._watch.steps += samples.counts["steps"] + samples.counts.get("rejected_steps", 0)
        self._seconds += samples.seconds
        return samples

    def _stop(self, begin: float) -> _Stop:
        end, watch = float(self._times[-1]), self._watch
        is_over = None if watch.is_idle else lambda moment: watch.is_over(begin + moment, end)
        conditions = self._conditions
        return _Stop(self._model, self._here, conditions, self._must_not_pull, is_over)

    def _values(self, samples: Samples) -> Array:
        """Co-rotating coordinates, their rates and the constraint forces, shape (n, 12 + k)."""
        coordinates, rates = self._model.decode(samples.records)
        forces = self._model.multipliers(samples.records, samples.algebraic, coordinates, rates)
        return np.column_stack((coordinates, rates, forces))

    def _unwrap(self, values: Array, moments: Array) -> None:
        """Make alpha and gamma continuous in place, from the last sample on.

        A record half a turn off what its rates predict cannot be told from the next.
        """
        if self._model.has_euler_angles:
            return
        upright = int(np.argmin(np.append(leaning(values) >= LEAST_TILT, False)))
        rows, times = values[:upright], moments[:upright]
        rows[:, sampled.TURNING] += _whole_turns(
            self._here[sampled.TURNING] - rows[:1, sampled.TURNING]
        )
        frames.follow_turns(times, rows[:, sampled.COORDINATES], rows[:, sampled.RATES])
        for column in sampled.TURNING:
            angle, rate = rows[:, column], rows[:, 6 + column]
            doubt = np.abs(0.5 * np.diff(times) * (rate[1:] + rate[:-1]) - np.diff(angle))
            if np.any(doubt > 0.5 * np.pi):
                raise EngineError(
                    f"the turns of {COORDINATES[column]} cannot be followed after sample "
                    f"{int(np.argmax(doubt))}: the disk lies flat, or the samples are too far "
                    "apart"
                )

    def _places(
        self, values: Array, samples: Samples, reason: str | None, period: float
    ) -> Iterator[Place]:
        """Places where the run may end, in no order."""
        lying = np.flatnonzero(leaning(values) < LEAST_TILT)
        upright = values[: lying[0] if lying.size else len(values)]
        last = len(upright) - 1
        if last < 0:
            return
        if lying.size or samples.failure is not None:
            # It may lie flat.
            yield Place(last, 2.0, "")
        if self._must_not_pull:
            yield from dips(upright[:, sampled.NORMAL_FORCE], CONTACT_WOULD_PULL)
        for name, condition in self._conditions.items():
            yield from dips(np.array([condition(state_of(row)) for row in upright]), name)
        beyond = (samples.stopped or 0.0) - period * (len(values) - 1)
        if reason is not None and beyond > 1e-9 * period:
            yield Place(last, beyond / period, reason)

    def _motion_from(self, values: Array, period: float, row: int) -> Motion:
        """The motion from a record on, by the accelerations."""
        scene = self._scene.starting_at(state_of(values[row]))
        motion = AccelerationProblem(scene, self._conditions)
        method = stepping_integrator(scene, np.array([0.0, period]), LOCAL).method
        return Motion(
            motion.model.system,
            motion.initial_value_problem,
            method,
            lambda state: motion.samples(state[None])[0],
        )


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _failed(failure: EngineError, moments: Array, values: Array) -> EngineError | FlatError:
    """What to say of a run that broke off."""
    tilt = float(values[-1, sampled.BETA])
    if sin(tilt) >= NEARLY_FLAT:
        return failure
    text = f"{failure}; the disk lies nearly flat, at beta = {tilt:.3g} rad"
    return FlatError(text, float(moments[-1]))
