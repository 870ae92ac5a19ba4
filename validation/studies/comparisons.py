"""How accelerations, motions and eigenvalues of engine and in-house equations are compared.

Both sides are given the same scenario and share nothing of the mechanics. Three things are
compared: accelerations and constraint forces at random states that the constraints admit, the
motion from the scenario's own start, and the eigenvalues of both stationary spinning motions.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from math import inf
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse.csgraph import connected_components

import mbs_models
from analysis import (
    MOTIONS,
    FlatError,
    Motion,
    Scenario,
    SpatialMotion,
    Start,
    State,
    TimeLimitError,
    ToleranceError,
    Trajectory,
)
from analysis.mechanics.recorded import accelerations
from analysis.motion.endings import FLAT, TIME_LIMIT
from analysis.problem.checks import Array
from analysis.problem.constraints import independent_coordinates
from analysis.stability import spectra
from analysis.stability.linearisation import ComplexArray
from mbs_models import Formulation, Scene
from validation.comparison.differences import deviation
from validation.comparison.limits import holds, largest
from validation.display.progress import counted
from validation.display.tables import Table
from validation.run import run, run_effort, run_to_rest

ACCELERATION_LIMIT = 1e-9
"""Largest relative difference of accelerations and constraint forces that passes."""

ANGLE_LIMIT = 1e-7
"""Tolerance of the engine's runs in rad, and the largest difference that passes."""

REST_LIMIT = 1e-5
"""The same of the deviation on the way to rest, in rad and in parts of the energy."""

EIGENVALUE_LIMIT = 1e-6
"""Largest difference that passes, relative to the larger of |lambda| and 1."""

IN_HOUSE: Mapping[str, Any] = {"source": "in-house", "tolerance": 0.01 * ANGLE_LIMIT}
"""How the in-house runs are made: two digits better in rad than what is compared with them."""

PATIENCE = 10.0
"""Processor time in s that a motion is expected to take at most; a longer one is cut."""

LIMIT = 3.0 * PATIENCE
"""Processor time in s after which a motion that takes longer than expected is given up."""

MAY_FAIL_BELOW = 0.3
"""Sine of the least inclination of an in-house motion up to which an engine's run may fail since
the disk lies nearly flat."""

CLOSE = 0.1
"""Distance of eigenvalues, relative to the larger of |lambda| and the pace of the motion, up to
which they count as close: those of a centred disk coincide at zero."""

SPINS = (15.0, 40.0)
"""Spins in rad/s at which eigenvalues are compared, below and above the critical ones."""

END = 1.0
"""End in s of the motions that are compared, past the inversion, if the scenario allows it."""

MOTION = "β and γ of the motion in rad"

Found = tuple[float, str, float | None]
"""Largest difference of motions, how it was found, and the time in s for which they last."""


class Comparison(NamedTuple):
    """One comparison of the engine with the in-house equations.

    Parameters
    ----------
    quantity : str
        What is compared, with its unit.
    formulation : str
        How the engine has built the scenario.
    criterion : float
        Largest difference that passes.
    difference : float, optional
        Largest difference found; infinite if the sides differ in more than numbers, None if there
        is nothing to compare.
    detail : str
        How it was compared; or why there is nothing to compare.
    lasting : float, optional
        Time in s for which motions are compared.
    counted : int, optional
        Number of random states at which both sides have something to compare.
    """

    quantity: str
    formulation: Formulation
    criterion: float
    difference: float | None
    detail: str
    lasting: float | None = None
    counted: int | None = None

    @property
    def agrees(self) -> bool | None:
        """Whether the two agree; None if that is not defined."""
        return None if self.difference is None else holds(self.difference, self.criterion)


def compare_scenario(
    scenario: Scenario, *, states: int = 100, end: float | None = END
) -> list[Comparison]:
    """Compare every formulation that can build a scenario with the in-house equations.

    Parameters
    ----------
    scenario : Scenario
    states : int
        Number of random states.
    end : float, optional
        Longest time in s over which motions are compared; None if they are not.
    """
    return [
        each
        for formulation in counted(mbs_models.formulations(scenario), "formulations")
        for each in compare_scene(Scene(scenario, formulation), states=states, end=end)
    ]


