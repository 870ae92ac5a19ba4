"""Where a run ends: found among samples, then located by short runs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import pi, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.state import State
from mbs_models import columns
from mbs_models.runs import EngineError

Says = Callable[[Array], float]
"""From a sample to a number; the run ends where that turns negative."""


def says_of(conditions: Mapping[str, Condition], *, may_pull: bool) -> dict[str, Says]:
    """What ends a run, by its reason; that the disk lies flat comes first.

    Parameters
    ----------
    conditions : mapping
        Functions of a `State`.
    may_pull : bool
        Whether a contact that pulls is none of the reasons.
    """

    def of_state(condition: Condition) -> Says:
        return lambda row: condition(state_of(row))

    found: dict[str, Says] = {FLAT: lambda row: float(leaning(row)) - LEAST_TILT}
    if not may_pull:
        found[CONTACT_WOULD_PULL] = lambda row: float(row[columns.NORMAL_FORCE])
    return found | {reason: of_state(condition) for reason, condition in conditions.items()}


def leaning(rows: Array) -> Array:
    """Angle in rad between disk and table in samples.

    It is negative where beta lies outside (0, pi), by whole turns if a run has failed.
    """
    tilts = rows[..., columns.BETA]
    result: Array = np.minimum(tilts, pi - tilts)
    return result


def state_of(row: Array) -> State:
    """State of a sample."""
    values = row.tolist()
    coordinates, rates = values[columns.COORDINATES], values[columns.RATES]
    return State(coordinates=tuple(coordinates), rates=tuple(rates))


def touch_down(
    after: Callable[[float], Array], row: Array, width: float, pull: float
) -> float | None:
    """Time after a sample at which the disk lies flat, if it goes straight there.

    Steps that stop short of it and shrink: beyond, there is no motion to look at. One that goes
    too far all the same, which may fail, is taken back.

    Parameters
    ----------
    after : callable
        From a positive time after the sample in s to the sample there.
    row : ndarray, shape (12 + k,)
    width : float
        Latest time in s.
    pull : float
        Angular acceleration in rad/s² with which a disk falls, at most.
    """
    moment, here, part = 0.0, row, 1.0
    for _ in range(40):
        gap = float(leaning(here)) - LEAST_TILT
        if moment and gap < 1e-3 * LEAST_TILT:
            return moment
        rising = float(here[columns.BETA_RATE])
        rate = rising if here[columns.BETA] > 0.5 * pi else -rising
        if rate <= 0.0 or part < 0.01:
            return None
        later = moment + part * 2.0 * gap / (rate + sqrt(rate**2 + 2.0 * pull * gap))
        if later > width:
            return None
        try:
            there = after(later)
        except EngineError:
            there = None
        if there is None or leaning(there) < (1.0 - 1e-3) * LEAST_TILT:
            part *= 0.5
        else:
            moment, here = later, there
    return None


class Dip(NamedTuple):
    """Where a condition is negative, or may be between two samples.

    Parameters
    ----------
    row : int
        Sample before it, where it is not negative.
    width : float
        Sampling intervals after it that hold the dip.
    sure : bool
        Whether it is negative at the end of them.
    """

    row: int
    width: float
    sure: bool


def dips(values: Array) -> Iterator[Dip]:
    """Places to look at, in order, up to the first sample at which a condition turns negative.

    Parameters
    ----------
    values : ndarray, shape (n,)
        What the condition says at even spacing. Where it is negative from the start on, it waits
        until it has not been.
    """
    armed = int(np.argmax(values >= 0.0)) if values.size else 0
    if not values.size or values[armed] < 0.0:
        return
    first = armed + 1
    negative = np.flatnonzero(values[first:] < 0.0)
    end = first + int(negative[0]) if negative.size else values.size - 1
    before, here, after = (
        values[first - 1 : end - 1],
        values[first:end],
        values[first + 1 : end + 1],
    )
    curvature = before - 2.0 * here + after
    lowest = (np.minimum(before, after) >= here) & (after >= 0.0) & (curvature > 0.0)
    bent = np.where(lowest, curvature, 1.0)
    vertex = here - (after - before) ** 2 / (8.0 * bent)
    near = vertex < 0.1 * (np.maximum(before, after) - here)
    for place in np.flatnonzero(lowest & near).tolist():
        yield Dip(armed + place, 2.0, sure=False)
    if negative.size:
        yield Dip(end - 1, 1.0, sure=True)


def zero(
    says: Callable[[float], float], begin: float, width: float, *, sure: bool
) -> float | None:
    """First time in [0, width] at which a condition turns negative, if it does.

    Parameters
    ----------
    says : callable
        The condition at a positive time in s.
    begin : float
        What it says at time 0, not negative.
    width : float
        In s.
    sure : bool
        Whether it is known to be negative at `width`, up to rounding.
    """
    last = width
    if not sure:
        least = minimize_scalar(
            says, bounds=(0.0, width), method="bounded", options={"xatol": 1e-3 * width}
        )
        last = float(least.x)
        if says(last) >= 0.0:
            return None
    elif says(last) >= 0.0:
        return last
    return float(
        brentq(lambda time: says(time) if time else begin, 0.0, last, xtol=1e-13, rtol=1e-13)
    )


class Found(NamedTuple):
    """Where a run ends: `moment` s after sample `row`, with these `values`, for this reason."""

    reason: str
    row: int
    moment: float
    values: Array


class Search:
    """Search for the first ending among the samples of a run.

    Parameters
    ----------
    after : callable
        From a sample, a time in s after it and a number of records to the sample there, by a
        short run with as many steps as so many records take.
    values : ndarray, shape (n, 12 + k)
        Samples at even spacing.
    period : float
        Time between them in s.
    broke_off : bool
        Whether the run failed after the last of them.
    pull : float
        See `touch_down`.
    """

    def __init__(
        self,
        after: Callable[[Array, float, int], Array],
        values: Array,
        period: float,
        broke_off: bool,
        pull: float,
    ) -> None:
        self._after, self._values, self._period = after, values, period
        self._broke_off, self._pull = broke_off, pull

    def first(
        self, says: Mapping[str, Says], stopped_by: str | None, beyond: float
    ) -> Found | None:
        """Earliest of the endings.

        Parameters
        ----------
        says : mapping
            As `says_of` makes it.
        stopped_by : str or None
            The reason for which the run was stopped after the last sample.
        beyond : float
            Time in s after the last sample at which it was.
        """
        found: list[Found] = []
        lying = np.flatnonzero(leaning(self._values) < LEAST_TILT)
        upright = int(lying[0]) if lying.size else len(self._values)
        flat = self._flat(upright)
        if flat is not None:
            found = [flat]
        for reason, each in says.items():
            if reason == FLAT:
                continue
            series = self._series(reason, each, self._values[:upright])
            places = list(dips(series))
            if stopped_by == reason and beyond > 1e-9 * self._period:
                places.append(Dip(upright - 1, beyond / self._period, sure=True))
            for place in places:
                ending = self._located(reason, each, place, float(series[place.row]))
                if ending is not None:
                    found.append(ending)
                    break
        return min(
            found, key=lambda ending: ending.row + ending.moment / self._period, default=None
        )

    @staticmethod
    def _series(reason: str, says: Says, values: Array) -> Array:
        """What a condition says at samples; for those that every run has, read at once."""
        if reason == CONTACT_WOULD_PULL:
            return values[:, columns.NORMAL_FORCE]
        return np.array([says(row) for row in values])

    def _located(self, reason: str, says: Says, place: Dip, begin: float) -> Found | None:
        after = self._from_before(place.row, place.width)
        moment = zero(
            lambda time: says(after(time)), begin, place.width * self._period, sure=place.sure
        )
        return None if moment is None else Found(reason, place.row, moment, after(moment))

    def _flat(self, upright: int) -> Found | None:
        """Where the disk lies flat, if it goes there, or the run broke off on the way there.

        Parameters
        ----------
        upright : int
            Number of samples before the first one at which it lies flat.
        """
        row = upright - 1
        if row < 0 or (upright == len(self._values) and not self._broke_off):
            return None
        after = self._from_before(row, 1.0)
        moment = touch_down(after, self._values[row], 2.0 * self._period, self._pull)
        return None if moment is None else Found(FLAT, row, moment, after(moment))

    def _from_before(self, row: int, width: float) -> Callable[[float], Array]:
        """Samples at times after sample `row`, by runs from the one before it.

        Very short steps would make the forces noisy.
        """
        first = max(0, row - 1)
        records = int(np.ceil(width)) + row - first
        lead = self._period * (row - first)
        return lambda moment: self._after(self._values[first], lead + moment, records)


def pulling_times(
    moments: Sequence[float], forces: Sequence[float]
) -> tuple[tuple[float, float], ...]:
    """Times in s between which a force is negative, by linear interpolation of samples.

    Parameters
    ----------
    moments : sequence of n floats
        Increasing times in s.
    forces : sequence of n floats
        In N.
    """
    times, values = np.asarray(moments), np.asarray(forces)
    negative = values < 0.0
    if not np.any(negative):
        return ()
    edges = np.flatnonzero(negative[1:] != negative[:-1])
    share = values[edges] / (values[edges] - values[edges + 1])
    crossings = (times[edges] + share * np.diff(times)[edges]).tolist()
    if negative[0]:
        crossings.insert(0, float(times[0]))
    if negative[-1]:
        crossings.append(float(times[-1]))
    return tuple(zip(crossings[::2], crossings[1::2], strict=True))
