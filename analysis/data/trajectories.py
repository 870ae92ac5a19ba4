"""The motions of an ensemble as arrays, and each of them as a `Trajectory` if it is asked for."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from analysis.data.checks import Array
from analysis.data.ensemble import Ensemble
from analysis.data.files import AnyArray
from analysis.data.inversion import Inversions, inversions
from analysis.data.members import Rows
from analysis.data.motion_quantities import InCoordinates, lowest
from analysis.data.trajectory import Trajectory

_BLOCK = 2**14
"""Samples of motions that are looked at at once: they take some 5 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples(InCoordinates):
    """Samples of k motions; behind the end of one its last sample is repeated.

    Parameters
    ----------
    times : ndarray, shape (k, n)
    coordinates, rates : ndarray, shape (k, n, 6)
    multipliers : ndarray, shape (k, n, c)
    """

    times: Array
    coordinates: Array
    rates: Array
    multipliers: Array

    @classmethod
    def of(cls, motion: Trajectory, count: int) -> "Samples":
        """So many samples of one motion, k = 1."""
        rows = np.minimum(np.arange(count), motion.times.size - 1)[None]
        arrays = (motion.times, motion.coordinates, motion.rates, motion.multipliers)
        return cls(*(each[rows] for each in arrays))

    def direction_rates(self, some: Rows) -> Array:
        """Rate of `cog_direction` of some of the motions in 1/s, shape (j, n)."""
        kept = replace(self, coordinates=self.coordinates[some], rates=self.rates[some])
        return kept.cog_direction_rate


