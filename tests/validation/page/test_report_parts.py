"""Finished parts of a report: kept, found again, and made anew when what they hang on changes."""

import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Scenario, Start, simulate
from tests.calls import refusal, run
from tests.helpers import not_none
from validation.kit import clock, parts, report, shipped, sources
from validation.kit.page import Verdict
from validation.kit.parts import Job, Part, Store, open_store
from validation.kit.report import Section
from validation.kit.tables import Cell, Table
from validation.studies import full_report, inversion, summary
from validation.studies.full_report import Study
from validation.studies.rest import runs as rest


def test_runs_hang_on_mechanics_and_not_on_what_shows_them() -> None:
    for function in (rest.run_in_house, rest.run_engine, inversion.run_pair):
        behind = sources.modules(function.__module__)
        assert function.__module__ in behind
        shown = {module for module in behind if module.startswith("validation.studies")}
        assert not any(module.endswith(("figures", "summary", "section")) for module in shown)


def test_code_behind_a_result_is_the_mechanics_and_what_its_module_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = {"outer": "from tests.toy import inner\n", "inner": "FACTOR = 2.0\n", "other": "\n"}
    folder = tmp_path / "tests" / "toy"
    folder.mkdir(parents=True)

    def file(module: str) -> Path | None:
        found = folder / f"{module.removeprefix('tests.toy.')}.py"
        if module in sources.MECHANICS:
            found = tmp_path / module / "__init__.py"
        return found if found.is_file() else None

    def found(**changes: str) -> str:
        for name in sources.MECHANICS:
            (tmp_path / name).mkdir(exist_ok=True)
            (tmp_path / name / "__init__.py").write_text(changes.get(name, ""))
        for name, usual in text.items():
            (folder / f"{name}.py").write_text(changes.get(name, usual))
        sources.modules.cache_clear()
        sources._text.cache_clear()
        return sources.behind("tests.toy.outer")

    monkeypatch.setattr(sources, "_file", file)
    before = found()
    assert found(inner="FACTOR = 2.5\n") != before
    assert found(analysis="print()\n") != before
    assert found(inner="FACTOR = 2.0  # as always\n", other="print()\n") == before
    sources.modules.cache_clear()


def test_parts_of_all_studies_can_be_told_apart() -> None:
    jobs = [job for each in full_report.STUDIES for job in (*each.jobs(), *each.shipped())]
    keys = {job.key for job in jobs}
    assert len({parts.identity(job) for job in jobs}) == len(keys) > 100


def test_identity_tells_arguments_apart() -> None:
    one, other = (
        Job("run", simulate, (Scenario(start=Start(spin=spin)), 1.0)) for spin in (40.0, 40.1)
    )
    assert parts.identity(one) == parts.identity(Job("run", simulate, one.arguments))
    assert parts.identity(one) != parts.identity(other)


def test_store_gives_back_what_it_was_given(tmp_path: Path) -> None:
    store = Store(tmp_path / "parts")
    motion = simulate(Scenario(), np.linspace(0.0, 0.1, 3))
    job = Job("run", simulate, (1.0,))
    assert store.find(job) is None
    values: dict[str, Any] = {
        "complex": np.array((1.0 / 3.0 + 2.0j, complex(np.inf, -0.0))),
        "missing": np.array((np.nan, 2.0**0.5)),
        "empty": np.zeros((0, 3), dtype=bool),
        "picture": b"\x89PNG\xff",
        "table": Table(name="t", title="T", columns=("a",), rows=[[1.0], [None]]),
        "section": Section(name="one", title="One"),
    }
    store.keep(job, Part({"run": motion, **values}, 2.5))
    found = store.find(job)
    assert found is not None
    assert found.seconds == 2.5
    for name, value in values.items():
        again = found.result[name]
        assert type(again) is type(value)
        np.testing.assert_array_equal(again, value)
        if isinstance(value, np.ndarray):
            assert (again.shape, again.dtype) == (value.shape, value.dtype)
    np.testing.assert_array_equal(found.result["run"].coordinates, motion.coordinates)
    store.forget_all_but([Job("other", simulate)])
    assert store.find(job) is None
    assert store.unreadable == 0


