"""Engine against in-house equations, for any scenario.

Both sides are given the same scenario and share nothing of the mechanics. Three things are
compared: accelerations and constraint forces at random states that the constraints admit, the
motion from the scenario's own start, and the eigenvalues of both stationary spinning motions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import mbs_models
from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    ConstraintSet,
    Scenario,
    SmoothCoulomb,
)
from mbs_models import Formulation, Scene
from validation.kit import samples
from validation.kit.limits import holds, largest
from validation.kit.progress import counted
from validation.kit.report import Job, Section
from validation.kit.samples import Sample
from validation.kit.tables import Cell, Table, Tables
from validation.studies.comparisons import (
    ANGLE_LIMIT,
    REST_LIMIT,
    SPINS,
    acceleration_differences,
    eigenvalue_difference,
    goes_to_rest,
    motion_difference,
    rest_difference,
)
from validation.studies.stability.eigenvalue_check import EIGENVALUE_LIMIT

ACCELERATION_LIMIT = 1e-8
"""Largest relative difference of accelerations and constraint forces that passes."""

STATES = "random states that count"
"""Column of an overview: fewest of all checks of a case."""

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
    counted : int, optional
        Number of random states at which both sides have something to compare.
    """

    quantity: str
    formulation: Formulation
    criterion: float
    difference: float | None
    detail: str
    counted: int | None = None

    @property
    def verdict(self) -> bool | str:
        """Whether the two agree; or why that is not defined."""
        if self.difference is None:
            return f"not defined: {self.detail}"
        return holds(self.difference, self.criterion)


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
    scene = Scene(scenario, formulation)

    def check(quantity: str, criterion: float, difference: float | None, detail: str) -> Check:
        return Check(
            quantity=quantity,
            formulation=formulation,
            criterion=criterion,
            difference=difference,
            detail=detail,
        )

    *differences, counted = acceleration_differences(scene, states)
    how = f"relative, at {states} random states"
    if counted < states:
        how = f"relative, at {counted} of {states} random states: the others have no solution"
    checks = [
        replace(check(quantity, ACCELERATION_LIMIT, difference, how), counted=counted)
        for quantity, difference in zip(
            ("accelerations", "constraint forces"), differences, strict=True
        )
    ]
    if end is not None and goes_to_rest(scene):
        moved = rest_difference(scene, end)
        checks.append(check("vertical and energies of the motion, relative", REST_LIMIT, *moved))
    elif end is not None:
        moved = motion_difference(scene, end)
        checks.append(check("β and γ of the motion in rad", ANGLE_LIMIT, *moved))
    for motion in MOTIONS:
        found = eigenvalue_difference(scene, motion)
        checks.append(check(f"eigenvalues, {motion}", EIGENVALUE_LIMIT, *found))
    return checks


def table(checks: Sequence[Check]) -> Table:
    """Every check of a scenario with its criterion and verdict."""
    return Table.of(
        checks,
        {
            "formulation": lambda check: check.formulation,
            "compared": lambda check: check.quantity,
            "how": lambda check: check.detail,
            "largest difference": lambda check: check.difference,
            "at most": lambda check: check.criterion,
            "agrees": lambda check: (
                check.verdict if isinstance(check.verdict, bool) else "not defined"
            ),
        },
        name="check",
        title="Engine against in-house equations",
    )


def overview(
    name: str,
    title: str,
    heads: tuple[str, ...],
    checked: Mapping[tuple[str, ...], Sequence[Check]],
    note: str = "",
) -> Table:
    """A row for each case and a column for each check.

    Parameters
    ----------
    name, title, note : str
        Of the table.
    heads : tuple of str
        Of the columns that name the case.
    checked : mapping
        From the names of each case to its checks; all make the same ones.
    """
    first = next(iter(checked.values()))
    quantities = [(check.quantity, check.criterion) for check in first]
    for key, checks in checked.items():
        if not checks or [(check.quantity, check.criterion) for check in checks] != quantities:
            raise ValueError(
                "checked must hold the same checks for all, and some, got others for "
                f"{', '.join(key)}"
            )
    limits = [f"{quantity} (at most {criterion:g})" for quantity, criterion in quantities]
    return Table(
        name=name,
        title=title,
        columns=(*heads, STATES, *limits, "agrees"),
        rows=[
            [*key, _counted(checks), *(check.difference for check in checks), _agrees(checks)]
            for key, checks in checked.items()
        ],
        note=note,
        # Motions are what a reader asks for first; sets of constraints are not run.
        worst=next((each for each in limits if each.startswith("β")), limits[0]),
    )


