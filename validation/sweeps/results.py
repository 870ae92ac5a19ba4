"""Results of a sweep, read from its store."""

import csv
import io
import os
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from analysis.data.checks import Array
from analysis.data.files import whole_file
from analysis.data.limits import check_storage
from analysis.data.outcomes import Column, OutcomeTable
from validation.sweeps.outcomes import COLUMNS, NUMBERS, TIME
from validation.sweeps.store import read_about, told
from validation.sweeps.sweep import Sweep


@dataclass(frozen=True, kw_only=True, eq=False)
class Results(OutcomeTable):
    """Rows of a sweep, in the order of their numbers; columns as in `COLUMNS`.

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
        file, sweep = read_about(path)
        with closing(file), told(Path(path)):
            names, rows = _rows(file)
            table = list(zip(*rows, strict=True)) or [()] * len(names)
        columns = {}
        for name, cells in zip(names, table, strict=True):
            words = COLUMNS.get(name, "") is None or any(isinstance(each, str) for each in cells)
            kind: Any = int if name == "number" else object if words else float
            columns[name] = np.array(cells, dtype=kind)
        axes = tuple(axis.field for axis in sweep.design.axes)
        return cls(axes=axes, columns=columns, sweep=sweep, path=Path(path))

    def on_grid(self, name: str) -> Column:
        """A column in the shape of the grid, the first axis first; nan or None where no row is.

        Raises
        ------
        ValueError
            If the cases are drawn, and lie on no grid.
        """
        design = self.sweep.design
        if design.layout != "grid":
            raise ValueError(f"layout must be grid, got {design.layout}: these cases lie on none")
        column = self.columns[name]
        empty = None if column.dtype == object else np.nan
        values = np.full(design.size, empty, dtype=object if empty is None else float)
        values[self.columns["number"]] = column
        return values.reshape([axis.size or 0 for axis in design.axes])

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
        if not self.sweep.plan.keep:
            raise ValueError(f"{self.path} holds no series: its sweep was told to keep none")
        file, _ = read_about(self.path)
        with closing(file), told(self.path):
            found = file.execute("SELECT * FROM series WHERE number BETWEEN ? AND ?",
                                 (first, last))  # fmt: skip
            names = [column[0] for column in found.description][1:]
            for number, *blobs in found:
                yield (
                    number,
                    {
                        name: np.frombuffer(blob, NUMBERS).astype(float)
                        for name, blob in zip(names, blobs, strict=True)
                        if blob is not None
                    },
                )

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
        design, held = self.sweep.design, super().to_xarray()
        if design.layout != "grid":
            for name, values in self._all_series(self.columns["number"]).items():
                held[name] = (("number", "sample"), values)
            return held
        coordinates = {
            axis.field: [axis.at(index) for index in range(axis.size or 0)] for axis in design.axes
        }
        data: dict[str, tuple[Any, ...]]
        data = {
            name: (self.axes, self.on_grid(name), held[name].attrs)
            for name in COLUMNS
            if name in held
        }
        shape = [len(each) for each in coordinates.values()]
        for name, values in self._all_series(np.arange(design.size)).items():
            data[name] = ((*self.axes, "sample"), values.reshape(*shape, -1))
        return type(held)(data, coords=coordinates)

    def _all_series(self, cases: Column) -> dict[str, Array]:
        """Series of some cases by name, shape (cases, samples) each."""
        plan = self.sweep.plan
        if not plan.keep:
            return {}
        shape = (cases.size, plan.times.size)
        check_storage("to_xarray", cases.size * plan.times.size, 1 + len(plan.keep))
        values = {name: np.full(shape, np.nan) for name in (TIME, *plan.keep)}
        rows = {int(number): row for row, number in enumerate(cases)}
        for number, found in self._series(0, self.sweep.design.size):
            for name, series in found.items():
                values[name][rows[number], : series.size] = series
        return values


def write_csv(store: str | os.PathLike[str], path: str | os.PathLike[str]) -> int:
    """Write the rows of a store as comma-separated text, row by row; returns their number.

    Raises
    ------
    OSError
        If a file cannot be read or written.
    ValueError
        If the store is none.
    """
    file, _ = read_about(store)
    count = 0
    with closing(file), told(Path(store)), whole_file(path) as stream:
        text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        names, rows = _rows(file)
        writer.writerow(names)
        for count, row in enumerate(rows, 1):  # noqa: B007
            writer.writerow(row)
        text.flush()
        text.detach()
    return count


def _rows(file: Any) -> tuple[list[str], Iterator[tuple[Any, ...]]]:
    found = file.execute("SELECT * FROM cases ORDER BY number")
    return [column[0] for column in found.description], iter(found)
