"""Engine against in-house equations, for any scenario.

Both sides are given the same scenario and share nothing of the mechanics. Three things are
compared: accelerations and constraint forces at random states that the constraints admit, the
motion from the scenario's own start, and the eigenvalues of both stationary spinning motions.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, inf, log10, pi
from typing import Any, NamedTuple

import pandas as pd

import mbs_models
from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    Disk,
    EllipticDisk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Sphere,
    Start,
)
from analysis.data.trajectory import SOURCES, Source
from mbs_models import Formulation, Scene
from validation import study
from validation.kit.limits import holds, largest
from validation.kit.progress import counted
from validation.kit.tables import Table
from validation.page.content import Content, Rows, Verdict
from validation.page.section import power
from validation.run import run_to_rest
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
from validation.study import Row, Study, at_most, equal

TITLE = "Engine against in-house equations"

ACCELERATION_LIMIT = 1e-8
"""Largest relative difference of accelerations and constraint forces that passes."""

MOTION = "β and γ of the motion in rad"

END = 1.0
"""End in s of the motions that are compared, past the inversion, if the scenario allows it."""

MODELS_OF_PAPER, SETS, OTHERS = "the paper's models", "sets of constraints", "other bodies"

STATES = {MODELS_OF_PAPER: 250, SETS: 50, OTHERS: 50}
"""Random states of each scene."""

TOP = Sphere(
    radius=0.02,
    mass=0.02,
    eccentricity=0.003,
    inertia_x=3.0e-6,
    inertia_y=2.98e-6,
    inertia_z=2.98e-6,
)
"""A tippe top: a sphere with its centre of gravity off its middle."""

COMPOSED = Disk.of_parts(
    (0.045, 0.01, 7700.0),
    holes=[(-0.02, 0.0, 0.012), (0.01, 0.02, 0.005)],
    masses=[(0.0, 0.03, 0.02)],
)
"""A disk whose centre of gravity does not lie on a principal axis."""

ELLIPSE = EllipticDisk(
    radius=0.045,
    other_radius=0.035,
    mass=0.4,
    eccentricity=0.003,
    inertia_x=2.2e-4,
    inertia_y=2.1e-4,
    inertia_z=4.0e-4,
)

TURNED = 1e-7
"""By how much in s the times may differ at which the tippe top has turned over."""


class Check(NamedTuple):
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
    accelerations, forces, number = acceleration_differences(scene, states)
    how = f"relative, at {states} random states"
    if number < states:
        how = f"relative, at {number} of {states} random states: the others have no solution"
    checks = [
        Check(quantity, formulation, ACCELERATION_LIMIT, difference, how, number)
        for quantity, difference in (
            ("accelerations", accelerations),
            ("constraint forces", forces),
        )
    ]
    if end is not None and goes_to_rest(scene):
        quantity = "vertical and energies of the motion, relative"
        checks.append(Check(quantity, formulation, REST_LIMIT, *rest_difference(scene, end)))
    elif end is not None:
        checks.append(Check(MOTION, formulation, ANGLE_LIMIT, *motion_difference(scene, end)))
    for motion in MOTIONS:
        found = eigenvalue_difference(scene, motion)
        checks.append(Check(f"eigenvalues, {motion}", formulation, EIGENVALUE_LIMIT, *found))
    return checks


def table(checks: Sequence[Check]) -> Table:
    """Every check of a scenario with its criterion and verdict."""
    heads = ("formulation", "compared", "how", "largest difference", "at most", "agrees")
    rows = [
        [*(each.formulation, each.quantity, each.detail, each.difference, each.criterion), agrees]
        for each in checks
        for agrees in [each.verdict if isinstance(each.verdict, bool) else "not defined"]
    ]
    return Table(title=TITLE, columns=heads, rows=rows)


class Case(NamedTuple):
    """A scenario to compare, what for, and whether its motions are compared, too."""

    scenario: Scenario
    kind: str

    @property
    def end(self) -> float | None:
        """Time in s over which motions are compared."""
        return None if self.kind == SETS else END


def cases() -> dict[str, Case]:
    """The paper's models on either load, every possible set of constraints, and other bodies."""
    models = {
        f"Model {level}, load {load}": Scenario(
            constraints=MODELS[level], friction=SmoothCoulomb(load=load)
        )
        for load in LOADS
        for level in LEVELS
    }
    sets = {" + ".join(each): Scenario(constraints=each) for each in POSSIBLE_SETS}
    bodies = {
        "composed disk": Scenario(disk=COMPOSED),
        "sphere": Scenario(disk=TOP),
        "ellipse": Scenario(disk=ELLIPSE, contact=PenaltyContact.damped(1e5, ELLIPSE)),
    }
    return {
        label: Case(scenario, kind)
        for kind, scenarios in ((MODELS_OF_PAPER, models), (SETS, sets), (OTHERS, bodies))
        for label, scenario in scenarios.items()
    }


