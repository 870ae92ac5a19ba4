"""What is no agreement: no number, nothing measured, or not as many things on both sides."""

from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest

from analysis import Scenario
from analysis.data.trajectory import SOURCES
from validation import benchmark
from validation.kit import shipped
from validation.kit.limits import holds, largest
from validation.kit.report import Section
from validation.kit.samples import Sample
from validation.kit.tables import Table, Tables
from validation.studies.nonlinear import confirm as nonlinear_confirm
from validation.studies.nonlinear import engine_cycles
from validation.studies.rest import runs as rest
from validation.studies.rest import section as rest_section
from validation.studies.stability import eigenvalue_check

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


VALUES = np.array([1.0 + 2.0j, 1.0 - 2.0j, -3.0])


@pytest.mark.parametrize(
    "found",
    [VALUES[:2], np.append(VALUES, -5.0), VALUES[:0], [1.0, 2.0, nan], [1.0, 2.0, inf]],
    ids=["fewer", "more", "none", "nan", "inf"],
)
def test_other_eigenvalues_are_infinitely_far_off(found: Any) -> None:
    found = np.asarray(found, dtype=complex)
    assert eigenvalue_check.distance(VALUES[::-1], VALUES) == 0.0
    assert eigenvalue_check.distance(found, VALUES) == inf
    assert eigenvalue_check.distance(found[:0], VALUES[:0]) == inf


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
