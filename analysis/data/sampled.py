"""What motions of either kind have in common: how they print, leave Python and are told apart."""

import json
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, replace
from html import escape
from importlib import import_module
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from analysis.data.checks import (
    Array,
    ToleranceError,
    choice,
    increasing_times,
    number,
    positive,
    real_array,
)
from analysis.data.endings import Ending
from analysis.data.files import whole_file
from analysis.data.inversion import Inversion
from analysis.data.own import foreign_names
from analysis.data.scenario import Scenario
from analysis.data.state import State

FORMAT = 2
"""Of the files of motions; the first held no whole scenario."""

_META = ("source", "error_estimate", "method", "counts", "versions")
"""What a file says of a motion in plain data, beside scenario and ending."""

UNKNOWN_TOLERANCE = 1e-6
"""Error in rad between samples allowed to a run that was asked for none."""


class SampledMotion(ABC):
    """A motion sampled in time; `Trajectory` and `SpatialMotion` are the two kinds."""

    __slots__ = ()

    ERROR_UNIT: ClassVar[str]
    """Unit of the error estimate, with a space before it; empty if it has none."""

    times: Array
    scenario: Scenario
    source: Any
    method: Mapping[str, Any]
    error_estimate: float | None
    ending: Ending | None

    @property
    @abstractmethod
    def cog_direction(self) -> Array:
        """Height of the centre of gravity above G over the eccentricity, -1 to 1, shape (n,)."""

    @property
    @abstractmethod
    def cog_direction_rate(self) -> Array:
        """Rate of `cog_direction` in 1/s, shape (n,)."""

    @abstractmethod
    def columns(self) -> dict[str, tuple[Array, str]]:
        """Every sampled quantity by name: its values, shape (n,), and its unit."""

    @abstractmethod
    def _state(self, wanted: Array, tolerance: float | None) -> tuple[Array, Array]:
        """Co-rotating coordinates and rates at times within the samples, each shape (m, 6)."""

    @abstractmethod
    def _arrays_at(self, wanted: Array, tolerance: float | None) -> tuple[dict[str, Any], float]:
        """What differs at times within the samples, shape (m,), and the error between these."""

    @property
    def inversion(self) -> Inversion:
        """What became of the inversion; a disk without eccentricity is never inverted."""
        if not self.scenario.disk.eccentricity:
            return Inversion(outcome="not inverted")
        return Inversion.of_direction(self.times, self.cog_direction, self.cog_direction_rate)

    @property
    def inversion_time(self) -> float | None:
        """Time in s at which the disk is inverted; None if not. `inversion` holds its error."""
        return self.inversion.time

    def at(self, time: float, *, tolerance: float | None = None) -> State:
        """State at any time within the samples, in the paper's coordinates.

        Parameters
        ----------
        time : float
            In s.
        tolerance : float, optional
            Largest error that interpolation may add, in rad for beta and gamma or the attitude;
            by default that asked of the run, or 1e-6.

        Raises
        ------
        ValueError
            If the time lies outside the samples, or the disk lies flat then.
        ToleranceError
            If the samples lie too far apart for the tolerance.
        """
        coordinates, rates = self._state(self._wanted(number("time", time)), tolerance)
        return State(coordinates=tuple(coordinates[0].tolist()), rates=tuple(rates[0].tolist()))

    def resampled(self, times: npt.ArrayLike, *, tolerance: float | None = None) -> Self:
        """The same motion at other times within its samples.

        What has rates goes through the samples and these by polynomials of degree 11, whose
        derivatives the rates are; constraint forces in the paper's coordinates by cubic ones
        through the samples alone; everything else is linear between samples. The error of beta
        and gamma, or of the attitude, is estimated, and added to the run's error estimate.

        Parameters
        ----------
        times : array_like, shape (m,)
            Strictly increasing times in s.
        tolerance : float, optional
            As in `at`.

        Raises
        ------
        ValueError
            If times do not increase or lie outside the samples.
        ToleranceError
            If the samples lie too far apart for the tolerance.
        """
        wanted = self._wanted(increasing_times(times))
        arrays, error = self._arrays_at(wanted, tolerance)
        estimate = None if self.error_estimate is None else self.error_estimate + error
        same: Any = self
        found: Self = replace(same, times=wanted, **arrays, error_estimate=estimate)
        return found

    def to_dict(self) -> dict[str, Array]:
        """Every sampled quantity by name, each shape (n,), in SI units; the first is `time`."""
        return {name: values for name, (values, _) in self.columns().items()}

    @property
    def units(self) -> dict[str, str]:
        """Unit of every quantity of `to_dict`."""
        return {name: unit for name, (_, unit) in self.columns().items()}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write `to_dict` as comma-separated columns below their names, whole or not at all.

        Numbers are written so that reading them gives back the same ones.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        columns = self.to_dict()
        with whole_file(path) as stream:
            np.savetxt(
                stream,
                np.column_stack(list(columns.values())),
                fmt="%.17g",
                delimiter=",",
                header=",".join(columns),
                comments="",
            )

    def to_dataframe(self) -> Any:
        """`to_dict` as a `pandas.DataFrame` over time, with the units in its `attrs`.

        Raises
        ------
        ImportError
            If pandas is not installed; it comes with `pip install 'tippedisk[export]'`.
        """
        pandas = optional("pandas", "to_dataframe")
        frame = pandas.DataFrame(self.to_dict()).set_index("time")
        frame.attrs = self._told() | {"units": self.units}
        return frame

    def to_xarray(self) -> Any:
        """`to_dict` as an `xarray.Dataset` over time, each variable with its unit.

        Raises
        ------
        ImportError
            If xarray is not installed; it comes with `pip install 'tippedisk[export]'`.
        """
        xarray = optional("xarray", "to_xarray")
        variables = {
            name: ("time", values, {"units": unit})
            for name, (values, unit) in self.columns().items()
        }
        time = {"time": variables.pop("time")}
        return xarray.Dataset(variables, coords=time, attrs=self._told())

    def plot(self, *names: str, ax: Any = None, **line: Any) -> Any:
        """Draw quantities over time into one pair of axes.

        Parameters
        ----------
        *names : str
            Keys of `to_dict` of the same unit; the height of the centre of gravity by default.
        ax : matplotlib.axes.Axes, optional
            By default new ones, in a figure of their own that no global state knows of.
        **line
            As `Axes.plot` takes them, such as `label` or `color`.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ValueError
            If a name is unknown or its unit is not that of the others.

        Examples
        --------
        >>> import numpy as np
        >>> from analysis import Scenario, simulate
        >>> simulate(Scenario(), np.linspace(0.0, 0.1, 11)).plot("beta", "gamma").get_ylabel()
        'beta, gamma in rad'
        """
        names, units = names or ("cog_height",), self.units
        unit = units[choice("names", names[0], units)]
        for name in names[1:]:
            if units[choice("names", name, units)] != unit:
                raise ValueError(
                    f"names must have one unit, got {names[0]} in {unit} and {name} in "
                    f"{units[name]}"
                )
        if ax is None:
            ax = optional("matplotlib.figure", "plot").Figure(layout="constrained").subplots()
        values = self.to_dict()
        for name in names:
            ax.plot(self.times, values[name], **({"label": name.replace("_", " ")} | line))
        label = ", ".join(name.replace("_", " ") for name in names)
        ax.set(xlabel="time in s", ylabel=f"{label} in {unit}" if unit else label)
        if len(names) > 1:
            ax.legend()
        return ax

    def _told(self) -> dict[str, str]:
        """What to say of the motion beside its numbers."""
        return {
            "motion": type(self).__name__,
            "source": self.source,
            "scenario": self.scenario.name,
            "samples": f"{self.times.size} from {self.times[0]:.6g} to {self.times[-1]:.6g} s",
            "error": "not estimated"
            if self.error_estimate is None
            else f"{self.error_estimate:.1e}{self.ERROR_UNIT}",
            "ending": "complete" if self.ending is None else str(self.ending),
        }

    def _meta(self, **further: Any) -> str:
        """What a file says of the motion beside its arrays; `stored_meta` reads it."""
        meta = {
            "format": FORMAT,
            "scenario": self.scenario.values(),
            "ending": None if self.ending is None else asdict(self.ending),
            **{name: getattr(self, name) for name in _META},
        }
        return json.dumps(meta | further, default=dict)

    def __repr__(self) -> str:
        said = self._told()
        return f"{said.pop('motion')}({', '.join(f'{key}: {text}' for key, text in said.items())})"

    def _repr_html_(self) -> str:
        said = self._told()
        kind = said.pop("motion")
        said["method"] = ", ".join(
            f"{name} {value}" for name, value in self.method.items() if value is not None
        )
        rows = "".join(
            f"<tr><th>{key}</th><td>{escape(text)}</td></tr>" for key, text in said.items()
        )
        return f"<table><caption>{kind}</caption>{rows}</table>"

    def _wanted(self, times: npt.ArrayLike) -> Array:
        """Check times that lie within the samples, shape (m,)."""
        wanted = np.atleast_1d(real_array("times", times))
        first, last = self.times[[0, -1]]
        outside = wanted[(wanted < first) | (wanted > last)]
        if outside.size:
            raise ValueError(
                f"times must lie within the samples, from {first:g} to {last:g} s, "
                f"got {outside[0]:g}"
            )
        return wanted

    def _check_between(self, wanted: Array, error: Array, tolerance: float | None) -> float:
        """Largest error between samples, shape (m,), if it is small enough."""
        if tolerance is None:
            asked = self.method.get("tolerance") or self.error_estimate or UNKNOWN_TOLERANCE
            tolerance = float(asked)
        tolerance = positive("tolerance", tolerance)
        worst = int(np.argmax(error))
        if not error[worst] <= tolerance:
            raise ToleranceError(
                f"the samples around t = {wanted[worst]:.6g} s determine the motion between them "
                f"only to {error[worst]:.1e} rad, and tolerance is {tolerance:.1e}: "
                "sample the run more closely, or give a larger tolerance"
            )
        return float(error[worst])


