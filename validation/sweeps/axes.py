"""What varies in a sweep, and how its cases are laid out; every case is found by its number."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from math import prod
from typing import Any, Literal, get_args

import numpy as np

from analysis.data.checks import Array, choice, number
from analysis.data.limits import LARGEST_STORAGE
from analysis.data.names import full_name
from analysis.data.written import Value, is_text, is_word, read_value

Layout = Literal["grid", "random", "latin-hypercube", "sobol"]
LAYOUTS: tuple[Layout, ...] = get_args(Layout)

MOST_CASES = 10_000_000
"""Cases of a sweep, unless more are asked for by name."""

_BLOCK = 4096
"""Cases that are drawn at once; a power of 2, as Sobol points want it."""


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
        object.__setattr__(self, "field", field)
        if (self.first is None) != (self.last is None) or (self.first is None) != bool(
            self.values
        ):
            raise ValueError(f"axis {field} must have either values, or first and last")
        if self.values:
            values = tuple(read_value(field, value) for value in self.values)
            if len(set(values)) < len(values):
                raise ValueError(f"axis {field} must hold each value once, got {values}")
            object.__setattr__(self, "values", values)
        else:
            self._check_range()

    def _check_range(self) -> None:
        field, count = self.field, self.count
        if is_word(field):
            raise ValueError(f"axis {field} takes a list, such as {field}=a,b, and no range")
        for name in ("first", "last"):
            object.__setattr__(self, name, read_value(field, getattr(self, name)))
        first, last = number("first", self.first), number("last", self.last)
        if count is not None and (type(count) is not int or count < 1):
            raise ValueError(f"axis {field} must have at least 1 value, got {count!r}")
        if (first == last) != (count == 1):
            got = f"{'no count' if count is None else count} from {first:g} to {last:g}"
            raise ValueError(f"axis {field} is an empty range: one value needs equal ends and "
                             f"several need different ones, got {got}")  # fmt: skip
        if self.log and not (first > 0.0 and last > 0.0):
            raise ValueError(
                f"axis {field} must be positive to be logarithmic, got {first:g} to {last:g}"
            )

    @property
    def size(self) -> int | None:
        """Number of values; None for a range without count."""
        return len(self.values) or self.count

    def at(self, index: int) -> Value:
        """Value of an index on a grid."""
        if self.values:
            return self.values[index]
        assert self.count is not None
        return self.between(index / max(1, self.count - 1))

    def draw(self, part: float) -> Value:
        """Value of a random number from 0 to 1; each of a list is as probable."""
        if self.values:
            return self.values[min(int(part * len(self.values)), len(self.values) - 1)]
        return self.between(part)

    def between(self, part: float) -> float:
        """Value on a range, of which the ends are exact."""
        assert self.first is not None
        assert self.last is not None
        if part in (0.0, 1.0):
            return self.last if part else self.first
        if self.log:
            return float(self.first * (self.last / self.first) ** part)
        return self.first + part * (self.last - self.first)

    def to_values(self) -> dict[str, Any]:
        """Plain data."""
        if self.values:
            return {"field": self.field, "values": list(self.values)}
        return {name: value for name, value in asdict(self).items() if name != "values"}

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> "Axis":
        """Axis from what `to_values` has returned."""
        return cls(**{**values, "values": tuple(values.get("values", ()))})


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """The cases of a sweep.

    Parameters
    ----------
    axes : tuple of Axis
    layout : {"grid", "random", "latin-hypercube", "sobol"}
        All combinations, the last axis fastest; or points of `scipy.stats.qmc` between the ends.
    number : int, optional
        Of points, where they are drawn.
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
        names = [axis.field for axis in self.axes]
        if not names:
            raise ValueError("axes must be at least one, such as spin=0:60:61")
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"axis {name} is given twice")
        if type(self.seed) is not int or self.seed < 0:
            raise ValueError(f"seed must be a whole number, not negative, got {self.seed!r}")
        if self.layout != "grid":
            self._check_drawn()
            return
        if self.number is not None:
            raise ValueError(f"number belongs to drawn points, not to a grid, got {self.number}")
        for axis in self.axes:
            if axis.size is None:
                raise ValueError(f"axis {axis.field} needs a count on a grid: first:last:count")

    def _check_drawn(self) -> None:
        if type(self.number) is not int or self.number < 1:
            raise ValueError(
                f"number of points must be given for layout {self.layout}, got {self.number!r}"
            )
        for axis in self.axes:
            if axis.count is not None:
                raise ValueError(
                    f"axis {axis.field} takes no count where points are drawn: first:last"
                )
        # A Latin hypercube is drawn as a whole; the others go block by block.
        held = 8 * self.number * len(self.axes)
        if self.layout == "latin-hypercube" and held > LARGEST_STORAGE:
            raise ValueError(
                f"number of points of a Latin hypercube is limited by memory, got {self.number}; "
                "sobol is not"
            )

    @property
    def size(self) -> int:
        """Number of cases."""
        if self.number is not None:
            return self.number
        return prod(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each axis of a grid."""
        return tuple(axis.size or 0 for axis in self.axes)

    def case(self, index: int) -> tuple[Value, ...]:
        """Values of the axes in a case, from 0 to `size` - 1."""
        if self.layout == "grid":
            found: list[Value] = []
            for axis in reversed(self.axes):
                index, place = divmod(index, axis.size or 1)
                found.insert(0, axis.at(place))
            return tuple(found)
        # A Latin hypercube is drawn as a whole.
        is_whole = self.layout == "latin-hypercube"
        block, row = (0, index) if is_whole else divmod(index, _BLOCK)
        parts = _drawn(self, block)[row].tolist()
        return tuple(axis.draw(part) for axis, part in zip(self.axes, parts, strict=True))

    def values_of(self, index: int) -> dict[str, Value]:
        """The same by the names of the fields."""
        return dict(zip([axis.field for axis in self.axes], self.case(index), strict=True))

    def to_values(self) -> dict[str, Any]:
        """Plain data."""
        return {**asdict(self), "axes": [axis.to_values() for axis in self.axes]}

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> "Design":
        """Design from what `to_values` has returned."""
        axes = tuple(Axis.from_values(axis) for axis in values["axes"])
        return cls(**{**values, "axes": axes})


@lru_cache(maxsize=2)
def _drawn(design: Design, block: int) -> Array:
    """Random numbers from 0 to 1 of a block of cases, shape (n, axes)."""
    axes, seed = len(design.axes), design.seed
    if design.layout == "random":
        return np.random.default_rng([seed, block]).random((_BLOCK, axes))
    from scipy.stats import qmc  # noqa: PLC0415 - a third of what a worker would take to start

    if design.layout == "latin-hypercube":
        whole: Array = qmc.LatinHypercube(axes, rng=seed).random(design.size)
        return whole
    sobol = qmc.Sobol(axes, rng=seed)
    if block:
        sobol.fast_forward(block * _BLOCK)
    drawn: Array = sobol.random(_BLOCK)
    return drawn


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


def axis_from(field: str, told: Any) -> Axis:
    """Axis from what a TOML file says of a field: the text of a range, a list, or one value."""
    if isinstance(told, list):
        return Axis(field=field, values=tuple(told))
    if not isinstance(told, str):
        return Axis(field=field, values=(told,))
    name = full_name(field)
    # A friction law of one's own is called module:Class.
    parts = [told] if is_text(name) else [part.strip() for part in told.split(":")]
    if len(parts) == 1:
        return Axis(field=name, values=tuple(told.split(",")))
    log = parts[-1] == "log"
    first, last, *counts = [*(parts[:-1] if log else parts), ""][:4]
    counts = [count for count in counts if count]
    if not last or len(counts) > 1 or not all(count.isdigit() for count in counts):
        raise ValueError(
            f"axis {name} must be first:last:count, with :log behind it or not, got {told!r}"
        )
    return Axis(
        field=name,
        first=read_value(name, first),  # type: ignore[arg-type]
        last=read_value(name, last),  # type: ignore[arg-type]
        count=int(counts[0]) if counts else None,
        log=log,
    )