def compare_scene(
    scene: Scene, *, states: int = 100, end: float | None = END
) -> Iterator[Comparison]:
    """Compare one formulation; the arguments are those of `compare_scenario`."""
    yield from compare_accelerations(scene, states)
    contact = scene.scenario.contact
    rounded = contact is not None and contact.is_rounded
    if end is not None and rounded and scene.built_as == Scene(scene.scenario).built_as:
        # Through impacts and flat attitudes.
        quantity = "vertical and energies of the motion, relative"
        yield _tried(scene, quantity, REST_LIMIT, _rest, end)
    elif end is not None:
        yield compare_motions(scene, end)
    yield from (compare_eigenvalues(scene, motion) for motion in MOTIONS)


def table(comparisons: Sequence[Comparison]) -> Table:
    """Every comparison of a scenario with its criterion, and whether both sides agree."""
    heads = ("formulation", "compared", "how", "largest difference", "at most", "agrees")
    rows = [
        [
            *(each.formulation, each.quantity, each.detail, each.difference, each.criterion),
            "not defined" if each.agrees is None else each.agrees,
        ]
        for each in comparisons
    ]
    return Table(title="Engine against in-house equations", columns=heads, rows=rows)


def _tried(
    scene: Scene, quantity: str, criterion: float, compared: Callable[..., Found], *given: Any
) -> Comparison:
    """What a comparison finds, or why there is nothing to compare."""
    told = partial(Comparison, quantity, scene.built_as, criterion)
    try:
        return told(*compared(scene, *given))
    except FlatError as error:
        flat = f"nearly flat at t = {error.time:.4g} s"
        return told(None, f"the disk lies {flat}, where a run fails; give an earlier end")
    except (ToleranceError, TimeLimitError, ValueError) as error:
        return told(None, " ".join(str(error).split()))
    except ArithmeticError as error:
        return told(inf, f"a side fails: {error}")


# --- Accelerations ------------------------------------------------------------------------------


SIZES = {"gamma_rate": 60, "beta_rate": 20, "x": 0.05, "y": 0.05, "x_rate": 1, "y_rate": 1}
"""Largest values of a random start, where they are free."""


