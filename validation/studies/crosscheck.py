"""Engine against in-house equations, for any scenario.

Both sides are given the same scenario and share nothing of the mechanics. Three things are
compared: accelerations and constraint forces at random states that the constraints admit, the
motion from the scenario's own start, and the eigenvalues of both stationary spinning motions.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import NamedTuple

import pandas as pd

import mbs_models
from analysis import LEVELS, LOADS, MODELS, MOTIONS, POSSIBLE_SETS, Scenario, SmoothCoulomb
from mbs_models import Formulation, Scene
from validation.kit import tables
from validation.kit.limits import holds, largest
from validation.kit.progress import counted
from validation.kit.tables import Table
from validation.page.content import Content, Rows, Verdict
from validation.studies.comparisons import (
    ANGLE_LIMIT,
    REST_LIMIT,
    SPINS,
    Found,
    acceleration_differences,
    eigenvalue_difference,
    goes_to_rest,
    motion_difference,
    rest_difference,
)
from validation.studies.stability.eigenvalue_check import EIGENVALUE_LIMIT
from validation.study import Row, Study, at_most, equal

TITLE = "Engine against in-house equations"

ACCELERATION_LIMIT = 1e-8
"""Largest relative difference of accelerations and constraint forces that passes."""

END = 2.0
"""End in s of the motions that are compared, if the scenario allows so long a one."""

MODEL_STATES, SET_STATES = 1000, 50
"""Random states of each of the paper's models, and of each set of constraints."""


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


def check_scenario(
    scenario: Scenario, *, states: int = 100, end: float | None = END
) -> list[Check]:
    """Compare every formulation that can build a scenario with the in-house equations.

    Parameters
    ----------
    scenario : Scenario
    states : int
        Number of random states.
    end : float, optional
        Longest time in s over which motions are compared; without it, they are not.
    """
    return [
        check
        for formulation in counted(mbs_models.formulations(scenario), "formulations")
        for check in check_formulation(scenario, formulation, states=states, end=end)
    ]


def check_formulation(
    scenario: Scenario, formulation: Formulation, *, states: int = 100, end: float | None = END
) -> list[Check]:
    """Compare one formulation; the arguments are those of `check_scenario`."""
    scene = Scene(scenario, formulation)
    accelerations, forces, number = acceleration_differences(scene, states)
    how = f"relative, at {states} random states"
    if number < states:
        how = f"relative, at {number} of {states} random states: the others have no solution"

    def check(quantity: str, criterion: float, found: Found, counted: int | None = None) -> Check:
        return Check(
            quantity=quantity,
            formulation=formulation,
            criterion=criterion,
            difference=found[0],
            detail=found[1],
            counted=counted,
        )

    checks = [
        check("accelerations", ACCELERATION_LIMIT, (accelerations, how), number),
        check("constraint forces", ACCELERATION_LIMIT, (forces, how), number),
    ]
    if end is not None and goes_to_rest(scene):
        moved = rest_difference(scene, end)
        checks.append(check("vertical and energies of the motion, relative", REST_LIMIT, moved))
    elif end is not None:
        moved = motion_difference(scene, end)
        checks.append(check("β and γ of the motion in rad", ANGLE_LIMIT, moved))
    for motion in MOTIONS:
        spectra = eigenvalue_difference(scene, motion)
        checks.append(check(f"eigenvalues, {motion}", EIGENVALUE_LIMIT, spectra))
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
        title=TITLE,
    )


class Case(NamedTuple):
    """A scenario to compare, and the arguments of `check_scenario`."""

    scenario: Scenario
    states: int
    end: float | None


def cases() -> dict[str, Case]:
    """The paper's models on either load, and every set of constraints that is possible."""
    models = {
        f"Model {level}, load {load}": Case(
            Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load)),
            MODEL_STATES,
            END,
        )
        for load in LOADS
        for level in LEVELS
    }
    sets = {
        " + ".join(each): Case(Scenario(constraints=each), SET_STATES, None)
        for each in POSSIBLE_SETS
    }
    return models | sets


def measure(case: Case) -> list[Row]:
    """All comparisons of a case."""
    checks = check_scenario(case.scenario, states=case.states, end=case.end)
    return [asdict(check) for check in checks]


