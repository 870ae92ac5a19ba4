"""The commands: what each is called, takes and does."""

from collections.abc import Callable
from typing import Any

from analysis.data.quantities import SECTIONS
from validation.parser.options import (
    OWN,
    SCENARIO,
    Command,
    Options,
    file,
    of_run,
    option,
)
from validation.parser.paths import existing, store, writable
from validation.parser.runs import FORMULATIONS

SYSTEMS = ("full", "reduced", "numeric")
MOTIONS = ("inverted", "noninverted")
LAYOUTS = ("grid", "random", "latin-hypercube", "sobol")
MAPS = ("spin-friction", "spin-eccentricity", "attitude", "tilting", "basins", "rest")
SHELLS = ("bash", "zsh", "fish")
MOST = 10_000_000
"""Cases of a sweep, unless more are asked for."""

SECTIONS_OF_REPORT = (
    *("modelled", "inversion", "claims", "stability", "nonlinear", "rest", "maps"),
    *("crosscheck", "work-precision", "robustness", "lean", "numbers"),
)

STORED = ("claims", "rest", "maps", "work-precision", "robustness")
"""Studies of which results come with the package."""

INVERSION = (
    "The disk is inverted from the first time at which its centre of gravity has risen to 90% of "
    "its largest height above the geometric centre and from which it stays above that centre for "
    "1 s; if the motion ends before, it is not decided."
)

WHOLE = tuple(SECTIONS)
PROBLEM = ("", "disk", "friction", "table")
ALL = ("json", "csv", "plot")

_TOLERANCES = ("tolerance", "step", "local_tolerance")
_RUN = ("formulation", *_TOLERANCES)
_IN_HOUSE = {"source": {"default": "in-house"}}
_OUT = file("--out", "store the motion, .npz or -", writable(".npz"))
_REST = option("--rest", "start from the defaults of `tippedisk rest`", default=False)

_SPINS: dict[str, Any] = {"nargs": "+", "type": str, "metavar": "SPIN"}
_SPIN_GRAMMAR = "in rad/s: values, with commas or not, or first:last:number"

_OVER = option(
    "--over",
    "go through a parameter, as in sweep: mu=0.1:1:10:log, eps=0.01,0.1, hole-radius=0.01:0.02:4",
    type=str,
    metavar="AXIS",
)

_OF_SYSTEM = (
    option(
        "--system",
        "full and reduced stand for Models 1 and 4, unless constraints are given",
        choices=SYSTEMS,
        usual="that of the constraints, numeric if there is none",
    ),
    option(
        "--motion",
        "centre of gravity above or below the geometric centre",
        default="inverted",
        choices=MOTIONS,
    ),
)

_WORKERS = (
    option("--workers", "processes", type=int, usual="one for each core"),
    option(
        "--executor",
        "processes, dask, mpi, or module:function of your own that returns a "
        "concurrent.futures.Executor",
        default="processes",
    ),
    option(
        "--scheduler",
        "of Dask",
        type=str,
        metavar="ADDRESS",
        usual="a cluster of this machine",
    ),
    *of_run(
        "time_limit",
        time_limit={"about": "of each run, processor time in s", "default": 60.0, "usual": ""},
    ),
)


COMMANDS: list[Command] = []
"""In the order of the help."""


def _command(module: str, **how: Any) -> Callable[[Callable[[], Options]], None]:
    """Let a function be a command: its name, what it does by its docstring, and its options.

    Parameters
    ----------
    module : str
        Of `validation.commands`, with the function that does it.
    **how
        Further parameters of `Command`.
    """
    return lambda options: COMMANDS.append(Command(options=options, module=module, **how))


@_command("studies")
def _report() -> Options:
    """Measure or confirm all studies and write two pages with what they found.

    Run engine and in-house equations, compare them, and write a page on the disk and one on the
    method, with the tables as CSV and the figures as PNG and SVG beside them. Printed are verdicts
    and checks that fail; the exit code is 1 if one does. What has been measured is kept in the
    folder: another call takes it as it is while the code behind it, the versions and the machine
    stay the same.
    """
    return (
        option(
            "--only",
            f"make this section alone; may be given several times: "
            f"{', '.join(SECTIONS_OF_REPORT)}",
            action="append",
            choices=SECTIONS_OF_REPORT,
            metavar="SECTION",
        ),
        option("--out", "folder to write to", default="report", metavar="DIR"),
        _FRESH,
        file("--text", "write verdicts and sections as Markdown, .md or -", writable(".md")),
        option("--verbose", "print all checks", default=False),
    )