def states_counted(tables: Tables) -> str:
    """Fewest random states that count for one of the paper's models, in words."""
    found = tables.numbers("crosscheck-models", STATES)
    return f"{min(found):.0f} random states" if found else "random states"


def _counted(checks: Sequence[Check]) -> int | None:
    return min((check.counted for check in checks if check.counted is not None), default=None)


def _agrees(checks: Sequence[Check]) -> Cell:
    """No if a check fails, else what is not defined, else yes."""
    verdicts = [check.verdict for check in checks]
    return False if False in verdicts else next((v for v in verdicts if v is not True), True)


def _models() -> dict[tuple[str, ...], tuple[Scenario, Formulation]]:
    """The paper's models on either load, in every formulation."""
    return {
        (f"Model {level}, load {load}", formulation): (scenario, formulation)
        for load in LOADS
        for level in LEVELS
        for scenario in [Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))]
        for formulation in mbs_models.formulations(scenario)
    }


def check_set(constraints: ConstraintSet) -> list[Check]:
    """Compare a set of constraints in every formulation; of each quantity the worst is kept."""
    scenario = Scenario(constraints=constraints)
    found = [
        check_formulation(scenario, formulation, states=50, end=None)
        for formulation in mbs_models.formulations(scenario)
    ]
    # Each formulation makes the same checks: one that is missing is an error.
    return [_worst(checks) for checks in zip(*found, strict=True)]


def _worst(checks: Sequence[Check]) -> Check:
    """The check that stands for all of a quantity, with the fewest states that counted in any.

    One that fails comes before one that is not defined, and that before one that holds.
    """

    def rank(check: Check) -> tuple[int, float]:
        order = 1 if isinstance(check.verdict, str) else 0 if check.verdict else 2
        return order, largest([check.difference])

    counted = [check.counted for check in checks if check.counted is not None]
    return replace(max(checks, key=rank), counted=min(counted, default=None))


REPEATED = (
    ("Model 1, load weight", "contact-tree"),
    ("Model 2, load contact", "floating"),
    ("Model 3, load contact", "euler-tree"),
    ("Model 4, load weight", "floating-lie"),
)
"""Scenarios and formulations of the shipped checks that are made again."""


def shipped() -> list[Job]:
    """Checks whose results come with the package."""
    return [Job(("crosscheck", key), _check_model, case) for key, case in _models().items()]


def jobs() -> list[Job]:
    """Checks on the spot."""
    again = [samples.fresh(job) for job in shipped() if job.key[1] in REPEATED]
    return [*again, *(Job(("crosscheck", each), check_set, (each,)) for each in POSSIBLE_SETS)]


def _check_model(scenario: Scenario, formulation: Formulation) -> list[Check]:
    return check_formulation(scenario, formulation, states=1000)


def _samples(results: Mapping[Any, Any]) -> list[Sample]:
    """The checks that are made again, by their worst difference in parts of what it may be."""
    found = []
    for key in REPEATED:
        again: list[Check] = results[samples.fresh_key(("crosscheck", key))]
        parts = [
            np.inf if each.difference is None else each.difference / each.criterion
            for each in again
        ]
        found.append(
            Sample(
                what=", ".join(key),
                how="made again",
                quantity="engine with in-house, in parts of what each difference may be",
                difference=largest(parts),
                limit=1.0,
            )
        )
    return [*found, Sample(what="the others of the paper's models")]


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
            (
                "The checks of the paper's models come with the package, and one of each model "
                "is made again on the spot, in another formulation each. The sets of constraints "
                "are all checked on the spot."
            ),
        ],
        tables=[
            samples.table("crosscheck", shipped(), _samples(results)),
            overview(
                "crosscheck-models",
                "The paper's models",
                ("scenario", "formulation"),
                {key: results["crosscheck", key] for key in _models()},
            ),
            overview(
                "crosscheck-sets",
                "Every set of constraints that is possible",
                ("constraints",),
                {(" + ".join(each),): results["crosscheck", each] for each in POSSIBLE_SETS},
                note="Any of the constraints beside the contact, but not all of them: 50 random "
                "states each, and the worst of all formulations.",
            ),
        ],
    )
