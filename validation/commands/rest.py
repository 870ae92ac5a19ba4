"""What `tippedisk rest` does."""

import argparse
from dataclasses import fields, replace
from pathlib import Path

from analysis import (
    CAUSES,
    DISKS,
    PenaltyContact,
    SpatialMotion,
    State,
    find_phases,
    judge_inversion,
    simulate_to_rest,
)
from analysis.data.checks import not_negative, positive
from analysis.data.files import whole_file
from analysis.models.effort import rest_effort
from validation.commands.options import (
    PICTURES,
    announce,
    chosen_dissipation,
    chosen_end,
    chosen_friction,
    chosen_start,
    output_path,
)
from validation.kit.progress import progress_bar


def rest(options: argparse.Namespace) -> int:
    """Simulate the disk until it lies still, and print phases and energy budget."""
    out = None if options.out is None else output_path("--out", options.out, (".npz",))
    plot = None if options.plot is None else output_path("--plot", options.plot, PICTURES)
    motion = _simulate(options)
    if out is not None:
        motion.save(out)
    if plot is not None:
        _plot(motion, plot)
    phases = find_phases(motion)
    for field in fields(phases):
        begin = getattr(phases, field.name)
        print(f"{field.name.replace('_', ' '):16s} {'-' if begin is None else f'{begin:.3f} s'}")
    if judge_inversion(motion).outcome == "not decided":
        print("inversion not decided: the disk was up, and the motion ended too soon after")
    energies = motion.energies.sum(axis=1)
    print(f"energy           {energies[0]:.6f} J at first, {energies[-1]:.6f} J left")
    for cause, taken in zip(CAUSES, motion.dissipated[-1], strict=True):
        if taken:
            # Below the error it may come out negative; no -0.000000.
            print(f"  {cause.replace('_', ' '):14s} {round(taken, 6) + 0.0:.6f} J")
    if motion.error_estimate is None:
        print("error            not estimated; --tolerance does")
    else:
        print(f"estimated error  {motion.error_estimate:.1e} in rad and in parts of the energy")
    if motion.ending is not None:
        print(motion.ending)
    elif phases.rest is None:
        print(
            f"not at rest after {motion.times[-1]:g} s, leaning by {motion.leaning[-1]:.4g} rad; "
            "lying flat needs --rolling or --rolling-viscous, lying still --pivoting"
        )
    return 0


def _simulate(options: argparse.Namespace) -> SpatialMotion:
    disk, end = DISKS[options.disk], chosen_end(options)
    if options.source == "in-house" and options.step is not None:
        raise ValueError(
            "--step must be left out with --source in-house, which controls its steps by "
            f"--tolerance, got {options.step:g}"
        )
    friction = chosen_friction(options, "contact")
    contact = PenaltyContact.rounded(
        disk, stiffness=options.stiffness, half_thickness=options.half_thickness
    )
    dissipation = chosen_dissipation(options)
    start = contact.lowered(disk, chosen_start(options, 1, disk))
    if not_negative("--height", options.height):
        start = _lifted(start, options.height + contact.resting_penetration(disk))
    if options.source == "in-house":
        announce("rest", rest_effort(end, disk, contact), options.time_limit)
    with progress_bar() as progress:
        if options.source == "in-house":
            return simulate_to_rest(
                end,
                disk=disk,
                friction=friction,
                contact=contact,
                dissipation=dissipation,
                start=start,
                tolerance=options.tolerance,
                time_limit=options.time_limit,
                progress=progress,
            )
        from mbs_models import Scene
        from mbs_models import simulate_to_rest as simulate_in_engine
        from mbs_models.effort import rest_effort as engine_effort
        from mbs_models.rest_run import SAFETY, largest_step

        scene = Scene.rest(
            disk=disk, friction=friction, contact=contact, dissipation=dissipation, start=start
        )
        step = SAFETY * largest_step(scene) if options.step is None else options.step
        effort = engine_effort(scene, end, positive("--step", step))
        announce("rest", effort, options.time_limit)
        return simulate_in_engine(
            scene,
            end,
            step=options.step,
            tolerance=options.tolerance,
            time_limit=options.time_limit,
            progress=progress,
        )


def _lifted(start: State, height: float) -> State:
    x, y, z, *angles = start.coordinates
    return replace(start, coordinates=(x, y, z + height, *angles))


def _plot(motion: SpatialMotion, out: Path) -> None:
    from validation.kit import figures
    from validation.studies.rest.figures import draw_story

    figure, axes = figures.new_figure(5, height=11.0)
    draw_story(motion, axes)
    with whole_file(out) as stream:
        figure.savefig(stream, format=out.suffix[1:], dpi=150)