STUDY = Study(
    name="crosscheck",
    cases=cases,
    measure=measure,
    keys=("formulation", "quantity"),
    columns={
        "criterion": "largest difference that passes",
        "difference": "largest difference found, in the unit of the quantity",
        "counted": "random states at which both sides have a solution",
    },
)
STUDIES = (STUDY,)

MODELS_OF_PAPER, SETS = "the paper's models", "sets of constraints"


def present(rows: Rows) -> Content:
    """Every comparison with its limit, the paper's models and the sets of constraints apart."""
    known, found = cases(), rows["crosscheck"]
    kinds = {label: SETS if case.end is None else MODELS_OF_PAPER for label, case in known.items()}
    found = found.assign(kind=found["case"].map(kinds))
    worst = found.groupby(["kind", "quantity"], sort=False).agg(
        scenes=("case", "size"),
        states=("counted", "min"),
        difference=("difference", largest),
        criterion=("criterion", "max"),
    )
    scenes = Counter[str]()
    for label, case in known.items():
        scenes[kinds[label]] += len(mbs_models.formulations(case.scenario))
    checks = []
    for (kind, quantity), row in worst.iterrows():
        name = f"crosscheck: {quantity}, {kind}"
        checks += [at_most(name, row["difference"], row["criterion"])]
        checks += [equal(f"{name}, scenes", row["scenes"], scenes[kind])]
    for kind, number in ((MODELS_OF_PAPER, MODEL_STATES), (SETS, SET_STATES)):
        fewest = found.loc[found["kind"] == kind, "counted"].min()
        checks.append(equal(f"crosscheck: random states with a solution, {kind}", fewest, number))
    numbers = _numbers(worst.loc[MODELS_OF_PAPER], scenes)
    return Content(
        numbers=numbers,
        tables={
            "agreement": worst.reset_index().set_axis(
                ("compared over", "quantity", "scenes", "random states", "largest", "at most"),
                axis=1,
            ),
            "models": _by_scene(found[found["kind"] == MODELS_OF_PAPER], ["case", "formulation"]),
            "sets": _by_scene(found[found["kind"] == SETS], ["case"]),
        },
        checks=checks,
        verdicts=[
            Verdict(
                statement="The engine solves the same equations as the in-house ones.",
                answer="yes" if all(check.holds for check in checks) else "no",
                numbers=f"Over {numbers['scenes']} scenes: accelerations and constraint forces at "
                f"{MODEL_STATES} random states each to {numbers['accelerations']}, relative; "
                f"motions over {END:g} s to {numbers['motions']} rad; eigenvalues to "
                f"{numbers['eigenvalues']}, relative.",
                criterion=f"at most {ACCELERATION_LIMIT:g}, {ANGLE_LIMIT:g} rad and "
                f"{EIGENVALUE_LIMIT:g}, in every formulation; both sides share the description of "
                "the problem and no mechanics, which a test sees to by reading the imports.",
                good=all(check.holds for check in checks),
            )
        ],
    )


def _numbers(worst: pd.DataFrame, scenes: Counter[str]) -> dict[str, object]:
    """What the text states, differences rounded up to one digit."""

    def most(*quantities: str) -> str:
        return tables.at_most(largest(worst["difference"].get(each) for each in quantities))

    return {
        "scenes": scenes[MODELS_OF_PAPER],
        "accelerations": most("accelerations", "constraint forces"),
        "motions": most("β and γ of the motion in rad"),
        "eigenvalues": most(*(f"eigenvalues, {motion}" for motion in MOTIONS)),
        "states": MODEL_STATES,
        "set_states": SET_STATES,
        "sets": len(POSSIBLE_SETS),
        "end": END,
        "spins": SPINS,
        "angle_limit": ANGLE_LIMIT,
    }


def _by_scene(found: pd.DataFrame, scene: list[str]) -> pd.DataFrame:
    """A row for each scene with its largest difference of every quantity."""
    largest_ones = found.groupby([*scene, "quantity"], sort=False)["difference"].agg(largest)
    return largest_ones.unstack(sort=False).reset_index()
