"""Types of what commands take: behind each stands what `argparse` needs to know of it.

A parameter with such a type, or a plain one, is an option of the command line; what it means is
said by the command's docstring. What several commands share is a group.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from analysis.problem.quantities import SECTIONS
from validation.parser.commands import Group, OfScenario
from validation.parser.files import Result, existing, file, folder, store, writable
from validation.parser.runs import CaseOptions, Layout

if TYPE_CHECKING:
    from validation.commands.options import Problem


AnyProblem = Annotated["Problem", OfScenario(tuple(SECTIONS))]
NamedProblem = Annotated["Problem", OfScenario(tuple(SECTIONS), "scenario")]
"""With its file as an argument."""

_PLAIN = ("", "disk", "friction", "table")
SpinningProblem = Annotated["Problem", OfScenario((*_PLAIN, "contact", "dissipation"))]
"""From whatever start."""

ReducedProblem = Annotated["Problem", OfScenario(_PLAIN, model=4)]
"""The same of Model 4, on the ideal contact."""

Numbers = Annotated[Result, Group(Result.deliver, "json", "csv")]
"""A result without a picture."""

Run = Annotated[Path, file(existing, ".npz")]
Runs = Annotated[list[Path], file(existing, ".npz", nargs="+")]
Toml = Annotated[Path | None, file(existing)]
MotionOut = Annotated[Path | None, file(writable, ".npz")]
StoreOut = Annotated[Path, file(store)]
AnimationOut = Annotated[Path | None, file(writable, ".html", ".gif")]
PageOut = Annotated[Path, file(writable, ".html")]
TextOut = Annotated[Path | None, file(writable, ".md")]
Folder = Annotated[Path, file(folder, metavar="DIR")]
OtherFolder = Annotated[Path | None, file(folder, metavar="DIR")]

DISK = ("modelled", "inversion", "claims", "stability", "nonlinear", "rest", "maps")
METHOD = ("crosscheck", "work-precision", "robustness", "lean", "numbers")
"""Studies of the first page of a report, on the disk, and of the second one, on the method."""

Sections = Annotated[
    list[str] | None,
    {"action": "append", "choices": (*DISK, *METHOD), "metavar": "SECTION"},
]

_SPINS = {"nargs": "+", "type": str, "metavar": "SPIN"}
Spins = Annotated[tuple[str, ...], _SPINS]
SomeSpins = Annotated[tuple[str, ...] | None, _SPINS]
"""In rad/s: values, with commas or not, or `first:last:number`."""

Axes = Annotated[list[str], {"nargs": "*", "type": str, "metavar": "AXIS"}]
Axis = Annotated[str | None, {"metavar": "AXIS"}]
_UserClass = Annotated[str | None, {"metavar": "MODULE:CLASS"}]


def _user_classes(*, law: _UserClass = None, body: _UserClass = None) -> None:
    """Classes of one's own that a stored motion was run with.

    Parameters
    ----------
    law : str, optional
        Friction law of one's own that the motion was run with: imports it.
    body : str, optional
        Body of one's own that moved: imports it.
    """


def _spectrum(
    *,
    system: Literal["full", "reduced", "numeric"] | None = None,
    motion: Literal["inverted", "noninverted"] = "inverted",
) -> None:
    """Whose eigenvalues are meant.

    Parameters
    ----------
    system : str, optional
        Full and reduced stand for Models 1 and 4, unless constraints are given (that of the
        constraints, numeric if there is none).
    motion : str
        Centre of gravity above or below the geometric centre.
    """


def _drawing(
    *, layout: Layout | None = None, number: int | None = None, seed: int | None = None
) -> None:
    """How the cases of a sweep are laid out.

    Parameters
    ----------
    layout : str, optional
        How cases are laid out (grid).
    number : int, optional
        Of drawn cases.
    seed : int, optional
        Of the drawing (0).
    """


def _pool(
    *,
    workers: int | None = None,
    executor: str = "processes",
    scheduler: Annotated[str | None, {"metavar": "ADDRESS"}] = None,
) -> None:
    """Who computes many runs.

    Parameters
    ----------
    workers : int, optional
        Processes (one for each core).
    executor : str
        Processes, dask, mpi, or module:function of your own that returns a
        concurrent.futures.Executor.
    scheduler : str, optional
        Of Dask (a cluster of this machine).
    """


UserClasses = Annotated[dict[str, Any], Group(_user_classes)]
Spectrum = Annotated[dict[str, Any], Group(_spectrum)]
Drawing = Annotated[dict[str, Any], Group(_drawing)]
Pool = Annotated[dict[str, Any], Group(_pool)]
Cases = Annotated[
    dict[str, Any],
    Group(
        CaseOptions,
        *("source", "formulation", "tolerance", "step", "local_tolerance", "integrator", "method"),
        *("stop_when", "time_limit", "end", "spacing", "witnesses", "keep"),
    ),
]
"""How the cases of a sweep are run."""
