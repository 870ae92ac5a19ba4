"""Compiled runs of the members of an ensemble, as arrays from its fields to its motions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.compiled import systems
from analysis.compiled.batches import PosedMember, checked_effort, ladder_to
from analysis.compiled.code import Code, values
from analysis.compiled.lots import RUNNING, Judged, Lot, run_to
from analysis.compiled.runs import code_for
from analysis.compiled.systems import SPIN
from analysis.data.checks import Array
from analysis.data.endings import Condition
from analysis.data.ensemble import Ensemble
from analysis.data.files import AnyArray
from analysis.data.members import Rows, in_columns
from analysis.data.scenario import Scenario
from analysis.data.trajectories import Part, Samples
from analysis.data.trajectory import Trajectory
from analysis.mechanics import reduced
from analysis.mechanics.states import paper_arrays, state_of
from analysis.models.forms import Form, check_form, default_form, start_values
from analysis.models.simulation import local_tolerances
from analysis.solve.effort import longest_step
from analysis.solve.stepping import Run


@dataclass(frozen=True, slots=True, eq=False)
class CompiledPart:
    """Members of an ensemble that were run as a lot; see `Part`.

    Parameters
    ----------
    rows : ndarray of int, shape (k,)
    ensemble : Ensemble
        Of these members alone.
    form : str
    conditions : mapping
        From reasons to functions of a `State`.
    times : ndarray, shape (n,)
    tolerances : ndarray, shape (k,)
    judged : Judged
    reasons : tuple of str
        Of the endings.
    frame : tuple of two ndarrays, shapes (k, 12) and (k, p)
        State of the index-1 system at the start, and parameters of the code.
    """

    rows: Rows
    ensemble: Ensemble
    form: Form
    conditions: Mapping[str, Condition]
    times: Array
    tolerances: Array
    judged: Judged
    reasons: tuple[str, ...]
    frame: tuple[Array, Array]

    def moved(self, by: int) -> "CompiledPart":
        """The same with larger numbers of members."""
        return replace(self, rows=self.rows + by)

    def some(self, rows: Rows) -> "CompiledPart":
        """The same without some of its members."""
        return replace(
            self,
            rows=self.rows[rows],
            ensemble=self.ensemble.part(rows),
            tolerances=self.tolerances[rows],
            judged=self.judged.part(rows),
            frame=(self.frame[0][rows], self.frame[1][rows]),
        )

    @property
    def ends(self) -> Array:
        """Time of each end in s."""
        return self.judged.reached.ends

    @property
    def error_estimates(self) -> Array:
        """Estimated errors in rad, or nan."""
        return self.judged.estimates

    @property
    def endings(self) -> AnyArray:
        """Reasons, or None."""
        names = np.array([*self.reasons, None], dtype=object)
        assert RUNNING == -1
        found: AnyArray = names[self.judged.reached.reasons]
        return found

    def kinematics(self, some: slice) -> Samples:
        """Samples of some at the times asked for, and at their ends, without forces."""
        return self._sampled(some)[0]

    def samples(self, some: slice) -> Samples:
        """The same with constraint forces."""
        found, states = self._sampled(some)
        numbers = self.frame[1][some]
        if self.form == "reduced":
            z, u = (np.moveaxis(each, 2, 0) for each in (found.coordinates, found.rates))
            variables = np.stack(state_of(systems.disk_of(numbers[:, None]), z, u))
        else:
            variables = np.ascontiguousarray(np.moveaxis(states, 2, 0))
        code = code_for(self.ensemble[0], self.form, self.conditions, allow_pulling=False)
        forces = code.multipliers_of(variables, numbers)
        return replace(found, multipliers=np.moveaxis(forces, 0, 2))

    def _sampled(self, some: slice) -> tuple[Samples, Array]:
        """Samples of some without forces, and the states that they come from."""
        judged, columns = self.judged.reached, np.arange(self.times.size + 1)
        ends = judged.ends[some, None]
        counts = np.searchsorted(self.times, judged.ends[some], side="right")
        times = np.minimum(np.append(self.times, np.inf), ends)
        states = np.append(judged.states[some], judged.last[some, None], axis=1)
        over = columns >= counts[:, None]
        states[over] = np.repeat(judged.last[some], over.sum(axis=1), axis=0)
        start, numbers = (each[some] for each in self.frame)
        found = _expanded(self.form, start, numbers, states, times - self.times[0])
        return Samples(times, *found, np.empty((*times.shape, 0))), states

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""
        member = PosedMember.of(self.ensemble[row], self.form, self.conditions)
        return member.trajectory(self.judged, row, self.times, float(self.tolerances[row]))


def _expanded(
    form: Form, starts: Array, numbers: Array, states: Array, passed: Array
) -> tuple[Array, Array]:
    """Coordinates and rates, each shape (k, n, 6), from states at times since the start."""
    disk = systems.disk_of(numbers[:, None])
    if form == "index-1":
        return paper_arrays(disk, states)
    spin = numbers[:, None, SPIN]
    alpha = starts[:, None, 3] + spin * passed
    found = np.empty((*passed.shape, 12))
    coordinates, rates = reduced.expanded(disk, spin, alpha, np.moveaxis(states, 2, 0))
    for column, value in enumerate(coordinates + rates):
        found[:, :, column] = value
    return found[:, :, :6], found[:, :, 6:]


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked of the members of an ensemble, beside their tolerances; see `simulate`."""

    times: Array
    form: Form | None
    local_tolerance: float | None
    conditions: Mapping[str, Condition]


