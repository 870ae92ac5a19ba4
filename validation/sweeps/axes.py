"""What varies in a sweep, and how its cases are laid out; every case is found by its number."""

import re
from dataclasses import dataclass
from functools import lru_cache
from math import prod
from typing import Any

import numpy as np

from analysis.problem.checks import Array, choice, instance, several, switch, whole
from analysis.problem.limits import check_storage
from analysis.problem.names import ArgumentError, full_name
from analysis.problem.quantities import declared
from analysis.problem.values import Value, read_value
from validation.parser.runs import LAYOUTS, Layout

_RANGE = re.compile(r"([^:]+):([^:]+?)(?:\s*:\s*(\d+)\s*)?(:\s*log\s*)?")

_LABELS = {
    "start.spin": "spinning speed at the start in rad/s",
    "start.beta": "β at the start in rad",
    "start.gamma": "γ at the start in rad",
    "start.beta_rate": "rate of β at the start in rad/s",
    "friction.coefficient": "friction coefficient μ",
    "disk.eccentricity": "eccentricity in m",
}
"""What stands at the axis of a field, where that is not its name."""

_BLOCK = 4096
"""Cases that are drawn at once, where they can be; a power of 2, as Sobol points want it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """A field that varies, over a list or over a range.

    Parameters
    ----------
    field : str
        Dotted name, or its last part where that is enough: "start.spin", "spin".
    values : tuple, optional
        The list.
    first, last : float, optional
        Ends of the range, in place of a list.
    count : int, optional
        Number of values on a range; needed by a grid alone.
    log : bool
        Whether the logarithm is spaced evenly.

    Raises
    ------
    ValueError
        If there is no such field, or nothing to vary.
    """

    field: str
    values: tuple[Value, ...] = ()
    first: float | None = None
    last: float | None = None
    count: int | None = None
    log: bool = False

    def __post_init__(self) -> None:
        field = full_name(self.field)
        given = several(f"values of axis {field}", self.values, "values")
        is_range = self.first is not None
        if is_range != (self.last is not None) or is_range == bool(given):
            raise ValueError(f"axis {field} must have either values, or first and last")
        values = tuple(read_value(field, value) for value in given)
        if len(set(values)) < len(values):
            raise ValueError(f"axis {field} must hold each value once, got {values}")
        object.__setattr__(self, "field", field)
        object.__setattr__(self, "values", values)
        is_log = switch(f"log of axis {field}", self.log)
        object.__setattr__(self, "log", is_log)
        if is_range:
            self._check_range(field)

    def _check_range(self, field: str) -> None:
        if declared(field).is_word:
            raise ValueError(f"axis {field} takes a list, such as {field}=a,b, and no range")
        ends = [float(read_value(field, each)) for each in (self.first, self.last)]
        if self.count is not None:
            count = whole(f"count of axis {field}", self.count)
            object.__setattr__(self, "count", count)
        if (ends[0] == ends[1]) != (self.count == 1):
            got = f"{ends[0]:g} to {ends[1]:g}"
            got = got if self.count is None else f"{self.count} from {got}"
            raise ValueError(
                f"axis {field} is an empty range: one value needs equal ends and several need "
                f"different ones, got {got}"
            )
        if self.log and min(ends) <= 0.0:
            raise ValueError(
                f"axis {field} must be positive to be logarithmic, got {ends[0]:g} to {ends[1]:g}"
            )
        object.__setattr__(self, "first", ends[0])
        object.__setattr__(self, "last", ends[1])

    @property
    def size(self) -> int:
        """Number of values; 0 for a range without count."""
        return len(self.values) or self.count or 0

    def at(self, index: int) -> Value:
        """Value of an index on a grid."""
        return self.values[index] if self.values else self.draw(index / max(1, self.size - 1))

    @property
    def label(self) -> str:
        """What stands at its axis in a picture, and above its values, with their unit."""
        name, measure = self.field.replace("_", " ").replace(".", ": "), declared(self.field).unit
        return _LABELS.get(self.field, f"{name} in {measure}" if measure else name)

    @property
    def grid(self) -> list[Any]:
        """All values on a grid."""
        return [self.at(index) for index in range(self.size)]

    def draw(self, part: float) -> Value:
        """Value of a number from 0 to 1: of a list, each as probable; of a range, exact ends."""
        if self.values:
            return self.values[min(int(part * len(self.values)), len(self.values) - 1)]
        first, last = self.first, self.last
        assert first is not None
        assert last is not None
        if self.log:
            return float(first ** (1.0 - part) * last**part)
        return last if part == 1.0 else first + part * (last - first)


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """The cases of a sweep.

    Parameters
    ----------
    axes : tuple of Axis
    layout : {"grid", "random", "latin-hypercube", "sobol"}
        All combinations, the last axis fastest; or points of `scipy.stats.qmc` between the ends.
    number : int, optional
        Of points, where they are drawn; a Latin hypercube is held as a whole, others are not.
    seed : int
        Of the drawing.

    Raises
    ------
    ValueError
        If the axes do not fit the layout, or there are too many cases.
    """

    axes: tuple[Axis, ...]
    layout: Layout = "grid"
    number: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        choice("layout", self.layout, LAYOUTS)
        seed = whole("seed", self.seed, least=0)
        object.__setattr__(self, "seed", seed)
        axes = [instance("axes", each, Axis) for each in several("axes", self.axes, "Axis")]
        object.__setattr__(self, "axes", tuple(axes))
        names = [axis.field for axis in self.axes]
        if not names:
            raise ValueError("axes must be at least one, such as spin=0:60:61")
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"axis {name} is given twice")
        is_grid = self.layout == "grid"
        if not is_grid:
            if self.number is None:
                raise ArgumentError("layout", f"needs a number of points, got {self.layout!r}")
            number = whole("number", self.number)
            object.__setattr__(self, "number", number)
        elif self.number is not None:
            fault = f"belongs to drawn points, not to a grid, got {self.number}"
            raise ArgumentError("number", fault)
        for axis in self.axes:
            if is_grid and not axis.size:
                raise ValueError(f"axis {axis.field} needs a count on a grid: first:last:count")
            if not is_grid and axis.count is not None:
                fault = "takes no count where points are drawn: first:last"
                raise ValueError(f"axis {axis.field} {fault}")
        check_storage("number", self._block, len(names))

    @property
    def _block(self) -> int:
        """Cases that are drawn at once: of a Latin hypercube all."""
        return self.size if self.layout == "latin-hypercube" else _BLOCK

    @property
    def size(self) -> int:
        """Number of cases."""
        return prod(self.shape) if self.number is None else self.number

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each axis of a grid."""
        return tuple(axis.size for axis in self.axes)

    def values_of(self, index: int) -> dict[str, Value]:
        """Values of the axes in a case, from 0 to `size` - 1, by the names of their fields."""
        if self.layout == "grid":
            found: dict[str, Value] = {}
            for axis in reversed(self.axes):
                index, place = divmod(index, axis.size)
                found[axis.field] = axis.at(place)
            return {axis.field: found[axis.field] for axis in self.axes}
        block, row = divmod(index, self._block)
        parts = _drawn(self, block, self._block)[row].tolist()
        return {axis.field: axis.draw(part) for axis, part in zip(self.axes, parts, strict=True)}


