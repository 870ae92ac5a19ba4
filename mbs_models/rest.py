"""Engine runs of scenes with a rounded rim, until an event says that the disk lies still."""

from collections.abc import Callable
from math import hypot, sqrt
from typing import Any

import exudyn as exu
import numpy as np

from analysis import frames
from analysis.checks import Array, positive
from analysis.contact import PenaltyContact
from analysis.dissipation import CAUSES, RestCriterion
from analysis.limits import check_storage
from analysis.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.trajectory import versions
from mbs_models.effort import rest_effort
from mbs_models.floating import FloatingLie
from mbs_models.loads import Loads
from mbs_models.quiet import quiet
from mbs_models.runs import EngineError
from mbs_models.scene import Scene

STRETCH = 0.1
"""Longest time in s after which the step is chosen anew and rest is looked for."""

SAFETY = 0.6
"""Part of the predicted stability limit that a step may use."""

STAGE_WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
"""Weights of the stages of the classical Runge-Kutta method of order 4."""


def simulate_to_rest(
    scene: Scene,
    end: float,
    *,
    step: float | None = None,
    spacing: float = 2e-3,
    criterion: RestCriterion | None = None,
    progress: Callable[[float], None] | None = None,
) -> SpatialMotion:
    """Simulate a scene in the engine until the disk rests, or until `end`.

    The engine's explicit Runge-Kutta method of order 4 runs on the Lie group. Its step is cut
    where rolling resistance makes a nearly flat disk stiff.

    Parameters
    ----------
    scene : Scene
        Of formulation "floating-lie" and with a rounded rim, such as `Scene.rest` makes.
    end : float
        Longest time in s.
    step : float, optional
        Largest step in s; by default a part of the predicted stability limit.
    spacing : float
        Time between samples in s.
    criterion : RestCriterion, optional
    progress : callable, optional
        Called now and then with the time in s that the motion has reached.

    Returns
    -------
    SpatialMotion
        The energy taken by each cause is integrated with the weights of the engine's stages.

    Raises
    ------
    ValueError
        If an argument is out of range, the scene does not last until the disk lies flat, the
        step is too large for the contact's stiffness, or the run would take more than
        `MOST_STEPS` or samples than can be held.
    EngineError
        If the engine does not reach the end.
    """
    end, spacing = positive("end", end), positive("spacing", spacing)
    if spacing > end:
        raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
    contact = _rounded_contact(scene)
    limit = largest_step(scene)
    step = SAFETY * limit if step is None else positive("step", step)
    if step > limit:
        raise ValueError(
            f"step must not exceed {limit:.3g} s, the predicted stability limit at stiffness "
            f"{contact.stiffness:g}, damping {contact.damping:g} and friction gradient "
            f"{scene.friction.coefficient / scene.friction.smoothing:g}, got {step:g}"
        )
    check_storage("end", end / spacing, MOTION_COLUMNS)
    rest_effort(scene, end, step).check()
    criterion = criterion if criterion is not None else RestCriterion()
    run = _Run(scene, spacing)
    count = int(np.floor(end / spacing + 1e-9))
    stretch = max(1, round(STRETCH / spacing))
    still = None
    while still is None and run.done < count:
        run.advance(min(stretch, count - run.done), step)
        still = run.rest_after(criterion)
        if progress is not None:
            progress(run.done * spacing)
    last = count if still is None else still + criterion.samples(spacing) - 1
    return _motion(scene, run, last + 1, (step, still))


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
    disk, contact, loss = scene.disk, _rounded_contact(scene), scene.dissipation
    inertia = min(disk.inertia_about_cog[:2])
    # The contact point of a disk leaning low carries the least mass.
    mobility = 1.0 / disk.mass + (disk.radius + disk.eccentricity) ** 2 / inertia
    frequency = sqrt(contact.stiffness * mobility)
    slope = loss.rolling_viscous + loss.rolling_dry / loss.rolling_smoothing
    reach = disk.radius**2 / hypot(disk.radius * leaning, contact.half_thickness)
    decay = max(
        contact.damping * mobility,
        scene.friction.coefficient * disk.weight / scene.friction.smoothing * mobility,
        slope * disk.weight * reach**2 / inertia,
    )
    # Stability limits of the method along the imaginary and the negative real axis.
    return min(2.8 / frequency, 2.7 / decay) if decay else 2.8 / frequency


def _rounded_contact(scene: Scene) -> PenaltyContact:
    if scene.contact is None:
        raise ValueError("scene must have a penalty contact, got contact None")
    if not scene.contact.is_rounded:
        raise ValueError(
            "half_thickness must be positive, since only then the contact is defined when the "
            "disk lies flat, got 0"
        )
    if scene.formulation != "floating-lie":
        raise ValueError(
            "scene must be of formulation 'floating-lie', which the explicit integrator of this "
            f"run can take, got {scene.formulation!r}"
        )
    return scene.contact


