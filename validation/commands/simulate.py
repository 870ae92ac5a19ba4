"""What `tippedisk simulate` does."""

import argparse

import numpy as np

from analysis import multiplier_names
from analysis.data.checks import whole
from analysis.data.limits import check_storage
from analysis.stability.unstable_start import unstable_start
from validation.commands.options import announce, chosen_end, run_options
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario
from validation.commands.show import picture
from validation.kit.progress import progress_bar
from validation.run import run, run_effort


def simulate(options: argparse.Namespace) -> Result:
    """Simulate a scenario and store the motion."""
    whole("samples", options.samples, least=2)
    scenario = chosen_scenario(options)
    # Time, six coordinates, their rates and the constraint forces.
    columns = 13 + len(multiplier_names(scenario.constraints))
    check_storage("samples", options.samples, columns)
    times = np.linspace(0.0, chosen_end(options), options.samples)
    how = run_options(options)
    announce("simulate", run_effort(scenario, times, **how), options.time_limit)
    with progress_bar() as progress:
        motion = run(scenario, times, **how, progress=progress)
    if options.out is not None:
        motion.save(options.out)
    estimate = motion.error_estimate
    accuracy = "" if estimate is None else f", estimated error {estimate:.1e} rad"
    name = "in memory alone; --out stores it" if options.out is None else options.out
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
        draw=lambda: picture([(scenario.name, motion)]),
        notes=notes,
    )
