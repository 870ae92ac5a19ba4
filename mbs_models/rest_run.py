"""Engine runs of a disk with a rounded rim, in stretches, until it is at rest."""

from collections.abc import Mapping
from dataclasses import replace
from math import sqrt
from typing import Any

import exudyn as exu
import numpy as np

from analysis.data.body import Body
from analysis.data.checks import Array, TimeLimitError
from analysis.data.contact import PenaltyContact
from analysis.data.dissipation import CAUSES, RestCriterion
from analysis.data.endings import Condition, Ending, Poses, ending_met, first_met
from analysis.data.trajectory import Setting
from analysis.data.watch import Watch
from mbs_models.body_contact import largest_lever
from mbs_models.floating import FloatingWithLosses
from mbs_models.runs import EngineError, StepLimiter
from mbs_models.scene import Scene
from mbs_models.solving import Ended, solving

STRETCH = 0.1
"""Longest time in s after which a fixed step is chosen anew and rest is looked for."""

SAFETY = 0.6
"""Part of the predicted stability limit that a fixed step may use."""

FIRST_STEP = 1e-5
"""Step in s with which step control begins a stretch."""

MINIMUM_STEP = 1e-13
"""Step in s at which step control gives up; it needs short ones where a damper's force sets in."""

PARTS = 16
"""Of the time between two samples, at which conditions are asked where one has turned negative."""

LOOK = 100
"""Steps after which step control looks at the time."""


_INITIAL = exu.ConfigurationType.Initial


def largest_step(scene: Scene, leaning: float = 1.0) -> float:
    """Step in s above which explicit Runge-Kutta runs of order 4 are predicted to diverge.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    leaning : float
        Sine of the smallest inclination, 0 flat. The lower the disk leans, the more a rolling
        resistance on the fast contour brakes its turning.

    Returns
    -------
    float
        The least of three limits: of the contact's spring and damper, of sliding friction at no
        slip, and of the rolling resistance.

    Raises
    ------
    ValueError
        If the scene has no rounded rim.
    """
    scenario, contact = scene.scenario, rounded_contact(scene)
    disk, loss, weight = scenario.disk, scenario.dissipation, scenario.weight
    frequency = sqrt(contact.stiffness * disk.contact_mobility)
    slope = loss.rolling_viscous + loss.rolling_dry / loss.rolling_smoothing
    reach = largest_lever(disk, leaning, contact.half_thickness)
    decay = max(
        contact.damping * disk.contact_mobility,
        scenario.slip_decay,
        slope * weight * reach**2 / disk.least_moment,
    )
    # Stability limits of the method along the imaginary and the negative real axis.
    return min(2.8 / frequency, 2.7 / decay) if decay else 2.8 / frequency


def rounded_contact(scene: Scene) -> PenaltyContact:
    """Contact of a scene that lasts until the disk lies flat; `ValueError` for another scene."""
    contact = scene.scenario.contact
    if contact is None:
        raise ValueError("scene must have a penalty contact, got contact None")
    if not scene.scenario.is_smooth:
        raise ValueError(
            "half_thickness must be positive, since only then the contact is defined when the "
            "disk lies flat, got 0"
        )
    if scene.has_constraints:
        raise ValueError(
            "scene must be of formulation 'floating-lie', which the explicit integrator of this "
            f"run can take, got {scene.built_as!r}"
        )
    return contact


