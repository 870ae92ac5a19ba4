"""The command line.

Importing this module and building the parser loads neither NumPy nor the engine, so that `--help`
and wrong calls answer at once; each subcommand imports what it needs when it runs.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout, suppress
from importlib import import_module
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from typing import NoReturn, TextIO

SOURCES = ("engine", "in-house")
MODELS = (1, 2, 3, 4)
FORMULATIONS = ("floating", "floating-lie", "euler-tree", "contact-tree", "index-1", "reduced")
LOADS = ("weight", "contact")
DISKS = ("steel", "steel-rounded")
SYSTEMS = ("full", "reduced", "model1", "model2", "model3", "model4")
MOTIONS = ("inverted", "noninverted")

INVERSION = (
    "The disk is inverted from the first time at which its centre of gravity has risen to 90% of "
    "its largest height above the geometric centre and from which it stays above that centre for "
    "1 s; if the motion ends before, it is not decided."
)

_DESCRIPTION = """\
The tippedisk: a rigid disk whose centre of gravity lies off its centre. Spun fast about an
in-plane axis on a table, it turns itself upside down through friction.

Models 1 to 4 each add a constraint: 1 the disk stays on the table, 2 its centre of gravity
stays above one point, 3 it does not slip along its edge, 4 its spin is constant. Each runs in
the multibody engine Exudyn (--source engine) and in independent in-house equations
(--source in-house).
"""

_EPILOG = """\
examples:
  tippedisk report                                   everything, as one page in ./report
  tippedisk simulate --model 1 --out engine.npz      the engine, from the paper's start
  tippedisk simulate --model 1 --source in-house --out equations.npz
  tippedisk show engine.npz equations.npz --out compare.png
  tippedisk eigenvalues --system full --spin 0:50:501 --plot figure-6.png
  tippedisk critical --system full                   where eigenvalues cross, where it is stable
  tippedisk rest --rolling 1e-3 --pivoting 5e-5 --plot rest.png
  tippedisk animate engine.npz                       a page that plays the motion

exit codes:
  0  done
  1  done, and a check fails
  2  wrong call or failed run; one line says what is allowed or what happened
  3  done, all files are written, but standard output could not be written to

