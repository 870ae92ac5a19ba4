"""Engine simulation of the disk until it lies still, to a tolerance or to a step size."""

from math import hypot
from typing import Any

import numpy as np

from analysis.data import frames
from analysis.data.agreement import until_agreement
from analysis.data.checks import instance, positive
from analysis.data.dissipation import RestCriterion
from analysis.data.endings import AT_REST, Ending, StopWhen, named_conditions
from analysis.data.friction import check_slipping
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.data.trajectory import versions
from analysis.data.watch import Progress, Watch
from mbs_models.body_contact import loads_of
from mbs_models.effort import rest_effort
from mbs_models.rest_run import SAFETY, RestRun, kinetic_energy, largest_step, rounded_contact
from mbs_models.scene import Scene

LOCAL_PART = 1e-4
"""Part of the tolerance that the first run allows in a step; the sum over a motion is larger."""


def simulate_to_rest(
    scene: Scene | Scenario,
    end: float,
    *,
    step: float | None = None,
    tolerance: float | None = None,
    spacing: float = 2e-3,
    criterion: RestCriterion | None = None,
    stop_when: StopWhen = (),
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> SpatialMotion:
    """Simulate a scene in the engine until the disk rests, or until `end`.

    Accuracy is asked for in one of two ways. With `tolerance`, the engine controls its steps,
    which grow short where the contact opens and closes, and the tolerance of a step is tightened
    tenfold until two runs agree. With `step`, there is a single run of fixed steps, and nobody
    looks at its error: it is of order 4 in the step while the contact stays closed, but each
    touch-down, where the damper's force sets in at once, leaves an error of the first order.

    Parameters
    ----------
    scene : Scene or Scenario
        Of formulation "floating-lie" and with a rounded rim, such as `Scene(Scenario.rest())`.
    end : float
        Longest time in s.
    step : float, optional
        Largest step in s. It is cut where rolling resistance makes a nearly flat disk stiff.
    tolerance : float, optional
        Largest error, see `SpatialMotion.deviation`, and by `error_at_ending` where a condition
        ends the run; 1e-3 if neither is given.
    spacing : float
        Time between samples in s.
    criterion : RestCriterion, optional
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there. They are asked at the samples, but not where the disk lies flat, and
        located by short runs from the sample before.
    time_limit : float, optional
        Processor time in s after which the motion is returned as far as it has come, with its
        `ending`.
    progress : callable, optional
        Called now and then with the time reached and `end`, anew for each run.

    Returns
    -------
    SpatialMotion
        With `error_estimate` if two runs could be compared: their whole difference.

    Raises
    ------
    ValueError
        If an argument is out of range, the scene does not last until the disk lies flat, the
        step is too large for the contact's stiffness, or the run would take more than
        `MOST_STEPS` or samples than can be held.
    ToleranceError
        If runs of ever shorter steps do not agree, as after impacts that a small change turns
        into another motion.
    TimeLimitError
        If the time limit is met before the first sample.
    EngineError
        If the engine does not reach the end.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> from mbs_models import Scene, simulate_to_rest
    >>> motion = simulate_to_rest(Scene(Scenario.rest(start=Start(spin=5.0))), 0.02)
    >>> motion.error_estimate < 1e-3
    True
    """
    end, spacing = positive("end", end), positive("spacing", spacing)
    step = None if step is None else positive("step", step)
    if spacing > end:
        raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    scene = Scene.of(scene)
    rounded_contact(scene)
    check_storage("end", end / spacing, MOTION_COLUMNS)
    rest_effort(scene, end, SAFETY * largest_step(scene) if step is None else step).check()
    check_slipping(scene.scenario.friction)
    watch = Watch(time_limit, progress)
    wanted = RestCriterion()
    if criterion is not None:
        wanted = instance("criterion", criterion, RestCriterion)
    conditions = named_conditions(stop_when, scene.scenario.initial_state)
    count = int(np.floor(end / spacing + 1e-9))

    def run(local: float | None) -> SpatialMotion:
        found = RestRun(scene, spacing, watch, step=step, local_tolerance=local)
        still = found.until_rest(count, wanted, conditions)
        size = len(found.times) if still is None else still + wanted.samples(spacing)
        return _motion(found, size, still)

    if step is not None:
        _check_step(scene, step)
        return run(None)
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    return until_agreement(run, LOCAL_PART * tolerance, tolerance)


def _check_step(scene: Scene, step: float) -> None:
    limit = largest_step(scene)
    if step > limit:
        raise ValueError(
            f"step must not exceed {limit:.3g} s, the predicted stability limit at stiffness "
            f"{rounded_contact(scene).stiffness:g}, damping {rounded_contact(scene).damping:g} "
            "and friction gradient "
            f"{scene.scenario.friction_gradient:g}, got {step:g}"
        )


def _motion(run: RestRun, count: int, still: int | None) -> SpatialMotion:
    """Motion over so many samples; at rest from the sample of number `still` on."""
    scenario = run.scene.scenario
    disk = scenario.disk
    records, times = run.records[:count], run.times[:count]
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    loads = loads_of(scenario, rounded_contact(run.scene))
    rows = []
    for record in records.tolist():
        matrix: Any = (*record[3:12],)
        angular = (record[15], record[16], record[17])
        load = loads.at(record[2], matrix, (record[12], record[13], record[14]), angular)
        contour = hypot(*loads.contour(matrix, angular, load.point))
        rows.append((*load.point, load.slip, contour, load.force[2], load.elastic))
    values = np.array(rows)
    cog = records[:, :3] + disk.eccentricity * rotation[:, :, 0]
    potential = -disk.mass * cog @ np.array(scenario.table.vector)
    kinetic = kinetic_energy(disk, records)
    ending = run.ending if still is None else None
    if still is not None:
        ending = Ending(reason=AT_REST, time=float(times[-1]), value=float(kinetic[-1]))
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
        energies=np.column_stack((kinetic, potential, values[:, 6])),
        dissipated=records[:, 18:],
        scenario=scenario,
        source="engine",
        rest_time=None if still is None else float(times[still]),
        method=run.method,
        counts=dict(run.counts),
        versions=versions("numpy", "exudyn"),
        ending=ending,
    )