class RestRun:
    """A run in stretches, with a fixed step or under step control.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    spacing : float
        Time between samples in s.
    watch : Watch
        Ends the run, within a stretch only under step control.
    step : float, optional
        Largest step in s of the Runge-Kutta method of order 4. It is cut where rolling
        resistance makes a nearly flat disk stiff.
    local_tolerance : float, optional
        Error that step control of Dormand and Prince's method of order 5 allows in a step, in m,
        rad, m/s, rad/s and parts of weight times radius. One of the two is given.

    Attributes
    ----------
    done : int
        Sampling intervals behind it.
    is_over : bool
        Whether the watch has ended it.
    counts : dict
        Work done.
    """

    def __init__(
        self,
        scene: Scene,
        spacing: float,
        watch: Watch,
        *,
        step: float | None = None,
        local_tolerance: float | None = None,
    ) -> None:
        self.scene, self.spacing, self.done, self.is_over = scene, spacing, 0, False
        self.counts = {"steps": 0, "rejected_steps": 0}
        self._watch, self._step, self._local_tolerance = watch, step, local_tolerance
        self._end, self._calls = 0.0, 0
        self._is_locating = False
        self._stopped: Ending | None = None
        self._model = FloatingWithLosses(scene.scenario)
        self._limiter = StepLimiter(spacing, MINIMUM_STEP)
        if step is None:
            self._model.system.SetPreStepUserFunction(self._before_step)
        self._records: list[Array] = [self._model.record()[None]]

    def until_rest(
        self, count: int, criterion: RestCriterion, conditions: Mapping[str, Condition]
    ) -> int | None:
        """Run over so many sampling intervals; number of the sample at which rest began.

        It ends earlier where a condition turns negative, or where the watch ends it.
        """
        self._end = count * self.spacing
        stretch = max(1, round(STRETCH / self.spacing))
        still = None
        while still is None and self.done < count and not self.is_over:
            begin = self._state(_INITIAL)
            self._advance(min(stretch, count - self.done))
            self._stopped = self._met(begin, conditions)
            if self._stopped is not None:
                break
            self.is_over |= self._watch.is_over(self._time, self._end) and self.done < count
            still = self._rest(criterion)
        return still

    @property
    def times(self) -> Array:
        """Times of the records in s, shape (n,)."""
        found: Array = np.arange(sum(map(len, self._records)), dtype=float) * self.spacing
        if self._stopped is not None:
            found[-1] = self._stopped.time
        return found

    @property
    def method(self) -> dict[str, Setting]:
        """How it was made."""
        if self._step is not None:
            return {"integrator": "RK44", "step": self._step}
        return {"integrator": "DOPRI5", "local_tolerance": self._local_tolerance}

    @property
    def ending(self) -> Ending | None:
        """Why it ended early, if it did."""
        if self._stopped is not None:
            return self._stopped
        if not self.is_over:
            return None
        if self.done == 0:
            raise TimeLimitError(
                f"time limit met after {self._watch.seconds:.3g} s of processor time, before "
                "the first sample"
            )
        return Ending(reason="time limit", time=self._time, value=self._watch.seconds)

    @property
    def records(self) -> Array:
        """Position of G, rotation, velocity, angular velocity and energy taken, shape (n, 24)."""
        units = np.repeat((1.0, self._model.unit), (18, len(CAUSES)))
        result: Array = np.concatenate(self._records) * units
        return result

    def _before_step(self, system: Any, moment: float) -> bool:
        """Limit the step, and end the run where its time is over."""
        self._calls += 1
        is_due = self._calls % LOOK == 0 and not self._is_locating
        if is_due and self._watch.is_over(moment, self._end):
            self.is_over = True
            raise Ended("time limit")
        return self._limiter.limit(system, moment)

    def _advance(self, intervals: int) -> None:
        """Run over so many sampling intervals, unless the watch ends the run on the way."""
        stored = self._solved(intervals, self.spacing, self._time)
        if stored is not None:
            self._go_on_from(self._state(exu.ConfigurationType.Current))
            self._records.append(stored)
            self.done += intervals

    def _solved(self, intervals: int, spacing: float, begin: float) -> Array | None:
        """Samples behind a time in s, by a run from the initial state; None if it was ended."""
        system: Any = self._model.system
        solver = exu.DynamicSolverType
        try:
            with solving(system):
                system.SolveDynamic(
                    self._settings(intervals, spacing, begin),
                    solverType=solver.DOPRI5 if self._step is None else solver.RK44,
                )
        except exu.ExudynError as error:
            if self.is_over:
                return None
            cause = str(error).strip().splitlines()[0]
            if self._limiter.stalled:
                cause = f"step control came down to its minimum step of {MINIMUM_STEP:g} s"
            raise EngineError(
                f"engine run stopped after t = {self._time:.6g} s: {cause}"
            ) from error
        _, stored = self._model.samples()
        if len(stored) != intervals + 1 or not np.all(np.isfinite(stored)):
            raise EngineError(f"engine run stopped after t = {self._time:.6g} s")
        iteration = system.sys["dynamicSolver"].it
        # The engine's index is that of the step to come.
        self.counts["steps"] += int(iteration.currentStepIndex) - 1
        self.counts["rejected_steps"] += int(iteration.rejectedAutomaticStepSizeSteps)
        found: Array = stored[1:]
        return found

    def _state(self, configuration: Any) -> list[Array]:
        data = self._model.system.systemData
        return [np.array(each) for each in data.GetSystemState(configuration)]

    def _go_on_from(self, state: list[Array]) -> None:
        self._model.system.systemData.SetSystemState(state, _INITIAL)

    def _settings(self, intervals: int, spacing: float, begin: float) -> Any:
        settings = exu.SimulationSettings()
        time = settings.timeIntegration
        time.startTime = begin
        time.endTime = begin + intervals * spacing
        time.numberOfSteps = intervals
        time.verboseMode = 0
        time.adaptiveStep = False
        time.automaticStepSize = self._step is None
        if self._step is not None:
            leaning = float(np.hypot(*self._records[-1][-1, [5, 8]]))
            step = min(self._step, SAFETY * largest_step(self.scene, 0.5 * leaning))
            time.numberOfSteps *= int(np.ceil(spacing / step - 1e-9))
        else:
            time.absoluteTolerance = self._local_tolerance
            # The engine scales it with signed coordinates, so that it may cancel the other.
            time.relativeTolerance = 0.0
            time.minimumStepSize = MINIMUM_STEP
            time.initialStepSize = min(FIRST_STEP, spacing)
        # Nothing reads them, and the next step's first stage computes them anyway.
        time.explicit.computeEndOfStepAccelerations = False
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = spacing
        return settings

    @property
    def _time(self) -> float:
        return self.done * self.spacing

    def _met(self, begin: list[Array], conditions: Mapping[str, Condition]) -> Ending | None:
        """Ending in the last stretch by a condition; the records then end there.

        Parameters
        ----------
        begin : list of ndarray
            State of the engine at the beginning of the stretch.
        conditions : mapping
        """
        if not conditions or len(self._records) < 2:
            return None
        records = np.concatenate((self._records[-2][-1:], self._records[-1]))
        met = first_met(conditions, *_poses(records))
        if met is None:
            return None
        self._is_locating = True
        begun = self._time - len(self._records[-1]) * self.spacing
        state = self._state_after(begin, met.before, self.spacing, begun)
        since, record = begun + met.before * self.spacing, records[met.before]
        width, part = (met.row - met.before) * self.spacing, self.spacing / PARTS
        finer = np.vstack((record, self._short_run(state, width, round(width / part))))
        closer = first_met(conditions, *_poses(finer))
        if closer is not None:
            state = self._state_after(state, closer.before, part, 0.0)
            since, record = since + closer.before * part, finer[closer.before]
            width = (closer.row - closer.before) * part

        def after(moment: float) -> Array:
            return self._short_run(state, moment, 1) if moment else record[None]

        ending = ending_met(conditions, lambda moment: _poses(after(moment)), 0.0, width)
        last, time = after(ending.time), since + ending.time
        whole = np.concatenate(self._records)
        self._records = [whole[np.arange(len(whole)) * self.spacing < time], last]
        return replace(ending, time=time)

    def _state_after(
        self, state: list[Array], count: int, spacing: float, begin: float
    ) -> list[Array]:
        """State so many intervals after another: the same steps lead to it again."""
        if not count:
            return state
        self._go_on_from(state)
        self._solved(count, spacing, begin)
        return self._state(exu.ConfigurationType.Current)

    def _short_run(self, state: list[Array], duration: float, intervals: int) -> Array:
        """Records behind a state, in so many intervals."""
        self._go_on_from(state)
        self._limiter = StepLimiter(duration / intervals, MINIMUM_STEP)
        found = self._solved(intervals, duration / intervals, 0.0)
        assert found is not None
        return found

    def _rest(self, criterion: RestCriterion) -> int | None:
        """Number of the first sample at rest, seen from the last stretches."""
        needed = criterion.samples(self.spacing)
        recent: list[Array] = []
        number = 0
        for block in reversed(self._records):
            recent.insert(0, block)
            number += len(block)
            if number >= needed + len(self._records[-1]):
                break
        records = np.concatenate(recent)
        scenario = self.scene.scenario
        disk = scenario.disk
        height = records[:, 2] + disk.eccentricity * records[:, 9]
        rise = height - rounded_contact(self.scene).resting_height(disk, scenario.weight)
        found = criterion.first(kinetic_energy(disk, records), rise, self.spacing)
        return None if found is None else self.done + 1 - number + found


def _poses(records: Array) -> Poses:
    place, rotation, velocity, angular = np.split(records[:, :18], (3, 12, 15), axis=1)
    return Poses(place, rotation.reshape(-1, 3, 3), velocity, angular)


def kinetic_energy(disk: Body, records: Array) -> Array:
    """Kinetic energy in J, shape (n,), from records of `RestRun`, shape (n, 24)."""
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    v, w = records[:, 12:15], records[:, 15:18]
    local = np.einsum("nij,ni->nj", rotation, w)
    about_centre = np.einsum("ni,ij,nj->n", local, disk.tensor, local)
    arm = disk.eccentricity * rotation[:, :, 0]
    coupling = 2.0 * np.sum(v * np.cross(w, arm), axis=1)
    result: Array = 0.5 * (about_centre + disk.mass * (np.sum(v * v, axis=1) + coupling))
    return result
