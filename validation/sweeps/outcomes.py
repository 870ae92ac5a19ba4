"""What is kept of a motion: a row of numbers and words, and series where they are asked for."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.integrate import simpson

from analysis import (
    CAUSES,
    CONSTRAINTS,
    SpatialMotion,
    Trajectory,
    energies,
    multiplier_names,
)
from analysis.data.checks import Array, choice
from analysis.data.endings import TIME_LIMIT
from analysis.data.inversion import STAYING
from analysis.data.state import COORDINATES

Cell = float | str | bytes | None
Row = dict[str, Cell]

DONE = "done"
FAILURES = ("refused", "failed", "too slow", "crashed")
"""The scenario cannot be run as asked; the run ends in an error, meets its time limit, or takes
the interpreter down."""

COLUMNS: Mapping[str, str] = {
    "status": "TEXT",
    "reason": "TEXT",
    "inversion": "TEXT",
    "inverted_at": "REAL",
    "lost_at": "REAL",
    "spin_after": "REAL",
    "spin_end": "REAL",
    "cog_direction_end": "REAL",
    "face_end": "REAL",
    "force_least": "REAL",
    "force_largest": "REAL",
    "energy_start": "REAL",
    "energy_end": "REAL",
    **{f"taken_{cause}": "REAL" for cause in CAUSES},
    "brought_by_spin_torque": "REAL",
    "rolling_from": "REAL",
    "flat_from": "REAL",
    "rest_from": "REAL",
    "ending": "TEXT",
    "end": "REAL",
    "error_estimate": "REAL",
    "seconds": "REAL",
    "other_inversion": "TEXT",
    "other_face_end": "REAL",
    "other_error_estimate": "REAL",
    "other_seconds": "REAL",
    "difference": "REAL",
}
"""Columns of a row behind those of the axes, with their types.

status, reason
    "done", or one of `FAILURES` and why. A case that the other side failed on has its reason
    here, too.
inversion, inverted_at, lost_at
    As `Inversion` says; times in s.
spin_after, spin_end
    Vertical angular velocity in rad/s: rate of alpha on an ideal contact. When the disk has
    stayed up for `STAYING`, and at the end.
cog_direction_end, face_end
    Vertical parts of the unit vectors from G to S and normal to the disk, at the end.
force_least, force_largest
    Normal force in N over the samples.
energy_start, energy_end, taken_..., brought_by_spin_torque
    In J: kinetic, gravitational and elastic energy; what each cause took; and what the torque
    that keeps the spin constant brought. Empty where a motion does not hold it.
rolling_from, flat_from, rest_from
    Times in s of `Phases`.
ending, end
    Why the motion ended early, and when it ended, in s.
error_estimate, seconds
    Of the run, in rad; processor time in s.
other_...
    Of the run of the other side, where there is one ("failed" if it gave none); `difference` is
    the largest of beta and gamma in rad over the samples of both, or `SpatialMotion.deviation`.
"""

TIME = "time"
"""The series that goes with all others: times of the samples in s."""

SERIES: tuple[str, ...] = (
    *COORDINATES,
    *(f"{name}_rate" for name in COORDINATES),
    *multiplier_names(CONSTRAINTS),
    "cog_height",
    *(f"contact_{axis}" for axis in "xyz"),
)
"""What can be kept of a trajectory; what a scenario does not have, such as a torque, is empty."""

REST_SERIES: tuple[str, ...] = (
    *(f"position_{axis}" for axis in "xyz"),
    *(f"quaternion_{part}" for part in "wxyz"),
    *(f"velocity_{axis}" for axis in "xyz"),
    *(f"angular_velocity_{axis}" for axis in "xyz"),
    *(f"contact_{axis}" for axis in "xyz"),
    *(f"taken_by_{cause}" for cause in CAUSES),
    *(f"{kind}_energy" for kind in ("kinetic", "potential", "elastic")),
    *("slip_speed", "contour_speed", "normal_force", "tilt", "cog_height"),
)
"""What can be kept of a motion to rest."""

GROUPS: Mapping[str, tuple[str, ...]] = {
    "coordinates": COORDINATES,
    "rates": tuple(f"{name}_rate" for name in COORDINATES),
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


def series(motion: Trajectory | SpatialMotion, names: Sequence[str]) -> Row:
    """Bytes of some series of a motion and of its times; nothing if there are no names."""
    if not names:
        return {}
    held = motion.columns()
    wanted = [TIME, *(name for name in names if name in held)]
    return {name: held[name][0].astype(NUMBERS).tobytes() for name in wanted}


def failure(status: str, error: BaseException | str) -> Row:
    """What is kept of a case without a motion."""
    text = " ".join(str(error).split()) or type(error).__name__
    return {"status": status, "reason": text}


def outcome(motion: Trajectory | SpatialMotion) -> Row:
    """What is kept of a motion, without its run time."""
    inversion = motion.inversion
    is_slow = motion.ending is not None and motion.ending.reason == TIME_LIMIT
    row: Row = {
        "status": "too slow" if is_slow else DONE,
        "reason": str(motion.ending) if is_slow else None,
        "inversion": inversion.outcome,
        "inverted_at": inversion.time,
        "lost_at": inversion.lost,
        "cog_direction_end": float(motion.cog_direction[-1]),
        "force_least": float(motion.normal_force.min()),
        "force_largest": float(motion.normal_force.max()),
        "ending": None if motion.ending is None else motion.ending.reason,
        "end": float(motion.times[-1]),
        "error_estimate": motion.error_estimate,
    }
    row |= _spatial(motion) if isinstance(motion, SpatialMotion) else _plain(motion)
    spin = motion.spin if isinstance(motion, SpatialMotion) else motion.rate("alpha")
    row["spin_end"] = float(spin[-1])
    if inversion.time is not None:
        row["spin_after"] = float(np.interp(inversion.time + STAYING, motion.times, spin))
    return row


def _spatial(motion: SpatialMotion) -> Row:
    phases, total = motion.phases, motion.energies.sum(axis=1)
    return {
        "face_end": float(motion.rotations[-1, 2, 2]),
        "energy_start": float(total[0]),
        "energy_end": float(total[-1]),
        **{f"taken_{cause}": float(motion.energy_taken(cause)[-1]) for cause in CAUSES},
        "rolling_from": phases.rolling,
        "flat_from": phases.flat,
        "rest_from": phases.rest,
    }


def _plain(motion: Trajectory) -> Row:
    row: Row = {"face_end": float(np.cos(motion.coordinate("beta")[-1]))}
    if motion.scenario.contact is not None:
        # The trajectory does not hold what its spring stores and its damper takes.
        return row
    ends = [0, -1]
    kinetic, potential = energies(motion.scenario, motion.coordinates[ends], motion.rates[ends])
    first, last = (kinetic + potential).tolist()
    brought = 0.0
    if "constant-spin" in motion.scenario.constraints:
        power = motion.multiplier("spin_torque") * motion.rate("alpha")
        brought = float(simpson(power, x=motion.times))
        row["brought_by_spin_torque"] = brought
    return row | {
        "energy_start": first,
        "energy_end": last,
        "taken_sliding": first - last + brought,
    }


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
