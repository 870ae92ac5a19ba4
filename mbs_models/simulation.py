"""Simulation of a scene in the engine, to a step size or to a tolerance."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from analysis.checks import Array, ToleranceError, increasing_times, positive
from analysis.state import COORDINATES, State, check_upright
from analysis.trajectory import Trajectory, versions
from mbs_models.build import build
from mbs_models.extrapolation import Ladder
from mbs_models.integrators import EngineError, Integrator, IntegratorName, find_integrator, run
from mbs_models.probe import Probe
from mbs_models.scene import Scene
from mbs_models.trees import ContactTree

HALVINGS = 13
"""Number of runs after which a tolerance-controlled run gives up; the last step is some µs."""


def simulate(
    scene: Scene,
    times: npt.ArrayLike,
    *,
    step: float | None = None,
    tolerance: float | None = None,
    integrator: IntegratorName | None = None,
) -> Trajectory:
    """Simulate a scene in the engine.

    Accuracy is asked for in one of two ways. With `step`, there is a single run. With
    `tolerance`, runs with steps halved again and again are extrapolated until the estimated
    error of beta and gamma is below it.

    Parameters
    ----------
    scene : Scene
    times : array_like, shape (n,)
        Strictly increasing times in s; the motion starts at the first. Each stretch of evenly
        spaced times is one engine run, so even spacing is fastest.
    step : float, optional
        Largest step in s; shortened so that every sample falls on a step.
    tolerance : float, optional
        Largest error in beta and gamma in rad; 1e-8 if neither is given.
    integrator : str, optional
        One of `integrators(scene.formulation)`, by default the first.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is out of range, or the start breaks a constraint.
    EngineError
        If the engine does not reach the end.
    ToleranceError
        If `tolerance` cannot be met.
    """
    times = increasing_times(times)
    chosen = find_integrator(scene.formulation, integrator)
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    Probe(build(scene)).check_start()
    if step is not None:
        result = _single(scene, times, chosen, positive("step", step))
        estimate = None
    else:
        tolerance = positive("tolerance", 1e-8 if tolerance is None else tolerance)
        result, estimate = _to_tolerance(scene, times, chosen, tolerance)
    return _trajectory(scene, times, chosen, result, (tolerance, estimate))


@dataclass(frozen=True, slots=True, eq=False)
class _Result:
    """Samples of a motion, values (n, 12 + k), the longest step and the work they took."""

    values: Array
    step: float
    counts: Counter[str]


def _trajectory(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    result: _Result,
    accuracy: tuple[float | None, float | None],
) -> Trajectory:
    tolerance, estimate = accuracy
    coordinates, rates = result.values[:, :6], result.values[:, 6:12]
    multipliers = result.values[:, 12:]
    if scene.formulation == "contact-tree":
        multipliers = _contact_tree_forces(scene, coordinates, rates)
    return Trajectory(
        times=times,
        coordinates=coordinates,
        rates=rates,
        multipliers=multipliers,
        level=scene.level,
        disk=scene.disk,
        friction=scene.friction,
        source="engine",
        method={
            "formulation": scene.formulation,
            "integrator": integrator.name,
            "step": result.step,
            "tolerance": tolerance,
        },
        error_estimate=estimate,
        counts=dict(result.counts),
        versions=versions("numpy", "exudyn"),
    )


def _to_tolerance(
    scene: Scene, times: Array, integrator: Integrator, tolerance: float
) -> tuple[_Result, float]:
    """Halve the step and extrapolate until the estimated error is small enough."""
    ladder = Ladder(scene.formulation, integrator.name)
    counts: Counter[str] = Counter()
    failure: EngineError | None = None
    for halvings in range(HALVINGS):
        try:
            result = _single(scene, times, integrator, integrator.first_step, halvings)
        except EngineError as error:
            # A step too long for the iteration is no failure of the tolerance: halve it.
            failure, ladder = error, Ladder(scene.formulation, integrator.name)
        else:
            failure = None
            counts += result.counts
            ladder.add(result.values)
            if ladder.estimate <= tolerance:
                return _Result(ladder.best, result.step, counts), ladder.estimate
            if ladder.stalled:
                break
    if failure is not None:
        raise failure
    raise ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {integrator.name} on formulation "
        f"{scene.formulation!r}: the best estimated error is {ladder.best_estimate:.1e} rad"
    )


def _single(
    scene: Scene, times: Array, integrator: Integrator, step: float, halvings: int = 0
) -> _Result:
    """One pass over all times, with steps of at most `step` that are then halved so often."""
    blocks: list[Array] = []
    counts: Counter[str] = Counter()
    longest = 0.0
    for first, intervals, spacing in _even_stretches(times):
        if blocks:
            scene = replace(scene, start=_restart(blocks[-1]))
        model = build(scene)
        substeps = max(1, int(np.ceil(spacing / step - 1e-9))) << halvings
        longest = max(longest, spacing / substeps)
        try:
            samples = run(
                model, integrator, spacing=spacing, intervals=intervals, substeps=substeps
            )
        except EngineError as error:
            raise EngineError(f"{error} (stretch from t = {times[first]:.6g} s)") from error
        counts += Counter(samples.counts)
        coordinates, rates = model.decode(samples.records)
        if blocks:
            coordinates[:, [3, 5]] += _whole_turns(blocks[-1][-1, [3, 5]] - coordinates[0, [3, 5]])
        _unwrap(coordinates, rates, spacing)
        check_upright(times[first : first + intervals + 1], coordinates)
        columns = [coordinates, rates]
        if not isinstance(model, ContactTree):
            columns.append(model.multipliers(samples.algebraic, coordinates))
        block = np.column_stack(columns)
        blocks.append(block[1:] if blocks else block)
    return _Result(np.concatenate(blocks), longest, counts)


def _even_stretches(times: Array) -> Iterator[tuple[int, int, float]]:
    """First index, number of intervals and spacing of each stretch of even spacing."""
    spacings = np.diff(times)
    first = 0
    while first < spacings.size:
        same = np.abs(spacings[first:] - spacings[first]) <= 1e-9 * spacings[first]
        length = int(np.argmin(same)) if not np.all(same) else same.size
        yield first, length, float((times[first + length] - times[first]) / length)
        first += length


def _restart(block: Array) -> State:
    last = block[-1].tolist()
    return State(coordinates=tuple(last[:6]), rates=tuple(last[6:12]))


def _whole_turns(angles: Array) -> Array:
    return 2 * np.pi * np.round(angles / (2 * np.pi))


def _unwrap(coordinates: Array, rates: Array, spacing: float) -> None:
    """Make alpha and gamma continuous in place.

    Their mean rates predict each sample, so that coarse sampling of a fast spin does not lose
    turns. A sample half a turn off its prediction cannot be told from the next.
    """
    for column in (3, 5):
        angle, rate = coordinates[:, column], rates[:, column]
        predicted = 0.5 * spacing * (rate[1:] + rate[:-1])
        turns = _whole_turns(predicted - np.diff(angle))
        doubt = np.abs(predicted - np.diff(angle) - turns)
        if np.any(doubt > 0.5 * np.pi):
            raise EngineError(
                f"the turns of {COORDINATES[column]} cannot be followed after sample "
                f"{int(np.argmax(doubt))}: the disk lies flat, or the samples are too far apart"
            )
        angle[1:] += np.cumsum(turns)


def _contact_tree_forces(scene: Scene, coordinates: Array, rates: Array) -> Array:
    """Normal force at every sample, from the engine's accelerations; shape (n, 1)."""
    model = ContactTree(scene)
    probe = Probe(model)
    forces = np.empty((len(coordinates), 1))
    r = scene.disk.radius
    for row, (z, u) in enumerate(zip(coordinates, rates, strict=True)):
        sb, cb = np.sin(z[4]), np.cos(z[4])
        position = np.array((z[3], z[0], z[1] - r * cb, z[4], z[5]))
        probe.set_state(position, np.array((u[3], u[0], u[1] + r * sb * u[4], u[4], u[5])))
        forces[row, 0] = model.normal_force(probe.solve()[0])
    return forces
