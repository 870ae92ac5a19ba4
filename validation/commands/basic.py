"""What the subcommands of the command line do; each returns the exit code."""

import argparse

import numpy as np

from analysis import multiplier_names
from analysis.data.limits import check_storage
from analysis.stability.unstable_start import unstable_start
from validation.commands.options import announce, chosen_end, output_folder
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import progress_bar
from validation.run import run, run_effort, single_run


def report(options: argparse.Namespace) -> int:
    """Write the report and print its verdicts and checks."""
    from validation.kit.verdicts import verdicts
    from validation.studies import full_report

    page, sections = full_report.make(output_folder("--out", options.out), only=options.only)
    tables = [table for section in sections for table in section.tables]
    print(verdicts(sections))
    if options.verbose:
        for table in tables:
            if not table.file_only:
                print(f"\n{table.title}\n{table.to_text()}")
    failed = sum(table.checks().count(False) for table in tables)
    print(f"\n{'All checks hold' if not failed else f'{failed} checks FAIL'}. Open {page}")
    return 0 if not failed else 1


def _check_integrator(options: argparse.Namespace) -> None:
    """Refuse an integrator that takes no --local-tolerance, which would go unused."""
    if None in {options.integrator, options.local_tolerance} or options.source != "engine":
        return
    if options.integrator != "DOPRI5":
        raise ValueError(
            "--integrator must be DOPRI5 with --local-tolerance, since the others keep their "
            f"step, got {options.integrator!r}"
        )


def simulate(options: argparse.Namespace) -> int:
    """Simulate a scenario and store the motion."""
    if options.samples < 2:
        raise ValueError(f"--samples must be at least 2, got {options.samples}")
    if options.step is not None and options.source == "in-house":
        raise ValueError("--step needs --source engine; the in-house solvers choose theirs")
    scenario = chosen_scenario(options)
    # Time, six coordinates, their rates and the constraint forces.
    columns = 13 + len(multiplier_names(scenario.constraints))
    check_storage("--samples", options.samples, columns)
    times = np.linspace(0.0, chosen_end(options), options.samples)
    _check_integrator(options)
    how = {
        "source": options.source,
        "formulation": options.formulation,
        "tolerance": options.tolerance,
        "step": options.step,
        "integrator": options.integrator,
        "method": options.method,
        **single_run(options.source, options.local_tolerance),
    }
    announce("simulate", run_effort(scenario, times, **how), options.time_limit)
    with progress_bar() as progress:
        trajectory = run(
            scenario,
            times,
            **how,
            stop_when=options.stop_when,
            allow_pulling=options.allow_pulling,
            time_limit=options.time_limit,
            progress=progress,
        )
    trajectory.save(options.out)
    estimate = trajectory.error_estimate
    accuracy = "" if estimate is None else f", estimated error {estimate:.1e} rad"
    print(f"{options.out}: {trajectory.times.size} samples of {scenario.name}{accuracy}")
    if warning := unstable_start(scenario):
        print(warning)
    if trajectory.ending is not None:
        print(f"{trajectory.ending}")
    for first, last in trajectory.pulling:
        print(f"the contact pulls from t = {first:.6g} s to {last:.6g} s")
    return 0
