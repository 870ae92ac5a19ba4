"""The subcommands for many runs: `sweep` and `map`."""

import argparse

from validation.parser.base import Commands
from validation.parser.groups import (
    FORMS,
    FORMULATIONS,
    add_scenario,
    add_source,
    add_stop_when,
)
from validation.parser.paths import PICTURES, store, table, writable

LAYOUTS = ("grid", "random", "latin-hypercube", "sobol")
MOST = 10_000_000

_SWEEP = """\
Run a scenario many times and keep the outcomes in one SQLite file.

An axis is a field of the scenario's file and what it goes through:
  spin=0:60:61            61 values from 0 to 60, both included
  mu=0.01:1:20:log        even steps of the logarithm
  model=1,2,4             a list; friction.load=weight,contact likewise
  gamma=-pi/2:pi/2        drawn between, with --layout random, latin-hypercube or sobol
A grid holds all combinations, the last axis fastest. Each case is a row: inverted or not, when,
spin after it, extremes of the normal force, energy taken, why it ended, estimated error and
processor time; a run that fails, hangs or crashes is a row with its reason.

The same command goes on where an interrupted one stopped, also after kill -9. A file of another
sweep, or of sources that compute something else, is refused.
"""


def add_sweep(commands: Commands) -> None:
    """The subcommand `sweep`."""
    sweep = commands.add_parser(
        "sweep",
        help="run a scenario many times with some of its fields varied",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_SWEEP,
    )
    sweep.set_defaults(module="sweep")
    add = sweep.add_argument
    add("axes", nargs="*", metavar="AXIS", help="what varies, as above")
    add("--axes", dest="axes_file", metavar="FILE", help="TOML with the table [axes] instead")
    add("--layout", choices=LAYOUTS, help="how cases are laid out (grid)")
    add("--number", type=int, metavar="N", help="of drawn cases")
    add("--seed", type=int, metavar="N", help="of the drawing (0)")
    add(
        "--out",
        required=True,
        type=store,
        metavar="FILE",
        help="store, .db; made if there is none",
    )
    add("--csv", type=table, metavar="FILE", help="write all rows to a .csv (or -) at the end")
    add(
        "--plot",
        type=writable(*PICTURES),
        metavar="PICTURE",
        help="draw the outcomes over one axis, over two as a map, or over the pairs of several: "
        ".png, .svg or .pdf",
    )
    add("--retry", action="store_true", help="run cases again that failed")
    add(
        "--accept-other-code",
        action="store_true",
        help="add to a store of other sources; each row says which it comes from",
    )
    add("--most", type=int, default=MOST, metavar="N", help=f"cases to allow ({MOST})")
    _add_plan(sweep)
    add_workers(sweep)
    add_scenario(sweep)


def _add_plan(sweep: argparse.ArgumentParser) -> None:
    """How each case is run."""
    add_source(sweep, default="in-house")
    add = sweep.add_argument
    add("--witnesses", type=int, default=0, metavar="N",
        help="cases, evenly spread, that the other side runs as well, with the difference (0)",
        )  # fmt: skip
    add("--formulation", choices=(*FORMULATIONS, *FORMS), help="as in `tippedisk simulate`")
    add(
        "--method",
        metavar="NAME",
        help="in-house only: solver (DOP853; to rest LSODA); taylor runs in compiled batches",
    )
    accuracy = sweep.add_mutually_exclusive_group()
    accuracy.add_argument(
        "--tolerance", type=float, help="largest error of beta and gamma in rad (1e-6)"
    )
    accuracy.add_argument("--step", type=float, help="engine only: fixed step in s instead")
    accuracy.add_argument(
        "--local-tolerance",
        type=float,
        help="of a single run whose solver controls its steps, in place of several that agree; no "
        "error is estimated; engine: DOPRI5, without constraints (Model 1)",
    )
    add("--end", type=float, default=4.0, help="end of each motion in s (4)")
    add("--spacing", type=float, default=5e-3, help="between samples in s (0.005)")
    add_stop_when(sweep, "end each run there")
    add(
        "--keep",
        default="",
        metavar="NAMES",
        help="series to keep of each run at its samples, such as beta,gamma,normal_force",
    )
    add("--rest", action="store_true", help="run until the disk lies still, as `tippedisk rest`")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Who computes, and how long a case may take."""
    add = parser.add_argument_group("workers").add_argument
    add("--workers", type=int, metavar="N", help="processes (one for each core)")
    add(
        "--executor",
        default="processes",
        metavar="NAME",
        help="processes (default), dask, mpi, or module:function of your own that returns a "
        "concurrent.futures.Executor",
    )
    add("--scheduler", metavar="ADDRESS", help="of Dask; by default a cluster of this machine")
    add("--time-limit", type=float, default=60.0, help="of each run, processor time in s (60)")


_MAP = """\
Run a map of what becomes of the disk over two parameters, and draw it:
  spin-friction      inversion over spin and friction coefficient
  spin-eccentricity  inversion over spin and eccentricity
  attitude           inversion over gamma and beta at the start
  tilting            inversion over the rate of beta and beta at the start
  basins             the same as attitude, in Models 1 to 4 beside each other
  rest               which face is up at rest, over spin and beta at the start
A coarse grid is run whole; cells that hold different outcomes are halved again and again. Model 1
runs in the engine, everything else in the in-house equations; the other side runs some of the
cases, too. Each panel has a store as `tippedisk sweep` writes it, and the same command goes on.
"""

MAPS = ("spin-friction", "spin-eccentricity", "attitude", "tilting", "basins", "rest")


def add_map(commands: Commands) -> None:
    """The subcommand `map`."""
    parser = commands.add_parser(
        "map",
        help="draw what becomes of the disk over two parameters",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_MAP,
    )
    parser.set_defaults(module="maps")
    add = parser.add_argument
    add("name", choices=MAPS, metavar="MAP", help=", ".join(MAPS))
    add("--out", default="maps", metavar="DIR", help="folder (default: %(default)s)")
    add("--cells", type=int, default=8, metavar="N", help="of the coarse grid along an axis (8)")
    add("--levels", type=int, default=2, metavar="N", help="how often cells are halved (2)")
    add("--end", type=float, help="end of each motion in s (4; rest: 20)")
    add(
        "--witnesses",
        type=int,
        default=8,
        metavar="N",
        help="on the coarse grid, and as large a part of the other cases (8)",
    )
    add(
        "--compiled",
        action="store_true",
        help="run compiled, in batches, to 1e-6 rad; needs tippedisk[fast]",
    )
    add(
        "--pairs",
        type=int,
        default=0,
        metavar="N",
        help="random starts, each run at 4 small distances as well: how fine the map is (0)",
    )
    add_workers(parser)
    add_scenario(parser)
