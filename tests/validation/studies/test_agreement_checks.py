"""What is no agreement: no number, nothing measured, or not as many things on both sides."""

from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import MODELS, MOTIONS, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.trajectory import SOURCES
from mbs_models import Formulation, Scene
from validation.kit import shipped
from validation.kit.limits import holds, largest
from validation.kit.report import Section
from validation.kit.samples import Sample
from validation.kit.tables import Table, Tables
from validation.run import run
from validation.studies import comparisons, crosscheck
from validation.studies.crosscheck import Check
from validation.studies.rest import runs as rest
from validation.studies.rest import section as rest_section

CHECK = Check(quantity="q", formulation="floating", criterion=1.0, difference=0.5, detail="how")
NOTHING = (nan, inf, None)


@pytest.mark.parametrize("difference", NOTHING)
@pytest.mark.parametrize("limit", [1.0, inf, nan])
def test_what_has_not_been_measured_never_holds(difference: float | None, limit: float) -> None:
    assert not holds(difference, limit)
    assert not holds(0.5, nan)
    assert holds(0.5, 0.5)


@pytest.mark.parametrize("found", [[], [nan, 1.0], [1.0, nan], [None, 1.0], [1.0, inf]])
def test_largest_of_what_is_not_all_measured_is_infinite(found: list[float | None]) -> None:
    assert largest(found) == inf
    assert largest([1.0, 2.0, 0.5]) == 2.0


def spoiled(monkeypatch: pytest.MonkeyPatch, number: int, how: Callable[[Array], Array]) -> None:
    """Let the engine's accelerations be others at one of the states."""
    right, calls = mbs_models.acceleration, iter(range(1000))

    def acceleration(*arguments: Any) -> tuple[Array, Array]:
        found, forces = right(*arguments)
        return (how(found), forces) if next(calls) == number else (found, forces)

    monkeypatch.setattr(mbs_models, "acceleration", acceleration)


def singular(_: Array) -> Array:
    raise ArithmeticError("singular")


def accelerations(states: int, scenario: Scenario | None = None) -> Check:
    scenario = Scenario() if scenario is None else scenario
    return crosscheck.check_formulation(scenario, "euler-tree", states=states, end=None)[0]