_FRESH = option("--fresh", "measure again what is kept", default=False)


@_command("studies")
def _study() -> Options:
    """Measure the stored tables of a study anew, all of their cases.

    A report shows these tables and measures a sample of their cases again. An interrupted call
    goes on where it stopped. Run times mean something on an idle machine alone.
    """
    return (
        option("name", ", ".join(STORED), choices=STORED, metavar="STUDY"),
        option("--out", "folder for what is finished", default="study", metavar="DIR"),
        option(
            "--results", "folder for the tables", usual="that of --out", type=str, metavar="DIR"
        ),
        _FRESH,
    )


@_command("simulate", tables=WHOLE, outputs=ALL)
def _simulate() -> Options:
    """Simulate a scenario and store the motion.

    The file holds t (N,), q and u (N, 6) in the order x, y, z, alpha, beta, gamma of the co-
    rotating coordinates (m, rad, m/s, rad/s), normal_force (N,) in N, multipliers (N, k), and
    meta, a JSON string with the scenario, versions and the error estimate. The table of --csv has
    the samples.
    """
    return (
        SCENARIO,
        *of_run("source", *_RUN, "integrator", "method", "stop_when", "allow_pulling"),
        option("--end", "end of the simulation in s", default=2.0),
        option("--samples", "number of evenly spaced samples", default=201),
        *of_run("time_limit"),
        _OUT,
    )


@_command("show", outputs=ALL)
def _show() -> Options:
    """Say how far stored motions differ, and plot them over each other.

    Print in what stored motions differ besides their source, what each is and, for each but the
    first, how far its quantities are from those of the first; and plot inclination, rotation angle
    (with rest files: height of the centre of gravity), spin and normal force, in a window unless
    an output is asked for. The table of --csv holds the differences, or the samples of a single
    motion.
    """
    return (
        file("files", "written by simulate or rest", existing(".npz"), nargs="+"),
        *OWN,
    )


@_command("scenario", tables=WHOLE)
def _scenario() -> Options:
    """Print a problem as a commented file, to be changed and run.

    Print the whole problem as a TOML file, which says of every key what it is and what is allowed:
    the paper's; or that of a file or a stored run; with what the options change.
    """
    return (
        file("scenario", "scenario, .toml, or stored run, .npz", existing(), nargs="?"),
        _REST,
    )


@_command("scenario", tables=WHOLE, outputs=ALL)
def _check() -> Options:
    """Compare engine and in-house equations on a scenario of your own.

    Compare accelerations, trajectories and, where they are defined, eigenvalues of a scenario
    between the in-house equations and every formulation of the engine that can build it. Exit code
    1 if they disagree.
    """
    return (
        SCENARIO,
        option("--end", "of the motions in s, at most", default=2.0),
        option("--states", "random states for accelerations", default=100),
    )


@_command("sweep", tables=WHOLE, outputs=ALL)
def _sweep() -> Options:
    """Run a scenario many times with some of its fields varied.

    Run a scenario many times and keep the outcomes in one SQLite file.

    An axis is a field of the scenario's file and what it goes through:
      spin=0:60:61            61 values from 0 to 60, both included
      mu=0.01:1:20:log        even steps of the logarithm
      model=1,2,4             a list; friction.load=weight,contact likewise
      gamma=-pi/2:pi/2        drawn between, with --layout random, latin-hypercube or sobol
    A grid holds all combinations, the last axis fastest. Each case is a row: inverted or not,
    when, spin after it, extremes of the normal force, energy taken, why it ended, estimated error
    and processor time; a run that fails, hangs or crashes is a row with its reason.

    The same command goes on where an interrupted one stopped, also after kill -9. A file of
    another sweep, or of sources that compute something else, is refused.
    """
    return (
        option("axes", "what varies, as above", type=str, nargs="*", metavar="AXIS"),
        file("--axes", "TOML with the table [axes] instead", existing(), dest="axes_file"),
        option("--layout", "how cases are laid out", choices=LAYOUTS, usual="grid"),
        option("--number", "of drawn cases", type=int),
        option("--seed", "of the drawing", type=int, usual="0"),
        file("--out", "store, .db; made if there is none", store, required=True),
        option("--retry", "run cases again that failed", default=False),
        option(
            "--accept-other-code",
            "add to a store of other sources; each row says which it comes from",
            default=False,
        ),
        option("--most", "cases to allow", default=MOST),
        SCENARIO,
        *of_run(
            "source",
            *_RUN,
            "method",
            "stop_when",
            **_IN_HOUSE,
            tolerance={"usual": "1e-6; to rest 1e-3"},
            method={"usual": "DOP853; to rest LSODA"},
        ),
        option("--end", "end of each motion in s", default=4.0),
        option("--spacing", "between samples in s", default=5e-3),
        option(
            "--witnesses",
            "cases, evenly spread, that the other side runs as well, with the difference",
            default=0,
        ),
        option(
            "--keep",
            "series to keep of each run at its samples, such as beta,gamma,normal_force",
            default="",
            metavar="NAMES",
        ),
        option("--rest", "run until the disk lies still, as `tippedisk rest`", default=False),
        *_WORKERS,
    )


