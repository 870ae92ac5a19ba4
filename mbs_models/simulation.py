"""Simulation of a scene in the engine, to a step size or to a tolerance."""

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

import numpy as np
import numpy.typing as npt

from analysis.checks import Array, ToleranceError, increasing_times, positive
from analysis.disk import GRAVITY
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
    integrator: Integrator | IntegratorName | None = None,
    symbolic: bool = False,
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
    integrator : Integrator or str, optional
        With its options, or the name of one of `integrators(scene.formulation)`; by default the
        first of them. DOPRI5 takes its accuracy from `Integrator.local_tolerance`, and `step`
        only limits its steps.
    symbolic : bool
        Hand the friction law to the engine as a symbolic expression instead of a Python function.

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
    chosen = find_integrator(scene.formulation, integrator, constrained=scene.has_constraints)
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    if tolerance is not None and chosen.controls_step:
        raise ValueError(
            f"tolerance must be left out for integrator {chosen.name!r}, which has a "
            f"local_tolerance of its own, got {tolerance!r}"
        )
    Probe(build(scene, symbolic=symbolic)).check_start()
    if step is not None or chosen.controls_step:
        largest = np.inf if step is None else positive("step", step)
        result = one_pass(scene, times, chosen, largest, symbolic=symbolic)
        return trajectory(scene, times, chosen, result)
    tolerance = positive("tolerance", 1e-8 if tolerance is None else tolerance)
    result, estimate = _to_tolerance(scene, times, chosen, tolerance, symbolic)
    return trajectory(scene, times, chosen, result, tolerance=tolerance, estimate=estimate)


@dataclass(frozen=True, slots=True, eq=False)
class Pass:
    """One pass over all times: what came out and what it took.

    Parameters
    ----------
    values : ndarray, shape (n, 12 + k)
        Co-rotating coordinates, their rates, and the multipliers of scenes with constraints.
    step : float
        Longest step in s, or the limit of step control.
    counts : Counter
        See `Samples`.
    setup_seconds : float
        Processor time that building the scene took.
    seconds : float
        Processor time that the engine's solver took.
    """

    values: Array
    step: float
    counts: Counter[str]
    setup_seconds: float = 0.0
    seconds: float = 0.0


def trajectory(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    result: Pass,
    *,
    tolerance: float | None = None,
    estimate: float | None = None,
) -> Trajectory:
    """Trajectory from the samples of a pass; the contact tree's normal force is added here."""
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
            **integrator.settings(),
            "step": result.step,
            "tolerance": tolerance,
        }
        | ({} if scene.contact is None else asdict(scene.contact))
        | (asdict(scene.dissipation) if scene.dissipation.is_on else {}),
        error_estimate=estimate,
        counts=dict(result.counts),
        versions=versions("numpy", "exudyn"),
    )


def _to_tolerance(
    scene: Scene, times: Array, integrator: Integrator, tolerance: float, symbolic: bool
) -> tuple[Pass, float]:
    """Halve the step and extrapolate until the estimated error is small enough."""
    ladder = Ladder(scene.formulation, integrator.name)
    counts: Counter[str] = Counter()
    failure: EngineError | None = None
    for halvings in range(HALVINGS):
        try:
            result = one_pass(
                scene, times, integrator, integrator.first_step, halvings, symbolic=symbolic
            )
        except EngineError as error:
            # A step too long for the iteration is no failure of the tolerance: halve it.
            failure, ladder = error, Ladder(scene.formulation, integrator.name)
        else:
            failure = None
            counts.update(result.counts)
            ladder.add(result.values)
            if ladder.estimate <= tolerance:
                return Pass(ladder.best, result.step, counts), ladder.estimate
            if ladder.stalled:
                break
    if failure is not None:
        raise failure
    raise ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {integrator.name} on formulation "
        f"{scene.formulation!r}: the best estimated error is {ladder.best_estimate:.1e} rad"
    )


def one_pass(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    step: float,
    halvings: int = 0,
    *,
    symbolic: bool = False,
) -> Pass:
    """One pass over all times, with steps of at most `step` that are then halved so often.

    Raises
    ------
    EngineError
        If the engine does not reach the end.
    ArithmeticError
        If the disk comes to lie flat.
    """
    blocks: list[Array] = []
    counts: Counter[str] = Counter()
    longest = setup = seconds = 0.0
    for first, intervals, spacing in _even_stretches(times):
        if blocks:
            scene = replace(scene, start=_restart(blocks[-1]))
        begin = time.process_time()
        model = build(scene, symbolic=symbolic)
        setup += time.process_time() - begin
        substeps = max(1, int(np.ceil(spacing / step - 1e-9))) << halvings
        longest = max(longest, spacing / substeps)
        # Angles from rotation matrices are followed more closely than they are asked for.
        finer = 1 if model.continuous_angles else _fineness(scene, spacing, substeps)
        try:
            samples = run(
                model,
                integrator,
                spacing=spacing / finer,
                intervals=intervals * finer,
                substeps=substeps // finer,
            )
        except EngineError as error:
            raise EngineError(f"{error} (stretch from t = {times[first]:.6g} s)") from error
        counts.update(samples.counts)
        seconds += samples.seconds
        coordinates, rates = model.decode(samples.records)
        check_upright(times[first] + spacing / finer * np.arange(len(coordinates)), coordinates)
        if not model.continuous_angles:
            turns = scene.start.coordinates[3::2] - coordinates[0, 3::2]
            coordinates[:, 3::2] += _whole_turns(turns)
            _unwrap(coordinates, rates, spacing / finer)
        coordinates, rates = coordinates[::finer], rates[::finer]
        columns = [coordinates, rates]
        if not isinstance(model, ContactTree):
            columns.append(model.multipliers(samples.algebraic[::finer], coordinates, rates))
        block = np.column_stack(columns)
        blocks.append(block[1:] if blocks else block)
    return Pass(np.concatenate(blocks), longest, counts, setup, seconds)


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


def _fineness(scene: Scene, spacing: float, substeps: int) -> int:
    """Divisor of `substeps` that leaves less than about a radian between samples.

    From the rates at the start, and those that the fall of the disk can add.
    """
    fall = np.sqrt(GRAVITY / scene.disk.radius)
    fastest = 2.0 * (sum(abs(rate) for rate in scene.start.rates[3:]) + fall)
    needed = fastest * spacing
    return next((k for k in range(1, substeps) if k >= needed and substeps % k == 0), substeps)


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
