"""Types of what commands take: behind each stands what `argparse` needs to know of it.

A parameter with such a type, or a plain one, is an option of the command line; what it means is
said by the command's docstring, or here where several commands share it.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from analysis.data.quantities import SECTIONS
from validation.commands.output import Result
from validation.parser.options import OfScenario
from validation.parser.paths import existing, file, filled, store, writable

if TYPE_CHECKING:
    from validation.commands.scenarios import Problem


AnyProblem = Annotated["Problem", OfScenario(tuple(SECTIONS))]
NamedProblem = Annotated["Problem", OfScenario(tuple(SECTIONS), "scenario")]
"""With its file as an argument."""

PlainProblem = Annotated["Problem", OfScenario(("", "disk", "friction", "table"))]
"""On the ideal contact, from whatever start."""

Numbers = Annotated[Result, "json", "csv"]
"""A result without a picture."""

Run = Annotated[Path, file(existing(".npz"))]
Runs = Annotated[list[Path], file(existing(".npz"), nargs="+")]
Toml = Annotated[Path | None, file(existing())]
MotionOut = Annotated[Path | None, file(writable(".npz"), help="store the motion, .npz or -")]
StoreOut = Annotated[Path, file(store)]
AnimationOut = Annotated[Path | None, file(writable(".html", ".gif"))]
PageOut = Annotated[Path, file(writable(".html"))]
TextOut = Annotated[Path | None, file(writable(".md"))]
Sections = Annotated[
    list[str] | None,
    {
        "action": "append",
        "metavar": "SECTION",
        "choices": (
            *("modelled", "inversion", "claims", "stability", "nonlinear", "rest", "maps"),
            *("crosscheck", "work-precision", "robustness", "lean", "numbers"),
        ),
    },
]
Folder = Annotated[str, file(filled, "DIR")]
OtherFolder = Annotated[str | None, file(filled, "DIR")]

_SPINS = {"nargs": "+", "type": str, "metavar": "SPIN"}
Spins = Annotated[tuple[str, ...], _SPINS]
SomeSpins = Annotated[tuple[str, ...] | None, _SPINS]
"""In rad/s: values, with commas or not, or `first:last:number`."""

Axes = Annotated[list[str], {"nargs": "*", "type": str, "metavar": "AXIS"}]
Over = Annotated[
    str | None,
    {
        "metavar": "AXIS",
        "help": "go through a parameter, as in sweep: mu=0.1:1:10:log, eps=0.01,0.1, "
        "hole-radius=0.01:0.02:4",
    },
]

System = Annotated[
    Literal["full", "reduced", "numeric"] | None,
    {
        "help": "full and reduced stand for Models 1 and 4, unless constraints are given (that of "
        "the constraints, numeric if there is none)"
    },
]
Side = Annotated[
    Literal["inverted", "noninverted"],
    {"help": "centre of gravity above or below the geometric centre"},
]

Law = Annotated[
    str | None,
    {
        "metavar": "MODULE:CLASS",
        "help": "friction law of one's own that the motion was run with: imports it",
    },
]
Body = Annotated[
    str | None,
    {"metavar": "MODULE:CLASS", "help": "body of one's own that moved: imports it"},
]

Workers = Annotated[int | None, {"help": "processes (one for each core)"}]
Executor = Annotated[
    str,
    {
        "help": "processes, dask, mpi, or module:function of your own that returns a "
        "concurrent.futures.Executor"
    },
]
Scheduler = Annotated[
    str | None, {"metavar": "ADDRESS", "help": "of Dask (a cluster of this machine)"}
]
TimeLimit = Annotated[float, {"help": "of each run, processor time in s"}]