class _Run:
    """A run in stretches.

    Attributes
    ----------
    done, steps : int
        Sampling intervals and steps behind it.
    taken : list of 6 floats
        Energy in J taken so far by each of `CAUSES`.
    records : list of ndarray, each shape (n, 24)
        Position of G, rotation, velocity, angular velocity and energy taken.
    """

    def __init__(self, scene: Scene, spacing: float) -> None:
        self.scene, self.spacing, self.done, self.steps = scene, spacing, 0, 0
        self.taken = [0.0] * len(CAUSES)
        self._step, self._calls = 0.0, 0
        self._model = FloatingLie(scene)
        self._model.count_work = self._count_work
        self._sensor = self._model.add_sensor(self._record)
        self.records: list[Array] = [self._record()[None]]

    def _record(self) -> Array:
        return np.concatenate((self._model.record(), self.taken))

    def _count_work(self, powers: list[float]) -> None:
        """Add the work of one stage of a step.

        The engine evaluates the loads once a stage; `advance` checks that. An engine variable of
        order 1 would see the powers of the stage before.
        """
        part = self._step * STAGE_WEIGHTS[self._calls % len(STAGE_WEIGHTS)]
        self._calls += 1
        for cause, power in enumerate(powers):
            if power:
                self.taken[cause] += part * power

    def advance(self, intervals: int, step: float) -> None:
        """Run over so many sampling intervals."""
        leaning = float(np.hypot(*self.records[-1][-1, [5, 8]]))
        step = min(step, SAFETY * largest_step(self.scene, 0.5 * leaning))
        substeps = int(np.ceil(self.spacing / step - 1e-9))
        settings = _settings(self.done * self.spacing, intervals * self.spacing)
        settings.timeIntegration.numberOfSteps = intervals * substeps
        settings.solution.sensors.writePeriod = self.spacing
        system: Any = self._model.system
        self._step = self.spacing / substeps
        self._calls = 0
        try:
            with quiet():
                system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
        except exu.ExudynError as error:
            cause = str(error).strip().splitlines()[0]
            raise EngineError(
                f"engine run stopped after t = {self._time:.6g} s: {cause}"
            ) from error
        stored = np.array(system.GetSensorStoredData(self._sensor))[:, 1:]
        if len(stored) != intervals + 1 or not np.all(np.isfinite(stored)):
            raise EngineError(f"engine run stopped after t = {self._time:.6g} s")
        if self._calls != len(STAGE_WEIGHTS) * intervals * substeps:
            raise EngineError(
                f"the engine evaluated the loads {self._calls} times in "
                f"{intervals * substeps} steps of {len(STAGE_WEIGHTS)} stages"
            )
        data = system.systemData
        data.SetSystemState(
            data.GetSystemState(exu.ConfigurationType.Current), exu.ConfigurationType.Initial
        )
        self.records.append(stored[1:])
        self.done += intervals
        self.steps += intervals * substeps

    @property
    def _time(self) -> float:
        return self.done * self.spacing

    def rest_after(self, criterion: RestCriterion) -> int | None:
        """Index of the first sample at rest, seen from the last stretches."""
        needed = criterion.samples(self.spacing)
        recent: list[Array] = []
        number = 0
        for block in reversed(self.records):
            recent.insert(0, block)
            number += len(block)
            if number >= needed + len(self.records[-1]):
                break
        records = np.concatenate(recent)
        found = criterion.first(
            kinetic_energy(self.scene, records),
            records[:, 2] + self.scene.disk.eccentricity * records[:, 9],
            self.spacing,
        )
        return None if found is None else self.done + 1 - number + found


def _settings(begin: float, duration: float) -> Any:
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.startTime = begin
    time.endTime = begin + duration
    time.verboseMode = 0
    time.adaptiveStep = False
    # One evaluation per stage and no more: the work is counted by them.
    time.explicit.computeEndOfStepAccelerations = False
    settings.solution.file.write = False
    return settings


def kinetic_energy(scene: Scene, records: Array) -> Array:
    """Kinetic energy in J, shape (n,), from records of `_Run`, shape (n, 24)."""
    disk = scene.disk
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    v, w = records[:, 12:15], records[:, 15:18]
    local = np.einsum("nij,ni->nj", rotation, w)
    about_centre = local**2 @ (disk.inertia_x, disk.inertia_y, disk.inertia_z)
    arm = disk.eccentricity * rotation[:, :, 0]
    coupling = 2.0 * np.sum(v * np.cross(w, arm), axis=1)
    result: Array = 0.5 * (about_centre + disk.mass * (np.sum(v * v, axis=1) + coupling))
    return result


def _motion(
    scene: Scene, run: _Run, count: int, outcome: tuple[float, int | None]
) -> SpatialMotion:
    step, still = outcome
    records = np.concatenate(run.records)[:count]
    times: Array = np.arange(count, dtype=float) * run.spacing
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    loads = Loads(scene.disk, scene.friction, _rounded_contact(scene), scene.dissipation)
    rows = []
    for record in records.tolist():
        axis = (record[5], record[8], record[11])
        angular = (record[15], record[16], record[17])
        load = loads.at(record[2], axis, (record[12], record[13], record[14]), angular)
        contour = hypot(*loads.contour(axis, angular, load.point))
        rows.append((*load.point, load.slip, contour, load.force[2], load.elastic))
    values = np.array(rows)
    height = records[:, 2] + scene.disk.eccentricity * rotation[:, 2, 0]
    return SpatialMotion(
        times=times,
        positions=records[:, :3],
        quaternions=frames.quaternions(rotation),
        velocities=records[:, 12:15],
        angular_velocities=records[:, 15:18],
        contact_points=records[:, :3] + values[:, :3],
        slip_speeds=values[:, 3],
        contour_speeds=values[:, 4],
        normal_force=values[:, 5],
        energies=np.column_stack(
            (kinetic_energy(scene, records), scene.disk.weight * height, values[:, 6])
        ),
        dissipated=records[:, 18:],
        disk=scene.disk,
        friction=scene.friction,
        contact=_rounded_contact(scene),
        dissipation=scene.dissipation,
        source="engine",
        rest_time=None if still is None else float(times[still]),
        method={"integrator": "RK44", "step": step},
        counts={"steps": run.steps},
        versions=versions("numpy", "exudyn"),
    )
