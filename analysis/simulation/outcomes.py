"""What each of many motions came to: whether the disk was inverted, forces, energies, endings."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from scipy.integrate import simpson
from scipy.interpolate import CubicSpline

from analysis.motion.endings import TIME_LIMIT
from analysis.motion.inversion import STAYING, inversions
from analysis.motion.outcomes import DONE, OutcomeTable, failed, failure
from analysis.motion.sampled import SampledMotion
from analysis.motion.spatial_motion import SpatialMotion
from analysis.motion.stored_runs import StoredRun
from analysis.problem.checks import Array, instance, several
from analysis.problem.constraints import multiplier_names, prescribed
from analysis.problem.contact import CAUSES
from analysis.problem.start import COORDINATES
from analysis.simulation.compiled.ensemble import Samples
from analysis.simulation.energies import energies_of
from analysis.simulation.trajectories import Trajectories, stacked

_APART = 1e-3
"""Part of the energy at the start by which the work of a torque may differ between all samples and
either half of them, every other one: the rule has then mostly erred by a fifteenth of that."""

_FEWEST = 9
"""Samples below which these agree by chance."""

_AROUND = 6
"""Samples to either side that a value between two of them is told from."""


def outcomes(
    motions: Trajectories | Iterable[StoredRun | BaseException],
) -> OutcomeTable:
    """Outcomes of many motions, as a sweep keeps them.

    Parameters
    ----------
    motions : Trajectories or iterable
        What `simulate_many` returns, or motions of any kind and errors.

    Returns
    -------
    OutcomeTable
        A row for each, with the columns of `analysis.motion.outcomes.OUTCOMES`.

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
    alone: Mapping[int, StoredRun | BaseException]
    if isinstance(motions, Trajectories):
        table = OutcomeTable.empty(motions.ensemble.fields, len(motions))
        for rows, samples in motions.blocks():
            table.put(rows, _in_coordinates(samples))
        columns = {"status": DONE, "ending": motions.endings, "end": motions.ends}
        columns |= {"error_estimate": motions.error_estimates, "seconds": motions.seconds}
        table.put(slice(None), columns)
        # What is not finite is an error of that member.
        forces = table.columns["force_least"] + table.columns["force_largest"]
        apart = ~np.isfinite(forces) | (motions.endings == TIME_LIMIT)
        alone = {member: motions.outcome(member) for member in np.flatnonzero(apart).tolist()}
    else:
        alone = dict(enumerate(several("motions", motions, "motions and errors")))
        table = OutcomeTable.empty({}, len(alone))
    for member, motion in alone.items():
        if isinstance(motion, BaseException):
            row: Mapping[str, Any] = failure(motion)
        else:
            row = _row(instance(f"motions[{member}]", motion, SampledMotion))
        table.put(slice(member, member + 1), row)
    for rows, samples in stacked(alone):
        table.put(rows, _in_coordinates(samples))
    return table


def _row(motion: StoredRun) -> Mapping[str, Any]:
    is_slow = motion.ending is not None and motion.ending.reason == TIME_LIMIT
    return {
        **(failed("too slow", str(motion.ending)) if is_slow else {"status": DONE}),
        **(_to_rest(motion) if isinstance(motion, SpatialMotion) else {}),
        "ending": None if motion.ending is None else motion.ending.reason,
        "end": motion.times[-1],
        "error_estimate": motion.error_estimate,
    }


def _to_rest(motion: SpatialMotion) -> Mapping[str, Any]:
    phases, total = motion.phases, motion.energies.sum(axis=1)
    return {
        **_sampled(motion),
        "energy_start": total[0],
        "energy_end": total[-1],
        **{f"taken_{each}": np.diff(motion.energy_taken(each)[[0, -1]])[0] for each in CAUSES},
        "rolling_from": phases.rolling,
        "flat_from": phases.flat,
        "rest_from": phases.rest,
    }


def _in_coordinates(samples: Samples) -> Mapping[str, Array]:
    """What samples of k motions in the paper's coordinates tell, each shape (k,)."""
    ends = samples.coordinates[:, [0, -1]], samples.rates[:, [0, -1]]
    energies = np.array(energies_of(samples.scenario, *ends))
    brought = _brought(samples, np.abs(energies[..., 0]).sum(axis=0))
    found = _sampled(samples) | brought
    if samples.scenario.contact is not None:
        # It does not hold what its spring stores and its damper takes.
        return found
    first, last = energies.sum(axis=0).T
    taken = first - last + sum(brought.values())
    return found | {"energy_start": first, "energy_end": last, "taken_sliding": taken}


def _sampled(motion: Samples | StoredRun) -> dict[str, Array]:
    """What samples of k motions tell by themselves, each shape (k,)."""
    names = ("times", "cog_direction", "face", "spin", "normal_force")
    times, directions, face, spin, force = (np.atleast_2d(getattr(motion, each)) for each in names)
    found = inversions(motion)
    after = np.full(len(times), np.nan)
    for row in np.flatnonzero(np.isfinite(found.times)).tolist():
        after[row] = _at(found.times[row] + STAYING, times[row], spin[row])
    return {
        "inversion": found.outcomes,
        "inverted_at": found.times,
        "inverted_at_error": found.time_errors,
        "lost_at": found.lost,
        "lost_at_error": found.lost_errors,
        "spin_after": after,
        "spin_end": spin[:, -1],
        "cog_direction_end": directions[:, -1],
        "face_end": face[:, -1],
        "force_least": force.min(axis=1),
        "force_largest": force.max(axis=1),
    }


def _at(wanted: float, times: Array, values: Array) -> float:
    """What a sampled quantity is at a time, by cubic polynomials through the samples around it."""
    # Behind the end of a motion its last sample is repeated.
    last = int(np.searchsorted(times, times[-1])) + 1
    near = slice(max(0, int(np.searchsorted(times[:last], wanted)) - _AROUND), last)
    some = times[near][: 2 * _AROUND], values[near][: 2 * _AROUND]
    return float(CubicSpline(*some)(min(wanted, some[0][-1])))


def _brought(samples: Samples, energy: Array) -> dict[str, Array]:
    """Work of those forces that keep a rate as it is, by Simpson's rule, each shape (k,).

    It is no number where half of the samples give another one, by a part of the energy at the
    start, shape (k,), or where there are few.
    """
    constraints, times, found = samples.scenario.constraints, samples.times, {}
    names = multiplier_names(constraints)
    # Behind the end of a motion its last sample is repeated.
    counts = 1 + np.count_nonzero(np.diff(times), axis=1)
    for name, coordinate in prescribed(constraints).items():
        rate = samples.rates[..., COORDINATES.index(coordinate)]
        power = samples.multipliers[..., names.index(name)] * rate
        work = found[f"brought_by_{name}"] = np.empty(len(counts))
        for count in np.unique(counts).tolist():
            rows, inner, sums = counts == count, np.arange(1, count - 1), []
            for each in (inner, inner[::2], inner[1::2]):
                some = np.ix_(rows, np.r_[0, each, count - 1])
                sums.append(simpson(power[some], x=times[some]))
            tells = (np.ptp(sums, axis=0) <= _APART * energy[rows]) & (count >= _FEWEST)
            work[rows] = np.where(tells, sums[0], np.nan)
    return found
