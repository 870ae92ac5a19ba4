"""The command `simulate`."""

from typing import Annotated, Any

import numpy as np

from analysis import multiplier_names
from analysis.data.checks import whole
from analysis.data.limits import check_storage
from analysis.stability.unstable_start import unstable_start
from validation.commands.options import announce, checked_end
from validation.commands.output import Result, pictured
from validation.kit.progress import progress_bar
from validation.parser.kinds import AnyProblem, MotionOut
from validation.parser.options import Group
from validation.parser.runs import RunOptions
from validation.run import run, run_effort


def simulate(
    *,
    problem: AnyProblem,
    how: Annotated[dict[str, Any], Group(RunOptions)],
    end: float = 2.0,
    samples: int = 201,
    out: MotionOut = None,
) -> Result:
    """Simulate a scenario and store the motion.

    The file holds t (N,), q and u (N, 6) in the order x, y, z, alpha, beta, gamma of the co-
    rotating coordinates (m, rad, m/s, rad/s), normal_force (N,) in N, multipliers (N, k), and
    meta, a JSON string with the scenario, versions and the error estimate. The table of --csv has
    the samples.

    Parameters
    ----------
    end
        End of the simulation in s.
    samples
        Number of evenly spaced samples.
    out
        Store the motion, .npz or -.
    """
    whole("samples", samples, least=2)
    scenario = problem.scenario()
    # Time, six coordinates, their rates and the constraint forces.
    check_storage("samples", samples, 13 + len(multiplier_names(scenario.constraints)))
    times = np.linspace(0.0, checked_end(end), samples)
    announce("simulate", run_effort(scenario, times, **how), how.get("time_limit"))
    with progress_bar() as progress:
        motion = run(scenario, times, **how, progress=progress)
    if out is not None:
        motion.save(out)
    estimate = motion.error_estimate
    accuracy = "" if estimate is None else f", estimated error {estimate:.1e} rad"
    name = "in memory alone; --out stores it" if out is None else out
    notes = [f"{name}: {motion.times.size} samples of {scenario.name}{accuracy}"]
    if warning := unstable_start(scenario):
        notes.append(warning)
    if motion.ending is not None:
        notes.append(str(motion.ending))
    for first, last in motion.pulling:
        notes.append(f"the contact pulls from t = {first:.6g} s to {last:.6g} s")
    return Result(
        values={
            "samples": motion.times.size,
            "error_estimate": estimate,
            "inversion": motion.inversion.outcome,
            "inversion_time": motion.inversion_time,
            "ending": None if motion.ending is None else motion.ending.reason,
            "end": float(motion.times[-1]),
            "pulling": motion.pulling,
        },
        csv=motion.to_csv,
        draw=lambda: pictured([(scenario.name, motion)]),
        notes=notes,
    )