@lru_cache(maxsize=2)
def _drawn(design: Design, block: int, size: int) -> Array:
    """Random numbers from 0 to 1 of a block of cases, shape (size, axes)."""
    axes, seed = len(design.axes), design.seed
    if design.layout == "random":
        return np.random.default_rng([seed, block]).random((size, axes))
    from scipy.stats import qmc  # noqa: PLC0415 - a third of what a worker would take to start

    kinds: Any = {"latin-hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}
    points = kinds[design.layout](axes, rng=seed)
    if block:
        points.fast_forward(block * size)
    return points.random(size)


def axis_from_text(text: str) -> Axis:
    """Axis from the words of a command line.

    Parameters
    ----------
    text : str
        `field=first:last:count`, with `:log` behind it for even steps of the logarithm;
        `field=first:last` where points are drawn; or a list, `field=a,b,c`.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    field, equals, rest = text.partition("=")
    if not equals or not rest.strip():
        raise ValueError(f"axis must be field=first:last:count or field=a,b,c, got {text!r}")
    return axis_from(field, rest)


def axis_from(field: str, given: Any) -> Axis:
    """Axis from the text of a range or a list, from one value, or from None, an empty list."""
    if not isinstance(given, str):
        return Axis(field=field, values=() if given is None else (given,))
    name = full_name(field)
    # A friction law of one's own is called module:Class.
    if ":" not in given or declared(name).is_text:
        return Axis(field=name, values=tuple(each.strip() for each in given.split(",")))
    parts: Any = _RANGE.fullmatch(given)
    if parts is None:
        raise ValueError(
            f"axis {name} must be first:last:count, with :log behind it or not, got {given!r}"
        )
    first, last, count, log = parts.groups()
    return Axis(
        field=name,
        first=first,
        last=last,
        count=int(count) if count else None,
        log=bool(log),
    )
