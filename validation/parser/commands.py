"""The subcommands: what each is called, takes and does."""

import argparse

from validation.parser.base import Commands
from validation.parser.groups import (
    FORMS,
    FORMULATIONS,
    INTEGRATORS,
    METHODS,
    MOTIONS,
    SYSTEMS,
    add_law_name,
    add_output,
    add_problem,
    add_scenario,
    add_source,
    add_stop_when,
)
from validation.parser.nonlinear import add_cycles, add_heteroclinic, add_passage
from validation.parser.paths import PICTURES, existing, table, writable
from validation.parser.sweeps import add_map, add_sweep

SECTIONS = (
    "modelled", "inversion", "claims", "crosscheck", "stability", "nonlinear",
    "rest", "maps", "work-precision", "robustness", "lean", "numbers",
)  # fmt: skip
"""Sections of the report."""

INVERSION = (
    "The disk is inverted from the first time at which its centre of gravity has risen to 90% of "
    "its largest height above the geometric centre and from which it stays above that centre for "
    "1 s; if the motion ends before, it is not decided."
)


def _report(commands: Commands) -> None:
    report = commands.add_parser(
        "report",
        help="run all checks and write them with the paper's figures to one HTML page",
        description="Run engine and in-house equations, compare them, and write one page of HTML "
        "with everything in it, the figures as PNG and SVG and the tables as CSV. What has been "
        "computed is kept in the folder: another call takes it as it is while the code behind it, "
        "the versions and the machine stay the same. " + INVERSION,
    )
    report.set_defaults(module="basic")
    report.add_argument(
        "--only",
        action="append",
        default=[],
        choices=SECTIONS,
        metavar="SECTION",
        help=f"make this section alone; may be given several times ({', '.join(SECTIONS)})",
    )
    report.add_argument(
        "--out", default="report", metavar="DIR", help="folder to write to (default: %(default)s)"
    )
    report.add_argument(
        "--verbose",
        action="store_true",
        help="print the tables of the page below the verdicts, too",
    )


def _simulate(commands: Commands) -> None:
    simulate = commands.add_parser(
        "simulate",
        help="simulate a scenario and store the motion",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Simulate a scenario and store the motion.\n\n"
        "The file holds t (N,), q and u (N, 6) in the order x, y, z, alpha, beta, gamma of the\n"
        "co-rotating coordinates (m, rad, m/s, rad/s), normal_force (N,) in N, multipliers\n"
        "(N, k), and meta, a JSON string with the scenario, versions and the error estimate.",
    )
    simulate.set_defaults(module="basic")
    add = simulate.add_argument
    add_source(simulate)
    add(
        "--formulation",
        choices=(*FORMULATIONS, *FORMS),
        help="engine: floating, floating-lie, euler-tree or contact-tree; in-house: index-1, "
        "reduced (Model 4) or free-body (with --stiffness); by default the most accurate",
    )
    add("--end", type=float, default=2.0, help="end of the simulation in s (2)")
    add("--samples", type=int, default=201, help="number of evenly spaced samples (201)")
    accuracy = simulate.add_mutually_exclusive_group()
    accuracy.add_argument(
        "--tolerance", type=float, help="largest error of beta and gamma in rad (1e-8)"
    )
    accuracy.add_argument("--step", type=float, help="engine only: fixed step in s instead")
    accuracy.add_argument(
        "--local-tolerance",
        type=float,
        help="of a single run whose solver controls its steps, in place of several that agree; no "
        "error is estimated; engine: DOPRI5, without constraints (Model 1)",
    )
    add(
        "--integrator",
        choices=INTEGRATORS,
        help="engine only: RK67, RK44, DOPRI5 without constraints; by default the most accurate",
    )
    add("--method", choices=METHODS, help="in-house only: solver (DOP853); taylor runs compiled")
    add_stop_when(simulate, "end the run there, at the exact time")
    add(
        "--allow-pulling",
        action="store_true",
        help="go on where the ideal contact would have to pull, instead of ending there; friction "
        "with the load weight still rubs under it, and with the load contact not at all",
    )
    add("--time-limit", type=float, help="processor time in s after which the run ends")
    add("--out", required=True, type=writable(".npz"), metavar="FILE", help="file to write, .npz")
    add_scenario(simulate)


