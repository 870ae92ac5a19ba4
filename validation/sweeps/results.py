"""Results of a sweep, read from its store."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from analysis import SpatialMotion, Trajectory
from analysis.motion import files
from analysis.motion.outcomes import DONE, Column, OutcomeTable
from analysis.motion.quantities import quantities
from analysis.problem.checks import Array, choice
from analysis.problem.limits import check_storage
from validation.sweeps.case import COLUMNS, NUMBERS
from validation.sweeps.plan import TIME
from validation.sweeps.store import reading, tables
from validation.sweeps.sweep import Sweep

_ROWS = "SELECT * FROM cases ORDER BY number"

_BLOCK = 20_000
"""Rows that are held at once as SQLite gives them, which takes much more than as arrays."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Results(OutcomeTable):
    """Rows of a sweep, in the order of their numbers.

    Columns are those that the guide on sweeps lists.

    Parameters
    ----------
    axes, columns
        As in `OutcomeTable`.
    sweep : Sweep
    path : Path
        Of the store, from which `series` reads.
    """

    KNOWN: ClassVar[Mapping[str, str | None]] = COLUMNS

    sweep: Sweep
    path: Path

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Results":
        """Read a store, also one that is being written to.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is no store, or damaged.
        """
        kinds: Any = {"REAL": float, "TEXT": object, "BOOLEAN": bool}
        with reading(path) as (file, sweep):
            known = tables(sweep)["cases"]
            dtype = {name: kinds.get(kind, int) for name, kind in known.items()}
            try:
                table = pd.concat(pd.read_sql(_ROWS, file, dtype=dtype, chunksize=_BLOCK))
            except pd.errors.DatabaseError as error:
                raise error.__cause__ or error from None
        words = [name for name, kind in dtype.items() if kind is object]
        # Beside words, some versions of pandas read an empty cell as nan.
        table[words] = table[words].where(table[words].notna(), None)
        columns = {name: table[name].to_numpy() for name in table}
        axes = tuple(axis.field for axis in sweep.design.axes)
        return cls(axes=axes, columns=columns, sweep=sweep, path=Path(path))

    def on_grid(self, name: str) -> Column:
        """A column in the shape of the grid, the first axis first; nan or None where no row is.

        Raises
        ------
        ValueError
            If the cases are drawn, and lie on no grid, or there is no such column.
        """
        if (layout := self.sweep.design.layout) != "grid":
            raise ValueError(f"layout must be grid, got {layout}: these cases lie on none")
        return self._gridded(self.columns[choice("name", name, self.columns)])

    def _gridded(self, rows: Any) -> Any:
        """Values of the rows, shape (n, ...), in the shape of the grid."""
        design, is_words = self.sweep.design, rows.dtype == object
        shape, gap = (design.size, *rows.shape[1:]), None if is_words else np.nan
        values = np.full(shape, gap, object if is_words else float)
        values[self.columns["number"]] = rows
        return values.reshape(*design.shape, *rows.shape[1:])

    def series(self, case: int) -> dict[str, Array]:
        """What `Plan.keep` names of a case, and the "time" of its samples.

        Parameters
        ----------
        case : int
            Its number.

        Returns
        -------
        dict
            Arrays of shape (n,) by name, in the units of `Trajectory.columns` or
            `SpatialMotion.columns`; a force that the case does not have is left out.

        Raises
        ------
        ValueError
            If the store holds none of that case.
        """
        for _, found in self._series(case, case):
            return found
        raise ValueError(f"{self.path} holds no series of case {case}")

    def _series(self, first: int, last: int) -> Iterator[tuple[int, dict[str, Array]]]:
        """Numbers of cases, from the first to the last one, and their series."""
        names = (TIME, *self.sweep.plan.keep)
        if len(names) == 1:
            raise ValueError(f"{self.path} holds no series: its sweep was told to keep none")
        with reading(self.path) as (file, _):
            # A case that has run again and failed may have left what it had before.
            asked = (
                "SELECT series.* FROM series JOIN cases USING (number) "
                "WHERE status = ? AND number BETWEEN ? AND ?"
            )
            for number, *blobs in file.execute(asked, (DONE, first, last)):
                held = {name: blob for name, blob in zip(names, blobs, strict=True) if blob}
                arrays = {name: np.frombuffer(blob, NUMBERS) for name, blob in held.items()}
                yield number, {name: values.astype(float) for name, values in arrays.items()}

    def to_xarray(self) -> Any:
        """An `xarray.Dataset` over the axes of a grid, or over "number" where cases are drawn.

        Each variable has its unit. Series have "sample" as a further dimension, with nan behind
        the end of a case, and are all read at once.

        Raises
        ------
        ImportError
            If xarray is not installed; it comes with `pip install 'tippedisk[export]'`.
        ValueError
            If the series take more than `LARGEST_STORAGE`.
        """
        held, design, plan = super().to_xarray(), self.sweep.design, self.sweep.plan
        if plan.keep:
            names, samples = (TIME, *plan.keep), plan.times.size
            rows = {number: row for row, number in enumerate(self.columns["number"].tolist())}
            check_storage("to_xarray", design.size * samples, len(names))
            kept = {name: np.full((len(rows), samples), np.nan) for name in names}
            for number, found in self._series(0, design.size):
                # More may have come in since the rows were read.
                for name, values in found.items() if number in rows else ():
                    kept[name][rows[number], : values.size] = values
            told = quantities(SpatialMotion if plan.to_rest else Trajectory).values()
            units = {name: unit for columns in told for name, unit in columns.items()}
            series = {
                name: (("number", "sample"), kept[name], {"units": units[name]}) for name in names
            }
            held = held.assign(series)
        if design.layout == "grid":
            data = {
                name: ((*self.axes, *each.dims[1:]), self._gridded(each.values), each.attrs)
                for name, each in held.data_vars.items()
            }
            axes = {each.field: (each.field, list(each.grid)) for each in design.axes}
            coordinates = {name: (*each, held[name].attrs) for name, each in axes.items()}
            held = type(held)(data, coords=coordinates)
        return held


def write_csv(store: str | os.PathLike[str], path: str | os.PathLike[str]) -> None:
    """Write the rows of a store as comma-separated text, none of which is held for long.

    Raises
    ------
    OSError
        If a file cannot be read or written.
    ValueError
        If the store is none.
    """
    with reading(store) as (file, _):
        rows = file.execute(_ROWS)
        files.write_csv(path, (name for name, *_ in rows.description), rows)