class Part(Protocol):
    """Motions of k members that were run in one way."""

    @property
    def rows(self) -> Rows:
        """Numbers of the members, shape (k,)."""

    @property
    def ends(self) -> Array:
        """Time of each end in s, shape (k,)."""

    @property
    def error_estimates(self) -> Array:
        """Estimated errors in rad, or nan, shape (k,)."""

    @property
    def endings(self) -> AnyArray:
        """Reasons, or None, shape (k,)."""

    def moved(self, by: int) -> "Part":
        """The same with larger numbers of members."""

    def kinematics(self, some: slice) -> Samples:
        """Samples of some at the n times asked for, and at their ends, without forces."""

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Listed:
    """Motions that were run one by one, at so many times asked for."""

    rows: Rows
    motions: Sequence[Trajectory]
    samples: int

    def moved(self, by: int) -> "Listed":
        """The same with larger numbers of members."""
        return replace(self, rows=self.rows + by)

    @property
    def ends(self) -> Array:
        """Time of each end in s."""
        return np.array([motion.times[-1] for motion in self.motions])

    @property
    def error_estimates(self) -> Array:
        """Estimated errors in rad, or nan."""
        return np.array([motion.error_estimate for motion in self.motions], dtype=float)

    @property
    def endings(self) -> AnyArray:
        """Reasons, or None."""
        endings = [motion.ending for motion in self.motions]
        return np.array([each and each.reason for each in endings], dtype=object)

    def kinematics(self, some: slice) -> Samples:
        """Samples of some at the times asked for, and at their ends, without forces."""
        each = [Samples.of(motion, self.samples + 1) for motion in self.motions[some]]
        return Samples(
            np.concatenate([one.times for one in each]),
            np.concatenate([one.coordinates for one in each]),
            np.concatenate([one.rates for one in each]),
            np.empty((len(each), self.samples + 1, 0)),
        )

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""
        return self.motions[row]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Trajectories(InCoordinates):
    """Motions of the members of an ensemble, each at the times asked for.

    Quantities are those of a `Trajectory`, of all members: `runs.cog_height` has the shape
    (m, n). Where a member has failed or its motion has ended before, arrays hold nan.
    `trajectories[member]` is a `Trajectory` as `simulate` returns it, with constraint forces and
    all, or raises the error that ended that member.

    Parameters
    ----------
    ensemble : Ensemble
        Of m members.
    times : ndarray, shape (n,)
        In s.
    parts : sequence of Part
    failures : mapping
        From numbers of members to errors.
    seconds : ndarray, shape (m,)
        Processor time of each run in s; of members that ran together the mean.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import MODELS, Ensemble, Scenario, simulate_many
    >>> spins = Ensemble(scenario=Scenario(), fields={"spin": np.array([30.0, 200.0])})
    >>> runs = simulate_many(spins, np.linspace(0.0, 0.2, 21), workers=1)
    >>> runs.endings.tolist()
    [None, 'contact would pull']
    >>> np.isnan(runs.coordinates[:, -1, 4]).tolist()
    [False, True]
    >>> bool(runs[1].normal_force[-1] < 1e-6)
    True
    """

    ensemble: Ensemble
    times: Array
    parts: Sequence[Part]
    failures: Mapping[int, Exception]
    seconds: Array

    def __len__(self) -> int:
        return len(self.ensemble)

    def __getitem__(self, member: int) -> Trajectory:
        member = range(len(self))[member]
        if member in self.failures:
            raise self.failures[member]
        part = next(part for part in self.parts if member in part.rows)
        return part.trajectory(int(np.argmax(part.rows == member)))

    def __iter__(self) -> Iterator[Trajectory]:
        return (self[member] for member in range(len(self)))

    def __repr__(self) -> str:
        return f"Trajectories({self.ensemble!r}, {len(self.failures)} failed)"

    def outcome(self, member: int) -> Trajectory | Exception:
        """Motion of a member, or the error that ended it."""
        try:
            return self[member]
        except (ArithmeticError, ValueError, OSError, RuntimeError) as error:
            return error

    @cached_property
    def _eccentricity(self) -> Array:
        return self.ensemble.numbers(lambda scenario: scenario.disk.eccentricity)[:, None]

    def _lowest(self, up: Any) -> Any:
        return np.array([lowest(each, one) for each, one in zip(self.ensemble, up, strict=True)])

    @cached_property
    def ends(self) -> Array:
        """Time of the end of each motion in s, shape (m,)."""
        return self._whole("ends", np.nan)

    @cached_property
    def error_estimates(self) -> Array:
        """Estimated errors of beta and gamma in rad, shape (m,); nan where there is none."""
        return self._whole("error_estimates", np.nan)

    @cached_property
    def endings(self) -> AnyArray:
        """Why motions ended before the last time asked for, or None, shape (m,); see `Ending`."""
        return self._whole("endings", None)

    @cached_property
    def coordinates(self) -> Array:
        """Co-rotating coordinates, Eq. (8), in m and rad, shape (m, n, 6)."""
        return self._kinematics[0]

    @cached_property
    def rates(self) -> Array:
        """Time derivatives of the coordinates, shape (m, n, 6)."""
        return self._kinematics[1]

    @property
    def last_coordinates(self) -> Array:
        """Coordinates at the ends, shape (m, 6)."""
        return self._kinematics[2]

    @property
    def last_rates(self) -> Array:
        """Rates at the ends, shape (m, 6)."""
        return self._kinematics[3]

    @cached_property
    def inversions(self) -> Inversions:
        """What became of the inversion of each member; see `Trajectory.inversion`."""
        outcomes = np.full(len(self), "not inverted", dtype=object)
        numbers = np.full((4, len(self)), np.nan)
        for rows, samples in self._blocks():
            eccentricities = self._eccentricity[rows, 0]
            found = inversions(
                samples.times, samples.cog_direction, samples.direction_rates, eccentricities
            )
            outcomes[rows], numbers[:, rows] = found.outcomes, found.numbers
        return Inversions(outcomes, *numbers)

    @cached_property
    def _kinematics(self) -> tuple[Array, Array, Array, Array]:
        """Coordinates and rates at the times asked for, and at the ends."""
        whole = np.full((2, len(self), self.times.size + 1, 6), np.nan)
        for rows, samples in self._blocks():
            whole[0, rows], whole[1, rows] = samples.coordinates, samples.rates
        whole[:, :, :-1][:, self.times > self.ends[:, None]] = np.nan
        whole.setflags(write=False)
        return whole[0, :, :-1], whole[1, :, :-1], whole[0, :, -1], whole[1, :, -1]

    def _blocks(self) -> Iterator[tuple[Rows, Samples]]:
        """Numbers of some members at a time, and their samples, without forces."""
        for part in self.parts:
            for some in blocks(len(part.rows), self.times.size):
                yield part.rows[some], part.kinematics(some)

    def _whole(self, name: str, empty: float | None) -> AnyArray:
        """What the parts tell of their members, of all of them."""
        whole = np.full(len(self), empty)
        for part in self.parts:
            whole[part.rows] = getattr(part, name)
        whole.setflags(write=False)
        return whole


def blocks(rows: int, samples: int) -> Iterator[slice]:
    """Rows with so many samples, some at a time."""
    size = max(1, _BLOCK // samples)
    return (slice(first, first + size) for first in range(0, rows, size))


def joined(ensemble: Ensemble, pieces: Sequence[Trajectories]) -> Trajectories:
    """Motions of an ensemble from those of its pieces, one after the other."""
    parts: list[Part] = []
    failures: dict[int, Exception] = {}
    first = 0
    for piece in pieces:
        parts += [part.moved(first) for part in piece.parts]
        failures |= {first + member: error for member, error in piece.failures.items()}
        first += len(piece)
    return Trajectories(
        ensemble=ensemble,
        times=pieces[0].times,
        parts=parts,
        failures=failures,
        seconds=np.concatenate([piece.seconds for piece in pieces]),
    )
