"""Engine simulation of the disk until it lies still, to a tolerance or to a step size."""

from math import hypot
from typing import Any

import numpy as np

from analysis.data import frames
from analysis.data.agreement import until_agreement
from analysis.data.checks import Array, positive
from analysis.data.dissipation import RestCriterion
from analysis.data.endings import StopWhen
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.trajectory import Setting, versions
from analysis.data.watch import Progress
from analysis.solve.until_rest import RestCall
from mbs_models.body_contact import loads_of
from mbs_models.effort import rest_effort
from mbs_models.rest_run import (
    TAKEN,
    RestRun,
    kinetic_energy,
    largest_step,
    rounded_contact,
    spatial,
)
from mbs_models.scene import Scene
from mbs_models.solving import EngineError

LOCAL_PART, COARSEST = 1e-6, 1e-9
"""Part of the tolerance that the first run allows in a step, as the sum over a motion is larger;
and error in a step from which on two runs may agree by the longest step that both take."""


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

    Accuracy is asked for in one of two ways. With `tolerance`, the engine's accelerations are
    stepped by LSODA, whose steps grow short where the contact opens and closes, and the tolerance
    of a step is tightened tenfold until two runs agree. With `step`, there is a single run of
    fixed steps of the engine's RK44, and nobody looks at its error: it is of order 4 in the step
    while the contact stays closed, but each touch-down, where the damper's force sets in at once,
    leaves an error of the first order.

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
        negative there. They are not asked where the disk lies flat.
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
        If the engine does not reach the end, or fixed steps make more energy than there was.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> from mbs_models import Scene, simulate_to_rest
    >>> motion = simulate_to_rest(Scene(Scenario.rest(start=Start(spin=5.0))), 0.02)
    >>> motion.error_estimate < 1e-3
    True
    """
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    scene = Scene.of(scene)
    largest = largest_step(scene)
    call = RestCall(
        scene.scenario,
        end,
        spacing=spacing,
        criterion=criterion,
        stop_when=stop_when,
        time_limit=time_limit,
        progress=progress,
    )
    rest_effort(scene, end, step).check()
    runs = RestRun(scene, call)
    if step is not None:
        if step > largest:
            raise ValueError(_beyond(scene, step, largest))
        motion = _motion(scene, *runs.by_steps(step), {"integrator": "RK44", "step": step})
        if np.max(np.abs(motion.energy_residual)) > motion.energies[0].sum():
            raise EngineError(f"steps of {step:g} s are too long: the energy has exploded")
        return motion

    def run(local: float) -> SpatialMotion:
        method: dict[str, Setting] = {"integrator": "LSODA", "local_tolerance": local}
        return _motion(scene, *runs.by_accelerations(local), method)

    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    return until_agreement(run, min(LOCAL_PART * tolerance, COARSEST), tolerance)


def _beyond(scene: Scene, step: float, limit: float) -> str:
    contact = rounded_contact(scene)
    return (
        f"step must not exceed {limit:.3g} s, the predicted stability limit at stiffness "
        f"{contact.stiffness:g}, damping {contact.damping:g} and friction gradient "
        f"{scene.scenario.friction_gradient:g}, got {step:g}"
    )


def _motion(
    scene: Scene, states: Array, told: dict[str, Any], method: dict[str, Setting]
) -> SpatialMotion:
    """Motion over the samples of a run."""
    scenario = scene.scenario
    disk, loads = scenario.disk, loads_of(scenario, rounded_contact(scene))
    place, rotation, velocity, angular = spatial(states)
    rows, matrices = [], rotation.reshape(-1, 9)
    matrix: Any
    for height, matrix, v, w in zip(
        place[:, 2].tolist(),
        map(tuple, matrices.tolist()),
        velocity.tolist(),
        angular.tolist(),
        strict=True,
    ):
        load = loads.at(height, matrix, v, w)
        contour = hypot(*loads.contour(matrix, w, load.point))
        rows.append((*load.point, load.slip, contour, load.force[2], load.elastic))
    values = np.array(rows)
    cog = place + disk.eccentricity * rotation[:, :, 0]
    potential = -disk.mass * cog @ np.array(scenario.table.vector)
    return SpatialMotion(
        **told,
        positions=place,
        quaternions=frames.quaternions(rotation),
        velocities=velocity,
        angular_velocities=angular,
        contact_points=place + values[:, :3],
        slip_speeds=values[:, 3],
        contour_speeds=values[:, 4],
        normal_force=values[:, 5],
        energies=np.column_stack((kinetic_energy(disk, states), potential, values[:, 6])),
        dissipated=states[:, TAKEN],
        scenario=scenario,
        source="engine",
        method=method,
        versions=versions("numpy", "exudyn"),
    )
