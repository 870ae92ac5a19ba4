"""What is kept of a motion: a row of numbers and words, and series where they are asked for."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from analysis import SpatialMotion, Trajectory, outcomes
from analysis.motion.outcomes import OUTCOMES, Row
from analysis.motion.quantities import quantities
from analysis.problem.checks import Array, choice

COLUMNS: Mapping[str, str | None] = {
    **OUTCOMES,
    "other_inversion": None,
    "other_face_end": "",
    "other_error_estimate": "rad",
    "other_seconds": "s",
    "difference": "rad",
    "code": None,
}
"""Columns of a row behind those of the axes, with their units; None for words.

Behind `OUTCOMES` those of the run of the other side, where there is one ("failed" if it gave
none, with its reason); `difference` is the largest of beta and gamma in rad over the samples of
both, or `SpatialMotion.deviation`; `code` names commit and sources that the row comes from.
"""

TIME = "time"
"""The series that goes with all others: times of the samples in s."""

SERIES = tuple(name for columns in quantities(Trajectory).values() for name in columns)[1:]
"""What can be kept of a trajectory; what a scenario does not have, such as a torque, is empty."""

REST_SERIES = tuple(name for columns in quantities(SpatialMotion).values() for name in columns)[1:]
"""What can be kept of a motion to rest."""

GROUPS: Mapping[str, tuple[str, ...]] = {
    name: tuple(quantities(Trajectory)[name]) for name in ("coordinates", "rates")
}
"""Names for several series of a trajectory."""

NUMBERS = "<f8"
"""Of a series in a store, as `numpy.frombuffer` takes it: 8 bytes each, the lowest one first."""


def series_named(names: Iterable[str], *, to_rest: bool) -> tuple[str, ...]:
    """Series by their names or those of `GROUPS`, each once.

    Raises
    ------
    ValueError
        If there is no such series.
    """
    groups = {} if to_rest else GROUPS
    found = [each for name in names for each in groups.get(name, (name,))]
    known = REST_SERIES if to_rest else SERIES
    return tuple(dict.fromkeys(choice("keep", name, (*groups, *known)) for name in found))


def series(motion: Trajectory | SpatialMotion, names: Sequence[str]) -> dict[str, bytes]:
    """Bytes of some series of a motion and of its times; those that it has."""
    held = motion.columns()
    return {
        name: held[name][0].astype(NUMBERS).tobytes() for name in (TIME, *names) if name in held
    }


def outcome(motion: Trajectory | SpatialMotion) -> Row:
    """What is kept of a motion, without its run time."""
    (row,) = outcomes([motion]).rows()
    return {name: row[name] for name in OUTCOMES}


def difference(one: Trajectory | SpatialMotion, other: Trajectory | SpatialMotion) -> float:
    """How far two motions of a case differ; see `COLUMNS`."""
    if isinstance(one, SpatialMotion) and isinstance(other, SpatialMotion):
        return one.deviation(other)
    assert isinstance(one, Trajectory)
    assert isinstance(other, Trajectory)
    count = min(one.times.size, other.times.size)
    # Motions that end early do so at times that differ a little.
    common = np.flatnonzero(one.times[:count] == other.times[:count])
    angles: list[Array] = [motion.coordinates[common, 4:6] for motion in (one, other)]
    return float(np.max(np.abs(angles[0] - angles[1])))
