"""Results that come with the package: stored as plain data, taken, confirmed and known by age."""

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Scenario, Start
from tests.helpers import not_none
from validation.kit import report, shipped
from validation.kit.parts import Job, Part, Store
from validation.kit.plain import pack, unpack
from validation.kit.provenance import Provenance
from validation.kit.samples import Sample, table
from validation.studies import full_report, ship
from validation.studies.rest.creep import Loss
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan
from validation.sweeps.sweep import Sweep

SCENARIO = Scenario(start=Start(spin=31.0))


def sample(what: str, limit: float) -> Sample:
    return Sample(what=what, how="", quantity="", difference=0.0, limit=limit)


@pytest.mark.parametrize(
    "value",
    [
        (1, 0.1, True, None, "text", (2.0, [3])),
        {("a", 1): {"b": 1.5}},
        2.0 - 1.0j,
        np.array(((0.1, np.nan), (2.0, -3.0))),
        np.array((1.0 + 2.0j, 3.0j)),
        np.array((True, False)),
        [SCENARIO],
        (SCENARIO, SCENARIO),
        [nan, inf],
        [sample("same", 1.0), sample("same", 2.0)],
        [sample("one", 1.0), sample("other", 1.0)],
    ],
)
def test_plain_data_make_the_same_result_again(value: Any) -> None:
    again = unpack(pack(value))
    assert type(again) is type(value)
    np.testing.assert_equal(again, value)


@pytest.mark.parametrize("value", [Path("x"), {1.0}, np.array(("a",)), Loss])
def test_what_is_no_result_is_refused(value: Any) -> None:
    with pytest.raises(ValueError, match="value must be"):
        pack(value)


@pytest.mark.parametrize(
    "name",
    ["os:system", "analysis.data.checks:number", "analysis.data.scenario:asdict", ":"],
)
def test_file_can_name_nothing_but_dataclasses_of_the_project(name: str) -> None:
    with pytest.raises(ValueError, match="stored must name a dataclass of this project"):
        unpack({name: {}})


def test_file_imports_no_module_that_a_law_in_it_names() -> None:
    axes = (Axis(field="law", values=("tanh",)), Axis(field="mu", values=(0.1, 0.2)))
    stored = json.dumps(pack(Sweep(scenario=SCENARIO, design=Design(axes=axes), plan=Plan())))
    with pytest.raises(ValueError, match="'this:Law' must be imported first"):
        unpack(json.loads(stored.replace("tanh", "this:Law")))
    assert "this" not in sys.modules


def spin_of(scenario: Scenario, factor: float) -> tuple[str, float]:
    """What a job computes."""
    state = scenario.initial_state
    return "here", factor * float(state.rates[3])


def jobs(*factors: float) -> list[Job]:
    return [Job(("spin", factor), spin_of, (SCENARIO, factor)) for factor in factors]