def _show(commands: Commands) -> None:
    show = commands.add_parser(
        "show",
        help="say how far stored motions differ, and plot them over each other",
        description="Print in what stored motions differ besides their source, what each is and, "
        "for each but the first, how far its quantities are from those of the first; and plot "
        "inclination, rotation angle (with rest files: height of the centre of gravity), spin and "
        "normal force.",
    )
    show.set_defaults(module="show")
    show.add_argument(
        "files",
        nargs="+",
        type=existing(".npz"),
        metavar="FILE",
        help="files written by simulate or rest",
    )
    show.add_argument(
        "--out",
        type=writable(*PICTURES),
        metavar="PICTURE",
        help="write a .png, .svg or .pdf instead of opening a window",
    )
    show.add_argument(
        "--csv",
        type=table,
        metavar="FILE",
        help="write the differences, or the samples of a single motion, .csv or -; no window",
    )
    add_law_name(show)


def _scenario(commands: Commands) -> None:
    scenario = commands.add_parser(
        "scenario",
        help="print a problem as a commented file, to be changed and run",
        description="Print the whole problem as a TOML file, which says of every key what it is "
        "and what is allowed: the paper's; or that of a file or a stored run; with what the "
        "options change.",
    )
    scenario.set_defaults(module="scenario")
    scenario.add_argument(
        "--rest", action="store_true", help="start from the defaults of `tippedisk rest`"
    )
    add_scenario(scenario, file=True)


def _check(commands: Commands) -> None:
    check = commands.add_parser(
        "check",
        help="compare engine and in-house equations on a scenario of your own",
        description="Compare accelerations, trajectories and, where they are defined, "
        "eigenvalues of a scenario between the in-house equations and every formulation of the "
        "engine that can build it. Exit code 1 if they disagree.",
    )
    check.set_defaults(module="scenario")
    check.add_argument("--end", type=float, default=2.0, help="of the motions in s, at most (2)")
    check.add_argument(
        "--states", type=int, default=100, help="random states for accelerations (100)"
    )
    add_scenario(check)


def _eigenvalues(commands: Commands) -> None:
    eigenvalues = commands.add_parser(
        "eigenvalues",
        help="eigenvalues of inverted and noninverted spinning",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Eigenvalues of the stationary spinning motions over the spin, in 1/s.\n\n"
        "full: the eight of Eq. (55), Model 1; reduced: the three of Eq. (111), Model 4;\n"
        "numeric: those of any constraints, linearised by dual numbers. With --source engine\n"
        "they come from the engine. Columns follow the branches.",
    )
    eigenvalues.set_defaults(module="stability")
    _add_system(eigenvalues)
    add = eigenvalues.add_argument
    add_source(eigenvalues, "in-house")
    add("--formulation", choices=FORMULATIONS, help="with --source engine: how it is built")
    add(
        "--spin",
        dest="spins",
        nargs="+",
        required=True,
        metavar="SPIN",
        help="spins in rad/s: values, or first:last:number",
    )
    add_output(eigenvalues)
    add_problem(eigenvalues)


def _critical(commands: Commands) -> None:
    critical = commands.add_parser(
        "critical",
        help="spins at which the spinning is stable, and at which eigenvalues cross",
        description="For each model the spins at which inverted spinning is stable, all of its "
        "eigenvalues together; then the spins at which one of them, or a pair, becomes stable or "
        "unstable, with its frequency, beside the closed form of the reduced system, Eq. (126).",
    )
    critical.set_defaults(module="stability")
    _add_system(critical)
    critical.add_argument(
        "--spin",
        dest="spins",
        default="0:60",
        metavar="FIRST:LAST",
        help="range in rad/s (default: %(default)s)",
    )
    add_output(critical)
    add_problem(critical)


def _scene(commands: Commands) -> None:
    scene = commands.add_parser(
        "scene",
        help="list what is in a scene of the engine, and why",
        description="List the nodes, objects, markers and sensors of a scene with the reason for "
        "each, and count its coordinates, constraints and user functions.",
    )
    scene.set_defaults(module="scene")
    scene.add_argument("--formulation", choices=FORMULATIONS, help="how the disk is built")
    add_scenario(scene)


