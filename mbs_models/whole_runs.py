"""Runs of the engine's own integrators over all times asked for, up to where the motion ends.

What they give are samples: coordinates, their rates and constraint forces.
"""

from dataclasses import dataclass
from functools import cache
from math import ceil, pi, sin

import numpy as np
import numpy.typing as npt

from analysis.motion import frames
from analysis.motion.endings import CONTACT_WOULD_PULL, TIME_LIMIT
from analysis.problem.checks import Array
from analysis.problem.elementary import Rows
from analysis.problem.limits import LEAST_TILT
from analysis.problem.start import FlatError, check_upright
from analysis.solve.stepping import Run
from analysis.solve.watch import PaperState, StateFunction, of_states
from mbs_models.accelerations import AccelerationProblem
from mbs_models.endings import Search, Suspect, suspects, turning_negative
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.runs import Recording, Stop, run
from mbs_models.solving import EngineError

PLACE, RATES, NORMAL_FORCE = slice(0, 6), slice(6, 12), 12
"""Columns of samples,"""

RIPPLING = 1e-5
"""Shortest over longest step below which constraint forces of GeneralizedAlpha, which carries them
on from step to step, are those of another motion."""

BETA, TURNING = 4, [3, 5]
"""and of angles among the coordinates; the turning ones are alpha and gamma."""

GRAZING = 0.5
"""Part of the weight up to which a contact that pulls by a run may press by its motion."""

