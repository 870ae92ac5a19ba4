"""Engine against in-house equations, for any scenario.

Both sides are given the same scenario and share nothing of the mechanics. Three things are
compared: accelerations and constraint forces at random states that the constraints admit, the
motion from the scenario's own start, and the eigenvalues of both stationary spinning motions.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

import mbs_models
from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    FlatError,
    Motion,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    TimeLimitError,
    ToleranceError,
    Trajectory,
)
from analysis.data.checks import Array
from analysis.data.endings import FLAT
from analysis.models import index1
from analysis.rest.free_disk import FreeDisk
from analysis.rest.to_rest import start_vector
from analysis.stability import spectra
from mbs_models import Formulation, Scene
from validation.kit.progress import counted
from validation.kit.report import Job, Section
from validation.kit.tables import Cell, Table
from validation.run import run, run_effort
from validation.studies.stability.eigenvalue_check import EIGENVALUE_LIMIT, distance

ACCELERATION_LIMIT = 1e-8
"""Largest relative difference of accelerations and constraint forces that passes."""

ANGLE_LIMIT = 1e-7
"""Largest difference of beta and gamma in rad that passes."""

REFERENCE_TOLERANCE = 0.01 * ANGLE_LIMIT
"""Tolerance of the in-house runs in rad: two digits better than what is compared with them."""

PATIENCE = 10.0
"""Processor time in s that a motion is expected to take at most; a longer one is cut."""

LIMIT = 3.0 * PATIENCE
"""Processor time in s after which a motion that takes longer than expected is given up."""

SPINS = (15.0, 40.0)
"""Spins in rad/s at which eigenvalues are compared, below and above the critical ones."""

END = 2.0
"""End in s of the motions that are compared, if the scenario allows so long a one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
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
        Largest difference found; None if there is nothing to compare.
    detail : str
        How it was compared; or why there is nothing to compare.
    """

    quantity: str
    formulation: Formulation
    criterion: float
    difference: float | None
    detail: str

    @property
    def verdict(self) -> bool | str:
        """Whether the two agree; or why that is not defined."""
        if self.difference is None:
            return f"not defined: {self.detail}"
        return self.difference <= self.criterion


def check_scenario(scenario: Scenario, *, states: int = 100, end: float = END) -> list[Check]:
    """Compare every formulation that can build a scenario with the in-house equations.

    Parameters
    ----------
    scenario : Scenario
    states : int
        Number of random states.
    end : float
        Longest time in s over which motions are compared.
    """
    return [
        check
        for formulation in counted(mbs_models.formulations(scenario), "formulations")
        for check in check_formulation(scenario, formulation, states=states, end=end)
    ]


def check_formulation(
    scenario: Scenario, formulation: Formulation, *, states: int = 100, end: float | None = END
) -> list[Check]:
    """Compare one formulation; the arguments are those of `check_scenario`.

    Without an `end`, motions are not compared.
    """
    scene = Scene(scenario=scenario, formulation=formulation)
    return [
        *check_accelerations(scene, states),
        *([] if end is None else [check_trajectory(scene, end)]),
        *(check_eigenvalues(scene, motion) for motion in MOTIONS),
    ]


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
    coordinates[2] += rng.uniform(-1.0, 2.0) * scenario.contact.resting_penetration(
        scenario.weight
    )
    rates[2] += rng.uniform(-0.01, 0.01)
    return State(coordinates=tuple(coordinates), rates=tuple(rates))


def check_accelerations(scene: Scene, states: int, seed: int = 1) -> list[Check]:
    """Compare accelerations and constraint forces at random admissible states."""
    scenario, rng = scene.scenario, np.random.default_rng(seed)
    compare = _ideal_differences if scenario.contact is None else _penalty_differences
    worst = np.zeros(2)
    for _ in range(states):
        worst = np.fmax(worst, compare(scene, random_state(scenario, rng)))
    return [
        Check(
            quantity=quantity,
            formulation=scene.built_as,
            criterion=ACCELERATION_LIMIT,
            difference=float(difference),
            detail=f"relative, at {states} random states",
        )
        for quantity, difference in zip(("accelerations", "constraint forces"), worst, strict=True)
    ]


def _ideal_differences(scene: Scene, state: State) -> tuple[float, float]:
    """Relative differences of accelerations and multipliers; nan where both are singular."""
    found: list[tuple[Array, Array] | None] = []
    sides: tuple[Callable[[], tuple[Array, Array]], ...] = (
        lambda: mbs_models.acceleration(scene, state),
        lambda: index1.accelerations(scene.scenario, state.coordinates, state.rates),
    )
    for side in sides:
        try:
            found.append(side())
        except ArithmeticError:
            # Friction on the contact force may leave no solution; then neither side has one.
            found.append(None)
    engine, inhouse = found
    if engine is None or inhouse is None:
        return (np.nan, np.nan) if engine is inhouse else (np.inf, np.inf)
    # A random normal force may vanish, so multipliers are measured by the weight as well.
    least = max(scene.scenario.weight, float(np.max(np.abs(inhouse[1]))))
    return _relative(engine[0], inhouse[0]), _relative(engine[1], inhouse[1], least)


def _penalty_differences(scene: Scene, state: State) -> tuple[float, float]:
    """The same on a penalty contact, whose in-house equations know of no Euler angles.

    The engine's accelerations carry the state of the free body along a path.
    """
    scenario = scene.scenario
    acceleration, forces = mbs_models.acceleration(scene, state)
    z, u = np.array(state.coordinates), np.array(state.rates)

    def velocities(time: float) -> Array:
        place, rates = z + time * u + time * time / 2 * acceleration, u + time * acceleration
        return start_vector(scenario.disk, State(coordinates=place, rates=rates))[7:13]  # type: ignore[arg-type]

    model, here = FreeDisk(scenario), start_vector(scenario.disk, state)
    expected = np.array(model.derivative(0.0, here)[7:13])
    found = _derivative(velocities, 0.02 / max(1.0, float(np.max(np.abs(u)))))
    force = np.array([model.touch(here.tolist()).force])
    return (
        _relative(found, expected, scenario.table.gravity),
        _relative(forces, force, max(scenario.weight, float(force[0]))),
    )


def _derivative(function: Callable[[float], Array], step: float) -> Array:
    """Derivative at 0 by central differences of eighth order."""
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    differences = [
        weight * (function(k * step) - function(-k * step)) for k, weight in enumerate(weights, 1)
    ]
    result: Array = np.sum(differences, axis=0) / step
    return result


def _relative(found: Array, expected: Array, least: float = 0.0) -> float:
    scale = max(least, float(np.max(np.abs(expected))))
    return float(np.max(np.abs(found - expected)) / scale)


def check_trajectory(scene: Scene, end: float) -> Check:
    """Compare the motions from the scenario's own start, over at most `end` in s.

    The time is cut short of where the disk comes to lie flat, and where a run would take too long
    or cannot be had to the tolerance. If one side ends because the contact would pull, the other
    one has to do so there.
    """
    why = ""
    for part in (1.0, 0.1, 0.01):
        try:
            difference, detail = _compare_motions(scene, part * end)
        except (ToleranceError, TimeLimitError, ValueError) as error:
            why = why or " ".join(str(error).split())
        else:
            return _motion_check(scene, difference, detail)
    return _motion_check(scene, None, why)


def _motion_check(scene: Scene, difference: float | None, detail: str) -> Check:
    return Check(
        quantity="β and γ of the motion in rad",
        formulation=scene.built_as,
        criterion=ANGLE_LIMIT,
        difference=difference,
        detail=detail,
    )


def _compare_motions(scene: Scene, end: float) -> tuple[float, str]:
    """Difference of both motions in rad, infinite if they end otherwise, and how it was found."""
    times, inhouse = _comparable(scene, end)
    try:
        engine = run(
            scene.scenario,
            times,
            formulation=scene.built_as,
            tolerance=ANGLE_LIMIT,
            time_limit=LIMIT,
        )
    except (mbs_models.EngineError, FlatError) as error:
        return np.inf, f"the engine fails: {error}"
    endings = [None if each.ending is None else each.ending.reason for each in (engine, inhouse)]
    if endings[0] != endings[1] or engine.times.size != inhouse.times.size:
        told = (str(each.ending or "runs through") for each in (engine, inhouse))
        return np.inf, "engine {}; in-house {}".format(*told)
    detail = f"over {engine.times[-1]:.4g} s" + (f", where {endings[0]}" if endings[0] else "")
    return angle_error(engine, inhouse), detail


def _comparable(scene: Scene, end: float) -> tuple[tuple[float, ...], Trajectory]:
    """Times in s as far as `end` if disk and patience allow, and the in-house motion there."""
    scenario = scene.scenario
    efforts = (
        run_effort(scenario, _times(end), formulation=scene.built_as, tolerance=ANGLE_LIMIT),
        run_effort(scenario, _times(end), source="in-house", tolerance=REFERENCE_TOLERANCE),
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


@cache
def reference(scenario: Scenario, times: tuple[float, ...]) -> Trajectory:
    """In-house run, two digits better than what is compared with it."""
    return run(scenario, times, source="in-house", tolerance=REFERENCE_TOLERANCE, time_limit=LIMIT)


def angle_error(trajectory: Trajectory, other: Trajectory) -> float:
    """Largest difference of beta and gamma in rad."""
    return float(np.max(np.abs(trajectory.coordinates - other.coordinates)[:, 4:6]))


def check_eigenvalues(scene: Scene, motion: Motion) -> Check:
    """Compare the eigenvalues of a stationary motion at some spins."""
    difference, detail = _compare_eigenvalues(scene, motion)
    return Check(
        quantity=f"eigenvalues, {motion}",
        formulation=scene.built_as,
        criterion=EIGENVALUE_LIMIT,
        difference=difference,
        detail=detail,
    )


def _compare_eigenvalues(scene: Scene, motion: Motion) -> tuple[float | None, str]:
    """Largest relative difference, infinite if one side has none, and how it was found."""
    scenario = scene.scenario
    if scenario.contact is not None:
        return None, "no linearisation of a compliant contact"
    try:
        expected = spectra.eigenvalues(scenario, SPINS, system="numeric", motion=motion)
    except ValueError as error:
        return None, str(error)
    except ArithmeticError as error:
        return np.inf, str(error)
    worst = 0.0
    for spin, values in zip(SPINS, expected, strict=True):
        start = Start.stationary(spin, motion)
        try:
            found = mbs_models.eigenvalues(replace(scene, scenario=replace(scenario, start=start)))
        except (ValueError, ArithmeticError) as error:
            return np.inf, f"the engine fails: {error}"
        worst = max(worst, distance(found, values) if found.size == values.size else np.inf)
    spins = " and ".join(f"{spin:g}" for spin in SPINS)
    return worst, f"relative to max(|λ|, 1), at {spins} rad/s"


def table(checks: Sequence[Check]) -> Table:
    """Every check of a scenario with its criterion and verdict."""
    return Table(
        name="check",
        title="Engine against in-house equations",
        columns=("formulation", "compared", "how", "largest difference", "at most", "agrees"),
        rows=[
            [
                check.formulation,
                check.quantity,
                check.detail,
                check.difference,
                check.criterion,
                check.verdict if isinstance(check.verdict, bool) else "not defined",
            ]
            for check in checks
        ],
    )


def overview(
    name: str, title: str, checked: Mapping[tuple[str, ...], Sequence[Check]], note: str = ""
) -> Table:
    """One row for each scenario and formulation, named by the keys, and a column for each check.

    Parameters
    ----------
    name, title, note : str
        Of the table.
    checked : mapping
        From scenario and formulation, in words, to the checks; all make the same ones.
    """
    first = next(iter(checked.values()))
    return Table(
        name=name,
        title=title,
        columns=(
            "scenario",
            "formulation",
            *(f"{check.quantity} (at most {check.criterion:g})" for check in first),
            "agrees",
        ),
        rows=[
            [*key, *(check.difference for check in checks), _agrees(checks)]
            for key, checks in checked.items()
        ],
        note=note,
    )


def _agrees(checks: Sequence[Check]) -> Cell:
    """No if a check fails, else what is not defined, else yes."""
    verdicts = [check.verdict for check in checks]
    return False if False in verdicts else next((v for v in verdicts if v is not True), True)


def _paper_scenarios() -> dict[tuple[str, ...], tuple[Scenario, Formulation]]:
    """The paper's models on either load, in every formulation."""
    return {
        (f"Model {level}, load {load}", formulation): (scenario, formulation)
        for load in LOADS
        for level in LEVELS
        for scenario in [Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))]
        for formulation in mbs_models.formulations(scenario)
    }


