"""How accelerations, motions and eigenvalues of engine and in-house equations are compared."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

import mbs_models
from analysis import (
    FlatError,
    Motion,
    Scenario,
    Start,
    State,
    TimeLimitError,
    ToleranceError,
    Trajectory,
)
from analysis.data.checks import Array
from analysis.data.endings import FLAT, TIME_LIMIT, Ending
from analysis.data.trajectory import Source
from analysis.mechanics.recorded import accelerations
from analysis.stability import spectra
from mbs_models import Scene
from validation.kit.limits import largest
from validation.kit.references import deviation
from validation.run import run, run_effort, run_to_rest
from validation.studies.stability.eigenvalue_check import distance

ANGLE_LIMIT = 1e-7
"""Tolerance of the engine's runs in rad, and the largest difference that passes."""

REST_LIMIT = 1e-5
"""The same of the deviation on the way to rest, in rad and in parts of the energy."""

REFERENCE_TOLERANCE = 0.01 * ANGLE_LIMIT
"""Tolerance of the in-house runs in rad: two digits better than what is compared with them."""

PATIENCE = 10.0
"""Processor time in s that a motion is expected to take at most; a longer one is cut."""

LIMIT = 3.0 * PATIENCE
"""Processor time in s after which a motion that takes longer than expected is given up."""

SPINS = (15.0, 40.0)
"""Spins in rad/s at which eigenvalues are compared, below and above the critical ones."""

Found = tuple[float | None, str]
"""Largest difference and how it was found; infinite if the sides differ in more than numbers,
None, with the reason, if there is nothing to compare."""


def random_state(scenario: Scenario, rng: np.random.Generator) -> State:
    """State that meets the constraints of a scenario and is random in all else."""
    held = "fixed-cog" in scenario.constraints
    along, across = (f"no-slip-{way}" in scenario.constraints for way in ("along", "across"))
    free = {
        "gamma_rate": 60.0 * (not (held and along)),
        "beta_rate": 20.0 * (not (held and across)),
        "x": 0.05 * (not held),
        "y": 0.05 * (not held),
        "x_rate": 1.0 * (not (held or along)),
        "y_rate": 1.0 * (not (held or across)),
    }
    start = Start(
        beta=rng.uniform(0.2, np.pi - 0.2),
        gamma=rng.uniform(-np.pi, np.pi),
        alpha=rng.uniform(-np.pi, np.pi),
        spin=rng.uniform(-60.0, 60.0),
        **{name: rng.uniform(-size, size) for name, size in free.items() if size},
    )
    state = replace(scenario, start=start).initial_state
    if scenario.contact is None:
        return state
    # In and out of contact, on the way up and down.
    coordinates, rates = list(state.coordinates), list(state.rates)
    depth = scenario.contact.resting_penetration(scenario.weight)
    coordinates[2] += rng.uniform(-1.0, 2.0) * depth
    rates[2] += rng.uniform(-0.01, 0.01)
    return State(coordinates=tuple(coordinates), rates=tuple(rates))


def acceleration_differences(scene: Scene, states: int, seed: int = 1) -> tuple[float, float, int]:
    """Largest relative differences of accelerations and of constraint forces.

    States at which neither side has a solution, as friction on the contact force may leave none,
    do not count.

    Parameters
    ----------
    scene : Scene
    states : int
        Number of random states that meet the constraints.
    seed : int
        Of these.

    Returns
    -------
    accelerations, forces : float
        Infinite where one side has no number and the other has, or no state counts.
    counted : int
        Number of states that count.
    """
    scenario, rng = scene.scenario, np.random.default_rng(seed)
    found = [_differences(scene, random_state(scenario, rng)) for _ in range(states)]
    counted = [each for each in found if each is not None]
    accelerations, forces = (largest(pair[side] for pair in counted) for side in (0, 1))
    return accelerations, forces, len(counted)


def solutions(scene: Scene, state: State) -> list[tuple[Array, Array] | None]:
    """Accelerations and multipliers of engine and in-house equations; None where singular."""
    found: list[tuple[Array, Array] | None] = []
    sides: tuple[Callable[[], tuple[Array, Array]], ...] = (
        lambda: mbs_models.acceleration(scene, state),
        lambda: accelerations(scene.scenario, state.coordinates, state.rates),
    )
    for side in sides:
        try:
            found.append(side())
        except ArithmeticError:
            found.append(None)
    return found


def _differences(scene: Scene, state: State) -> tuple[float, float] | None:
    """Relative differences of accelerations and multipliers; None where both are singular."""
    engine, inhouse = solutions(scene, state)
    if engine is None or inhouse is None:
        return None if engine is inhouse else (np.inf, np.inf)
    # A random normal force may vanish, so multipliers are measured by the weight as well.
    least = (0.0, scene.scenario.weight)
    one, other = (
        float(np.max(np.abs(a - b)) / max(smallest, float(np.max(np.abs(b)))))
        for a, b, smallest in zip(engine, inhouse, least, strict=True)
    )
    return one, other


def motion_difference(scene: Scene, end: float) -> Found:
    """Largest difference of beta and gamma in rad, from the scenario's own start.

    The time is cut short of where the disk comes to lie flat, and where a run would take too long
    or cannot be had to the tolerance. If one side ends because the contact would pull, the other
    one has to do so there.

    Parameters
    ----------
    scene : Scene
    end : float
        Longest time in s.
    """
    why = ""
    for part in (1.0, 0.1, 0.01):
        try:
            return _motion_difference(scene, part * end)
        except (ToleranceError, TimeLimitError, ValueError) as error:
            why = why or " ".join(str(error).split())
    return None, why