@pytest.fixture(name="section")
def _section(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A section for which the results of two jobs are shipped."""
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    made = jobs(1.0, 2.0)
    parts = {job.key: Part(("shipped", job.arguments[1]), 1.5) for job in made}
    shipped.of.cache_clear()
    shipped.gather(made, parts, Provenance.here()).write(shipped.path_of("toy"))
    yield "toy"
    shipped.of.cache_clear()


def results(section: str, wanted: list[Job]) -> list[Any]:
    return [job.function(*job.arguments) for job in shipped.taken(section, wanted)]


def test_shipped_results_are_taken_and_others_computed(section: str) -> None:
    assert results(section, jobs(2.0, 3.0)) == [("shipped", 2.0), ("here", 93.0)]
    assert results("other", jobs(2.0)) == [("here", 62.0)]


def test_result_of_another_call_is_not_taken(section: str) -> None:
    (job,) = jobs(2.0)
    other = replace(job, arguments=(replace(SCENARIO, start=Start(spin=32.0)), 2.0))
    assert results(section, [other]) == [("here", 64.0)]


def test_report_says_what_is_confirmed_what_is_only_shipped_and_how_old_it_is(
    section: str,
) -> None:
    samples = [
        Sample(what="good", how="again", quantity="x", difference=1e-6, limit=1e-5),
        Sample(what="bad", how="again", quantity="x", difference=2e-5, limit=1e-5),
        Sample(what="long"),
    ]
    shown = table(section, jobs(1.0, 2.0, 3.0), samples)
    assert [row[-1] for row in shown.rows] == [True, False, None]
    assert shown.rows[2][1] == "no, only shipped"
    assert "2 results are shipped, which took 3 s of processor time" in shown.note
    assert "1 others were computed for this page" in shown.note
    assert "has not changed since" in shown.note
    found = shipped.of(section)
    assert found is not None
    assert found.is_of_this_code(jobs(1.0))
    assert not replace(found, code="other").is_of_this_code(jobs(1.0))
    assert table("other", jobs(1.0), samples).note.startswith("Nothing is shipped")


def test_result_of_a_class_that_has_other_fields_now_is_computed(section: str) -> None:
    found = shipped.of(section)
    assert found is not None
    name = shipped.call(jobs(2.0)[0])
    loss = {"validation.studies.rest.creep:Loss": {"begin": 1.0}}
    replace(found, parts={**found.parts, name: (loss, 1.0)}).write(shipped.path_of(section))
    shipped.of.cache_clear()
    assert results(section, jobs(1.0, 2.0)) == [("shipped", 1.0), ("here", 62.0)]


def test_damaged_file_is_said_to_be_one(section: str) -> None:
    path = shipped.path_of(section)
    path.write_text(path.read_text()[:-9])
    shipped.of.cache_clear()
    with pytest.raises(ValueError, match=r"toy.json does not hold shipped results"):
        shipped.of(section)


SHIPPING = [each for each in full_report.STUDIES if each.shipped()]
LONG = [each for each in full_report.STUDIES if each.long()]


@pytest.mark.parametrize("study", SHIPPING + LONG, ids=lambda each: each.name)
def test_shipped_results_can_be_read_and_are_small(study: full_report.Study) -> None:
    path = shipped.path_of(study.name)
    assert path.stat().st_size < 450_000
    found = shipped.read(path)
    assert found.provenance.commit
    assert "+" not in found.provenance.commit
    assert any(shipped.holds(study.name, job) for job in (*study.shipped(), *study.long()))


@pytest.mark.parametrize("name", ["work-precision"])
def test_whole_study_is_shipped(name: str) -> None:
    (study,) = (each for each in LONG if each.name == name)
    found = shipped.of(name)
    keys = [repr(job.key) for job in study.long()]
    assert [known.rpartition(" ")[0] for known in not_none(found).parts] == keys


@pytest.mark.whole
@pytest.mark.parametrize("study", SHIPPING, ids=lambda each: each.name)
def test_shipped_results_are_those_of_all_calls_that_the_report_would_make(
    study: full_report.Study,
) -> None:
    found = shipped.read(shipped.path_of(study.name))
    left = [job.key for job in study.shipped() if not shipped.holds(study.name, job)]
    assert not left, f"run python -m validation.studies.ship DIR {study.name}"
    assert len(study.shipped()) == len(found.parts)


def test_shipping_computes_what_is_left_and_puts_it_into_the_package(
    section: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    toy = replace(full_report.STUDIES[0], name=section, shipped=lambda: jobs(3.0))
    longer = replace(toy, name="longer", shipped=list, long=lambda: jobs(4.0))
    monkeypatch.setattr(ship, "STUDIES", (toy, longer))
    calls: list[Any] = []

    def run(left: list[Job], *, store: Store, **_: Any) -> dict[Any, Part]:
        calls.extend(left)
        made = {job.key: Part(job.function(*job.arguments), 2.0) for job in left}
        for job in left:
            store.keep(job, made[job.key])
        return made

    monkeypatch.setattr(report, "run_parts", run)
    for _ in range(2):
        assert ship.main([str(tmp_path)]) == 0
        assert "toy: 1 results, 2 s of processor time" in capsys.readouterr().out
    assert len(calls) == 1
    report.run_kept(jobs(3.0), tmp_path, fresh=True)
    assert len(calls) == 2
    shipped.of.cache_clear()
    assert results(section, jobs(3.0)) == [("here", 93.0)]
    assert not shipped.path_of("longer").exists()
    assert ship.main([str(tmp_path), "longer"]) == 0
    assert results("longer", jobs(4.0)) == [("here", 124.0)]
    with pytest.raises(SystemExit):
        ship.main([str(tmp_path), "nothing"])
    assert "SECTION must be one of toy, longer, got 'nothing'" in capsys.readouterr().err
