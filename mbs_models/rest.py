"""Engine simulation of the disk until it lies still, to a tolerance or to a step size."""

import numpy as np

from analysis.data.dissipation import RestCriterion
from analysis.data.endings import StopWhen
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.watch import Progress
from analysis.solve.until_rest import until_agreement
from mbs_models.effort import rest_effort
from mbs_models.rest_run import EngineWay, largest_step
from mbs_models.scene import Scene
from mbs_models.solving import EngineError

COARSEST = 1e-9
"""Error in a step from which on two runs may agree by the longest step that both take."""


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
    scenario = scene.scenario
    way = EngineWay(
        scenario,
        end,
        spacing=spacing,
        criterion=criterion,
        stop_when=stop_when,
        time_limit=time_limit,
        progress=progress,
    )
    if scene.has_constraints:
        raise ValueError(
            "scene must be of formulation 'floating-lie', which the explicit integrator of this "
            f"run can take, got {scene.built_as!r}"
        )
    rest_effort(scene, end, step).check()
    if step is None:
        return until_agreement(way.by_accelerations, tolerance, COARSEST)
    if step > (largest := largest_step(scenario)):
        contact, gradient = scenario.penalty_contact, scenario.friction_gradient
        raise ValueError(
            f"step must not exceed {largest:.3g} s, the predicted stability limit at stiffness "
            f"{contact.stiffness:g}, damping {contact.damping:g} and friction gradient "
            f"{gradient:g}, got {step:g}"
        )
    motion = way.by_steps(step)
    if np.max(np.abs(motion.energy_residual)) > motion.energies[0].sum():
        raise EngineError(f"steps of {step:g} s are too long: the energy has exploded")
    return motion
