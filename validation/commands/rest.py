"""What `tippedisk rest` does."""

import argparse
from dataclasses import fields
from pathlib import Path

from tqdm import tqdm

from analysis import (
    CAUSES,
    DISKS,
    PenaltyContact,
    SmoothCoulomb,
    SpatialMotion,
    find_phases,
    simulate_to_rest,
)
from analysis.checks import positive
from analysis.effort import rest_effort
from analysis.files import whole_file
from validation.options import (
    PICTURES,
    announce,
    chosen_dissipation,
    chosen_end,
    chosen_start,
    output_path,
)


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
    energies = motion.energies.sum(axis=1)
    print(f"energy           {energies[0]:.6f} J at first, {energies[-1]:.6f} J left")
    for cause, taken in zip(CAUSES, motion.dissipated[-1], strict=True):
        if taken:
            print(f"  {cause.replace('_', ' '):14s} {taken:.6f} J")
    if phases.rest is None:
        print(
            f"not at rest after {motion.times[-1]:g} s, leaning by {motion.leaning[-1]:.4g} rad; "
            "lying flat needs --rolling or --rolling-viscous, lying still --pivoting"
        )
    return 0


def _simulate(options: argparse.Namespace) -> SpatialMotion:
    disk, end = DISKS[options.disk], chosen_end(options)
    friction = SmoothCoulomb(coefficient=options.mu, smoothing=options.eps, load="contact")
    contact = PenaltyContact.rounded(
        disk, stiffness=options.stiffness, half_thickness=options.half_thickness
    )
    dissipation = chosen_dissipation(options)
    start = contact.lowered(disk, chosen_start(options, 1, disk))
    if options.source == "in-house":
        announce("rest", rest_effort(end, disk, contact))
    with tqdm(total=end, disable=None, leave=False, unit="s", desc="simulated") as bar:

        def progress(time: float) -> None:
            bar.update(time - bar.n)

        if options.source == "in-house":
            return simulate_to_rest(
                end,
                disk=disk,
                friction=friction,
                contact=contact,
                dissipation=dissipation,
                start=start,
                progress=progress,
            )
        from mbs_models import Scene
        from mbs_models import simulate_to_rest as simulate_in_engine
        from mbs_models.effort import rest_effort as engine_effort
        from mbs_models.rest import SAFETY, largest_step

        scene = Scene.rest(
            disk=disk, friction=friction, contact=contact, dissipation=dissipation, start=start
        )
        step = SAFETY * largest_step(scene) if options.step is None else options.step
        announce("rest", engine_effort(scene, end, positive("--step", step)))
        return simulate_in_engine(scene, end, step=options.step, progress=progress)


def _plot(motion: SpatialMotion, out: Path) -> None:
    from validation import figures
    from validation.rest.figures import draw_story

    figure, axes = figures.new_figure(5, height=11.0)
    draw_story(motion, axes)
    with whole_file(out) as stream:
        figure.savefig(stream, format=out.suffix[1:], dpi=150)