def measure(case: Case) -> list[Row]:
    """All comparisons of a case; other bodies than the paper's disk have no spectra."""
    return [
        {"kind": case.kind, **check._asdict()}
        for formulation in mbs_models.formulations(case.scenario)
        for check in check_formulation(
            case.scenario, formulation, states=STATES[case.kind], end=case.end
        )
        if case.kind != OTHERS or not check.quantity.startswith("eigenvalues")
    ]


STUDY = Study(
    name="crosscheck",
    cases=cases,
    measure=measure,
    keys=("formulation", "quantity"),
)


def turn_over(source: Source) -> list[Row]:
    """When the tippe top, spun about its axis with the centre of gravity low, has turned over."""
    scenario = Scenario(
        disk=TOP,
        friction=SmoothCoulomb(smoothing=0.01, load="contact"),
        contact=PenaltyContact.rounded(TOP, stiffness=1e4),
        start=Start(beta=pi / 2, gamma=-pi / 2 + 0.1, spin=150.0),
    )
    step: dict[str, Any] = {"step": 1e-4} if source == "engine" else {}
    ending = run_to_rest(scenario, 2.4, source=source, stop_when="inverted", **step).ending
    return [{"turned": None if ending is None else ending.time}]


TIPPE_TOP = Study(
    name="tippe-top", cases=lambda: {source: source for source in SOURCES}, measure=turn_over
)
STUDIES = (STUDY, TIPPE_TOP)


def present(rows: Rows) -> Content:
    """Every comparison with its limit, the paper's models and the sets of constraints apart."""
    found, turned = rows["crosscheck"], rows["tippe-top"]["turned"]
    worst = found.groupby(["kind", "quantity"], sort=False).agg(
        scenes=("case", "size"),
        states=("counted", "min"),
        difference=("difference", largest),
        criterion=("criterion", "max"),
    )
    scenes = Counter[str]()
    for case in cases().values():
        scenes[case.kind] += len(mbs_models.formulations(case.scenario))
    apart = float(turned.max() - turned.min()) if turned.notna().all() else inf
    checks = [*_checks(worst, scenes), at_most("tippe top: turned over, in s", apart, TURNED)]
    of_models = worst.loc[MODELS_OF_PAPER, "difference"]
    most = {
        name: _rounded_up(largest(of_models[of_models.index.str.contains(name)]))
        for name in ("accelerations|forces", "motion in", "eigenvalues")
    }
    accelerations, motions, eigenvalues = most.values()
    agrees = all(check.holds for check in checks)
    heads = ("compared over", "quantity", "scenes", "random states", "largest", "at most")
    return Content(
        numbers={
            "accelerations": accelerations,
            "motions": motions,
            "eigenvalues": eigenvalues,
            "scenes": scenes[MODELS_OF_PAPER],
            "spins": SPINS,
            "turned": turned,
            "turned_apart": apart,
        },
        tables={
            "agreement": worst.reset_index().set_axis(heads, axis=1),
            "models": _by_scene(found[found["kind"] == MODELS_OF_PAPER], ["case", "formulation"]),
            "sets": _by_scene(found[found["kind"] == SETS], ["case"]),
        },
        checks=checks,
        verdicts=[
            Verdict(
                statement="The engine solves the same equations as the in-house ones.",
                answer="yes" if agrees else "no",
                numbers=f"Over {scenes[MODELS_OF_PAPER]} scenes: accelerations and constraint "
                f"forces at {STATES[MODELS_OF_PAPER]} random states each to {accelerations}, "
                f"relative; motions over {END:g} s to {motions} rad; eigenvalues to "
                f"{eigenvalues}, relative.",
                criterion=f"at most {power(ACCELERATION_LIMIT)}, {power(ANGLE_LIMIT)} rad "
                f"and {power(EIGENVALUE_LIMIT)}, in every formulation; both sides share the "
                "description of the problem and no mechanics, which a test sees to by reading "
                "the imports.",
                good=agrees,
            )
        ],
    )


def _checks(worst: pd.DataFrame, scenes: Mapping[str, int]) -> Iterator[study.Check]:
    """Whether all scenes and states were compared and agree."""
    for (kind, quantity), row in worst.iterrows():
        name = f"crosscheck: {quantity}, {kind}"
        yield at_most(name, row["difference"], row["criterion"])
        yield equal(f"{name}, scenes", row["scenes"], scenes[kind])
        if quantity == "accelerations":
            yield equal(f"{name}, states with a solution", row["states"], STATES[kind])


def _by_scene(found: pd.DataFrame, scene: list[str]) -> pd.DataFrame:
    """A row for each scene with its largest difference of every quantity."""
    largest_ones = found.groupby([*scene, "quantity"], sort=False)["difference"].agg(largest)
    return largest_ones.unstack(sort=False).reset_index()


def _rounded_up(value: float) -> str:
    """One digit that is not exceeded: "8e-10"."""
    if not 0.0 < value < inf:
        return f"{value:g}"
    exponent = floor(log10(value))
    # Rounding to some digits first keeps 2e-7 what it is.
    digit = ceil(round(value / 10.0**exponent, 6))
    return f"{digit}e{exponent}" if digit < 10 else f"1e{exponent + 1}"
