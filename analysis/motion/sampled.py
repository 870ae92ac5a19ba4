"""What motions of either kind have in common: how they print, leave Python and are told apart."""

import json
import os
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from html import escape
from importlib import import_module
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import Ending
from analysis.motion.files import whole_file, write_csv
from analysis.motion.inversion import Inversion, inversions
from analysis.motion.quantities import Columns, Quantities, filled, quantities
from analysis.problem.checks import (
    Array,
    ToleranceError,
    checked,
    choice,
    increasing_times,
    instance,
    not_negative,
    number,
    optional,
    positive,
    real_array,
    settings,
)
from analysis.problem.choices import SOURCES, Source
from analysis.problem.constraints import multiplier_names
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import QUANTITIES
from analysis.problem.scenario import Scenario
from analysis.problem.start import State

Setting = str | float | int | None

FORMAT = 3
"""Of the files of motions; the first held no whole scenario."""

LOOSER = 100.0
"""Error of a place between samples over the radius that goes with an error of an angle in rad: no
run is asked for the place."""

UNKNOWN_TOLERANCE = 1e-6
"""Error in rad between samples allowed to a run that was asked for none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SampledMotion(Quantities):
    """A motion sampled in time; `Trajectory` and `SpatialMotion` are the two kinds."""

    ERROR_UNIT: ClassVar[str]
    """Unit of the error estimate, with a space before it; empty if it has none."""

    times: Array
    scenario: Scenario
    source: Source
    method: Mapping[str, Setting] = field(default_factory=dict)
    error_estimate: float | None = None
    counts: Mapping[str, int] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    ending: Ending | None = None

    @abstractmethod
    def _between(self, wanted: Array) -> tuple[dict[str, Any], Array, Array]:
        """What has rates, at times within the samples, shape (m,), and the errors there.

        Errors are those of beta and gamma or of the attitude in rad, shape (m,), and of the place
        in m, shape (m, 3).
        """

    @abstractmethod
    def _beside(self, wanted: Array) -> dict[str, Any]:
        """What else differs there."""

    @staticmethod
    @abstractmethod
    def _state_of(arrays: Mapping[str, Array]) -> tuple[Array, Array]:
        """Co-rotating coordinates and rates, each shape (m, 6), of such arrays."""

    def _check(self) -> None:
        """Make the arrays and settings clean ones of this motion's own, or raise `ValueError`."""
        instance("scenario", self.scenario, Scenario)
        choice("source", self.source, SOURCES)
        optional(instance, "ending", self.ending, Ending)
        size = increasing_times(self.times).size
        for name in filled(type(self)):
            values = real_array(name, getattr(self, name))
            is_row = len(quantities(type(self))[name]) == 1
            shape = (size,) if is_row else (size, len(self._columns(name)))
            if values.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {values.shape}")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        for name in ("method", "counts", "versions"):
            checked = settings(name, getattr(self, name))
            object.__setattr__(self, name, checked)
        estimate = optional(not_negative, "error_estimate", self.error_estimate)
        object.__setattr__(self, "error_estimate", estimate)

    def _columns(self, name: str) -> Columns:
        """Columns of a quantity of this motion."""
        columns = quantities(type(self))[name]
        if name != "multipliers":
            return columns
        return {each: columns[each] for each in multiplier_names(self.scenario.constraints)}

    @property
    def inversion(self) -> Inversion:
        """What became of the inversion; a disk without eccentricity is never inverted."""
        return inversions(self)[0]

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
            Largest error that interpolation may add, in rad for beta and gamma or the attitude,
            and 100 times that in radii for the place; by default that asked of the run, or 1e-6.

        Raises
        ------
        ValueError
            If the time lies outside the samples, or the disk lies flat then.
        ToleranceError
            If the samples lie too far apart for the tolerance.
        """
        arrays, _ = self._found(number("time", time), tolerance)
        # Of a flat disk rates are none, which is not what is wrong with it.
        with np.errstate(divide="ignore", invalid="ignore"):
            coordinates, rates = (each[0].tolist() for each in self._state_of(arrays))
        checked(QUANTITIES["start.beta"], coordinates[4])
        return State(coordinates=tuple(coordinates), rates=tuple(rates))

    def resampled(self, times: npt.ArrayLike, *, tolerance: float | None = None) -> Self:
        """The same motion at other times within its samples.

        What has rates goes through the samples and these by polynomials of degree 11, whose
        derivatives the rates are; constraint forces in the paper's coordinates by cubic ones
        through the samples alone; everything else is linear between samples. The error of beta
        and gamma, or of the attitude, is estimated, and added to the run's error estimate. The
        motion keeps its ending if the last of the times is its own, and of the times of pulling
        those within.

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
        wanted = increasing_times(times)
        arrays, error = self._found(wanted, tolerance)
        arrays |= self._beside(wanted)
        arrays["ending"] = self.ending if wanted[-1] == self.times[-1] else None
        estimate = None if self.error_estimate is None else self.error_estimate + error
        same: Any = self
        return replace(same, times=wanted, **arrays, error_estimate=estimate)

    def columns(self) -> dict[str, tuple[Array, str]]:
        """Every sampled quantity by name: its values, shape (n,), and its unit."""
        found: dict[str, tuple[Array, str]] = {}
        for name in quantities(type(self)):
            values, columns = getattr(self, name), self._columns(name)
            each = values.T if values.ndim > 1 else [values]
            found |= dict(zip(columns, zip(each, columns.values(), strict=True), strict=True))
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
        rows = zip(*(values.tolist() for values in columns.values()), strict=True)
        write_csv(path, columns, rows)

    def to_dataframe(self) -> Any:
        """`to_dict` as a `pandas.DataFrame` over time, with the units in its `attrs`."""
        frame = import_module("pandas").DataFrame(self.to_dict()).set_index("time")
        frame.attrs = self._summary() | {"units": self.units}
        return frame

    def to_xarray(self) -> Any:
        """`to_dict` as an `xarray.Dataset` over time, each variable with its unit.

        Raises
        ------
        ImportError
            If xarray is not installed; it comes with `pip install 'tippedisk[export]'`.
        """
        xarray = xarray_module()
        variables = {
            name: ("time", values, {"units": unit})
            for name, (values, unit) in self.columns().items()
        }
        return xarray.Dataset(variables, attrs=self._summary())

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
            if (other := units[choice("names", name, units)]) != unit:
                raise ValueError(
                    f"names must have one unit, got {names[0]} in {unit} and {name} in {other}"
                )
        if ax is None:
            ax = import_module("matplotlib.figure").Figure(layout="constrained").subplots()
        elif not hasattr(ax, "plot"):
            raise ArgumentError("ax", f"must be the axes of a figure, got {ax!r}")
        values = self.to_dict()
        for name in names:
            ax.plot(self.times, values[name], **({"label": name.replace("_", " ")} | line))
        label = ", ".join(name.replace("_", " ") for name in names)
        ax.set(xlabel="time in s", ylabel=f"{label} in {unit}" if unit else label)
        if len(names) > 1:
            ax.legend()
        return ax

    def animate(
        self,
        *,
        begin: float | None = None,
        end: float | None = None,
        speed: float | None = None,
        title: str = "The tippedisk",
        caption: str = "",
    ) -> Any:
        """Player of the motion, which a notebook shows and `save` writes as a page or a GIF.

        Parameters
        ----------
        begin, end : float, optional
            Part of it in s, by default all.
        speed : float, optional
            1 for real time; by default slow enough for the inversion to be seen.
        title, caption : str
            Plain text.

        Returns
        -------
        validation.animation.player.Animation

        Raises
        ------
        ValueError
            If the part is none of the motion, its samples are too far apart to be animated, or
            the speed is out of range.

        Examples
        --------
        >>> import numpy as np
        >>> from analysis import Scenario, simulate
        >>> simulate(Scenario(), np.linspace(0.0, 0.1, 11)).animate(end=0.05).poses.times[-1]
        np.float64(0.05)
        """
        # The player knows motions, and these know it by name alone, as they do matplotlib.
        animate = import_module("validation.animation.player").animate
        return animate(self, begin, end, title=title, caption=caption, speed=speed)

    def _summary(self) -> dict[str, str]:
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

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the motion to an `.npz` file, whole or not at all, without pickle.

        The file holds the arrays by their names, and `meta`, a JSON string with everything else;
        `load_run` reads it.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        meta = {name: getattr(self, name) for name in described(type(self))} | {
            "format": FORMAT,
            "scenario": self.scenario.values(),
            "ending": None if self.ending is None else asdict(self.ending),
        }
        arrays = {name: getattr(self, name) for name in filled(type(self))}
        with whole_file(path) as stream:
            np.savez(stream, **arrays, meta=np.array(json.dumps(meta, default=dict)))

    def __repr__(self) -> str:
        said = self._summary()
        return f"{said.pop('motion')}({', '.join(f'{key}: {text}' for key, text in said.items())})"

    def _repr_html_(self) -> str:
        said = self._summary()
        kind = said.pop("motion")
        said["method"] = ", ".join(
            f"{name} {value if isinstance(value, str) else f'{value:.6g}'}"
            for name, value in self.method.items()
            if value is not None
        )
        rows = "".join(
            f"<tr><th>{key}</th><td>{escape(text)}</td></tr>" for key, text in said.items()
        )
        return f"<table><caption>{kind}</caption>{rows}</table>"

    def _found(
        self, times: npt.ArrayLike, tolerance: float | None
    ) -> tuple[dict[str, Any], float]:
        """What has rates at times that lie within the samples, and the largest error there."""
        wanted = np.atleast_1d(real_array("times", times))
        first, last = self.times[[0, -1]]
        outside = wanted[(wanted < first) | (wanted > last)]
        if outside.size:
            raise ValueError(
                f"times must lie within the samples, from {first:g} to {last:g} s, "
                f"got {outside[0]:g}"
            )
        arrays, turned, moved = self._between(wanted)
        part = np.linalg.norm(moved, axis=1) / (LOOSER * self.scenario.disk.radius)
        error = np.maximum(turned, part)
        if tolerance is None:
            asked = self.method.get("tolerance") or self.error_estimate or UNKNOWN_TOLERANCE
            tolerance = float(asked)
        tolerance = positive("tolerance", tolerance)
        worst = int(np.argmax(error))
        if not error[worst] <= tolerance:
            raise ToleranceError(
                f"the samples around t = {wanted[worst]:.6g} s determine the motion between them "
                f"only to {error[worst]:.1e} rad, and tolerance is {tolerance:.1e}: "
                "sample the run more closely"
            )
        return arrays, float(error[worst])


def described(kind: type[SampledMotion]) -> list[str]:
    """What a file says of a motion beside its arrays; a run time is that of one call."""
    left_out = (*filled(kind), "solver_seconds")
    return [field.name for field in fields(kind) if field.name not in left_out]


def xarray_module() -> Any:
    """The package xarray, which does not come with a plain install as the others do."""
    try:
        return import_module("xarray")
    except ImportError as error:
        raise ImportError(
            "to_xarray needs xarray, which is not installed; "
            "pip install 'tippedisk[export]' installs it"
        ) from error