NEARLY_FLAT = 0.1
"""Sine of the inclination below which a failure is likely to come from the Euler angles."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Call(Search):
    """What a call of `mbs_models.simulate` asks of every run that it takes.

    Parameters
    ----------
    motion : AccelerationProblem
        Its model is run by the engine's own integrators, too.
    times : ndarray, shape (n,)
        In s.
    longest : float
        Longest step in s.
    tolerance : float or None
        Largest error in rad, if the runs are to have one.
    may_change : bool
        Whether nearly flat, another formulation may be stepped.
    allow_pulling, watch, counts
        See `Search`.
    """

    motion: AccelerationProblem
    times: Array
    longest: float
    tolerance: float | None
    may_change: bool

    @property
    def must_not_pull(self) -> bool:
        """Whether a contact that pulls ends a run."""
        return self.motion.scenario.may_pull and not self.allow_pulling

    @property
    def conditions(self) -> dict[str, StateFunction]:
        """Conditions of the motion as functions of a sample."""
        return of_states(self.motion.conditions, _paper_state)


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
    start, watch, model = call.motion.scenario.initial_state.vector, call.watch, call.motion.model
    if not watch.steps_left:
        raise watch.given_up(integrator.name)
    moments, steps, sampled = _grid(call, integrator, step, halvings)
    stop, most = _stop(call, model, start), watch.steps_left
    recording = run(model, integrator, moments, steps, stop=stop, most=most)
    call.counts.update(recording.counts)
    watch.steps += recording.counts["steps"] + recording.counts.get("rejected_steps", 0)
    coordinates, rates = model.decode(recording.records)
    # A failed run may end flat, where some bodies touch the table in no one point.
    upright = _upright(coordinates)
    told = (each[:upright] for each in (recording.records, coordinates, rates))
    forces = np.pad(
        model.multipliers(*told), ((0, len(rates) - upright), (0, 0)), constant_values=np.nan
    )
    values = np.column_stack((coordinates, rates, forces))
    if not model.has_euler_angles:
        _unwrap(values, moments[: len(values)], start, call.motion.scenario.fall)
    ended, reached, values = _upto_ending(call, values, moments, recording)
    check_upright(reached, values[:, PLACE])
    kept = sampled[sampled < len(values)]
    if ended not in (None, TIME_LIMIT):
        kept = np.union1d(kept, [len(values) - 1])
    elif kept.size < sampled.size:
        ended = TIME_LIMIT
    pulling: tuple[tuple[float, float], ...] = ()
    if call.allow_pulling and call.motion.scenario.may_pull:
        forces = values[:, NORMAL_FORCE]
        pulling = call.pulling_times(reached, values, forces)
    # Differences of times have fewer digits than these.
    longest = float(f"{np.max(np.diff(moments) / steps):.9g}")
    found = Run(reached[kept], values[kept], 0, ended, pulling, seconds=recording.seconds)
    return found, longest


def _upto_ending(
    call: Call, values: Array, moments: Array, recording: Recording
) -> tuple[str | None, Array, Array]:
    """Why a run ends, if it does, and its times and samples up to there."""
    period, moments = float(np.max(np.diff(moments))), moments[: len(values)]
    leans = leaning(values)
    lowest = int(np.argmin(leans))
    call.watch.flattest = (float(moments[lowest]), float(leans[lowest]))
    upright = values[: _upright(values)]
    told: dict[str, npt.ArrayLike] = {
        name: [condition(row) for row in upright] for name, condition in call.conditions.items()
    }
    if call.must_not_pull:
        told[CONTACT_WOULD_PULL] = upright[:, NORMAL_FORCE]
    found = list(suspects(moments, told, recording.stopped))
    if recording.failure is not None:
        # What it has recorded last may make no sense: nothing is known to be negative there.
        found = [Suspect(row, width + period * bool(why), "") for row, width, why in found]
    if len(upright) < len(values) or recording.failure is not None:
        # It may lie flat.
        found.append(Suspect(max(0, len(upright) - 1), 2.0 * period, ""))
    ended, moments, values = call.until_ending(moments, values, found, period)
    pressing = values[-1, NORMAL_FORCE]
    if ended == CONTACT_WOULD_PULL and pressing > GRAZING * call.motion.scenario.weight:
        raise EngineError(
            f"the constraint force of this run goes up and down, and pulls at t = "
            f"{moments[-1]:.6g} s, where by its motion the contact presses with {pressing:.3g} N"
        )
    if ended is None and recording.failure is not None:
        raise _failed(recording.failure, moments, values)
    return ended, moments, values


def _grid(
    call: Call, integrator: Integrator, step: float, halvings: int
) -> tuple[Array, Rows, Rows]:
    """Times of records, steps between two of them, and which of the records are samples.

    Less than about a radian lies between two records, so that neither turns nor a contact that
    pulls are missed. That is estimated from the rates at the start, and from those that the fall
    of the disk can add. Runs of which each has half the step of the one before have the same
    records, as far as the first has the steps: endings are located from there, and else could not
    be extrapolated.
    """
    scenario = call.motion.scenario
    turning = float(np.sum(np.abs(scenario.initial_state.vector[9:12])))
    fastest = 2.0 * (turning + np.sqrt(scenario.fall))

    @cache
    def fineness(spacing: float) -> tuple[int, int]:
        """Records for each sample, and steps for each record."""
        needed, substeps = ceil(fastest * spacing), max(1, ceil(spacing / step - 1e-9))
        if integrator.controls_step:
            return needed, ceil((substeps << halvings) / needed)
        divisors = (k for k in range(needed, substeps) if substeps % k == 0)
        finer, steps = next(divisors, substeps), substeps << halvings
        while finer < min(needed, steps):
            finer *= 2
        return finer, steps // finer

    finer, steps = np.array([fineness(each) for each in np.diff(call.times).tolist()]).T
    sampled = np.append(0, np.cumsum(finer))
    moments = np.interp(np.arange(sampled[-1] + 1), sampled, call.times)
    lengths = np.diff(call.times) / (finer * steps)
    if integrator.name == "GeneralizedAlpha" and lengths.min() < RIPPLING * lengths.max():
        raise ValueError(
            f"times ask for steps of {lengths.min():.2g} and {lengths.max():.2g} s, which differ "
            "too much for GeneralizedAlpha: take even times, or another integrator"
        )
    return moments, np.repeat(steps, finer), sampled


def _stop(call: Call, model: Model, start: Array) -> Stop | None:
    """What ends a run that pulls, meets a condition or is out of time, if any may."""
    conditions, watch = call.conditions, call.watch
    pulls = call.must_not_pull and model.joints.contact_equation is not None
    turned = turning_negative(conditions, start)
    data, angles, end = model.system.systemData, start[TURNING], float(call.times[-1])

    def stop(moment: float) -> str | None:
        nonlocal angles
        if pulls and model.joints.contact_force(data.GetAECoordinates()) < 0.0:
            return CONTACT_WOULD_PULL
        if conditions:
            row = np.hstack(model.decode(model.record()[None]))[0]
            row[TURNING] += _whole_turns(angles - row[TURNING])
            angles = row[TURNING]
            if (name := turned(row)) is not None:
                return name
        return TIME_LIMIT if watch.is_over(moment, end) else None

    return stop if pulls or conditions or not watch.is_idle else None


def _unwrap(values: Array, moments: Array, start: Array, fall: float) -> None:
    """Make alpha and gamma continuous in place, from the start on."""
    upright = _upright(values)
    rows, times = values[:upright], moments[:upright]
    rows[:, TURNING] += _whole_turns(start[TURNING] - rows[:1, TURNING])
    unseen = frames.follow_turns(times, rows[:, PLACE], rows[:, RATES], fall)
    if np.any(unseen):
        moment = float(times[np.argmax(unseen)])
        raise FlatError(
            f"alpha and gamma may turn unseen after t = {moment:.6g} s, between two records, "
            "as the disk comes nearly flat: give times closer together",
            moment,
        )


def leaning(rows: Array) -> Array:
    """Angle in rad between disk and table in samples.

    It is negative where beta lies outside (0, pi), by whole turns if a run has failed.
    """
    tilts = rows[..., BETA]
    return np.minimum(tilts, pi - tilts)


def _upright(rows: Array) -> int:
    """Number of samples before the first in which the disk lies flat."""
    return int(np.argmin(np.append(leaning(rows) >= LEAST_TILT, False)))


def _paper_state(row: Array) -> PaperState:
    values = row.tolist()
    return None if leaning(row) < LEAST_TILT else (values[PLACE], values[RATES])


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _failed(failure: EngineError, moments: Array, values: Array) -> EngineError | FlatError:
    """What to say of a run that broke off."""
    tilt = float(values[-1, BETA])
    if abs(sin(tilt)) >= NEARLY_FLAT:
        return failure
    text = f"{failure}; the disk lies nearly flat, at beta = {tilt:.3g} rad"
    return FlatError(text, float(moments[-1]))