def simulate_ensemble(
    ensemble: Ensemble, tolerances: Sequence[float | None], request: Request
) -> tuple[list[Part], dict[int, Exception], list[int]]:
    """Motions of those members of an ensemble that run as lots.

    Parameters
    ----------
    ensemble : Ensemble
        Of m members.
    tolerances : sequence of m floats or None
        As in `simulate`.
    request : Request

    Returns
    -------
    list of Part
    dict
        From members to the errors that ended them.
    list of int
        Members that must be looked at one by one: they cannot be compiled, or may be refused.
    """
    parts: list[Part] = []
    failures: dict[int, Exception] = {}
    others: list[int] = []
    told = {each: ladder_to(each, request.local_tolerance)[1] for each in set(tolerances)}
    wanted = np.array([told[each] for each in tolerances])
    least = float(wanted.min())

    def columns(scenario: Scenario) -> tuple[Code, Form, list[Sequence[float]]]:
        form = default_form(scenario) if request.form is None else request.form
        check_form(scenario, form)
        effort = checked_effort(scenario, request.times, least, request.local_tolerance)
        code = code_for(scenario, form, request.conditions, allow_pulling=False)
        return (
            code,
            form,
            [
                start_values(scenario, form),
                systems.parameters(scenario),
                (longest_step(scenario),),
                (effort.most,),
                start_values(scenario, "index-1"),
            ],
        )

    for rows, found in ensemble.alike(columns):
        if isinstance(found, Exception):
            others += rows.tolist()
            continue
        code, form, numbers = found
        arrays = [in_columns(each, rows.size) for each in numbers]
        # The force at the start; one that is not a number is looked at again, too.
        pressed = values(code.multipliers, arrays[4], arrays[1])[:, 0] >= 0.0
        others += rows[~pressed].tolist()
        for ladder, some in _by_ladder(wanted[rows], np.flatnonzero(pressed), request):
            members = rows[some]
            part, failed = _run_part(
                ensemble.part(members),
                (code, form, ladder),
                [each[some] for each in arrays],
                wanted[members],
                request,
            )
            failures |= {int(members[row]): error for row, error in failed.items()}
            left = np.array([row for row in range(members.size) if row not in failed], dtype=int)
            if left.size:
                kept = part.some(left) if failed else part
                parts.append(replace(kept, rows=members[left]))
    return parts, failures, others


def _by_ladder(
    tolerances: Array, rows: Rows, request: Request
) -> Iterator[tuple[tuple[float, ...], Rows]]:
    """Rows with the same local tolerances."""
    if request.local_tolerance is not None:
        if rows.size:
            yield (request.local_tolerance,), rows
        return
    each, places = np.unique(tolerances[rows], return_inverse=True)
    kinds = [tuple(local_tolerances(float(tolerance), "taylor")) for tolerance in each]
    for kind in dict.fromkeys(kinds):
        same = np.array([other == kind for other in kinds])
        yield kind, rows[same[places]]


def _run_part(
    ensemble: Ensemble,
    kind: tuple[Code, Form, tuple[float, ...]],
    arrays: list[Array],
    tolerances: Array,
    request: Request,
) -> tuple[CompiledPart, dict[int, Exception]]:
    code, form, ladder = kind
    starts, numbers, longest, most, states = arrays

    def alone(row: int, *how: float) -> Run | Exception:
        member = PosedMember.of(ensemble[row], form, request.conditions)
        return member.alone(request.times, *how)

    lot = Lot(code, form, starts, numbers, longest[:, 0], most[:, 0], alone)
    judged = run_to(lot, request.times, ladder, tolerances)
    part = CompiledPart(
        rows=np.arange(len(ensemble)),
        ensemble=ensemble,
        form=form,
        conditions=request.conditions,
        times=request.times,
        tolerances=tolerances,
        judged=judged,
        reasons=code.reasons,
        frame=(states, numbers),
    )
    return part, judged.failures