@_command("maps", tables=WHOLE, outputs=ALL[:2])
def _map() -> Options:
    """Draw what becomes of the disk over two parameters.

    Run a map of what becomes of the disk over two parameters, and draw it:
      spin-friction      inversion over spin and friction coefficient
      spin-eccentricity  inversion over spin and eccentricity
      attitude           inversion over gamma and beta at the start
      tilting            inversion over the rate of beta and beta at the start
      basins             the same as attitude, in Models 1 to 4 beside each other
      rest               which face is up at rest, over spin and beta at the start
    A coarse grid is run whole; cells that hold different outcomes are halved again and again.
    Model 1 runs in the engine, everything else in the in-house equations; the other side runs some
    of the cases, too. Each panel has a store as `tippedisk sweep` writes it; the same command goes
    on.
    """
    return (
        option("name", ", ".join(MAPS), choices=MAPS, metavar="MAP"),
        option("--out", "folder", default="maps", metavar="DIR"),
        option("--cells", "of the coarse grid along an axis", default=8),
        option("--levels", "how often cells are halved", default=2),
        option("--end", "end of each motion in s", usual="4; rest: 20"),
        option(
            "--witnesses",
            "on the coarse grid, and as large a part of the other cases",
            default=8,
        ),
        option(
            "--compiled",
            "run compiled, in batches, to 1e-6 rad; needs tippedisk[fast]",
            default=False,
        ),
        option(
            "--pairs",
            "random starts, each run at 4 small distances as well: how fine the map is",
            default=0,
        ),
        SCENARIO,
        *_WORKERS,
    )


@_command("rest", tables=WHOLE, outputs=ALL, more=INVERSION)
def _rest() -> Options:
    """Simulate the disk from the paper's start until it lies still.

    Simulate the disk on a stiff unilateral contact until it lies still, and print when each phase
    began and where the energy went. By default the rim is rounded, friction knows the contact
    force, and nothing but sliding friction and the contact's damper takes energy; then the disk
    does not lie flat.
    """
    return (
        SCENARIO,
        *of_run(
            "source",
            *_TOLERANCES[:2],
            "stop_when",
            "time_limit",
            tolerance={
                "about": "largest error in rad and parts of the energy",
                "usual": "1e-3",
            },
            step={"about": "engine only: a single run of fixed steps in s instead"},
        ),
        option("--end", "longest time in s", default=80.0),
        _OUT,
    )


@_command("stability", tables=PROBLEM, outputs=ALL)
def _eigenvalues() -> Options:
    """Eigenvalues of inverted and noninverted spinning.

    Eigenvalues of the stationary spinning motions over the spin, in 1/s.

    full: the eight of Eq. (55), Model 1; reduced: the three of Eq. (111), Model 4; numeric: those
    of any constraints, linearised by dual numbers. With --source engine they come from the engine.
    Columns follow the branches.
    """
    return (
        SCENARIO,
        *_OF_SYSTEM,
        *of_run(
            "source",
            "formulation",
            **_IN_HOUSE,
            formulation={"about": "engine only: how it is built", "choices": FORMULATIONS},
        ),
        option("--spin", f"spins {_SPIN_GRAMMAR}", required=True, **_SPINS),
    )


