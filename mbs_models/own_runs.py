"""Runs of the engine's own integrators over all times asked for, span by span.

A span holds evenly spaced times; each is one run.
"""

from collections.abc import Iterator
from math import sin
from typing import Any

import numpy as np

from analysis.motion import frames
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT
from analysis.problem.checks import Array
from analysis.problem.limits import LEAST_TILT
from analysis.problem.start import COORDINATES, FlatError, check_upright
from analysis.solve.stepping import Run, pulls_at_start
from mbs_models import sampled
from mbs_models.accelerations import AccelerationProblem
from mbs_models.endings import Place, dips, pulling_times, until_ending
from mbs_models.integrators import Integrator
from mbs_models.runs import Samples, Stop, run
from mbs_models.sampled import Call, leaning, state_of
from mbs_models.scene import build
from mbs_models.solving import EngineError, solving

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


def run_over(
    call: Call, integrator: Integrator, step: float, halvings: int = 0
) -> tuple[Run, float]:
    """Run over all times, with steps of at most `step` that are then halved so often.

    Returns
    -------
    run : Run
        Its states are samples, see `Call.trajectory`.
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
        motion.probe.check_start()
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
        reasons: list[str] = []
        samples = self._recorded(begin, period, intervals * finer, substeps, reasons)
        values = self._values(samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lowest = int(np.argmin(leaning(values)))
        call.watch.flattest = (float(moments[lowest]), float(leaning(values[lowest])))
        self._unwrap(values, moments)
        self.ended, moments, values = until_ending(
            moments,
            values,
            self._places(values, samples, reasons, period),
            self._motion,
            period=period,
            work=call.counts,
            allow_pulling=not self._must_not_pull,
        )
        if self.ended is None and samples.failure is not None:
            raise _failed(samples.failure, moments, values)
        check_upright(moments, values[:, sampled.COORDINATES])
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
        forces = np.concatenate([rows[:, sampled.NORMAL_FORCE] for _, rows, _ in self._done])
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
        self, begin: float, period: float, intervals: int, substeps: int, reasons: list[str]
    ) -> Samples:
        """What a run from the last sample on has recorded; why it is stopped goes to a list."""
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
            stop=self._stop(begin, reasons),
            most=watch.steps_left,
            whole=False,
        )
        self._call.counts.update(samples.counts)
        watch.steps += samples.counts["steps"] + samples.counts.get("rejected_steps", 0)
        self._call.seconds += samples.seconds
        return samples

    def _stop(self, begin: float, reasons: list[str]) -> Stop | None:
        """What ends a run where the contact pulls, a condition holds or time is over, if any may.

        It is asked after each step, and appends the reason if that is not the time.
        """
        model, conditions, watch = self._model, self._call.conditions, self._call.watch
        pulls = self._must_not_pull and model.contact_equation is not None
        armed: set[str] = set()
        end, angles = float(self._call.times[-1]), self._here[sampled.TURNING]

        def reason() -> str | None:
            nonlocal angles
            if pulls and model.pulls():
                return CONTACT_WOULD_PULL
            if not conditions:
                return None
            row = np.hstack(model.decode(model.record()[None]))[0]
            row[sampled.TURNING] += _whole_turns(angles - row[sampled.TURNING])
            angles = row[sampled.TURNING]
            if leaning(row) < LEAST_TILT:
                return FLAT
            for name, condition in conditions.items():
                if condition(state_of(row)) >= 0.0:
                    armed.add(name)
                elif name in armed:
                    return name
            return None

        def stop(moment: float) -> bool:
            if found := reason():
                reasons.append(found)
            return bool(reasons) or watch.is_over(begin + moment, end)

        return stop if pulls or conditions or not watch.is_idle else None

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
        self, values: Array, samples: Samples, reasons: list[str], period: float
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
        for name, condition in self._call.conditions.items():
            yield from dips(np.array([condition(state_of(row)) for row in upright]), name)
        beyond = (samples.stopped or 0.0) - period * (len(values) - 1)
        if reasons and beyond > 1e-9 * period:
            yield Place(last, beyond / period, reasons[0])


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _failed(failure: EngineError, moments: Array, values: Array) -> EngineError | FlatError:
    """What to say of a run that broke off."""
    tilt = float(values[-1, sampled.BETA])
    if sin(tilt) >= NEARLY_FLAT:
        return failure
    text = f"{failure}; the disk lies nearly flat, at beta = {tilt:.3g} rad"
    return FlatError(text, float(moments[-1]))