def _motion_difference(scene: Scene, end: float) -> Found:
    times, inhouse = _comparable(scene, end)
    try:
        engine = run(
            scene.scenario,
            times,
            formulation=scene.built_as,
            tolerance=ANGLE_LIMIT,
            # Stepped by the engine as well, so that the sides share no solver.
            integrator=own_integrator(scene),
            time_limit=LIMIT,
        )
    except (mbs_models.EngineError, FlatError) as error:
        return np.inf, f"the engine fails: {error}"
    for each in (engine, inhouse):
        if _reason(each.ending) == TIME_LIMIT:
            raise TimeLimitError(f"{each.source} {each.ending}")
    reason = _reason(engine.ending)
    if reason != _reason(inhouse.ending) or engine.times.size != inhouse.times.size:
        told = (str(each.ending or "runs through") for each in (engine, inhouse))
        return np.inf, "engine {}; in-house {}".format(*told)
    where = "" if reason is None else f", where {reason}"
    return deviation(engine, inhouse), f"over {engine.times[-1]:.4g} s{where}"


def own_integrator(scene: Scene) -> mbs_models.IntegratorName:
    """The engine's own integrator that is the default of a scene with a step."""
    return mbs_models.integrators(scene.built_as, constrained=scene.has_constraints)[0]


def _comparable(scene: Scene, end: float) -> tuple[tuple[float, ...], Trajectory]:
    """Times in s as far as `end` if disk and patience allow, and the in-house motion there."""
    scenario, times = scene.scenario, _times(end)
    efforts = (
        run_effort(
            scenario,
            times,
            formulation=scene.built_as,
            tolerance=ANGLE_LIMIT,
            integrator=own_integrator(scene),
        ),
        run_effort(scenario, times, source="in-house", tolerance=REFERENCE_TOLERANCE),
    )
    longest = max(efforts, key=lambda effort: effort.seconds)
    if longest.seconds > 100.0 * PATIENCE:
        raise ValueError(f"a motion takes {longest}")
    times = _times(end * min(1.0, PATIENCE / longest.seconds))
    inhouse = reference(scenario, times)
    if inhouse.ending is not None and inhouse.ending.reason == FLAT:
        times = _times(0.8 * inhouse.ending.time)
        inhouse = reference(scenario, times)
    return times, inhouse


def _times(end: float) -> tuple[float, ...]:
    return tuple(np.linspace(0.0, end, 101).tolist())


def _reason(ending: Ending | None) -> str | None:
    return None if ending is None else ending.reason


@cache
def reference(scenario: Scenario, times: tuple[float, ...]) -> Trajectory:
    """In-house run, two digits better than what is compared with it."""
    return run(scenario, times, source="in-house", tolerance=REFERENCE_TOLERANCE, time_limit=LIMIT)


def goes_to_rest(scene: Scene) -> bool:
    """Whether a motion is compared on its way to rest, through impacts and flat attitudes."""
    scenario = scene.scenario
    rounded = scenario.contact is not None and scenario.contact.is_rounded
    return rounded and scene.built_as == Scene(scenario).built_as


_REST_TOLERANCES: dict[Source, float] = {"engine": REST_LIMIT, "in-house": 0.1 * REST_LIMIT}


def rest_difference(scene: Scene, end: float) -> Found:
    """Largest `SpatialMotion.deviation` on the way to rest; else as `motion_difference`."""
    try:
        engine, inhouse = (
            run_to_rest(
                scene.scenario,
                end,
                source=source,
                spacing=0.01 * end,
                tolerance=tolerance,
                time_limit=LIMIT,
            )
            for source, tolerance in _REST_TOLERANCES.items()
        )
    except (ToleranceError, TimeLimitError, ValueError) as error:
        return None, " ".join(str(error).split())
    except mbs_models.EngineError as error:
        return np.inf, f"the engine fails: {error}"
    late = TIME_LIMIT in (_reason(engine.ending), _reason(inhouse.ending))
    if not late and (engine.rest_time is None) != (inhouse.rest_time is None):
        return np.inf, f"at rest from: engine {engine.rest_time}, in-house {inhouse.rest_time} s"
    return engine.deviation(inhouse), f"over {min(engine.times[-1], inhouse.times[-1]):.4g} s"


def eigenvalue_difference(scene: Scene, motion: Motion) -> Found:
    """Largest difference at `SPINS`, relative to the larger of the eigenvalue's size and 1."""
    scenario = scene.scenario
    if scenario.contact is not None:
        return None, "no linearisation of a compliant contact"
    try:
        expected = spectra.eigenvalues(scenario, SPINS, system="numeric", motion=motion)
    except ValueError as error:
        return None, str(error)
    except ArithmeticError as error:
        return np.inf, str(error)
    differences = []
    for spin, values in zip(SPINS, expected, strict=True):
        start = Start.stationary(spin, motion)
        try:
            found = mbs_models.eigenvalues(replace(scene, scenario=replace(scenario, start=start)))
        except (ValueError, ArithmeticError) as error:
            return np.inf, f"the engine fails: {error}"
        differences.append(distance(found, values))
    spins = " and ".join(f"{spin:g}" for spin in SPINS)
    return largest(differences), f"relative to max(|λ|, 1), at {spins} rad/s"