@_command("stability", tables=PROBLEM, outputs=ALL)
def _critical() -> Options:
    """Spins at which the spinning is stable, and at which eigenvalues cross.

    For each model the spins at which inverted spinning is stable, all of its eigenvalues together;
    then the spins at which one of them, or a pair, becomes stable or unstable, with its frequency,
    beside the closed form of the reduced system, Eq. (126).
    """
    return (
        SCENARIO,
        *_OF_SYSTEM,
        option(
            "--spin",
            f"from the least to the largest of spins {_SPIN_GRAMMAR}",
            default=["0:60"],
            usual="0:60",
            **_SPINS,
        ),
    )


@_command("nonlinear", tables=PROBLEM, outputs=ALL)
def _cycles() -> Options:
    """Periodic motions of the reduced system, with their multipliers.

    Follow the periodic motions of the reduced system (Model 4) from the Hopf point of inverted
    spinning to their end, with period, Floquet multipliers and bifurcations; or find those at
    given spins; or follow others: one table of motions, and one of what happens along them.
    """
    return (
        SCENARIO,
        option("--spin", f"only the cycles at spins {_SPIN_GRAMMAR}", **_SPINS),
        option(
            "--rotating",
            "instead, the motions beyond the heteroclinic end, in which gamma turns round",
            default=False,
        ),
        option(
            "--asymmetric",
            "instead, the cycles without mirror symmetry, where symmetric ones lose it",
            default=False,
        ),
        _OVER,
        option("--amplitude", "of the cycle that --over follows, in rad"),
    )


@_command("nonlinear", tables=PROBLEM, outputs=ALL)
def _heteroclinic() -> Options:
    """The heteroclinic connection in which the cycles end.

    Find the spin at which the motion that leaves noninverted spinning ends in it again, to 1e-9
    rad/s, beside its prediction to first order on the slow manifold. The picture shows that motion
    on either side of the connection.
    """
    return (SCENARIO, _OVER)


@_command("nonlinear", tables=WHOLE, outputs=ALL)
def _passage() -> Options:
    """When an inverted disk is lost as its spin decays.

    Run a scenario, by default Model 1 from the paper's start, and tell when its falling spin
    passes the Hopf point of inverted spinning, when the inversion is lost, and when it should be
    by the eigenvalues alone.
    """
    return (
        SCENARIO,
        *of_run("source", **_IN_HOUSE),
        option("--end", "longest time in s", default=22.0),
        _REST,
    )


@_command("scene", tables=WHOLE, outputs=ALL[:2])
def _scene() -> Options:
    """List what is in a scene of the engine, and why.

    List the nodes, objects, markers and sensors of a scene with the reason for each, and count its
    coordinates, constraints and user functions.
    """
    return (
        SCENARIO,
        *of_run(
            "formulation",
            formulation={"about": "how the disk is built", "choices": FORMULATIONS},
        ),
    )


@_command("animate")
def _animate() -> Options:
    """Turn a stored motion into a page that plays it, or a GIF.

    Write a page that plays a motion stored by simulate or rest, and needs no network; or, with
    --out FILE.gif, an animated picture.
    """
    return (
        file("file", "motion written by simulate or rest, .npz", existing(".npz")),
        file(
            "--out",
            ".html or .gif to write",
            writable(".html", ".gif"),
            usual="FILE with .html",
        ),
        option("--begin", "in s", usual="that of the motion"),
        option("--end", "in s", usual="that of the motion"),
        option("--speed", "1 for real time", usual="0.1 until the disk is inverted"),
        option("--fps", "GIF only: frames per second", usual="20"),
        option("--width", "GIF only: width and height in pixels", type=int, usual="480"),
        *OWN,
    )


@_command("animate")
def _play() -> Options:
    """Write a page on which the disk is spun by hand.

    Its sliders set the start, the friction and the disk; the equations of Model 1 are integrated
    in the browser, without a network.
    """
    return (file("--out", "page to write, .html or -", writable(".html"), default="play.html"),)


@_command("completion")
def _completion() -> Options:
    """Completion of commands, options and their values in a shell.

    Print a script that teaches it the command line:
      bash, zsh   source <(tippedisk completion bash), or zsh
      fish        tippedisk completion fish | source
    It stays if the line stands in ~/.bashrc, ~/.zshrc or ~/.config/fish/config.fish.
    """
    return (option("shell", ", ".join(SHELLS), choices=SHELLS, metavar="SHELL"),)