`python -m validation` is the same command.
"""

_OPTION_OF = {
    "coefficient": "mu",
    "smoothing": "eps",
    "friction": "eps",
    "rolling_dry": "rolling",
    "interval": "spin",
    "spins": "spin",
}
"""Options that are called otherwise than the arguments they are handed on as."""

_OUTPUT_LOST = 3
"""Exit code of a command that did its work and could not say so."""


class _Parser(argparse.ArgumentParser):
    """Parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {message}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of the process.

    Returns
    -------
    int
        Exit code, as `--help` lists them.
    """
    if sys.stderr is None:
        # Closed before the start. Progress bars and warnings take for granted that there is one.
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115
    # What is printed is kept until the work is done: a full disk or a closed pipe then cannot be
    # taken for a failure of the work itself.
    output = StringIO()
    with redirect_stdout(output):
        code = _run(arguments)
    if not _deliver(output.getvalue()):
        code = code or _OUTPUT_LOST
    try:
        sys.stderr.flush()
    except (OSError, ValueError):
        _give_up(sys.stderr)
    return code


def _run(arguments: Sequence[str] | None) -> int:
    name, options = "tippedisk", argparse.Namespace()
    try:
        options = _parser().parse_args(arguments)
        name = f"tippedisk {options.command.replace('_', '-')}"
        # Imported late: the commands bring NumPy, SciPy and the engine along.
        commands = import_module(f"validation.commands.{options.module}")
        return int(getattr(commands, options.command)(options))
    except SystemExit as stop:
        return int(stop.code or 0)
    except (ValueError, ArithmeticError, OSError, MemoryError) as error:
        message = " ".join(str(error).split()) or "not enough memory"
        _complain(f"{name}: error: {_blamed_option(options, message)}{message}")
        return 2
    except KeyboardInterrupt:
        _complain(f"{name}: interrupted")
        return 130


def _blamed_option(options: argparse.Namespace, message: str) -> str:
    """The option whose argument a message begins with, if there is one."""
    argument = message.partition(" ")[0]
    option = _OPTION_OF.get(argument, argument)
    if option in {"mu", "eps"} and getattr(options, "law", None) is not None:
        option = "law"
    return f"--{option.replace('_', '-')}: " if hasattr(options, option) else ""


def _deliver(text: str) -> bool:
    """Write to standard output; whether that worked."""
    if not text:
        return True
    if sys.stdout is None:
        _complain("tippedisk: standard output is closed; what was to be printed is lost")
        return False
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        _complain(f"tippedisk: standard output could not be written to: {error}")
        _give_up(sys.stdout)
        return False
    return True


def _give_up(stream: TextIO) -> None:
    """Let a stream that cannot be written to lead nowhere.

    Or the interpreter would try again at its end, fail, and exit with a code of its own.
    """
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _complain(message: str) -> None:
    with suppress(OSError, ValueError):
        print(message, file=sys.stderr, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="tippedisk",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tippedisk {version('tippedisk')}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _add_report(commands)
    _add_simulate(commands)
    _add_show(commands)
    _add_eigenvalues(commands)
    _add_critical(commands)
    _add_scene(commands)
    _add_work_precision(commands)
    _add_robustness(commands)
    _add_rest(commands)
    _add_animate(commands)
    return parser


def _add_report(commands: "argparse._SubParsersAction[_Parser]") -> None:
    report = commands.add_parser(
        "report",
        help="run all checks and write them with the paper's figures to one HTML page",
        description="Run engine and in-house equations, compare them, and write one page of HTML "
        "with everything in it, the figures as PNG and SVG and the tables as CSV. " + INVERSION,
    )
    report.set_defaults(module="basic")
    report.add_argument(
        "--out", default="report", metavar="DIR", help="folder to write to (default: %(default)s)"
    )


def _add_simulate(commands: "argparse._SubParsersAction[_Parser]") -> None:
    simulate = commands.add_parser(
        "simulate",
        help="simulate one model and store the motion",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Simulate one model and store the motion.\n\n"
        "The file holds t (N,), q and u (N, 6) in the order x, y, z, alpha, beta, gamma of the\n"
        "co-rotating coordinates (m, rad, m/s, rad/s), normal_force (N,) in N, multipliers\n"
        "(N, k), and meta, a JSON string with all parameters, versions and the error estimate.",
    )
    simulate.set_defaults(module="basic")
    add = simulate.add_argument
    add("--source", choices=SOURCES, default="engine", help="who simulates (default: %(default)s)")
    add("--model", type=int, choices=MODELS, default=1, help="constraint level (default: 1)")
    add(
        "--formulation",
        choices=FORMULATIONS,
        help="engine: floating, floating-lie, euler-tree (default for models 2 to 4) or "
        "contact-tree (model 1, default); in-house: index-1 (default) or reduced (model 4)",
    )
    add(
        "--load",
        choices=LOADS,
        default="weight",
        help="load in the friction law: the weight m g (default), or the normal contact force",
    )
    _add_disk_and_friction(simulate)
    _add_start(simulate)
    add("--end", type=float, default=2.0, help="end of the simulation in s (2)")
    add("--samples", type=int, default=201, help="number of evenly spaced samples (201)")
    accuracy = simulate.add_mutually_exclusive_group()
    accuracy.add_argument(
        "--tolerance", type=float, help="largest error of beta and gamma in rad (1e-8)"
    )
    accuracy.add_argument("--step", type=float, help="engine only: fixed step in s instead")
    add(
        "--allow-pulling",
        action="store_true",
        help="go on where the ideal contact would have to pull, instead of ending there",
    )
    add("--time-limit", type=float, help="processor time in s after which the run ends")
    add("--out", required=True, metavar="FILE", help="file to write, .npz")


def _add_show(commands: "argparse._SubParsersAction[_Parser]") -> None:
    show = commands.add_parser(
        "show",
        help="plot stored motions over each other",
        description="Plot beta, gamma, spinning velocity and normal force of stored motions.",
    )
    show.set_defaults(module="basic")
    show.add_argument("files", nargs="+", metavar="FILE", help="files written by simulate")
    show.add_argument(
        "--out", metavar="PICTURE", help="write a .png, .svg or .pdf instead of opening a window"
    )


def _add_eigenvalues(commands: "argparse._SubParsersAction[_Parser]") -> None:
    eigenvalues = commands.add_parser(
        "eigenvalues",
        help="eigenvalues of inverted and noninverted spinning",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Eigenvalues of the stationary spinning motions over the spin, in 1/s.\n\n"
        "full: the eight of Eq. (55); reduced: the three of Eq. (111); model1 to model4: those\n"
        "of the nonlinear models, linearised numerically (8, 4, 3, 3). With --source engine they\n"
        "come from the engine's Models 1 (full) and 4 (reduced) or the model named. Columns\n"
        "follow the branches.",
    )
    eigenvalues.set_defaults(module="stability")
    _add_system(eigenvalues)
    add = eigenvalues.add_argument
    add("--source", choices=SOURCES, default="in-house", help="default: %(default)s")
    add("--formulation", choices=FORMULATIONS[:4], help="with --source engine: how it is built")
    add(
        "--spin",
        nargs="+",
        required=True,
        metavar="SPIN",
        help="spins in rad/s: values, or first:last:number",
    )
    output = eigenvalues.add_mutually_exclusive_group()
    output.add_argument(
        "--json", action="store_true", help="print a list with spin, real and imag for each spin"
    )
    output.add_argument("--csv", metavar="FILE", help="write a table with full precision")
    output.add_argument("--plot", metavar="PICTURE", help="write a .png, .svg or .pdf")


def _add_critical(commands: "argparse._SubParsersAction[_Parser]") -> None:
    critical = commands.add_parser(
        "critical",
        help="spins at which eigenvalues cross, and at which the spinning is stable",
        description="Critical spins with their frequency and the side on which the eigenvalue or "
        "pair that crosses decays, beside the closed form of the reduced system, Eq. (126); and "
        "for each model the spins at which all of its eigenvalues do.",
    )
    critical.set_defaults(module="stability")
    _add_system(critical)
    critical.add_argument(
        "--spin",
        default="0:60",
        metavar="FIRST:LAST",
        help="range in rad/s (default: %(default)s)",
    )


def _add_scene(commands: "argparse._SubParsersAction[_Parser]") -> None:
    scene = commands.add_parser(
        "scene",
        help="list what is in a scene of the engine, and why",
        description="List the nodes, objects, markers and sensors of a scene with the reason for "
        "each, and count its coordinates, constraints and user functions.",
    )
    scene.set_defaults(module="scene")
    add = scene.add_argument
    add("--model", type=int, choices=MODELS, default=1, help="constraint level (default: 1)")
    add("--formulation", choices=FORMULATIONS[:4], help="how the disk is built")
    add("--load", choices=LOADS, default="weight", help="load in the friction law (weight)")
    add("--mu", type=float, default=0.3, help="friction coefficient (0.3)")
    add("--stiffness", type=float, help="penalty contact in N/m instead of the ideal one")
    add("--half-thickness", type=float, default=0.0, help="of a rounded rim on it in m (0)")
    _add_dissipation(scene)


def _add_work_precision(commands: "argparse._SubParsersAction[_Parser]") -> None:
    study = commands.add_parser(
        "work-precision",
        help="measure error against run time of every formulation and integrator",
        description="Run every formulation with every integrator on ladders of steps or "
        "tolerances and write diagrams, tables and the lesson to one page. An interrupted study "
        "goes on where it stopped.",
    )
    study.set_defaults(module="work_precision", command="work_precision")
    add = study.add_argument
    add("--quick", action="store_true", help="a selection, less than a minute")
    add("--out", default="work-precision", metavar="DIR", help="folder (default: %(default)s)")
    add("--fresh", action="store_true", help="measure again what is kept")


def _add_robustness(commands: "argparse._SubParsersAction[_Parser]") -> None:
    study = commands.add_parser(
        "robustness",
        help="numerical stability on stiff and extreme cases",
        description="Run a grid of hard cases in separate processes, classify each from its "
        "measured error, drift and energy, and write tables and figures to one page.",
    )
    study.set_defaults(module="robustness")
    add = study.add_argument
    add("--quick", action="store_true", help="a selection, about a minute")
    add("--out", default="robustness", metavar="DIR", help="folder (default: %(default)s)")


def _add_rest(commands: "argparse._SubParsersAction[_Parser]") -> None:
    rest = commands.add_parser(
        "rest",
        help="simulate the disk from the paper's start until it lies still",
        description="Simulate the disk on a stiff unilateral contact until it lies still, and "
        "print when each phase began and where the energy went. All dissipation besides sliding "
        "friction and the contact's damper is off by default; then the disk does not lie flat. "
        + INVERSION,
    )
    rest.set_defaults(module="rest")
    add = rest.add_argument
    add("--source", choices=SOURCES, default="engine", help="who simulates (default: %(default)s)")
    _add_disk_and_friction(rest)
    _add_start(rest)
    _add_dissipation(rest)
    add("--stiffness", type=float, default=1e6, help="of the contact in N/m (1e6)")
    add("--half-thickness", type=float, default=2e-4, help="of the spheroid in m (2e-4)")
    add("--height", type=float, default=0.0, help="start so far in m above the table (0)")
    add("--tolerance", type=float, help="largest error in rad and parts of the energy (1e-3)")
    add("--step", type=float, help="engine only: a single run of fixed steps in s instead")
    add("--time-limit", type=float, help="processor time in s after which it ends as it is")
    add("--end", type=float, default=80.0, help="longest time in s (80)")
    add("--out", metavar="FILE", help="store the motion, .npz")
    add("--plot", metavar="PICTURE", help="draw the story, .png, .svg or .pdf")


def _add_animate(commands: "argparse._SubParsersAction[_Parser]") -> None:
    animate = commands.add_parser(
        "animate",
        help="turn a stored motion into a page that plays it, or a GIF",
        description="Write a page that plays a motion stored by simulate or rest, and needs no "
        "network; or, with --out FILE.gif, an animated picture.",
    )
    animate.set_defaults(module="animate")
    add = animate.add_argument
    add("file", metavar="FILE", help="motion written by simulate or rest, .npz")
    add("--out", metavar="FILE", help=".html or .gif to write (default: FILE with .html)")
    add("--begin", type=float, help="in s (default: that of the motion)")
    add("--end", type=float, help="in s (default: that of the motion)")
    add("--speed", type=float, help="1 for real time (default: 0.1 until the disk is inverted)")
    add("--fps", type=float, help="GIF only: frames per second (20)")
    add("--width", type=int, help="GIF only: width and height in pixels (480)")


def _add_system(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--system", choices=SYSTEMS, default="full", help="linear system (default: %(default)s)"
    )
    parser.add_argument(
        "--motion",
        choices=MOTIONS,
        default="inverted",
        help="centre of gravity above (default) or below the geometric centre",
    )
    _add_disk_and_friction(parser)


def _add_start(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--spin", type=float, default=40.0, help="rate of alpha at the start in rad/s (40)")
    add("--beta", type=float, help="inclination at the start in rad (pi/2)")
    add("--gamma", type=float, help="rotation angle at the start in rad (-pi/2 + 0.1)")
    add("--beta-rate", type=float, default=0.0, help="rate of beta at the start in rad/s (0)")
    add("--gamma-rate", type=float, help="rate of gamma in rad/s (-spin * cos(beta))")


def _add_dissipation(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--rolling", type=float, default=0.0, help="dry rolling resistance on the contour (0)")
    add("--rolling-viscous", type=float, default=0.0, help="viscous one, in s/m (0)")
    add("--pivoting", type=float, default=0.0, help="lever of the pivoting friction in m (0)")
    add("--air-drag", type=float, default=0.0, help="air density times drag coefficient (0)")


def _add_disk_and_friction(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--disk", choices=DISKS, default="steel", help="disk (default: %(default)s)")
    add("--mu", type=float, default=0.3, help="friction coefficient (0.3)")
    add("--eps", type=float, default=0.1, help="smoothing speed of the friction law in m/s (0.1)")
    add(
        "--law",
        metavar="LAW",
        help="another friction law than the paper's with --mu and --eps: stribeck, tanh, viscous "
        "or module:class, with its parameters behind commas, as in tanh,coefficient=0.4",
    )