@pytest.mark.parametrize(
    "how", [lambda a: nan * a, lambda a: inf * a, singular], ids=["nan", "inf", "singular"]
)
@pytest.mark.parametrize("number", [0, 2])
def test_one_state_without_a_number_on_one_side_is_no_agreement(
    how: Callable[[Array], Array], number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert accelerations(3).verdict is True
    spoiled(monkeypatch, number, how)
    assert accelerations(3).verdict is False


def test_no_state_at_all_is_no_agreement() -> None:
    assert accelerations(0).verdict is False


def test_states_without_a_solution_on_either_side_are_not_counted() -> None:
    friction = SmoothCoulomb(coefficient=1e3, load="contact")
    found = accelerations(20, Scenario(friction=friction))
    assert found.counted is not None
    assert 0 < found.counted < 20
    assert f"at {found.counted} of 20 random states" in found.detail
    easy = accelerations(20)
    assert easy.counted == 20
    assert easy.detail == "relative, at 20 random states"


@pytest.mark.parametrize(("seconds", "agree"), [(0.0, True), (1e-6, False)])
def test_motion_that_ends_later_in_the_same_state_does_not_agree(
    seconds: float, agree: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(scenario: Scenario, times: object, **options: Any) -> Trajectory:
        found = run(scenario, times, **options)  # type: ignore[arg-type]
        if options.get("source") == "in-house" or found.ending is None:
            return found
        ending = replace(found.ending, time=found.ending.time + seconds)
        return replace(found, times=found.times + seconds, ending=ending)

    comparisons.reference.cache_clear()
    monkeypatch.setattr(comparisons, "run", late)
    pulling = Scenario(start=Start(spin=100.0, beta=1.0))
    difference, _ = comparisons.motion_difference(Scene(pulling), 0.1)
    assert holds(difference, comparisons.ANGLE_LIMIT) is agree


OTHERS = {
    "not defined": replace(CHECK, difference=None, detail="why"),
    "nan": replace(CHECK, difference=nan),
    "wrong": replace(CHECK, difference=2.0),
    "right": CHECK,
}


@pytest.mark.parametrize(
    ("found", "verdict"),
    [
        (("not defined", "wrong", "right"), False),
        (("wrong", "not defined", "right"), False),
        (("right", "nan", "wrong"), False),
        (("right", "not defined", "right"), "not defined: why"),
        (("right", "right", "right"), True),
    ],
)
def test_worst_formulation_of_a_set_is_a_wrong_one(
    found: tuple[str, ...], verdict: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    counted = iter((50, 30, 40))
    left = iter(found)

    def check(_: Scenario, formulation: Formulation, **_options: object) -> list[Check]:
        return [replace(OTHERS[next(left)], formulation=formulation, counted=next(counted))]

    monkeypatch.setattr(crosscheck, "check_formulation", check)
    monkeypatch.setattr(mbs_models, "formulations", lambda _: ("a", "b", "c"))
    (worst,) = crosscheck.check_set(MODELS[2])
    assert worst.verdict == verdict
    assert worst.counted == 30


def test_formulation_that_lacks_a_check_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def check(_: Scenario, formulation: Formulation, **_options: object) -> list[Check]:
        return [CHECK] * (1 if formulation == "floating" else 2)

    monkeypatch.setattr(crosscheck, "check_formulation", check)
    with pytest.raises(ValueError, match="zip"):
        crosscheck.check_set(MODELS[2])
    first: dict[tuple[str, ...], list[Check]] = {("a",): [CHECK]}
    for others in ({}, first):
        with pytest.raises(ValueError, match="same checks for all, and some, got others for b"):
            crosscheck.overview("name", "title", ("case",), {**others, ("b",): []})


def test_overview_says_how_many_states_count() -> None:
    few = [replace(CHECK, counted=1000), replace(CHECK, quantity="p", counted=7)]
    many = [replace(CHECK, counted=9), replace(CHECK, quantity="p", counted=8)]
    table = crosscheck.overview(
        "crosscheck-models", "title", ("case",), {("a",): few, ("b",): many}
    )
    assert [row[1] for row in table.rows] == [7, 8]
    tables = Tables({table.name: table})
    assert crosscheck.states_counted(tables) == "7 random states"


def test_shipped_check_that_is_not_defined_when_made_again_is_not_confirmed() -> None:
    results = {
        job.key: [OTHERS["not defined" if job.key[0] == "fresh" else "right"]]
        for job in [*crosscheck.jobs(), *crosscheck.shipped()]
    }
    confirmed, *_ = crosscheck.section(results).tables
    assert [row[-1] for row in confirmed.rows] == [False] * 4 + [None]


@pytest.mark.parametrize(
    "found", [np.zeros(2), np.array([1.0, 2.0, np.nan])], ids=["fewer", "nan"]
)
def test_other_eigenvalues_do_not_agree(found: Array, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mbs_models, "eigenvalues", lambda _: found.astype(complex))
    for motion in MOTIONS:
        assert comparisons.eigenvalue_difference(Scene(), motion)[0] == inf


@pytest.mark.parametrize("difference", NOTHING)
def test_sample_without_a_difference_is_not_confirmed(difference: float | None) -> None:
    assert Sample(what="a", how="b", difference=0.5, limit=1.0).agrees is True
    assert Sample(what="a", how="b", difference=difference, limit=1.0).agrees is False
    assert Sample(what="only shipped").agrees is None


@pytest.fixture(scope="module")
def ways_to_rest() -> dict[Any, Any]:
    jobs = shipped.taken("rest", rest_section.shipped())
    return {job.key: job.function(*job.arguments) for job in jobs}


def test_no_run_to_rest_is_compared_with_itself(ways_to_rest: dict[Any, Any]) -> None:
    first, *others = rest_section.variant_table(ways_to_rest).rows
    assert list(first[-3:]) == [None] * 3
    assert [row[-1] for row in others] == [True] * len(others)
    for row in rest_section.budget(ways_to_rest).rows:
        assert row[-2] is True
        assert row[-1] is (True if row[1] == "engine" else None)
    key = ("rest", rest.SHOWN, "engine")
    wrong = replace(ways_to_rest[key], taken=1.1 * ways_to_rest[key].taken)
    found = rest_section.budget(ways_to_rest | {key: wrong})
    assert [row[-1] for row in found.rows].count(False) == 1


@pytest.mark.parametrize("source", SOURCES)
def test_phase_that_one_side_lacks_is_a_disagreement(
    source: str, ways_to_rest: dict[Any, Any]
) -> None:
    key = ("rest", rest.SHOWN, source)
    course = ways_to_rest[key]
    lost = replace(course, phases=replace(course.phases, inversion=None))
    found = ways_to_rest | {key: lost}
    assert rest_section.phase_table(ways_to_rest).checks().count(False) == 0
    assert rest_section.phase_table(found).checks().count(False) == 1
    wrong = 1 if source == "engine" else len(rest_section.VARIANTS)
    assert rest_section.variant_table(found).checks().count(False) == wrong


def test_check_that_is_none_of_python_is_refused_by_a_table() -> None:
    with pytest.raises(ValueError, match="rows must hold text, numbers, truth values and None"):
        Table(name="a", title="a", columns=("holds",), rows=[[np.bool_(False)]])  # type: ignore[list-item]


def test_no_table_hides_another_of_its_name() -> None:
    failed, held = (
        Table(name="a", title="a", columns=("holds",), rows=[[cell]]) for cell in (False, True)
    )
    sections = [Section(name=name, title=name, tables=[failed]) for name in "bc"]
    assert Tables.of(sections).checks() == (1, ["a"])
    sections[1] = Section(name="c", title="c", tables=[held])
    with pytest.raises(ValueError, match="each table once, got two of a"):
        Tables.of(sections)
