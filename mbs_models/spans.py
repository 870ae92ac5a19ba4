"""Runs of the engine's own integrators over all times asked for, span by span.

A span holds evenly spaced times; each is one run. What it has recorded are samples: coordinates,
their rates and constraint forces.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import pi, sin
from typing import Any

import numpy as np

from analysis.motion import frames
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT, Condition
from analysis.problem.checks import Array
from analysis.problem.limits import LEAST_TILT
from analysis.problem.start import FlatError, State, check_upright
from analysis.solve.stepping import Run, pulls_at_start
from analysis.solve.watch import Watch
from mbs_models.accelerations import AccelerationProblem
from mbs_models.endings import Place, beyond, dips, pulling_times, turning_negative, until_ending
from mbs_models.integrators import Integrator
from mbs_models.runs import Samples, Stop, run
from mbs_models.scene import Scene, build
from mbs_models.solving import EngineError, solving

PLACE, RATES, NORMAL_FORCE = slice(0, 6), slice(6, 12), 12
"""Columns of samples,"""

BETA, TURNING = 4, [3, 5]
"""and of angles among the coordinates; the turning ones are alpha and gamma."""

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


@dataclass(slots=True, kw_only=True, eq=False)
class Call:
    """What a call of `mbs_models.simulate` asks of every run that it takes.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    longest : float
        Longest step in s.
    tolerance : float or None
        Largest error in rad, if the runs are to have one.
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.
    allow_pulling : bool
        Whether to go on where the contact pulls.
    watch : Watch
    counts : Counter
        To which the work of the runs is added.
    seconds : float
        Processor time that the solver took for the last run.
    """

    scene: Scene
    times: Array
    longest: float
    tolerance: float | None
    conditions: Mapping[str, Condition]
    allow_pulling: bool
    watch: Watch
    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0


def run_over(
    call: Call, integrator: Integrator, step: float, halvings: int = 0
) -> tuple[Run, float]:
    """Run over all times, with steps of at most `step` that are then halved so often.

    Returns
    -------
    run : Run
        Its states are samples.
    longest : float
        Longest step in s.

    Raises
    ------
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes so close to lying flat that the Euler angles cannot be followed.
    """
    spans, longest = _Spans(call, integrator), 0.0
    for first, intervals, spacing in even_spans(call.times):
        substeps = max(1, int(np.ceil(spacing / step - 1e-9)))
        longest = max(longest, spacing / (substeps << halvings))
        spans.run(float(call.times[first]), intervals, spacing, substeps, halvings)
        if spans.ended is not None:
            break
    return spans.joined(), longest


def even_spans(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each span."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length


class _Spans:
    """Runs of a scene span after span, and what they have recorded.

    Parameters
    ----------
    call : Call
    integrator : Integrator

    Attributes
    ----------
    ended : str or None
        Why the last span ended early, if it did.
    """

    def __init__(self, call: Call, integrator: Integrator) -> None:
        self._call, self._integrator = call, integrator
        # The last sample: where the next span begins.
        self._here = call.scene.scenario.initial_state.vector
        self._motion = motion = AccelerationProblem(call.scene, call.conditions)
        self._model = motion.model
        self._must_not_pull = self._model.may_pull and not call.allow_pulling
        with solving(motion.system):
            pulls_at_start(motion.starting_at(self._here), allow_pulling=not self._must_not_pull)
        # Times and records of each span, and which of these are samples.
        self._done: list[tuple[Array, Array, Any]] = []
        self.ended: str | None = None
        call.seconds = 0.0

    def run(
        self, begin: float, intervals: int, spacing: float, substeps: int, halvings: int
    ) -> None:
        """Run over one span, with so many steps between its samples, halved."""
        call = self._call
        if self._done:
            self._model = build(call.scene.starting_at(state_of(self._here)))
        finer, substeps = self._fineness(spacing, substeps, halvings)
        period = spacing / finer
        samples = self._recorded(begin, period, intervals * finer, substeps)
        values = self._values(samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lowest = int(np.argmin(leaning(values)))
        call.watch.flattest = (float(moments[lowest]), float(leaning(values[lowest])))
        self._unwrap(values, moments)
        places = self._places(values, samples, period)
        if samples.failure is not None:
            # What it has recorded last may make no sense: nothing is known to be negative there.
            places = (Place(row, width + bool(why), "") for row, width, why in places)
        self.ended, moments, values = until_ending(
            moments,
            values,
            places,
            self._motion,
            period=period,
            work=call.counts,
            allow_pulling=not self._must_not_pull,
        )
        if self.ended is None and samples.failure is not None:
            raise _failed(samples.failure, moments, values)
        check_upright(moments, values[:, PLACE])
        kept = np.arange(0, len(values), finer)
        if self.ended is not None:
            kept = np.union1d(kept, [len(values) - 1])
        elif len(values) <= intervals * finer:
            self.ended = TIME_LIMIT
        self._done.append((moments, values, kept[bool(self._done) :]))
        self._here, self._last = values[kept[-1]], float(moments[kept[-1]])

    def joined(self) -> Run:
        """The samples of all spans."""
        samples = np.concatenate([rows[kept] for _, rows, kept in self._done])
        times = self._call.times[: len(samples)]
        if self.ended is not None:
            times = np.append(times[:-1], self._last)
        moments = np.concatenate([each for each, _, _ in self._done])
        forces = np.concatenate([rows[:, NORMAL_FORCE] for _, rows, _ in self._done])
        pulling = pulling_times(moments, forces) if self._call.allow_pulling else ()
        return Run(times, samples, 0, self.ended, pulling)

    def _fineness(self, spacing: float, substeps: int, halvings: int) -> tuple[int, int]:
        """Records per sample, and steps per record.

        Less than about a radian lies between two records, so that neither turns nor a contact
        that pulls are missed. That is estimated from the rates at the start, and from those that
        the fall of the disk can add. Runs of which each has half the step of the one before have
        the same records, as far as the first has the steps: endings are located from there, and
        else could not be extrapolated.
        """
        scenario = self._call.scene.scenario
        turning = float(np.sum(np.abs(self._here[9:12])))
        fastest = 2.0 * (turning + np.sqrt(scenario.fall))
        needed = int(np.ceil(fastest * spacing))
        if self._integrator.controls_step:
            return needed, int(np.ceil((substeps << halvings) / needed))
        divisors = (k for k in range(needed, substeps) if substeps % k == 0)
        finer, steps = next(divisors, substeps), substeps << halvings
        while finer < min(needed, steps):
            finer *= 2
        return finer, steps // finer

    def _recorded(self, begin: float, period: float, intervals: int, substeps: int) -> Samples:
        """What a run from the last sample on has recorded."""
        watch = self._call.watch
        if not watch.steps_left:
            raise watch.given_up(self._integrator.name)
        samples = run(
            self._model,
            self._integrator,
            spacing=period,
            intervals=intervals,
            substeps=substeps,
            begin=begin,
            stop=self._stop(begin),
            most=watch.steps_left,
            whole=False,
        )
        self._call.counts.update(samples.counts)
        watch.steps += samples.counts["steps"] + samples.counts.get("rejected_steps", 0)
        self._call.seconds += samples.seconds
        return samples

    def _stop(self, begin: float) -> Stop | None:
        """What ends a run that pulls, meets a condition or is out of time, if any may."""
        model, conditions, watch = self._model, self._call.conditions, self._call.watch
        pulls = self._must_not_pull and model.joints.contact_equation is not None
        turned = turning_negative(conditions, state_of(self._here))
        data, angles = model.system.systemData, self._here[TURNING]
        end = float(self._call.times[-1])

        def stop(moment: float) -> str | None:
            nonlocal angles
            if pulls and model.joints.contact_force(data.GetAECoordinates()) < 0.0:
                return CONTACT_WOULD_PULL
            if conditions:
                row = np.hstack(model.decode(model.assembly.record()[None]))[0]
                row[TURNING] += _whole_turns(angles - row[TURNING])
                angles = row[TURNING]
                if leaning(row) < LEAST_TILT:
                    return FLAT
                if (name := turned(state_of(row))) is not None:
                    return name
            return TIME_LIMIT if watch.is_over(begin + moment, end) else None

        return stop if pulls or conditions or not watch.is_idle else None

    def _values(self, samples: Samples) -> Array:
        """Co-rotating coordinates, their rates and the constraint forces, shape (n, 12 + k)."""
        coordinates, rates = self._model.decode(samples.records)
        forces = self._model.multipliers(samples.records, samples.algebraic, coordinates, rates)
        return np.column_stack((coordinates, rates, forces))

    def _unwrap(self, values: Array, moments: Array) -> None:
        """Make alpha and gamma continuous in place, from the last sample on."""
        if self._model.has_euler_angles:
            return
        upright = int(np.argmin(np.append(leaning(values) >= LEAST_TILT, False)))
        rows, times = values[:upright], moments[:upright]
        rows[:, TURNING] += _whole_turns(self._here[TURNING] - rows[:1, TURNING])
        fall = self._call.scene.scenario.fall
        unseen = frames.follow_turns(times, rows[:, PLACE], rows[:, RATES], fall)
        if np.any(unseen):
            moment = float(times[np.argmax(unseen)])
            raise FlatError(
                f"alpha and gamma may turn unseen after t = {moment:.6g} s, between two records, "
                "as the disk comes nearly flat: give times closer together",
                moment,
            )

    def _places(self, values: Array, samples: Samples, period: float) -> Iterator[Place]:
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
            yield from dips(upright[:, NORMAL_FORCE], CONTACT_WOULD_PULL)
        for name, condition in self._call.conditions.items():
            yield from dips(np.array([condition(state_of(row)) for row in upright]), name)
        if samples.stopped is not None and samples.stopped[1] != TIME_LIMIT:
            yield from beyond(samples.stopped, len(values) - 1, period)


def leaning(rows: Array) -> Array:
    """Angle in rad between disk and table in samples.

    It is negative where beta lies outside (0, pi), by whole turns if a run has failed.
    """
    tilts = rows[..., BETA]
    result: Array = np.minimum(tilts, pi - tilts)
    return result


def state_of(row: Array) -> State:
    """State of a sample."""
    values = row.tolist()
    return State(coordinates=tuple(values[PLACE]), rates=tuple(values[RATES]))


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _failed(failure: EngineError, moments: Array, values: Array) -> EngineError | FlatError:
    """What to say of a run that broke off."""
    tilt = float(values[-1, BETA])
    if sin(tilt) >= NEARLY_FLAT:
        return failure
    text = f"{failure}; the disk lies nearly flat, at beta = {tilt:.3g} rad"
    return FlatError(text, float(moments[-1]))