def _work_precision(commands: Commands) -> None:
    study = commands.add_parser(
        "work-precision",
        help="measure error against run time of every formulation and integrator",
        description="Run every formulation with every integrator on ladders of steps or "
        f"tolerances and write diagrams, tables and the lesson to one page. {_KEPT}",
    )
    study.set_defaults(command="work_precision")
    _add_study(study, "work-precision")


def _robustness(commands: Commands) -> None:
    study = commands.add_parser(
        "robustness",
        help="numerical stability on stiff and extreme cases",
        description="Run a grid of hard cases in separate processes, classify each from its "
        f"measured error, drift and energy, and write tables and figures to one page. {_KEPT}",
    )
    _add_study(study, "robustness")


_KEPT = "An interrupted study goes on where it stopped."


def _add_study(study: argparse.ArgumentParser, folder: str) -> None:
    study.set_defaults(module="studies")
    add = study.add_argument
    add("--quick", action="store_true", help="a selection, about a minute")
    add("--out", default=folder, metavar="DIR", help="folder (default: %(default)s)")
    add("--fresh", action="store_true", help="run again what is kept")


def _rest(commands: Commands) -> None:
    rest = commands.add_parser(
        "rest",
        help="simulate the disk from the paper's start until it lies still",
        description="Simulate the disk on a stiff unilateral contact until it lies still, and "
        "print when each phase began and where the energy went. By default the rim is rounded, "
        "friction knows the contact force, and nothing but sliding friction and the contact's "
        "damper takes energy; then the disk does not lie flat. " + INVERSION,
    )
    rest.set_defaults(module="rest")
    add = rest.add_argument
    add_source(rest)
    add("--tolerance", type=float, help="largest error in rad and parts of the energy (1e-3)")
    add("--step", type=float, help="engine only: a single run of fixed steps in s instead")
    add_stop_when(rest, "end the run there, located between samples")
    add("--time-limit", type=float, help="processor time in s after which it ends as it is")
    add("--end", type=float, default=80.0, help="longest time in s (80)")
    add("--out", type=writable(".npz"), metavar="FILE", help="store the motion, .npz")
    add(
        "--plot",
        type=writable(*PICTURES),
        metavar="PICTURE",
        help="draw the story, .png, .svg or .pdf",
    )
    add_scenario(rest)


def _animate(commands: Commands) -> None:
    animate = commands.add_parser(
        "animate",
        help="turn a stored motion into a page that plays it, or a GIF",
        description="Write a page that plays a motion stored by simulate or rest, and needs no "
        "network; or, with --out FILE.gif, an animated picture.",
    )
    animate.set_defaults(module="animate")
    add = animate.add_argument
    add(
        "file",
        type=existing(".npz"),
        metavar="FILE",
        help="motion written by simulate or rest, .npz",
    )
    add(
        "--out",
        type=writable(".html", ".gif"),
        metavar="FILE",
        help=".html or .gif to write (default: FILE with .html)",
    )
    add("--begin", type=float, help="in s (default: that of the motion)")
    add("--end", type=float, help="in s (default: that of the motion)")
    add("--speed", type=float, help="1 for real time (default: 0.1 until the disk is inverted)")
    add("--fps", type=float, help="GIF only: frames per second (20)")
    add("--width", type=int, help="GIF only: width and height in pixels (480)")
    add_law_name(animate)


def _add_system(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--system",
        choices=SYSTEMS,
        help="full and reduced stand for Models 1 and 4, unless constraints are given; by default "
        "that of the constraints, numeric if there is none",
    )
    parser.add_argument(
        "--motion",
        choices=MOTIONS,
        default="inverted",
        help="centre of gravity above (default) or below the geometric centre",
    )


SUBCOMMANDS = (
    _report,
    _simulate,
    _show,
    _scenario,
    _check,
    add_sweep,
    add_map,
    _rest,
    _eigenvalues,
    _critical,
    add_cycles,
    add_heteroclinic,
    add_passage,
    _scene,
    _animate,
    _work_precision,
    _robustness,
)
"""In the order of the help."""
