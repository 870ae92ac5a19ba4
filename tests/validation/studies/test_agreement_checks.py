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
from mbs_models import Formulation, Scene
from validation import benchmark
from validation.kit import shipped
from validation.kit.limits import holds, largest
from validation.kit.report import Section
from validation.kit.samples import Sample
from validation.kit.tables import Table, Tables
from validation.run import run
from validation.studies import comparisons, crosscheck
from validation.studies.crosscheck import Check
from validation.studies.nonlinear import confirm as nonlinear_confirm
from validation.studies.nonlinear import engine_cycles
from validation.studies.stability import eigenvalue_check

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


VALUES = np.array([1.0 + 2.0j, 1.0 - 2.0j, -3.0])


@pytest.mark.parametrize(
    "found",
    [VALUES[:2], np.append(VALUES, -5.0), VALUES[:0], [1.0, 2.0, nan], [1.0, 2.0, inf]],
    ids=["fewer", "more", "none", "nan", "inf"],
)
def test_other_eigenvalues_are_infinitely_far_off(
    found: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = np.asarray(found, dtype=complex)
    assert eigenvalue_check.distance(VALUES[::-1], VALUES) == 0.0
    assert eigenvalue_check.distance(found, VALUES) == inf
    assert eigenvalue_check.distance(found[:0], VALUES[:0]) == inf
    monkeypatch.setattr(mbs_models, "eigenvalues", lambda _: found)
    for motion in MOTIONS:
        assert comparisons.eigenvalue_difference(Scene(), motion)[0] == inf


@pytest.mark.parametrize(
    "spoil",
    [
        lambda found: found[:, :-1, :-1],
        lambda found: np.pad(found, ((0, 0), (0, 1), (0, 1))),
    ],
    ids=["fewer", "more"],
)
def test_engine_with_another_number_of_eigenvalues_does_not_agree(
    spoil: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = eigenvalue_check.engine_matrices
    monkeypatch.setattr(
        eigenvalue_check, "engine_matrices", lambda *args, **how: spoil(right(*args, **how))
    )
    found = eigenvalue_check.worst_difference(
        Scenario(), np.array([33.0]), "contact-tree", "inverted"
    )
    assert found == inf


@pytest.mark.parametrize("case", [("inverted",), ("noninverted",)])
def test_eigenvalue_check_without_a_number_fails(case: tuple[str]) -> None:
    right = eigenvalue_check.EigenvalueCheck(
        case=(1, "floating"), inverted=1e-9, noninverted=1e-9, stock=None
    )
    assert right.passed
    assert not replace(right, **{case[0]: nan}).passed  # type: ignore[arg-type]


@pytest.mark.parametrize("difference", NOTHING)
def test_sample_without_a_difference_is_not_confirmed(difference: float | None) -> None:
    assert Sample(what="a", how="b", difference=0.5, limit=1.0).agrees is True
    assert Sample(what="a", how="b", difference=difference, limit=1.0).agrees is False
    assert Sample(what="only shipped").agrees is None


def test_cycles_without_a_number_do_not_agree() -> None:
    (job,) = [
        job
        for job in shipped.taken("nonlinear", nonlinear_confirm.shipped())
        if job.key[:2] == ("repeated cycle", "Model 2 at held spin")
    ]
    pair = job.function(*job.arguments)
    right = engine_cycles.repeated_table([("Model 2", pair)])
    assert right.rows[0][-1] is True
    for name in ("spin", "period"):
        wrong = (pair[0], replace(pair[1], **{name: nan}))
        assert engine_cycles.repeated_table([("Model 2", wrong)]).rows[0][-1] is False


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


@pytest.mark.parametrize(("reached", "code"), [(True, 0), (False, 1)])
def test_benchmark_that_misses_what_it_should_reach_fails(
    reached: bool, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = Table(name="a", title="a", columns=("reached",), rows=[[True], [reached]])
    for name in ("targets", "stability", "engine_sweeps", "load_laws"):
        monkeypatch.setattr(benchmark, name, lambda _: table)
    for name in ("to_rest", "start_up"):
        monkeypatch.setattr(benchmark, name, lambda: table)
    monkeypatch.setattr(benchmark, "compiled", lambda _: [])
    monkeypatch.setattr("sys.argv", ["benchmark"])
    assert benchmark.main() == code
