"""Runs of the engine over stretches of evenly spaced times."""

import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import sin

import numpy as np

from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.state import COORDINATES, FlatError, State, check_upright
from analysis.data.watch import Watch
from mbs_models import columns
from mbs_models.build import build
from mbs_models.endings import Says, Search, leaning, says_of, state_of
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.runs import EngineError, Samples, Start, run, settle
from mbs_models.scene import Scene

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Samples of a stretch of even spacing; the last at `last` if it has ended early."""

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
        self, model: Model, watch: Watch, span: tuple[float, float], says: Mapping[str, Says]
    ) -> None:
        self._model, self._watch, self._span = model, watch, span
        self._pulls = CONTACT_WOULD_PULL in says and model.contact_equation is not None
        self._says = {
            reason: each
            for reason, each in says.items()
            if reason not in {FLAT, CONTACT_WOULD_PULL}
        }
        self._armed: set[str] = set()
        self._angles = np.array(model.start.coordinates)[columns.TURNING]
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
        row[columns.TURNING] += _whole_turns(self._angles - row[columns.TURNING])
        self._angles = row[columns.TURNING]
        if leaning(row) < LEAST_TILT:
            return FLAT
        for reason, says in self._says.items():
            if says(row) >= 0.0:
                self._armed.add(reason)
            elif reason in self._armed:
                return reason
        return None


class Runner:
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

    def stretch(
        self,
        scene: Scene,
        begin: float,
        intervals: int,
        spacing: float,
        substeps: int,
        *,
        halvings: int = 0,
    ) -> Block:
        """Samples of one stretch of even spacing, with so many steps between them, halved."""
        model = self._build(scene)
        start = None if self.moments else self._checked_start(model)
        finer, substeps = self._fineness(model, spacing, substeps, halvings)
        period = spacing / finer
        says = says_of(self._conditions, may_pull=not self._must_not_pull(model))
        if not self._watch.steps_left:
            raise self._watch.given_up(self._integrator.name)
        stop = _Stop(model, self._watch, (begin, self._end), says)
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
                most=self._watch.steps_left,
            )
        except EngineError as error:
            if error.samples is None:
                raise
            failure, samples = error, error.samples
        self._count(samples)
        values = _values(model, samples)
        moments: Array = begin + period * np.arange(len(values), dtype=float)
        lowest = int(np.argmin(leaning(values)))
        self._watch.flattest = (float(moments[lowest]), float(leaning(values[lowest])))
        if not model.has_euler_angles:
            upright = int(np.argmin(np.append(leaning(values) >= LEAST_TILT, False)))
            _unwrap(values[:upright], moments[:upright], model.start)
        beyond = (samples.stopped or 0.0) - period * (len(values) - 1) if stop.reason else 0.0
        fall = 2.0 * scene.scenario.table.gravity / scene.scenario.disk.radius
        search = Search(self._after(scene, substeps), values, period, bool(failure), fall)
        found = search.first(says, stop.reason, beyond)
        if found is not None:
            moments = np.append(moments[: found.row + 1], moments[found.row] + found.moment)
            values = np.vstack((values[: found.row + 1], found.values))
        elif failure is not None:
            raise _failed(failure, begin, moments, values) from failure
        check_upright(moments, values[:, columns.COORDINATES])
        self.moments += moments.tolist()
        self.forces += values[:, columns.NORMAL_FORCE].tolist()
        kept = np.arange(0, len(values), finer)
        if found is not None and kept[-1] != len(values) - 1:
            kept = np.append(kept, len(values) - 1)
        ended = None if found is None else found.reason
        if ended is None and len(values) <= intervals * finer:
            ended = TIME_LIMIT
        return Block(values[kept], ended, float(moments[kept[-1]]))

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

    def _after(self, scene: Scene, substeps: int) -> Callable[[Array, float, int], Array]:
        """Sample after a short run from a sample, over a time in s and so many records' steps."""

        def after(row: Array, duration: float, records: int) -> Array:
            model = self._build(scene.starting_at(state_of(row)))
            steps = records * substeps
            samples = run(
                model,
                self._integrator,
                spacing=duration,
                intervals=1,
                substeps=steps,
                most=self._watch.steps_left,
            )
            self._count(samples)
            values = _values(model, samples)
            if not model.has_euler_angles:
                _unwrap(values, np.array([0.0, duration]), model.start)
            result: Array = values[-1]
            return result

        return after

    def _build(self, scene: Scene) -> Model:
        begin = time.process_time()
        model = build(scene)
        self.setup_seconds += time.process_time() - begin
        return model

    def _count(self, samples: Samples) -> None:
        self.counts.update(samples.counts)
        self._watch.steps += samples.counts["steps"] + samples.counts.get("rejected_steps", 0)
        self.seconds += samples.seconds

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
    place = f"stretch from t = {begin:.6g} s"
    tilt = float(values[-1, columns.BETA])
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
    for column in columns.TURNING:
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