class Harmful:
    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (Path("harm"),)


ON_A_CLASS = b"(cvalidation.kit.parts\nStore\n(N(dS'harm'\nI1\nstbF1.0\nt."
"""Pickle that sets an attribute of a class of the project."""


@pytest.mark.parametrize(
    "content",
    [
        b"", b"damaged", pickle.dumps((Harmful(), 1.0)), ON_A_CLASS, b"[1]", b"[[], []]",
        b'[{"pathlib:Path": {}}, 1.0]', b'[{"validation.kit.parts:Store": {"folder": "x"}}, 1.0]',
        b'[{"tuple": 1}, 1.0]', b"[" * 100_000,
    ],
)  # fmt: skip
def test_damaged_or_foreign_part_is_made_anew_and_does_nothing(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    store, job = Store(tmp_path / "parts"), Job("run", simulate)
    store.keep(job, Part(1, 1.0))
    (path,) = (tmp_path / "parts").iterdir()
    path.write_bytes(content)
    assert store.find(job) is None
    assert store.unreadable == 1
    assert not (tmp_path / "harm").exists()
    assert not hasattr(Store, "harm")


CALLS: list[int] = []
DRAWN: list[str] = []


def work(number: int) -> int:
    CALLS.append(number)
    if number == BROKEN:
        raise ArithmeticError(f"job {number}")
    return number


BROKEN = -1


@dataclass(frozen=True)
class Toy:
    """Makes the section of a study from the results of its jobs."""

    name: str
    numbers: tuple[int, ...]

    def __call__(self, results: dict[Any, Any]) -> Section:
        DRAWN.append(self.name)
        rows = [[results[number], True] for number in self.numbers]
        table = Table(name=f"{self.name}-table", title=self.name, columns=("a", "b"), rows=rows)
        return Section(name=self.name, title=self.name, tables=[table])


def _study(name: str, *numbers: int) -> Study:
    jobs = [Job(number, work, (number,)) for number in numbers]
    return Study(name=name, jobs=lambda: jobs, section=Toy(name, numbers), work=1.0)


@pytest.fixture(name="small")
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """A report of two small sections, whose jobs run one after the other in this process."""
    monkeypatch.setattr(full_report, "STUDIES", (_study("one", 1, 2), _study("two", 2, 3)))
    box = Section(name="summary", title="Box")
    monkeypatch.setattr(summary, "section", lambda _: box)
    monkeypatch.setattr(report, "Pool", lambda _: ThreadPoolExecutor(1))
    monkeypatch.setattr(clock, "model_1_seconds", lambda: 0.5)
    monkeypatch.setattr(full_report, "model_1_seconds", lambda: 0.5)
    ticks = count()
    # Every job takes 10 s.
    monkeypatch.setattr(report, "processor_time", lambda: 10.0 * next(ticks))
    CALLS.clear()
    DRAWN.clear()


@pytest.mark.usefixtures("small")
def test_second_report_computes_only_what_the_first_has_not_finished(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(globals(), "BROKEN", 3)
    with pytest.raises(ArithmeticError, match="job 3"):
        full_report.make(tmp_path)
    assert CALLS == [1, 2, 3]
    assert not (tmp_path / "report.html").exists()
    monkeypatch.setitem(globals(), "BROKEN", -1)
    full_report.make(tmp_path)
    assert CALLS == [1, 2, 3, 3]
    page = (tmp_path / "report.html").read_text()
    full_report.make(tmp_path)
    assert CALLS == [1, 2, 3, 3]
    assert DRAWN == ["one", "two"]
    assert ", 20 s of it in earlier runs whose results were kept" in page
    said = capsys.readouterr().err
    assert "3 parts, 0 of them kept from before; the others take some" in said
    assert f"going on with the unfinished report in {tmp_path}" in said
    assert "3 parts, 2 of them kept" in said
    assert "3 parts, 3 of them kept from before; nothing is to be computed" in said


@pytest.mark.usefixtures("small")
def test_section_is_drawn_again_when_other_results_are_shipped_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    full_report.make(tmp_path / "report")
    (tmp_path / "two.json").write_text("{}")
    full_report.make(tmp_path / "report")
    assert DRAWN == ["one", "two", "two"]


@pytest.mark.usefixtures("small")
def test_some_sections_alone_take_and_leave_parts(tmp_path: Path) -> None:
    full_report.make(tmp_path, only=["two"])
    assert CALLS == [2, 3]
    page = (tmp_path / "report.html").read_text()
    assert "1 of 2 sections: two" in page
    assert 'id="one"' not in page
    full_report.make(tmp_path)
    assert CALLS == [2, 3, 1]
    assert DRAWN == ["two", "one"]
    assert 'id="one"' in (tmp_path / "report.html").read_text()


@pytest.mark.usefixtures("small")
def test_folder_of_an_older_report_is_named_and_made_whole(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in ("report.html", "figure-7.png", "notes.txt"):
        (tmp_path / name).write_text("old")
    full_report.make(tmp_path)
    said = capsys.readouterr().err
    assert f"{tmp_path} holds a report of an older version, whose page is replaced" in said
    assert f"1 files in {tmp_path} are not of this report: figure-7.png" in said
    # Files of one's own earlier report go when this one does not have them.
    monkeypatch.setattr(full_report, "STUDIES", (_study("one", 1, 2), _study("three", 1)))
    full_report.make(tmp_path)
    left = {path.name for path in tmp_path.iterdir() if not path.name.startswith(".")}
    assert left == {
        "report.html", "figure-7.png", "notes.txt", "one-table.csv", "three-table.csv",
    }  # fmt: skip


@pytest.mark.usefixtures("small")
def test_second_report_at_the_same_time_says_so_and_leaves_the_first_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with open_store(tmp_path):
        said = refusal(capsys, "report --out", str(tmp_path))
    assert f"{tmp_path} cannot be written to now: another process works in it" in said
    assert not CALLS
    assert run("report --out", str(tmp_path)) == 0
    assert CALLS == [1, 2, 3]


HOLDER = """
import sys
from pathlib import Path
from validation.kit.parts import open_store

with open_store(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.mark.slow
def test_folder_is_free_again_when_the_process_in_it_was_killed(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[3],
    ) as process:
        assert not_none(process.stdout).readline() == b"held\n"
        with pytest.raises(OSError, match="another process works in it"), open_store(tmp_path):
            pass
        process.kill()
    with open_store(tmp_path) as store:
        assert store.folder.parent == tmp_path


def judged(last: bool) -> Section:
    """Section with statements, a check that holds and one that may not."""
    columns = ("statement", "criterion", "measured", "verdict")
    words = ["it turns over", "within 1 s " + 30 * "or so ", "much " * 30, "yes"]
    checks: list[list[Cell]] = [["one", True], ["other", last]]
    tables = [
        Table(name="said", title="What is said", columns=columns, rows=[words]),
        Table(name="told", title="Agreement", columns=("run", "at most 1e-9"), rows=checks),
    ]
    found = Verdict(
        statement="Does it?", answer="yes", numbers="In 1 s.", certainty="very", section="one"
    )
    return Section(name="one", title="What it does", verdicts=[found], tables=tables)


def holding(_: dict[Any, Any]) -> Section:
    return judged(True)


def failing(_: dict[Any, Any]) -> Section:
    return judged(False)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("holds", [True, False])
def test_report_prints_verdicts_with_their_criteria_in_lines_of_a_terminal(
    holds: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    study = Study(name="one", jobs=list, section=holding if holds else failing)
    monkeypatch.setattr(full_report, "STUDIES", (study,))
    assert run("report --out", str(tmp_path)) == (0 if holds else 1)
    *lines, last = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) < 100
    shown = " ".join(" ".join(lines).split())
    assert "What it does Does it? Yes: In 1 s. yes: it turns over [within 1 s or so or so" in shown
    assert "much" not in shown
    assert f"{1 + holds} of 2 hold: Agreement [at most 1e-9]" in shown
    assert ("FAILS: run: other; at most 1e-9: NO" in shown) == (not holds)
    assert last.startswith("All checks hold." if holds else "1 checks FAIL.")
    assert run("report --verbose --out", str(tmp_path)) == (0 if holds else 1)
    assert "much much" in capsys.readouterr().out
