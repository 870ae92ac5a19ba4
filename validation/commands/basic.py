"""What the subcommands of the command line do; each returns the exit code."""

import argparse
from pathlib import Path

import numpy as np

import analysis
from analysis import DISKS, Progress, Trajectory, multiplier_names
from analysis.data.checks import Array
from analysis.data.files import whole_file
from analysis.data.limits import check_storage
from analysis.models.effort import simulation_effort
from validation.commands.options import (
    PICTURES,
    announce,
    chosen_end,
    chosen_friction,
    chosen_start,
    output_folder,
    output_path,
)
from validation.kit.progress import progress_bar


def report(options: argparse.Namespace) -> int:
    """Write the report and print its checks."""
    from validation.studies import full_report

    page, tables = full_report.make(output_folder("--out", options.out))
    for table in tables:
        print(f"\n{table.title}\n{table.to_text()}")
    failed = sum(cell is False for table in tables for row in table.rows for cell in row)
    print(f"\n{'All checks hold' if not failed else f'{failed} checks FAIL'}. Open {page}")
    return 0 if not failed else 1


def simulate(options: argparse.Namespace) -> int:
    """Simulate one model and store the motion."""
    out = output_path("--out", options.out, (".npz",))
    if options.samples < 2:
        raise ValueError(f"--samples must be at least 2, got {options.samples}")
    # Time, six coordinates, their rates and the constraint forces.
    check_storage("--samples", options.samples, 13 + len(multiplier_names(options.model)))
    times = np.linspace(0.0, chosen_end(options), options.samples)
    with progress_bar() as progress:
        trajectory = _simulate(options, times, progress)
    trajectory.save(out)
    estimate = trajectory.error_estimate
    accuracy = "" if estimate is None else f", estimated error {estimate:.1e} rad"
    print(f"{out}: {trajectory.times.size} samples of Model {trajectory.level}{accuracy}")
    if trajectory.ending is not None:
        print(f"{trajectory.ending}")
    for first, last in trajectory.pulling:
        print(f"the contact pulls from t = {first:.6g} s to {last:.6g} s")
    return 0


def _simulate(options: argparse.Namespace, times: Array, progress: Progress) -> Trajectory:
    disk = DISKS[options.disk]
    friction = chosen_friction(options, options.load)
    start = chosen_start(options, options.model, disk)
    if options.source == "in-house":
        if options.step is not None:
            raise ValueError("--step needs --source engine; the in-house solvers choose theirs")
        effort = simulation_effort(times, disk, friction, start, tolerance=options.tolerance)
        announce("simulate", effort, options.time_limit)
        return analysis.simulate(
            options.model,
            times,
            disk=disk,
            friction=friction,
            start=start,
            form=options.formulation or "index-1",
            tolerance=options.tolerance,
            allow_pulling=options.allow_pulling,
            time_limit=options.time_limit,
            progress=progress,
        )
    import mbs_models
    from mbs_models.effort import simulation_effort as engine_effort

    scene = mbs_models.Scene(
        level=options.model,
        formulation=options.formulation,
        disk=disk,
        friction=friction,
        start=start,
    )
    effort = engine_effort(scene, times, step=options.step, tolerance=options.tolerance)
    announce("simulate", effort, options.time_limit)
    return mbs_models.simulate(
        scene,
        times,
        step=options.step,
        tolerance=options.tolerance,
        allow_pulling=options.allow_pulling,
        time_limit=options.time_limit,
        progress=progress,
    )


def show(options: argparse.Namespace) -> int:
    """Plot stored motions over each other."""
    runs = [(Path(name).stem, Trajectory.load(name)) for name in options.files]
    from validation.kit import figures

    if options.out is not None:
        out = output_path("--out", options.out, PICTURES)
        figure, axes = figures.new_figure(4, height=8.5)
        figures.comparison(runs, axes)
        with whole_file(out) as stream:
            figure.savefig(stream, format=out.suffix[1:], dpi=150)
        return 0
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() == "agg":
        raise ValueError("no screen to open a window on; give --out PICTURE")
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(7.5, 8.5), layout="constrained")
    figures.comparison(runs, axes)
    plt.show()
    return 0
