"""What `tippedisk rest` does."""

import argparse
from dataclasses import fields
from pathlib import Path

from analysis import CAUSES, Dissipation, SpatialMotion
from analysis.data.checks import positive
from analysis.stability.unstable_start import unstable_start
from validation.commands.options import announce, chosen_end
from validation.commands.output import save
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import progress_bar
from validation.run import REST_SPACING, rest_effort, run_to_rest


def rest(options: argparse.Namespace) -> int:
    """Simulate the disk until it lies still, and print phases and energy budget."""
    motion = _simulate(options)
    if options.out is not None:
        motion.save(options.out)
    if options.plot is not None:
        _plot(motion, options.plot)
    phases = motion.phases
    for field in fields(phases):
        begin = getattr(phases, field.name)
        print(f"{field.name.replace('_', ' '):16s} {'-' if begin is None else f'{begin:.3f} s'}")
    if motion.inversion.outcome == "not decided":
        print("inversion not decided: the disk was up, and the motion ended too soon after")
    energies = motion.energies.sum(axis=1)
    print(f"energy           {energies[0]:.6f} J at first, {energies[-1]:.6f} J left")
    for cause, taken in zip(CAUSES, motion.dissipated[-1], strict=True):
        if taken:
            # Below the error it may come out negative; no -0.000000.
            print(f"  {cause.replace('_', ' '):14s} {round(taken, 6) + 0.0:.6f} J")
    _print_end(motion)
    return 0


def _print_end(motion: SpatialMotion) -> None:
    """How far the motion can be relied on, and why it ended."""
    if motion.error_estimate is None:
        print("error            not estimated; --tolerance does")
    else:
        print(f"estimated error  {motion.error_estimate:.1e} in rad and in parts of the energy")
    if warning := unstable_start(motion.scenario):
        print(warning)
    if motion.ending is not None:
        print(motion.ending)
    elif motion.phases.rest is None:
        print(
            f"not at rest after {motion.times[-1]:g} s, leaning by {motion.leaning[-1]:.4g} rad"
            + _lacking(motion.scenario.dissipation)
        )


def _lacking(losses: Dissipation) -> str:
    """What a disk needs that is to come to rest, and does not have."""
    needs = []
    if not losses.rolling_dry and not losses.rolling_viscous:
        needs.append("lying flat needs --rolling or --rolling-viscous")
    if not losses.pivoting:
        needs.append("lying still needs --pivoting")
    return "".join(f"; {each}" for each in needs)


def _simulate(options: argparse.Namespace) -> SpatialMotion:
    end = chosen_end(options, REST_SPACING)
    if options.source == "in-house" and options.step is not None:
        raise ValueError(
            "--step must be left out with --source in-house, which controls its steps by "
            f"--tolerance, got {options.step:g}"
        )
    step = None if options.step is None else positive("--step", options.step)
    scenario = chosen_scenario(options, rest=True)
    if scenario.contact is None:
        raise ValueError(
            "the way to rest needs a penalty contact, and the scenario's is ideal; give "
            "--stiffness and --half-thickness, or the table [contact]"
        )
    effort = rest_effort(scenario, end, source=options.source, step=step)
    announce("rest", effort, options.time_limit)
    with progress_bar() as progress:
        return run_to_rest(
            scenario,
            end,
            source=options.source,
            step=step,
            tolerance=options.tolerance,
            stop_when=options.stop_when or (),
            time_limit=options.time_limit,
            progress=progress,
        )


def _plot(motion: SpatialMotion, out: Path) -> None:
    from validation.kit import figures
    from validation.studies.rest.figures import draw_story

    figure, axes = figures.new_figure(5, height=11.0)
    draw_story(motion, axes)
    save(figure, out)