def stored_meta(text: Any, *further: str) -> dict[str, Any]:
    """What a file says of its motion, with scenario and ending as such.

    Raises
    ------
    KeyError
        If something is missing.
    ValueError
        If it is of another format than `FORMAT`, or holds anything else.
    """
    meta = json.loads(str(text))
    if not isinstance(meta, dict):
        raise ValueError(f"meta must be a mapping, got {type(meta).__name__}")
    found = meta.pop("format", 1)
    if found != FORMAT:
        age = "a newer" if isinstance(found, int) and found > FORMAT else "an older"
        raise ValueError(
            f"format must be {FORMAT}, got {found!r}: the file comes from {age} version of this "
            "project"
        )
    names = (*_META, *further)
    for name in meta:
        choice("meta", name, (*names, "scenario", "ending"))
    with foreign_names():
        scenario = Scenario.from_values(meta["scenario"])
    return {name: meta[name] for name in names} | {
        "scenario": scenario,
        "ending": None if meta["ending"] is None else Ending(**meta["ending"]),
    }


def optional(package: str, wanted_by: str) -> Any:
    """A module of an optional package, loaded only when it is asked for."""
    try:
        return import_module(package)
    except ImportError as error:
        raise ImportError(
            f"{wanted_by} needs {package}, which is not installed; "
            "pip install 'tippedisk[export]' installs it"
        ) from error
