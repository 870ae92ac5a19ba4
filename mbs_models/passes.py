"""Passes of the engine over all times asked for, with steps of one size."""

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import sin

import numpy as np

from analysis.data.checks import Array, TimeLimitError
from analysis.data.state import COORDINATES, FlatError, State, check_upright
from analysis.data.watch import Watch
from mbs_models.build import build
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.pulling import Dip, dips, pulling_times, zero
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
    ended : {"contact would pull", "time limit"} or None
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


def one_pass(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    step: float,
    halvings: int = 0,
    *,
    allow_pulling: bool = False,
    watch: Watch | None = None,
) -> Pass:
    """One pass over all times, with steps of at most `step` that are then halved so often.

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
        watch=watch or Watch(),
    )
    blocks: list[_Block] = []
    longest = 0.0
    for first, intervals, spacing in _even_stretches(times):
        if blocks:
            scene = scene.starting_at(_restart(blocks[-1].values))
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
        pulling_times(runner.moments, runner.forces),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Samples of a stretch of even spacing; the last at `last` if it has ended early."""

    values: Array
    ended: str | None
    last: float


class _Stop:
    """Ends a run where the contact's constraint pulls, or when the watch calls time.

    Attributes
    ----------
    pulled : bool
        Whether it ended it for the contact.
    """

    def __init__(self, model: Model, watch: Watch, begin: float, end: float) -> None:
        self._model, self._watch = model, watch
        self._begin, self._end = begin, end
        self.pulled = False

    def __call__(self, moment: float) -> bool:
        self.pulled = self._model.pulls()
        return self.pulled or self._watch.is_over(self._begin + moment, self._end)


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
        watch: Watch,
    ) -> None:
        self._integrator, self._end = integrator, end
        self._allow, self._watch = allow_pulling, watch
        self.counts: Counter[str] = Counter()
        self.setup_seconds = self.seconds = 0.0
        self.moments: list[float] = []
        self.forces: list[float] = []

    def stretch(
        self, scene: Scene, begin: float, intervals: int, spacing: float, substeps: int
    ) -> _Block:
        """Samples of one stretch of even spacing."""
        model = self._build(scene)
        start = None if self.moments else self._checked_start(model)
        finer, substeps = self._fineness(model, spacing, substeps)
        period = spacing / finer
        stop = _Stop(model, self._watch, begin, self._end)
        stops = self._must_not_pull(model) and model.contact_equation is not None
        failure: EngineError | None = None
        try:
            samples = run(
                model,
                self._integrator,
                spacing=period,
                intervals=intervals * finer,
                substeps=substeps,
                start=start,
                stop=stop if stops or not self._watch.is_idle else None,
            )
        except EngineError as error:
            if error.samples is None:
                raise
            failure, samples = error, error.samples
        self._count(samples)
        values = _values(model, samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        ended: str | None = None
        if self._must_not_pull(model):
            width = (samples.stopped or 0.0) - period * (len(values) - 1) if stop.pulled else 0.0
            pulled = self._first_pull(scene, values, moments, substeps, width)
            if pulled is not None:
                ended, failure, (moments, values) = "contact would pull", None, pulled
        if failure is not None:
            check_upright(moments, values[:, :6])
            place = f"stretch from t = {begin:.6g} s"
            tilt = float(values[-1, 4])
            if sin(tilt) < NEARLY_FLAT:
                raise FlatError(
                    f"{failure} ({place}); the disk lies nearly flat, at beta = {tilt:.3g} rad",
                    float(moments[-1]),
                ) from failure
            raise EngineError(f"{failure} ({place})") from failure
        check_upright(moments, values[:, :6])
        if not model.has_euler_angles:
            _unwrap(values, moments, model.start)
        self.moments += moments.tolist()
        self.forces += values[:, 12].tolist()
        if ended is None and len(values) <= intervals * finer:
            ended = "time limit"
        kept = np.arange(0, len(values), finer)
        if ended == "contact would pull" and kept[-1] != len(values) - 1:
            kept = np.append(kept, len(values) - 1)
        return _Block(values[kept], ended, float(moments[kept[-1]]))

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

    def _first_pull(
        self, scene: Scene, values: Array, moments: Array, substeps: int, beyond: float
    ) -> tuple[Array, Array] | None:
        """Times and values up to where the contact would first pull, if it would.

        Parameters
        ----------
        substeps : int
            Steps between two records.
        beyond : float
            Time after the last record at which the run was stopped for the contact, 0 if not.
        """
        period = float(moments[1] - moments[0]) if len(moments) > 1 else beyond
        places: list[Dip] = list(dips(values[:, 12]))
        if beyond > 1e-9 * period:
            places.append(Dip(len(values) - 1, beyond / period, sure=True))
        for row, width, sure in places:
            check_upright(moments[: row + 1], values[: row + 1, :6])
            # From one record earlier: very short steps would make the forces noisy.
            first = max(0, row - 1)
            start = scene.starting_at(_restart(values[first : first + 1]))
            steps = (int(np.ceil(width)) + row - first) * substeps
            lead = period * (row - first)

            def after(
                moment: float, start: Scene = start, lead: float = lead, steps: int = steps
            ) -> Array:
                return self._after(start, lead + moment, steps)

            moment = zero(
                lambda time: float(after(time)[12]),
                float(values[row, 12]),
                width * period,
                sure=sure,
            )
            if moment is not None:
                times = np.append(moments[: row + 1], moments[row] + moment)
                return times, np.vstack((values[: row + 1], after(moment)))
        return None

    def _after(self, scene: Scene, duration: float, steps: int) -> Array:
        """Values that a short run of so many steps ends with, shape (12 + k,)."""
        model = self._build(scene)
        samples = run(model, self._integrator, spacing=duration, intervals=1, substeps=steps)
        self._count(samples)
        result: Array = _values(model, samples)[-1]
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


def _restart(values: Array) -> State:
    last = values[-1].tolist()
    return State(coordinates=tuple(last[:6]), rates=tuple(last[6:12]))


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _unwrap(values: Array, moments: Array, start: State) -> None:
    """Make alpha and gamma continuous in place, from where they start.

    Their mean rates predict each sample, so that coarse sampling of a fast spin does not lose
    turns. A sample half a turn off its prediction cannot be told from the next.
    """
    for column in (3, 5):
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