def _every_set() -> dict[tuple[str, ...], tuple[Scenario, Formulation]]:
    """Every possible set of constraints, in every formulation."""
    return {
        (" + ".join(constraints), formulation): (scenario, formulation)
        for constraints in POSSIBLE_SETS
        for scenario in [Scenario(constraints=constraints)]
        for formulation in mbs_models.formulations(scenario)
    }


def _check_sets(keys: Sequence[tuple[str, ...]]) -> dict[tuple[str, ...], list[Check]]:
    every = _every_set()
    return {key: check_formulation(*every[key], states=50, end=None) for key in keys}


def jobs() -> list[Job]:
    """Jobs of this section."""
    models = [
        Job(("crosscheck", key), _check_model, case) for key, case in _paper_scenarios().items()
    ]
    return [*models, Job("crosscheck of sets", _check_sets, (list(_every_set()),))]


def _check_model(scenario: Scenario, formulation: Formulation) -> list[Check]:
    return check_formulation(scenario, formulation, states=1000)


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report from the results of `jobs`."""
    return Section(
        name="crosscheck",
        title="Engine against in-house equations",
        paragraphs=[
            (
                "Accelerations: mass matrix, right-hand side and constraint residual are taken "
                "from the engine, and one linear solve gives its accelerations and constraint "
                "forces; the in-house ones come from the index-1 systems (79), (80) and (92). "
                "1000 random states, relative to the largest acceleration, and to the largest "
                "constraint force or the weight."
            ),
            (
                f"Motions, over {END:g} s from Table 3: the engine halves its step and "
                "extrapolates until its own error estimate is below the limit; the in-house run "
                "is integrated with DOP853 to a hundredth of the limit."
            ),
            (
                "Eigenvalues: the engine's accelerations and the in-house ones, each "
                "differentiated along the constraint manifold, at "
                f"{' and '.join(f'{spin:g}' for spin in SPINS)} rad/s. `tippedisk check` does "
                "all this with a scenario of one's own."
            ),
        ],
        tables=[
            overview(
                "crosscheck-models",
                "The paper's models",
                {key: results["crosscheck", key] for key in _paper_scenarios()},
            ),
            overview(
                "crosscheck-sets",
                "Every set of constraints that is possible",
                results["crosscheck of sets"],
                note="Any of the constraints beside the contact, but not all of them: 50 random "
                "states each.",
            ),
        ],
    )
