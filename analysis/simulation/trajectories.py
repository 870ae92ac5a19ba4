"""The motions of an ensemble as arrays, and each of them as a `Trajectory` if it is asked for."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from analysis.mechanics import recorded
from analysis.motion.files import AnyArray
from analysis.motion.inversion import Inversions, inversions
from analysis.motion.quantities import InCoordinates, filled, lowest
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.elementary import Rows
from analysis.problem.variations import Ensemble
from analysis.simulation.compiled.ensemble import LOOKED_AT, CompiledRuns, Samples


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
    compiled : sequence of CompiledRuns
        Members that were run together.
    alone : mapping
        Motions of members that were run by themselves, by their numbers.
    failures : mapping
        Errors that ended members, by their numbers.
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
    compiled: Sequence[CompiledRuns]
    alone: Mapping[int, Trajectory]
    failures: Mapping[int, Exception]
    seconds: Array

    def __len__(self) -> int:
        return len(self.ensemble)

    def __getitem__(self, member: int) -> Trajectory:
        member = self.ensemble.number(member)
        if member in self.failures:
            raise self.failures[member]
        if member in self.alone:
            return self.alone[member]
        found = next(each for each in self.compiled if member in each.group.rows)
        return found.trajectory(member, self.ensemble[member])

    def __iter__(self) -> Iterator[Trajectory]:
        return (self[member] for member in range(len(self)))

    def __repr__(self) -> str:
        return f"Trajectories({self.ensemble!r}, {len(self.failures)} failed)"

    def outcome(self, member: int) -> Trajectory | Exception:
        """Motion of a member, or the error that ended it."""
        failed = self.failures.get(self.ensemble.number(member))
        try:
            return failed or self[member]
        except (ArithmeticError, ValueError) as error:
            return error

    @property
    def _eccentricity(self) -> Array:
        return self._sampled[3]

    def _lowest(self, up: Any) -> Any:
        # Behind an ending there are no numbers, which complex division would warn of.
        with np.errstate(invalid="ignore"):
            return np.array([lowest(*each) for each in zip(self.ensemble, up, strict=True)])

    @cached_property
    def ends(self) -> Array:
        """Time of the end of each motion in s, shape (m,)."""
        return self._of_each("ends", np.nan, lambda motion: motion.times[-1])

    @cached_property
    def error_estimates(self) -> Array:
        """Estimated errors of beta and gamma in rad, shape (m,); nan where there is none."""
        return self._of_each("estimates", np.nan, lambda motion: motion.error_estimate)

    @cached_property
    def endings(self) -> AnyArray:
        """Why motions ended before the last time asked for, or None, shape (m,); see `Ending`."""
        return self._of_each("reasons", None, lambda run: run.ending and run.ending.reason)

    @property
    def coordinates(self) -> Array:
        """Co-rotating coordinates, Eq. (8), in m and rad, shape (m, n, 6)."""
        return self._sampled[0]

    @property
    def rates(self) -> Array:
        """Time derivatives of the coordinates, shape (m, n, 6)."""
        return self._sampled[1]

    @property
    def normal_force(self) -> Array:
        """Normal contact force lambda_N in N, shape (m, n)."""
        return self._sampled[2]

    @cached_property
    def inversions(self) -> Inversions:
        """What became of the inversion of each member; see `Trajectory.inversion`."""
        outcomes = np.full(len(self), "not inverted", dtype=object)
        numbers = np.full((4, len(self)), np.nan)
        for rows, samples in self.blocks():
            found = inversions(samples)
            outcomes[rows], numbers[:, rows] = found.outcomes, found.numbers
        return Inversions(outcomes, *numbers)

    @cached_property
    def _sampled(self) -> tuple[Array, Array, Array, Array]:
        """Coordinates, rates and normal forces at the times asked for, and eccentricities."""
        found = np.full((len(self), self.times.size, 13), np.nan)
        eccentricities = np.full((len(self), 1), np.nan)
        for rows, samples in self.blocks():
            every = samples.coordinates, samples.rates, samples.multipliers[..., :1]
            values = np.concatenate(every, axis=-1)[..., : self.times.size, :]
            found[rows, : values.shape[-2]] = values
            eccentricities[rows] = samples.scenario.disk.eccentricity
        found[self.times > self.ends[:, None]] = np.nan
        found.setflags(write=False)
        return found[..., :6], found[..., 6:12], found[..., 12], eccentricities

    def blocks(self) -> Iterator[tuple[Rows, Samples]]:
        """Numbers of some members at a time that have not failed, and their samples.

        The last one of each is that at its end.
        """
        for each in self.compiled:
            for some, samples in each.blocks():
                yield each.group.rows[some], samples
        yield from stacked(self.alone)

    def _of_each(self, name: str, none: Any, alone: Callable[[Trajectory], Any]) -> AnyArray:
        """What `Runs` have by this name, and others by a function; or none, shape (m,)."""
        found = np.full(len(self), none)
        for each in self.compiled:
            found[each.group.rows] = getattr(each.runs, name)
        for row, motion in self.alone.items():
            found[row] = alone(motion)
        found.setflags(write=False)
        return found


def stacked(motions: Mapping[int, Any]) -> Iterator[tuple[Rows, Samples]]:
    """Numbers and samples of what is a `Trajectory` of these, of some alike at a time."""
    alike: defaultdict[Any, list[int]] = defaultdict(list)
    for row, motion in motions.items():
        if isinstance(motion, Trajectory):
            scenario, size = motion.scenario, motion.times.size
            # No more of them together than may be looked at at once.
            block = row * size // LOOKED_AT
            alike[scenario.constraints, scenario.contact, size, block].append(row)
    for (constraints, contact, *_), rows in alike.items():
        some = [motions[row] for row in rows]
        numbers = [recorded.numbers(each.scenario)[: len(recorded.NUMBERS)] for each in some]
        arrays = ([getattr(each, name) for each in some] for name in filled(Trajectory))
        yield np.array(rows), Samples.of(constraints, contact, numbers, *arrays)
