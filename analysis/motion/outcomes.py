"""Outcomes of many motions as a table: what each came to, in numbers and words."""

from collections.abc import Iterator, Mapping
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from importlib import import_module
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from analysis.motion.sampled import xarray_module
from analysis.problem.checks import TimeLimitError
from analysis.problem.constraints import PRESCRIBED
from analysis.problem.contact import CAUSES
from analysis.problem.quantities import declared
from analysis.problem.user_modules import fault_of

Column = npt.NDArray[Any]
Cell = float | str | bytes | None
Row = dict[str, Cell]

DONE = "done"
FAILURES = ("refused", "failed", "too slow", "crashed")
"""The scenario cannot be run as asked; the run ends in an error, meets its time limit, or takes
the interpreter down."""

OUTCOMES: Mapping[str, str | None] = {
    **dict.fromkeys(("status", "reason", "inversion")),
    **dict.fromkeys(("inverted_at", "inverted_at_error", "lost_at", "lost_at_error"), "s"),
    **dict.fromkeys(("spin_after", "spin_end"), "rad/s"),
    **dict.fromkeys(("cog_direction_end", "face_end"), ""),
    **dict.fromkeys(("force_least", "force_largest"), "N"),
    **dict.fromkeys(("energy_start", "energy_end"), "J"),
    **{f"taken_{cause}": "J" for cause in CAUSES},
    **{f"brought_by_{name}": "J" for name in PRESCRIBED},
    **dict.fromkeys(("rolling_from", "flat_from", "rest_from"), "s"),
    "ending": None,
    "end": "s",
    "error_estimate": "rad",
    "seconds": "s",
}
"""Columns of a table behind those of what varies, with their units; None for words.

status, reason
    "done", or one of `FAILURES` and why.
inversion, inverted_at, inverted_at_error, lost_at, lost_at_error
    As `Inversion` says: when, and how far off the samples may leave that.
spin_after, spin_end
    Rate of alpha, of motions to rest the vertical angular velocity. When the disk has stayed up
    for 1 s, by cubic polynomials between samples, and at the end.
cog_direction_end, face_end
    Vertical parts of the unit vectors from G to S and normal to the disk, at the end.
force_least, force_largest
    Normal force over the samples.
energy_start, energy_end, taken_..., brought_by_...
    Kinetic, gravitational and elastic energy; what each cause took; and what the torques that
    keep a rate constant brought, by its samples. Empty where a motion does not hold it, or its
    samples are too far apart to tell that work.
rolling_from, flat_from, rest_from
    As `Phases` says, of motions to rest.
ending, end
    Why the motion ended early, and when it ended.
error_estimate, seconds
    Of the run, to rest as `SpatialMotion.deviation` has it; processor time, of members that ran
    together the mean.
"""


@dataclass(frozen=True, kw_only=True, eq=False)
class OutcomeTable:
    """Outcomes of many motions, one row for each.

    Parameters
    ----------
    axes : tuple of str
        Dotted names of the fields that vary.
    columns : dict
        Arrays of shape (n,) by name: "number", those of the axes, and those that the guide on
        sweeps lists, as `analysis.motion.outcomes.OUTCOMES` does. An empty cell
        is nan in numbers and None in words.
    """

    KNOWN: ClassVar[Mapping[str, str | None]] = OUTCOMES

    axes: tuple[str, ...]
    columns: dict[str, Column]

    @classmethod
    def empty(cls, axes: Mapping[str, Column], size: int) -> "OutcomeTable":
        """Table of so many rows that holds the axes alone."""
        columns = {"number": np.arange(size), **axes}
        for name, measure in OUTCOMES.items():
            columns[name] = np.full(size, None if measure is None else np.nan)
        return cls(axes=tuple(axes), columns=columns)

    def put(self, rows: Any, found: Mapping[str, Any]) -> None:
        """Put values of columns into some rows; None stands for an empty cell."""
        for name, values in found.items():
            self.columns[name][rows] = values

    def rows(self) -> Iterator[Row]:
        """Cells by name, None where there is none."""
        for cells in zip(*(column.tolist() for column in self.columns.values()), strict=True):
            named = zip(self.columns, cells, strict=True)
            # Nan alone is not itself.
            yield {name: None if cell != cell else cell for name, cell in named}  # noqa: PLR0124

    @property
    def units(self) -> dict[str, str]:
        """Units of the columns that hold numbers; empty for plain ones."""
        return {
            name: self.KNOWN.get(name, declared(name).unit) or ""
            for name, column in self.columns.items()
            if column.dtype.kind in "fi"
        }

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` with "number" as its index and the units in its `attrs`."""
        frame = import_module("pandas").DataFrame(self.columns).set_index("number")
        frame.attrs = {"units": self.units}
        return frame

    def to_xarray(self) -> Any:
        """An `xarray.Dataset` over "number", each variable with its unit.

        Raises
        ------
        ImportError
            If xarray is not installed; it comes with `pip install 'tippedisk[export]'`.
        """
        units = self.units
        held = {
            name: ("number", column, {"units": units[name]} if units.get(name) else {})
            for name, column in self.columns.items()
        }
        return xarray_module().Dataset(held).set_coords(["number", *self.axes])


def failure(error: BaseException) -> Row:
    """What is kept of a member without a motion."""
    if isinstance(error, TimeLimitError):
        status = "too slow"
    elif isinstance(error, BrokenExecutor):
        status = "crashed"
    else:
        status = "refused" if isinstance(error, ValueError) else "failed"
    # What ends a program, such as SystemExit, says little by itself.
    reason = fault_of(error) if isinstance(error, Exception) else f"{type(error).__name__} {error}"
    return failed(status, reason or type(error).__name__)


def failed(status: str, reason: str) -> Row:
    """The same from one of `FAILURES` and why."""
    return {"status": status, "reason": " ".join(reason.split())}
