"""How far motions are from each other: as a whole, and quantity by quantity."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, isfinite
from typing import Any

import numpy as np

from analysis import SpatialMotion, StoredRun, Trajectory, energies
from analysis.motion.endings import FLAT
from analysis.motion.spatial_motion import SAME_TIME
from analysis.problem.checks import Array, ToleranceError
from analysis.solve.to_tolerance import error_at_ending
from validation.comparison.limits import largest
from validation.display.tables import Cell, Table, show

ANGLES = slice(4, 6)
"""Columns of beta and gamma."""

COARSEST = 1e-3
"""Error in rad that interpolation between samples may have for motions to be compared at all."""

_SIGNED_AT_WILL = "quaternion_"
"""The two signs of a quaternion are the same attitude, so its parts tell no difference."""


# --- As a whole ---------------------------------------------------------------------------------


def deviation(run: StoredRun, other: StoredRun) -> float:
    """Largest difference of beta and gamma in rad over what two runs of a kind have in common.

    Where both end for the same reason, also at one time there, but for a disk that lies flat,
    whose gamma has no meaning. Infinite if a number is none. Of motions to rest it is
    `SpatialMotion.deviation`.
    """
    if isinstance(run, SpatialMotion) and isinstance(other, SpatialMotion):
        return run.deviation(other)
    assert isinstance(run, Trajectory)
    assert isinstance(other, Trajectory)
    rows = _common(run, other)
    apart = np.abs(run.coordinates[:rows] - other.coordinates[:rows])[:, ANGLES]
    found = apart.ravel().tolist()
    if isfinite(late := ending_error(run, other)) and run.ending and run.ending.reason != FLAT:
        last = run.coordinates[-1, ANGLES] - other.coordinates[-1, ANGLES]
        found.append(float(error_at_ending(last, late, other.rates[-1, ANGLES])))
    return largest(found)


def ending_error(run: Trajectory, other: Trajectory) -> float:
    """Difference in s of the times at which two runs end; infinite if not both for one reason."""
    if run.ending is None and other.ending is None:
        return 0.0
    if run.ending is None or other.ending is None or run.ending.reason != other.ending.reason:
        return inf
    return abs(run.ending.time - other.ending.time)


def energy_error(run: Trajectory, other: Trajectory) -> float:
    """Largest deviation of the energy over what two runs have in common, relative."""
    rows = _common(run, other)
    total, expected = (
        np.sum(energies(each.scenario, each.coordinates, each.rates), axis=0)[:rows]
        for each in (run, other)
    )
    return float(np.max(np.abs(total - expected)) / np.max(expected))


def _common(run: Trajectory, other: Trajectory) -> int:
    """Number of samples that two runs of the same times share; the ending of one is none."""
    early = run.ending is not None or other.ending is not None
    return min(run.times.size, other.times.size) - early


# --- Quantity by quantity -----------------------------------------------------------------------


def difference_table(runs: Sequence[tuple[str, StoredRun]]) -> Table:
    """Largest and root-mean-square difference of every quantity from that of the first run.

    Parameters
    ----------
    runs : sequence of (str, StoredRun)
        Labels and motions. They are compared at the sample times of the first where both have
        samples; where those of another lie elsewhere, it is interpolated, and the note says to
        which error.
    """
    (first_name, first), *others = runs
    rows: list[list[Cell]] = []
    notes = []
    for name, run in others:
        inside = (first.times >= run.times[0]) & (first.times <= run.times[-1])
        times = first.times[inside]
        try:
            found, error = _at(run, times)
        except (ToleranceError, ValueError) as refusal:
            notes.append(f"{name} is not compared: {refusal}.")
            continue
        if error:
            told = f"to {error:.1e} rad; forces and energies by cubic or straight lines"
            notes.append(f"{name} is interpolated between its samples, {told}.")
        if times.size < first.times.size:
            notes.append(f"{name} is compared from {times[0]:g} to {times[-1]:g} s alone.")
        for quantity, values in first.to_dict().items():
            if quantity == "time" or quantity not in found or _SIGNED_AT_WILL in quantity:
                continue
            apart = np.abs(found[quantity] - values[inside])
            worst = int(np.argmax(apart))
            rms = float(np.sqrt(np.mean(apart**2)))
            unit = first.units[quantity]
            rows.append([name, quantity, unit, float(apart[worst]), float(times[worst]), rms])
    return Table(
        title=f"Differences from {first_name}",
        columns=("run", "quantity", "unit", "largest", "at t in s", "root mean square"),
        rows=rows,
        note=" ".join(notes),
    )


def fields_table(runs: Sequence[tuple[str, StoredRun]]) -> Table:
    """What motions differ in besides their source: fields of the scenario, and how they were run.

    How they were run is compared where all have the same source, since each has settings of its
    own. The table has no rows where nothing differs, or the source alone.

    Parameters
    ----------
    runs : sequence of (str, StoredRun)
        Labels and motions.
    """
    flattened = [flat(run.scenario.values()) for _, run in runs]
    sources = {run.source for _, run in runs}
    if len(sources) == 1:
        flattened = [
            fields | {f"method.{name}": value for name, value in run.method.items()}
            for fields, (_, run) in zip(flattened, runs, strict=True)
        ]
    rows: list[list[Cell]] = []
    is_clear = True
    for name in dict.fromkeys(name for fields in flattened for name in fields):
        values = [fields.get(name) for fields in flattened]
        if len(set(values)) > 1:
            rows.append([name, *values])
            is_clear &= len({show(value) for value in values}) == len(set(values))
    if rows and len(sources) > 1:
        rows.insert(0, ["source", *(str(run.source) for _, run in runs)])
    return Table(
        title="What differs",
        columns=("field", *(name for name, _ in runs)),
        rows=rows,
        digits=6 if is_clear else 0,
    )


def flat(values: Any, name: str = "") -> dict[str, Cell]:
    """Nested plain data as one level, with dotted names; lists of words and numbers as text."""
    if isinstance(values, list | tuple):
        if not any(isinstance(each, Mapping | list | tuple) for each in values):
            return {name: ", ".join(map(str, values)) or None}
        values = dict(enumerate(values))
    if not isinstance(values, Mapping):
        return {name: values}
    found: dict[str, Cell] = {}
    for key, value in values.items():
        found |= flat(value, ".".join(filter(None, (name, str(key)))))
    return found


def _at(run: StoredRun, times: Array) -> tuple[dict[str, Array], float]:
    """Quantities at some times within the samples, and the error of interpolation in rad."""
    if not times.size:
        raise ValueError("the two have no time in common")
    rows = np.searchsorted(run.times, times - SAME_TIME).clip(max=run.times.size - 1)
    if np.all(np.abs(run.times[rows] - times) <= SAME_TIME):
        return {name: values[rows] for name, values in run.to_dict().items()}, 0.0
    between = replace(run, error_estimate=0.0).resampled(times, tolerance=COARSEST)
    return between.to_dict(), between.error_estimate or 0.0
