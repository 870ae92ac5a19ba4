"""A motion between its samples, from coordinates and rates alone."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from scipy.integrate import cumulative_trapezoid

from analysis.problem.checks import Array

Numbers = npt.NDArray[Any]
"""Of rows or of columns."""

Polynomials = Callable[[Array], tuple[Array, Array]]
"""From times, shape (..., m), to values and slopes there, shape (..., m, k)."""

NODES = 6
"""Samples that an interpolating polynomial goes through, with their rates: it has degree 11."""

CAUTION = 10.0
"""Estimated error over the difference from a polynomial through two samples fewer.

Against runs sampled a hundred times as closely, the error of Models 1 to 4 is 0.03 to 4 times
that difference at sample spacings of 1 to 10 ms.
"""

_KINKED = 2.0
"""Times as much where more samples do not help, as around a touch-down. Of random motions that
come down on their rims, sampled every 1, 5 and 10 ms, one interval in 25,000, 2,000 and 1,500 then
has a larger error than estimated."""

_CLOSE = 1e-3
_PROBES = (0.25, 0.5, 0.75)
_REACH = 2 * NODES
"""Samples to either side that are looked at for those; some may lie too close together."""

_LEFT_OUT = (0, 2, 4)
"""Samples fewer that the polynomials go through by which an error is judged."""

_SMOOTH, _GAIN = 0.03, 0.1
"""Part of the difference of two polynomials that two samples more leave of a motion that is smooth
between its samples, and of one of which they still tell something."""

_ROUNDING = 1e-13
"""Difference of polynomials that is none."""

_STEPS = 60
"""After so many halvings, a bracket is as narrow as rounding."""


def interpolate(
    times: Array, values: Array, rates: Array, wanted: Array, nodes: int = NODES
) -> tuple[Array, Array, Array]:
    """Values and rates between samples by Hermite interpolation, and the error to expect.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Strictly increasing.
    values, rates : ndarray, shape (n, k)
    wanted : ndarray, shape (m,)
        Times within the samples.
    nodes : int
        Samples that a polynomial goes through at most.

    Returns
    -------
    values, rates, error : ndarray, shape (m, k)
        The error is that of the values, the largest over the interval between two samples, and
        none at a sample.
    """
    # Two samples nearly at one time, such as those at an ending, would amplify rounding.
    spacing = np.diff(times)
    kept = np.append(spacing >= _CLOSE * np.median(spacing), True)
    kept[0] = True
    times, values, rates = times[kept], values[kept], rates[kept]
    interval = np.clip(np.searchsorted(times, wanted, side="right") - 1, 0, times.size - 2)

    def through(count: int) -> Polynomials:
        first = np.clip(interval - (count // 2 - 1), 0, times.size - count)
        near = first[:, None] + np.arange(count)
        return _polynomials(times[near], values[near], rates[near])

    most = min(nodes, times.size)
    polynomials = [through(max(1, most - left_out)) for left_out in _LEFT_OUT]
    found, slopes = polynomials[0](wanted)
    apart, before = _differences(polynomials, times[interval], times[interval + 1])
    is_smooth = (apart < _SMOOTH * before) | (apart < _ROUNDING)
    error = CAUTION * np.where(is_smooth, apart, _KINKED * np.maximum(apart, before))
    error[(wanted == times[interval]) | (wanted == times[interval + 1])] = 0.0
    return found, slopes, error


class Sampled(NamedTuple):
    """Quantities with their rates, each shape (k, n), of which the last sample may be repeated."""

    times: Array
    values: Array
    rates: Array

    def part(self, place: Any) -> Self:
        """What stands at some rows, or at whatever else NumPy takes for a place."""
        return type(self)(*(each[place] for each in self))

    def crossings(self, level: float, columns: Numbers) -> tuple[Array, Array]:
        """Times at which quantities pass a level, by the polynomials of `interpolate`.

        Parameters
        ----------
        level : float
        columns : ndarray of int, shape (k,)
            Each passes the level between this sample and the one before.

        Returns
        -------
        times, errors : ndarray, shape (k,)
            The error to expect is that of the value over its slope, and at most what is left
            between the two samples.
        """
        found, errors = np.empty((2, len(columns)))
        for rows, polynomials, low, high in self.around(columns):
            found[rows], slope = _solve(polynomials[0], level, low, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                error = _error(polynomials, low, high) / np.abs(slope)
            errors[rows] = np.fmin(error, np.maximum(found[rows] - low, high - found[rows]))
        return found, errors

    def around(
        self, columns: Numbers
    ) -> Iterator[tuple[Numbers, list[Polynomials], Array, Array]]:
        """Polynomials of `crossings`, of some of its rows at a time.

        Yields
        ------
        rows : ndarray of int, shape (j,)
        polynomials : list of 3
            Through fewer and fewer samples around their columns.
        low, high : ndarray, shape (j,)
            Times of the sample before and of that in the column.
        """
        each, width = np.arange(len(columns)), min(self.times.shape[1], 2 * _REACH)
        begins = np.clip(columns - _REACH, 0, self.times.shape[1] - width)
        close = self.part((each[:, None], begins[:, None] + np.arange(width)))
        times, columns = close.times, columns - begins
        order, counts, kept = _apart(times)
        before = np.cumsum(kept, axis=1)[each, columns - 1] - 1
        for count in np.unique(np.minimum(counts, NODES)).tolist():
            rows = np.flatnonzero(np.minimum(counts, NODES) == count)

            def through(size: int, rows: Numbers = rows) -> Polynomials:
                first = np.clip(before[rows] - (size // 2 - 1), 0, counts[rows] - size)
                near = np.take_along_axis(order[rows], first[:, None] + np.arange(size), axis=1)
                nodes, *others = close.part((rows[:, None], near))
                return _polynomials(nodes, *(each[..., None] for each in others))

            polynomials = [through(max(1, count - left_out)) for left_out in _LEFT_OUT]
            yield rows, polynomials, times[rows, columns[rows] - 1], times[rows, columns[rows]]

    def with_extremes(self, low: float, high: float) -> tuple[Numbers, Self, Self]:
        """Samples of the quantities that between two of them go beyond a level which both keep to.

        Parameters
        ----------
        low, high : float
            What falls below the one, or comes up to the other, is of interest.

        Returns
        -------
        rows : ndarray of int, shape (j,)
            Of those quantities.
        samples : Sampled, shape (j, m)
            Theirs, with these extremes, and the last one repeated again.
        others : Sampled, shape (j, m)
            The same with the extremes by polynomials through two samples fewer.
        """
        times, values, rates = self
        first, last, width = values[:, :-1], values[:, 1:], np.diff(times, axis=1)
        # An arc lies within its tangents.
        ahead, back = first + width * rates[:, :-1], last - width * rates[:, 1:]
        beyond = (np.maximum(first, last) < high) & (np.minimum(ahead, back) >= high)
        beyond |= (np.minimum(first, last) >= low) & (np.maximum(ahead, back) < low)
        rows, columns = np.nonzero(beyond)
        # Where the slope of the cubic polynomial, a + b part + c part², vanishes.
        fall, width = (first - last)[rows, columns], width[rows, columns]
        a, end = width * rates[rows, columns], width * rates[rows, columns + 1]
        b, c = -6.0 * fall - 4.0 * a - 2.0 * end, 6.0 * fall + 3.0 * (a + end)
        part = 2.0 * np.abs(a) / (np.sqrt(b * b - 4.0 * a * c) - np.sign(a) * b)
        cubic = first[rows, columns] + part * (a + part * (b / 2.0 + part * c / 3.0))
        wanted = times[rows, columns] + part * width
        found = np.empty((2, 2, rows.size))
        for some, polynomials, _, _ in self.part(rows).around(columns + 1) if rows.size else ():
            told = [polynomial(wanted[some]) for polynomial in polynomials[:2]]
            found[:, :, some] = np.array(told)[..., 0]
        # Around an impact, the polynomial of more samples may tell anything.
        values_there = found[0, 0]
        both = np.minimum(cubic, values_there) >= high, np.maximum(cubic, values_there) < low
        is_so = np.where(a > 0.0, *both)
        rows, wanted, found = rows[is_so], wanted[is_so], found[..., is_so]
        chosen, place, counts = np.unique(rows, return_inverse=True, return_counts=True)
        numbers = np.arange(rows.size) - np.searchsorted(rows, rows)

        def whole(more: Array) -> Any:
            held = []
            for each, new in zip(self, (wanted, *more), strict=True):
                room = np.repeat(each[chosen, -1:], np.max(counts, initial=0), axis=1)
                room[place, numbers] = new
                held.append(np.hstack((each[chosen], room)))
            order = np.argsort(held[0], axis=1, kind="stable")
            return type(self)(*(np.take_along_axis(each, order, axis=1) for each in held))

        return chosen, whole(found[0]), whole(found[1])

    def extremes(self) -> tuple[Array, Array]:
        """Least and largest value between samples, by cubic polynomials, each shape (k, n - 1).

        Both are taken to go beyond the samples by half as much again, which stands for the error.
        """
        times, values, rates = self
        width, first, last = np.diff(times, axis=1), values[:, :-1], values[:, 1:]
        least, most = np.minimum(first, last), np.maximum(first, last)
        low, high = least, most
        for part in np.linspace(0.0, 1.0, 9)[1:-1].tolist():
            rest = 1.0 - part
            value = (1.0 + 2.0 * part) * rest**2 * first + part**2 * (3.0 - 2.0 * part) * last
            value += width * part * rest * (rest * rates[:, :-1] - part * rates[:, 1:])
            low, high = np.minimum(low, value), np.maximum(high, value)
        return low + 0.5 * (low - least), high + 0.5 * (high - most)


def running_mean(times: Array, values: Array, window: float | Array) -> Array:
    """Mean of sampled values over a window about each sample, shape (n,), shorter at the ends.

    Parameters
    ----------
    times, values : ndarray, shape (n,)
    window : float or ndarray, shape (n,)
        Its whole width.
    """
    total = cumulative_trapezoid(values, times, initial=0.0)
    left = np.maximum(times - 0.5 * window, times[0])
    right = np.minimum(times + 0.5 * window, times[-1])
    sums = np.interp(right, times, total) - np.interp(left, times, total)
    return sums / (right - left)


def _apart(times: Array) -> tuple[Numbers, Numbers, Numbers]:
    """Columns of each row with those first that are not close to the next one, and how many.

    The last array says which these are. The first and the last column are always among them.
    """
    spacing = np.diff(times, axis=1)
    typical = (times[:, -1] - times[:, 0]) / np.maximum(1, np.sum(spacing > 0.0, axis=1))
    kept = np.ones(times.shape, dtype=bool)
    kept[:, 1:-1] = spacing[:, 1:] >= _CLOSE * typical[:, None]
    return np.argsort(~kept, axis=1, kind="stable"), kept.sum(axis=1), kept


def _differences(through: Sequence[Polynomials], low: Array, high: Array) -> list[Array]:
    """Largest differences of polynomials from the next ones between two times, shape (m, k)."""
    probes = low + np.multiply.outer(_PROBES, high - low)
    found = [each(probes)[0] for each in through]
    return [np.max(np.abs(one - other), axis=0) for one, other in pairwise(found)]


def _error(through: Sequence[Polynomials], low: Array, high: Array) -> Array:
    """Error to expect of the first of three polynomials through fewer and fewer samples."""
    apart, before = (each[:, 0] for each in _differences(through, low, high))
    # Around an impact, or of too few samples, more of them tell nothing.
    tells = (apart < _GAIN * before) | (apart < _ROUNDING)
    return np.where(tells, CAUTION * apart, np.inf)


def _solve(polynomial: Polynomials, level: float, low: Array, high: Array) -> tuple[Array, Array]:
    """Where each takes a value between two times, and its slope there, by Newton's rule.

    A step that leaves what is known to hold the place halves it instead.
    """
    starts, ends = polynomial(np.array((low, high)))[0][..., 0] - level
    with np.errstate(divide="ignore", invalid="ignore"):
        place = low + (high - low) * np.clip(np.nan_to_num(starts / (starts - ends)), 0.0, 1.0)
    slope, is_sought = np.zeros(place.shape), np.ones(place.shape, dtype=bool)
    for _ in range(_STEPS):
        value, slopes = (each[:, 0] for each in polynomial(place))
        beyond = (value - level > 0.0) != (starts > 0.0)
        low, high = np.where(beyond, low, place), np.where(beyond, place, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = place - (value - level) / slopes
        wanted = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
        moved = np.abs(wanted - place)
        # What has been found stays as it is while others are sought.
        place, slope = np.where(is_sought, (wanted, slopes), (place, slope))
        is_sought &= moved > 4.0 * np.spacing(np.abs(place))
        if not is_sought.any():
            break
    return place, slope


def _polynomials(nodes: Array, values: Array, rates: Array) -> Polynomials:
    """Newton's form with every node taken twice; value and slope by Horner's rule.

    Shapes are (m, p) of the nodes, (m, p, k) of values and rates.
    """
    doubled = np.repeat(nodes, 2, axis=1)
    table = np.repeat(values, 2, axis=1)
    coefficients = [table[:, 0]]
    for order in range(1, doubled.shape[1]):
        gaps = (doubled[:, order:] - doubled[:, :-order])[..., None]
        rises = table[:, 1:] - table[:, :-1]
        if order == 1:
            table = np.empty_like(rises)
            table[:, 0::2] = rates
            table[:, 1::2] = rises[:, 1::2] / gaps[:, 1::2]
        else:
            table = rises / gaps
        coefficients.append(table[:, 0])

    def at(wanted: Array) -> tuple[Array, Array]:
        value, slope = coefficients[-1], np.zeros_like(coefficients[-1])
        for row in range(len(coefficients) - 2, -1, -1):
            step = (wanted - doubled[:, row])[..., None]
            slope = slope * step + value
            value = value * step + coefficients[row]
        return value, slope

    return at