def random_state(scenario: Scenario, rng: np.random.Generator) -> State:
    """State that meets the constraints of a scenario and is random in all else."""
    free = independent_coordinates(scenario.constraints)
    start = Start(
        beta=rng.uniform(0.2, np.pi - 0.2),
        gamma=rng.uniform(-np.pi, np.pi),
        alpha=rng.uniform(-np.pi, np.pi),
        spin=rng.uniform(-60.0, 60.0),
        **{name: rng.uniform(-size, size) for name, size in SIZES.items() if name in free},
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


def compare_accelerations(scene: Scene, states: int) -> Iterator[Comparison]:
    """Compare accelerations, and constraint forces, at random states.

    The difference is infinite where one side has no number and the other has, or no state counts;
    those do not at which neither side has a solution, as friction on the contact force may leave
    none.
    """
    scenario, rng, found = scene.scenario, np.random.default_rng(1), []
    for _ in range(states):
        engine, inhouse = solutions(scene, random_state(scenario, rng))
        if engine is not None and inhouse is not None:
            least = scenario.table.gravity, scenario.weight
            found.append([*map(_relative, engine, inhouse, least)])
        elif engine is not inhouse:
            found.append([inf, inf])
    how = f"relative, at {states} random states"
    if (number := len(found)) < states:
        how = f"relative, at {number} of {states} random states: the others have no solution"
    for side, quantity in enumerate(("accelerations", "constraint forces")):
        worst = largest(pair[side] for pair in found)
        yield Comparison(quantity, scene.built_as, ACCELERATION_LIMIT, worst, how, counted=number)


def _relative(found: Array, expected: Array, least: float) -> float:
    """Largest difference over the largest expected number, or over `least` if that is larger.

    A random normal force may vanish, and so may all accelerations of a slow disk with one freedom:
    they are measured by the weight and by gravity as well, which are what balances there.
    """
    return float(np.max(np.abs(found - expected)) / max(least, np.max(np.abs(expected))))


def solutions(scene: Scene, state: State) -> list[tuple[Array, Array] | None]:
    """Accelerations and multipliers of engine and in-house equations; None where singular."""
    found: list[tuple[Array, Array] | None] = []
    here: Any = (accelerations, scene.scenario, state.coordinates, state.rates)
    for side, *given in ((mbs_models.acceleration, scene, state), here):
        try:
            found.append(side(*given))
        except ArithmeticError:
            found.append(None)
    return found


# --- Motions ------------------------------------------------------------------------------------


def compare_motions(scene: Scene, end: float) -> Comparison:
    """Compare beta and gamma in rad, from the scenario's own start.

    The time is cut short of where the disk comes to lie flat, or so nearly that a run of the
    engine fails, and where a run would take too long or cannot be had to the tolerance, which is
    then told. If one side ends because the contact would pull, the other one has to do so there.

    Parameters
    ----------
    scene : Scene
    end : float
        Longest time in s.
    """
    tried = partial(_tried, scene, MOTION, ANGLE_LIMIT, _motion)
    whole = found = tried(end)
    for part in (0.1, 0.01):
        if found.difference is None:
            found = tried(part * end)
    if found.difference is None or found is whole:
        return whole
    return found._replace(detail=f"{found.detail}; over {end:.4g} s: {whole.detail}")


def _motion(scene: Scene, end: float) -> Found:
    # Stepped by the engine as well, so that the sides share no solver.
    integrator, *_ = mbs_models.integrators(scene)
    stepped: dict[str, Any] = {"formulation": scene.built_as, "integrator": integrator}
    stepped["tolerance"] = ANGLE_LIMIT
    efforts = (run_effort(scene.scenario, _times(end), **how) for how in (stepped, IN_HOUSE))
    longest = max(efforts, key=lambda effort: effort.seconds)
    if longest.seconds > 100.0 * PATIENCE:
        raise ValueError(f"a motion takes {longest}")
    part = min(1.0, PATIENCE / longest.seconds)
    cut = f": over {end:.4g} s it takes {longest}" if part < 1.0 else ""
    end *= part
    try:
        engine, inhouse = _runs(scene.scenario, end, stepped)
    except FlatError as error:
        if np.sin(reference(scene.scenario, end).coordinates[:, 4]).min() > MAY_FAIL_BELOW:
            return inf, f"a run fails: {error}", None
        cut = f", as the disk lies flat at {error.time:.4g} s"
        engine, inhouse = _runs(scene.scenario, 0.8 * error.time, stepped)
    for each in (engine, inhouse):
        if _reason(each) == TIME_LIMIT:
            raise TimeLimitError(f"{each.source} {each.ending}")
    reason = _reason(engine)
    if reason != _reason(inhouse) or engine.times.size != inhouse.times.size:
        endings = (str(each.ending or "runs through") for each in (engine, inhouse))
        return inf, "engine {}; in-house {}".format(*endings), None
    where, last = f", where {reason}" if reason else "", float(engine.times[-1])
    return deviation(engine, inhouse), f"over {last:.4g} s{where}{cut}", last


def _runs(
    scenario: Scenario, end: float, stepped: Mapping[str, Any]
) -> tuple[Trajectory, Trajectory]:
    """Both sides up to an end in s.

    Raises
    ------
    FlatError
        If the disk comes to lie flat, or so nearly that the engine may fail.
    """
    inhouse = reference(scenario, end)
    if inhouse.ending is not None and inhouse.ending.reason == FLAT:
        raise FlatError(str(inhouse.ending), inhouse.ending.time)
    try:
        return run(scenario, _times(end), **stepped, time_limit=LIMIT), inhouse
    except mbs_models.EngineError as error:
        # There is a motion, and that solver does not get through it.
        raise ToleranceError(f"no motion by the engine to compare with: {error}") from error


def _times(end: float) -> Array:
    return np.linspace(0.0, end, 101)


def _reason(motion: Trajectory | SpatialMotion) -> str | None:
    return None if motion.ending is None else motion.ending.reason


@cache
def reference(scenario: Scenario, end: float) -> Trajectory:
    """In-house run up to an end in s, two digits better than what is compared with it."""
    try:
        return run(scenario, _times(end), **IN_HOUSE, time_limit=LIMIT)
    except TimeLimitError:
        raise
    except ArithmeticError as error:
        # The motion may come to where the equations have no solution.
        raise ToleranceError(f"no in-house motion to compare with: {error}") from error


def _rest(scene: Scene, end: float) -> Found:
    """Largest `SpatialMotion.deviation` on the way to rest."""
    to_rest = partial(run_to_rest, scene.scenario, end, spacing=0.01 * end, time_limit=LIMIT)
    engine = to_rest(source="engine", tolerance=REST_LIMIT)
    inhouse = to_rest(source="in-house", tolerance=0.1 * REST_LIMIT)
    late = TIME_LIMIT in (_reason(engine), _reason(inhouse))
    if not late and (engine.rest_time is None) != (inhouse.rest_time is None):
        resting = f"at rest from: engine {engine.rest_time}, in-house {inhouse.rest_time} s"
        return inf, resting, None
    last = float(min(engine.times[-1], inhouse.times[-1]))
    return engine.deviation(inhouse), f"over {last:.4g} s", last


# --- Eigenvalues --------------------------------------------------------------------------------


def compare_eigenvalues(scene: Scene, motion: Motion) -> Comparison:
    """Compare them at `SPINS`, relative to the larger of the eigenvalue's size and 1."""
    return _tried(scene, f"eigenvalues, {motion}", EIGENVALUE_LIMIT, _eigenvalues, motion)


def _eigenvalues(scene: Scene, motion: Motion) -> Found:
    scenario, contact = scene.scenario, scene.scenario.contact
    if contact is not None:
        # Either side's height has it, and eigenvalues change with the force on the spring.
        digit = 2.0 * np.finfo(float).eps * scenario.disk.radius
        lost = contact.stiffness * digit / scenario.weight
        if lost > EIGENVALUE_LIMIT:
            raise ValueError(
                f"stiffness {contact.stiffness:g} N/m turns the last digit of a height into "
                f"{lost:.1g} of the weight, where {EIGENVALUE_LIMIT:g} passes"
            )
    how: dict[str, Any] = {"formulation": scene.built_as, "motion": motion}
    in_house = partial(spectra.eigenvalues, scenario, SPINS, system="numeric", motion=motion)
    try:
        engine = [mbs_models.eigenvalues(spinning(scenario, spin, **how)) for spin in SPINS]
    except ValueError as error:
        try:
            in_house()
        except ArithmeticError as singular:
            raise ValueError(f"neither side has any: {singular}; {error}") from singular
        raise ArithmeticError(f"the engine has none: {error}") from error
    paces = np.hypot(SPINS, np.sqrt(scenario.fall))
    worst = largest(map(distance, engine, in_house(), paces.tolist()))
    spins = " and ".join(f"{spin:g}" for spin in SPINS)
    return worst, f"relative to max(|λ|, 1), at {spins} rad/s", None


def spinning(
    scenario: Scenario,
    spin: float,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
) -> Scene:
    """Scene that starts on a stationary motion of a scenario."""
    start = Start.stationary(spin, motion)
    return Scene(scenario=replace(scenario, start=start), formulation=formulation)


def engine_matrices(scenario: Scenario, spins: Iterable[float], **how: Any) -> Array:
    """State matrices of the engine over the spin, shape (n, k, k): `mbs_models.state_matrix`.

    The further arguments are those of `spinning`.
    """
    scenes = (spinning(scenario, float(spin), **how) for spin in spins)
    return np.array([mbs_models.state_matrix(scene) for scene in scenes])


def distance(found: ComplexArray, expected: ComplexArray, pace: float = 1.0) -> float:
    """Largest difference of two sets of eigenvalues, matched for the smallest sum.

    Relative to the larger of |lambda| and 1; infinite if there are none, not as many in both, or
    one is no number. Rounding spreads k of them that coincide by its k-th root, but hardly moves
    the coefficients of the polynomial of which they are the roots: those that are close, for the
    pace in 1/s of the motion, are compared by these, the further ones in parts of its powers. That
    of a single one is the eigenvalue.
    """
    is_whole = found.size > 0 and found.shape == expected.shape
    if not (is_whole and np.all(np.isfinite([found, expected]))):
        return np.inf
    rows, columns = linear_sum_assignment(gaps(found, expected))
    found, expected = found[rows], expected[columns]
    near = CLOSE * np.maximum(np.abs(expected), pace)
    _, group_of = connected_components(np.abs(expected[:, None] - expected) <= near)
    differences = []
    for number in set(group_of.tolist()):
        group = group_of == number
        middle = np.mean(expected[group])
        size = max(abs(middle), 1.0)
        ours, others = (np.poly(each[group] - middle)[1:] for each in (found, expected))
        sizes = size * max(size, pace) ** np.arange(ours.size)
        differences.append(float(np.max(np.abs(ours - others) / sizes)))
    return largest(differences)


def gaps(found: ComplexArray, expected: ComplexArray) -> Array:
    """Differences of each of n from each of k eigenvalues, relative as in `distance`, (n, k)."""
    return np.abs(found[:, None] - expected) / np.maximum(np.abs(expected), 1.0)
