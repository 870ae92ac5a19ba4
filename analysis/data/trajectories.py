"""The motions of an ensemble as arrays, and each of them as a `Trajectory` if it is asked for."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from analysis.data.checks import Array
from analysis.data.ensemble import Ensemble
from analysis.data.files import AnyArray
from analysis.data.inversion import Inversions, direction_rates, inversions
from analysis.data.members import Rows
from analysis.data.trajectory import Trajectory

BETA, GAMMA = 4, 5
"""Columns of the coordinates."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
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

    def attitudes(self) -> Array:
        """Angles beta and gamma, shape (k, n, 2)."""

    def kinematics(self) -> tuple[Array, Array]:
        """Coordinates and rates, each shape (k, n, 6)."""

    def last(self) -> tuple[Array, Array]:
        """Coordinates and rates at the ends, each shape (k, 6)."""

    def at(self, rows: Rows, columns: Rows) -> tuple[Array, Array]:
        """Coordinates and rates of rows, shape (j,), at samples, shape (j, p), as in `Samples`."""

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Listed:
    """Motions that were run one by one; behind the end of one its arrays mean nothing."""

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
        estimates = [motion.error_estimate for motion in self.motions]
        return np.array([np.nan if each is None else each for each in estimates])

    @property
    def endings(self) -> AnyArray:
        """Reasons, or None."""
        endings = [motion.ending for motion in self.motions]
        return np.array([each and each.reason for each in endings], dtype=object)

    def attitudes(self) -> Array:
        """Angles beta and gamma, shape (k, n, 2)."""
        return self.kinematics()[0][:, :, BETA:]

    def kinematics(self) -> tuple[Array, Array]:
        """Coordinates and rates, each shape (k, n, 6)."""
        found = np.full((2, len(self.motions), self.samples, 6), np.nan)
        for row, motion in enumerate(self.motions):
            count = min(motion.times.size, self.samples)
            found[0, row, :count] = motion.coordinates[:count]
            found[1, row, :count] = motion.rates[:count]
        return found[0], found[1]

    def last(self) -> tuple[Array, Array]:
        """Coordinates and rates at the ends, each shape (k, 6)."""
        coordinates = np.array([motion.coordinates[-1] for motion in self.motions])
        return coordinates, np.array([motion.rates[-1] for motion in self.motions])

    def at(self, rows: Rows, columns: Rows) -> tuple[Array, Array]:
        """Coordinates and rates of rows, shape (j,), at samples, shape (j, p), as in `Samples`."""
        found = np.empty((2, *columns.shape, 6))
        for place, row in enumerate(rows.tolist()):
            motion = self.motions[row]
            wanted = np.minimum(columns[place], motion.times.size - 1)
            found[0, place], found[1, place] = motion.coordinates[wanted], motion.rates[wanted]
        return found[0], found[1]

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""
        return self.motions[row]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Trajectories:
    """Motions of the members of an ensemble, each at the times asked for.

    Where a member has failed or its motion has ended before, arrays hold nan.
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
        part, row = self._places[member]
        return self.parts[part].trajectory(row)

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
    def _places(self) -> dict[int, tuple[int, int]]:
        """Part of each member, and its row there."""
        return {
            member: (number, row)
            for number, part in enumerate(self.parts)
            for row, member in enumerate(part.rows.tolist())
        }

    @cached_property
    def ends(self) -> Array:
        """Time of the end of each motion in s, shape (m,)."""
        return self._whole([part.ends for part in self.parts])

    @cached_property
    def error_estimates(self) -> Array:
        """Estimated errors of beta and gamma in rad, shape (m,); nan where there is none."""
        return self._whole([part.error_estimates for part in self.parts])

    @cached_property
    def endings(self) -> AnyArray:
        """Why motions ended before the last time asked for, or None, shape (m,); see `Ending`."""
        return self._whole([part.endings for part in self.parts], empty=None)

    @property
    def coordinates(self) -> Array:
        """Co-rotating coordinates, Eq. (8), in m and rad, shape (m, n, 6)."""
        return self._kinematics[0]

    @property
    def rates(self) -> Array:
        """Time derivatives of the coordinates, shape (m, n, 6)."""
        return self._kinematics[1]

    @property
    def last_coordinates(self) -> Array:
        """Coordinates at the ends, shape (m, 6)."""
        return self._last[0]

    @property
    def last_rates(self) -> Array:
        """Rates at the ends, shape (m, 6)."""
        return self._last[1]

    @cached_property
    def inversions(self) -> Inversions:
        """What became of the inversion of each member; see `Trajectory.inversion`."""
        eccentric = self.ensemble.numbers(lambda scenario: scenario.disk.eccentricity) > 0.0
        sines = np.sin(self._during([part.attitudes() for part in self.parts], 2))
        last = np.prod(np.sin(self.last_coordinates[:, BETA:]), axis=1)
        directions = np.append(sines[:, :, 0] * sines[:, :, 1], last[:, None], axis=1)
        times = np.append(self.times, np.inf)
        np.copyto(directions, last[:, None], where=times > self.ends[:, None])
        # The centre of gravity of a disk without eccentricity is never above the centre.
        directions *= eccentric[:, None]
        return inversions(np.minimum(times, self.ends[:, None]), directions, self._direction_rates)

    def _direction_rates(self, members: Rows, columns: Rows) -> Array:
        """Rates of where the centre of gravity lies, of members at samples as in `Samples`."""
        found = np.empty(columns.shape)
        for part in self.parts:
            places = np.full(len(self), -1)
            places[part.rows] = np.arange(len(part.rows))
            some = np.flatnonzero(places[members] >= 0)
            found[some] = direction_rates(*part.at(places[members[some]], columns[some]))
        return found

    @cached_property
    def _kinematics(self) -> tuple[Array, Array]:
        found = [part.kinematics() for part in self.parts]
        return self._during([z for z, _ in found], 6), self._during([u for _, u in found], 6)

    @cached_property
    def _last(self) -> tuple[Array, Array]:
        found = [part.last() for part in self.parts]
        coordinates = self._whole([z for z, _ in found], (6,))
        return coordinates, self._whole([u for _, u in found], (6,))

    def _during(self, values: Sequence[Array], columns: int) -> Array:
        """Samples of all members, nan behind their ends."""
        whole = self._whole(values, (self.times.size, columns))
        whole.setflags(write=True)
        whole[self.times > self.ends[:, None]] = np.nan
        whole.setflags(write=False)
        return whole

    def _whole(
        self, values: Sequence[AnyArray], shape: tuple[int, ...] = (), empty: float | None = np.nan
    ) -> AnyArray:
        """Values of all members from those of the parts."""
        kind: Any = object if empty is None else float
        whole = np.full((len(self), *shape), empty, dtype=kind)
        for part, some in zip(self.parts, values, strict=True):
            whole[part.rows] = some
        whole.setflags(write=False)
        return whole


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
