"""What each of many motions came to: whether the disk was inverted, forces, energies, endings."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from analysis.compiled.ensemble import CompiledPart
from analysis.data.checks import Array
from analysis.data.constraint_set import (
    PRESCRIBED,
    ConstraintSet,
    multiplier_names,
    prescribed,
)
from analysis.data.dense import Numbers
from analysis.data.dissipation import CAUSES
from analysis.data.endings import TIME_LIMIT
from analysis.data.ensemble import Ensemble
from analysis.data.inversion import STAYING, Inversions, direction_rates, inversions
from analysis.data.members import Rows
from analysis.data.outcomes import DONE, OutcomeTable, failed, failure
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.state import COORDINATES
from analysis.data.trajectories import BETA, Samples, Trajectories
from analysis.data.trajectory import Trajectory
from analysis.models.balance import energies

_ALPHA = 3
"""Column of the rates."""

_BLOCK = 2**14
"""Samples of motions that are judged at once: they take some 5 MB."""


def outcomes(
    motions: Trajectories | Iterable[Trajectory | SpatialMotion | Exception],
) -> OutcomeTable:
    """Outcomes of many motions, as a sweep keeps them.

    Parameters
    ----------
    motions : Trajectories or iterable
        What `simulate_many` returns, or motions of any kind and errors.

    Returns
    -------
    OutcomeTable
        A row for each, with the columns of `analysis.data.outcomes.OUTCOMES`.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Ensemble, Scenario, outcomes, simulate_many
    >>> spins = Ensemble(scenario=Scenario(), fields={"spin": np.array([10.0, 40.0])})
    >>> table = outcomes(simulate_many(spins, np.linspace(0.0, 2.0, 401), workers=1))
    >>> table.columns["inversion"].tolist(), table.columns["inverted_at"].round(4).tolist()
    (['not inverted', 'inverted'], [nan, 0.4852])
    >>> bool(table.columns["taken_sliding"][1] > 0.0), table.units["taken_sliding"]
    (True, 'J')
    """
    if not isinstance(motions, Trajectories):
        listed = list(motions)
        table = OutcomeTable.empty({}, len(listed))
        _put(table, enumerate(listed))
        return table
    table = OutcomeTable.empty(motions.ensemble.fields, len(motions))
    for part in motions.parts:
        one_by_one = part.rows
        if isinstance(part, CompiledPart):
            _put_part(table, part)
            # What is not finite is an error of that member.
            forces = table.columns["force_least"] + table.columns["force_largest"]
            one_by_one = part.rows[~np.isfinite(forces[part.rows])]
        _put(table, ((member, motions.outcome(member)) for member in one_by_one.tolist()))
    _put(table, motions.failures.items())
    table.columns["seconds"][:] = motions.seconds
    return table


def _put(
    table: OutcomeTable, motions: Iterable[tuple[int, Trajectory | SpatialMotion | Exception]]
) -> None:
    """Put in motions one by one."""
    for number, motion in motions:
        row = slice(number, number + 1)
        if isinstance(motion, Exception):
            table.put(row, failure(motion))
            continue
        is_slow = motion.ending is not None and motion.ending.reason == TIME_LIMIT
        table.put(row, failed("too slow", str(motion.ending)) if is_slow else {"status": DONE})
        table.put(row, _spatial(motion) if isinstance(motion, SpatialMotion) else _plain(motion))
        told = {
            "ending": None if motion.ending is None else motion.ending.reason,
            "end": motion.times[-1],
            "error_estimate": motion.error_estimate,
        }
        table.put(row, told)


def _put_part(table: OutcomeTable, part: CompiledPart) -> None:
    """Put in motions that are arrays; none of these has a time limit."""
    eccentric = part.ensemble.numbers(lambda scenario: scenario.disk.eccentricity)
    constraints = part.ensemble[0].constraints
    ends = np.empty((2, len(part.rows), 2, 6))
    size = max(1, _BLOCK // part.times.size)
    for first in range(0, len(part.rows), size):
        some = slice(first, first + size)
        samples = part.samples(some)
        table.put(part.rows[some], _sampled(constraints, samples, eccentric[some]))
        ends[0, some], ends[1, some] = samples.coordinates[:, [0, -1]], samples.rates[:, [0, -1]]
    told = {"status": DONE, "ending": part.endings, "end": part.ends}
    table.put(part.rows, told | {"error_estimate": part.error_estimates})
    for rows, scenario in _scenarios(part.ensemble):
        members = part.rows[rows]
        brought = {name: table.columns[name][members] for name in _brought(constraints)}
        table.put(members, _balance(scenario, ends[0, rows], ends[1, rows], brought))


def _scenarios(ensemble: Ensemble) -> Iterator[tuple[Rows, Scenario]]:
    """Scenarios of members, of those that go the same way as one."""

    def level_or_leaning(scenario: Scenario) -> Scenario:
        _ = bool(scenario.table.is_horizontal)
        return scenario

    for rows, found in ensemble.alike(level_or_leaning):
        if isinstance(found, Exception):
            for row in rows.tolist():
                yield np.array([row]), ensemble[row]
        else:
            yield rows, found


def _spatial(motion: SpatialMotion) -> Mapping[str, Any]:
    phases, total, inversion = motion.phases, motion.energies.sum(axis=1), motion.inversion
    judged = Inversions(
        outcomes=np.array([inversion.outcome], dtype=object),
        times=np.array([inversion.time], dtype=float),
        lost=np.array([inversion.lost], dtype=float),
        time_errors=np.array([inversion.time_error], dtype=float),
        lost_errors=np.array([inversion.lost_error], dtype=float),
    )
    return {
        **_judged(judged, motion.times[None], motion.spin[None], motion.normal_force[None]),
        "cog_direction_end": motion.cog_direction[-1],
        "face_end": motion.rotations[-1, 2, 2],
        "energy_start": total[0],
        "energy_end": total[-1],
        **{f"taken_{cause}": motion.energy_taken(cause)[-1] for cause in CAUSES},
        "rolling_from": phases.rolling,
        "flat_from": phases.flat,
        "rest_from": phases.rest,
    }


def _plain(motion: Trajectory) -> Mapping[str, Any]:
    scenario = motion.scenario
    arrays = (motion.times, motion.coordinates, motion.rates, motion.multipliers)
    samples = Samples(*(each[None] for each in arrays))
    found = _sampled(scenario.constraints, samples, np.array([scenario.disk.eccentricity]))
    if scenario.contact is not None:
        # It does not hold what its spring stores and its damper takes.
        return found
    ends = samples.coordinates[:, [0, -1]], samples.rates[:, [0, -1]]
    brought = {name: found[name] for name in _brought(scenario.constraints)}
    return {**found, **_balance(scenario, *ends, brought)}


def _brought(constraints: ConstraintSet) -> tuple[str, ...]:
    """Columns of what the prescribed rates of a set brought."""
    return tuple(f"brought_by_{name}" for name in prescribed(constraints))


def _sampled(
    constraints: ConstraintSet, samples: Samples, eccentricities: Array
) -> Mapping[str, Array]:
    """What samples of k motions tell by themselves, each shape (k,)."""
    times, beta, spin = samples.times, samples.coordinates[:, :, BETA], samples.rates[:, :, _ALPHA]
    directions = np.sin(beta) * np.sin(samples.coordinates[:, :, BETA + 1])

    def rates_at(rows: Numbers, columns: Numbers) -> Array:
        near = rows[:, None], columns
        return direction_rates(samples.coordinates[near], samples.rates[near])

    # The centre of gravity of a disk without eccentricity is never above the centre.
    judged = inversions(times, directions * (eccentricities > 0.0)[:, None], rates_at)
    found = {
        **_judged(judged, times, spin, samples.multipliers[:, :, 0]),
        "cog_direction_end": directions[:, -1],
        "face_end": np.cos(beta[:, -1]),
    }
    names = multiplier_names(constraints)
    for name, column in zip(prescribed(constraints), _brought(constraints), strict=True):
        rate = samples.rates[:, :, COORDINATES.index(PRESCRIBED[name])]
        found[column] = integrals(times, samples.multipliers[:, :, names.index(name)] * rate)
    return found


def _judged(judged: Inversions, times: Array, spin: Array, force: Array) -> dict[str, Array]:
    after = np.full(len(times), np.nan)
    for row in np.flatnonzero(np.isfinite(judged.times)).tolist():
        after[row] = np.interp(judged.times[row] + STAYING, times[row], spin[row])
    return {
        "inversion": judged.outcomes,
        "inverted_at": judged.times,
        "inverted_at_error": judged.time_errors,
        "lost_at": judged.lost,
        "lost_at_error": judged.lost_errors,
        "spin_after": after,
        "spin_end": spin[:, -1],
        "force_least": force.min(axis=1),
        "force_largest": force.max(axis=1),
    }


def _balance(
    scenario: Scenario, coordinates: Array, rates: Array, brought: Mapping[str, Array]
) -> Mapping[str, Array]:
    """Energies of k motions at their starts and ends, shape (k, 2, 6), and what sliding took."""
    kinetic, potential = energies(scenario, coordinates, rates)
    first, last = np.asarray(kinetic + potential)
    taken = sum(brought.values(), first - last)
    return {"energy_start": first, "energy_end": last, "taken_sliding": taken}


def integrals(times: Array, values: Array) -> Array:
    """Integrals by Simpson's rule, as `scipy.integrate.simpson` has it, shape (k,).

    Parameters
    ----------
    times, values : ndarray, shape (k, n)
        Of each row the last sample may be repeated, so that rows may differ in length.
    """
    if times.shape[1] % 2 == 0:
        times, values = (np.append(each, each[:, -1:], axis=1) for each in (times, values))
    steps = np.diff(times)
    first, second = steps[:, ::2], steps[:, 1::2]
    pairs = second > 0.0
    h, k = np.where(pairs, first, 1.0), np.where(pairs, second, 1.0)
    both = h + k
    parts = (2.0 - k / h) * values[:, :-2:2] + both**2 / (h * k) * values[:, 1::2]
    parts += (2.0 - h / k) * values[:, 2::2]
    found: Array = np.sum(both * parts / 6.0, axis=1, where=pairs)
    # An interval that is left over takes the parabola through the sample before it, too.
    rows, places = np.nonzero((first > 0.0) & ~pairs)
    left = 2 * places
    k = times[rows, left + 1] - times[rows, left]
    found[rows] += 0.5 * k * (values[rows, left] + values[rows, left + 1])
    rows, left, k = rows[left > 0], left[left > 0], k[left > 0]
    h = times[rows, left] - times[rows, left - 1]
    bend = (values[rows, left] - values[rows, left - 1]) / h
    bend = (values[rows, left + 1] - values[rows, left]) / k - bend
    found[rows] -= k**3 / (6.0 * (h + k)) * bend
    return found
