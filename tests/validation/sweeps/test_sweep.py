"""Sweeps: outcomes of the cases, the store, and workers that fail."""

import re
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing
from dataclasses import asdict, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from threading import Event, Timer
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import MODELS, Scenario
from analysis.motion.outcomes import DONE
from tests.bodies import EGG
from tests.sweeps import direct, sweep, swept
from tests.wayward_law import CRASHES, HANGS, Wayward
from validation.measurement.sources import digest, own_files
from validation.sweeps import runner, store
from validation.sweeps.axes import Axis, Design
from validation.sweeps.case import COLUMNS, WITNESS_FAILED, run_chunk
from validation.sweeps.plan import Plan
from validation.sweeps.pools import open_pool
from validation.sweeps.results import Results, write_csv
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep, look_ahead

WAYWARD = Scenario(friction=Wayward())
OWN_LAW = Scenario(constraints=MODELS[4], friction=Wayward())
SPINS = ("spin=30:40:3", "mu=0.2,0.3")
WANTED = sweep(*SPINS)


# --- Rows ----------------------------------------------------------------------------------------


def test_an_interrupt_is_no_failure_of_a_case(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Plan, "motion", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_chunk(WANTED, [0])


def test_numbers_of_numpy_are_stored_as_those_of_python() -> None:
    numpys: dict[str, Any] = {"witnesses": np.int64(0), "tolerance": np.float32(0.5)}
    numpys |= {"end": np.float32(0.5), "spacing": np.float32(0.25)}
    drawn = {"layout": "random", "number": np.int64(1), "seed": np.int64(2)}
    wanted = sweep("spin=1:2", layout=drawn, allow_pulling=np.True_, **numpys)
    axis = Axis(field="mu", first=0.1, last=0.2, count=np.int64(2), log=np.False_)  # type: ignore[arg-type]
    for number, each in enumerate((wanted, replace(wanted, design=Design(axes=(axis,))))):
        found = swept(each, Path(f"numpy-{number}.db"))
        assert found.columns["status"].tolist() == [DONE] * each.design.size


# --- Witnesses -----------------------------------------------------------------------------------


def test_witness_is_the_other_side_as_accurate_as_it_is_told_to_be() -> None:
    (row,) = run_chunk(sweep("spin=40:44:2", witnesses=2, tolerance=1e-6), [1])
    assert row["other_inversion"] == "not inverted"
    assert 0.0 < float(row["difference"] or 0.0) < 2e-6
    assert float(row["other_seconds"] or 0.0) > 0.0
    told: list[tuple[dict[str, Any], dict[str, Any]]] = [
        ({"witness_tolerance": 1e-2}, {"tolerance": 1e-2}),
        ({"witness_step": 5e-3}, {"tolerance": None, "step": 5e-3}),
    ]
    for how, run_as in told:
        wanted = sweep("spin=40:44:2", scenario=Scenario(), **how)
        motion = wanted.plan.witness.motion(wanted.scenario_of(0))
        assert motion.source == "engine"
        assert run_as.items() <= motion.method.items()


def test_witness_goes_on_where_the_contact_pulls_if_the_case_does() -> None:
    assert sweep("spin=1,2", allow_pulling=True).plan.witness.allow_pulling


def test_witness_that_fails_in_any_way_is_told_in_the_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> None:
        raise LookupError("no such friction")

    monkeypatch.setattr("mbs_models.simulate", fails)
    (row,) = run_chunk(sweep("spin=40", witnesses=1), [0])
    assert (row["status"], row["other_inversion"]) == (DONE, "failed")
    assert row["reason"] == "no such friction"


def test_witnesses_are_spread_evenly() -> None:
    none, chosen, every = (
        [number for number in range(400) if wanted.has_witness(number)]
        for wanted in (sweep("spin=0:60:20", "gamma=0:1:20", witnesses=n) for n in (0, 40, 500))
    )
    assert [len(none), len(chosen), len(every)] == [0, 40, 400]
    assert all(sum(part <= n < part + 100 for n in chosen) >= 8 for part in (0, 100, 200, 300))


# --- The store -----------------------------------------------------------------------------------


def test_same_command_runs_only_what_is_missing_and_failures_where_asked() -> None:
    def again(time_limit: float = 60.0, **how: Any) -> list[Any]:
        done: list[Any] = []
        wanted = sweep("spin=30:40:3", "mu=0.2,-0.1", time_limit=time_limit)
        swept(wanted, told=done.extend, **how)
        return sorted(row["number"] for row in done)

    # A store that is killed while it is made is empty.
    Path("a.db").touch()
    assert again(numbers=[4, 1]) == [1, 4]
    assert again() == [0, 2, 3, 5]
    assert again() == []
    assert again(time_limit=30.0, retry=True) == [1, 3, 5]


def test_cases_that_failed_on_the_other_side_run_again_where_asked() -> None:
    wanted = sweep("spin=30:40:3", witnesses=3)
    rows = [run_chunk(wanted, [number])[0] for number in range(3)]
    rows[1] |= {"other_inversion": WITNESS_FAILED, "difference": None}
    with Store(Path("a.db"), wanted) as kept:
        kept.add(rows)
        assert kept.failures() == {"failed on the other side": 1}
        assert list(kept.missing(range(3))) == []
        run_cases(kept, direct(), retry=True)
        assert not kept.failures()
    differences = Results.load("a.db").columns["difference"]
    assert np.max(differences) < 1e-3


def test_a_store_whose_writer_was_killed_in_the_midst_of_it_is_read(path: Path) -> None:
    killed = (
        "import os, sqlite3; file = sqlite3.connect('a.db', isolation_level=None); "
        "file.execute('PRAGMA cache_size = 1'); file.execute('BEGIN IMMEDIATE'); "
        "file.execute('CREATE TABLE more (word)'); "
        "file.executemany('INSERT INTO more VALUES (?)', [('x' * 4000,)] * 500); os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", killed], check=True)
    assert Path("a.db-journal").stat().st_size > 0
    # The journal lies beside the store, and not beside a link to it.
    Path("link.db").symlink_to(path)
    assert Results.load("link.db").columns["number"].tolist() == [0]


def test_an_empty_cell_is_none_beside_words_and_nan_beside_numbers() -> None:
    # Of four cases one is refused, and one is seen by the other side.
    found = swept(sweep("spin=30,40", "mu=0.2,-0.1", witnesses=1))
    words = {
        name: found.columns[name].tolist() for name in ("reason", "ending", "other_inversion")
    }
    assert words["ending"] == [None] * 4
    assert [type(each) for each in words["reason"]] == [type(None), str] * 2
    assert sorted(map(str, words["other_inversion"])) == ["None"] * 3 + ["not inverted"]
    assert [{name: row[name] for name in words} for row in found.rows()] == [
        dict(zip(words, cells, strict=True)) for cells in zip(*words.values(), strict=True)
    ]
    assert np.isnan(found.columns["error_estimate"]).tolist() == [False, True] * 2


@pytest.fixture
def path() -> Path:
    """Store of `WANTED` that holds its first case."""
    swept(WANTED, numbers=[0])
    return Path("a.db")


OTHERS = {
    "plan.end": sweep(*SPINS, end=0.06),
    "design.axes.0.last": sweep("spin=30:41:3", "mu=0.2,0.3"),
    "scenario.friction": sweep(*SPINS, scenario=OWN_LAW, formulation="reduced"),
}


@pytest.mark.parametrize("key", OTHERS)
def test_store_of_another_sweep_is_refused(key: str, path: Path) -> None:
    before = path.read_bytes()
    with pytest.raises(ValueError, match=f"results of another sweep: {key}"):
        Store(path, OTHERS[key])
    assert path.read_bytes() == before


def test_rows_of_other_sources_are_refused_or_stand_beside_the_old_ones_where_accepted(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = WANTED.code()
    monkeypatch.setattr(Sweep, "code", lambda _: code | {"exudyn": "0.1"})
    with pytest.raises(ValueError, match=r"results of other sources: exudyn is .* 0\.1 here"):
        Store(path, WANTED)
    for number in (1, 2):
        with Store(path, WANTED, accept_other_code=number == 1) as kept:
            run_cases(kept, direct(), numbers=[number])
    monkeypatch.setattr(store, "commit", lambda: "later")
    with Store(path, WANTED) as kept:
        run_cases(kept, direct(), numbers=[3])
    first, second, third, later = Results.load(path).columns["code"].tolist()
    assert first != second == third != later
    with closing(sqlite3.connect(path)) as file:
        assert not file.execute("SELECT code FROM cases EXCEPT SELECT name FROM code").fetchall()


def test_a_sweep_ends_its_motions_at_the_first_of_several_conditions() -> None:
    wanted = sweep("spin=40", stop_when=["lost", "inverted"], end=1.0)
    (row,) = swept(wanted).rows()
    assert row["ending"] == "inverted"
    assert Results.load("a.db").sweep.values() == wanted.values()
    with pytest.raises(ValueError, match=r"stop_when must be one of .*, got 'flat'"):
        sweep("spin=40", stop_when=["lost", "flat"])


def test_identity_of_the_code_knows_what_is_of_ones_own_and_no_comments(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    own: tuple[dict[str, Any], ...] = (
        {},
        {"scenario": WAYWARD},
        {"scenario": Scenario(disk=EGG)},
        {"stop_when": f"{__name__}:one_worker"},
    )
    assert len({sweep("alpha=0,1", **each).code()["own"] for each in own}) == len(own)
    axes = ("law=tanh", "law=tanh,tests.wayward_law:Wayward", "disk.body=disk,tests.bodies:Egg")
    assert len({sweep(axis).code()["own"] for axis in axes}) == len(axes)
    # What it imports counts, too.
    monkeypatch.syspath_prepend(Path.cwd())
    Path("law.py").write_text("import beside\n")
    found = []
    for number in (1, 1, 2):
        Path("beside.py").write_text(f"# noted\nNUMBER = {number}\n")
        found.append(digest(own_files(["law"])))
    assert found[0] == found[1] != found[2]
    found = []
    for text in (
        "TWO = 2\ndef double(x):\n    return TWO * x\n",
        "# noted\nTWO = 2\n'Two.'\ndef double(x):\n    'Twice.'\n    return (TWO *\n      x)\n",
        "TWO = 2.0\ndef double(x): return TWO * x\n",
    ):
        Path("law.py").write_text(text)
        found.append(digest([Path("law.py")]))
    assert found[0] == found[1] != found[2]


DAMAGES: dict[str | bytes, str] = {
    b"no database " * 1000: "is no readable store",
    "UPDATE sweep SET value = '1' WHERE name = 'format'": "has format 1, this version reads 3",
    "PRAGMA application_id = 0": "is no store of a sweep, but another SQLite file",
    "UPDATE sweep SET value = replace(hex(zeroblob(50000)), '0', '[') WHERE name = 'sweep'": (
        "is no readable store"
    ),
    "DROP TABLE cases": "no such table: cases",
}
"""What is done to a store, or stands in its place."""


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda text: str(text[:50]))
def test_damaged_or_foreign_file_is_blamed_and_neither_read_nor_written(
    damage: str | bytes, path: Path
) -> None:
    if isinstance(damage, str):
        with closing(sqlite3.connect(path)) as file, file:
            file.execute(damage)
    else:
        path.write_bytes(damage)
    before, said = path.read_bytes(), rf"^{re.escape(str(path))}:? {DAMAGES[damage]}"
    for call in (Results.load, partial(swept, WANTED)):
        with pytest.raises((ValueError, OSError), match=said):
            call(path)
    assert path.read_bytes() == before


def test_a_store_says_in_its_head_what_it_is(path: Path) -> None:
    # Where files of SQLite name their application; later versions read these as well.
    assert path.read_bytes()[68:72] == b"tipp"


def test_second_writer_is_refused_and_readers_are_waited_for(path: Path) -> None:
    reader = sqlite3.connect(path, check_same_thread=False)
    with closing(reader), Store(path, WANTED) as kept:
        run_cases(kept, direct(), numbers=[1])
        with pytest.raises(OSError, match="is being written to by another process"):
            Store(path, WANTED)
        assert Results.load(path).columns["number"].tolist() == [0, 1]
        kept.add(run_chunk(WANTED, [2]))
        held = reader.execute("SELECT * FROM cases")
        Timer(0.5, held.close).start()
        kept.commit()
        assert kept.count() == 3


# --- Results -------------------------------------------------------------------------------------


def test_columns_are_those_of_the_csv_of_pandas_and_of_xarray_with_gaps_on_the_grid() -> None:
    pytest.importorskip("xarray")
    results = swept(sweep("spin=30:40:3", "mu=0.2,-0.1"), numbers=[0, 1, 2, 3, 5])
    frame, cube = results.to_dataframe(), results.to_xarray()
    write_csv("a.db", "a.csv")
    written = pd.read_csv("a.csv")
    assert written["number"].tolist() == [0, 1, 2, 3, 5]
    assert list(written) == ["number", "start.spin", "friction.coefficient", *COLUMNS]
    np.testing.assert_allclose(written["force_least"], frame["force_least"], rtol=1e-15)
    assert frame["status"].tolist() == [DONE, "refused", DONE, "refused", "refused"]
    picked = cube["energy_end"].sel({"start.spin": 35.0, "friction.coefficient": 0.2})
    assert float(picked) == frame.loc[2, "energy_end"]
    gaps = [[0.05, np.nan], [0.05, np.nan], [np.nan, np.nan]]
    np.testing.assert_array_equal(results.on_grid("end"), gaps)
    assert results.on_grid("status").tolist() == [*[[DONE, "refused"]] * 2, [None, "refused"]]
    with pytest.raises(ValueError, match=r"^name must be one of .*, got 'statu'; did you mean"):
        results.on_grid("statu")


def test_truth_values_of_an_axis_are_so_in_all_results() -> None:
    wanted = sweep("bilateral=true,false", scenario=Scenario.rest(), to_rest=True, end=0.01)
    told = [row["contact.bilateral"] for row in swept(wanted).rows()]
    assert (told[0], told[1]) == (True, False)
    assert {type(each) for each in told} == {bool}
    write_csv("a.db", "a.csv")
    assert pd.read_csv("a.csv")["contact.bilateral"].dtype == bool


class Failing(ThreadPoolExecutor):
    """All calls of it fail: their cases are run alone."""

    def submit(self, *_: Any, **__: Any) -> "Future[Any]":
        return super().submit(divmod, 1, 0)


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, Failing])
def test_cases_are_asked_for_while_others_are_run(
    executor: type[ThreadPoolExecutor], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "LARGEST_CHUNK", 2)
    monkeypatch.setattr(store, "_LOOK", 2)

    def numbers() -> Iterator[int]:
        yield from range(20)
        raise AssertionError("all cases are asked for first")

    def enough(_rows: object) -> None:
        raise LookupError

    how: dict[str, Any] = {"numbers": numbers(), "told": enough}
    with pytest.raises(LookupError):
        swept(sweep("spin=30:40:40"), pool=direct(executor(1)), **how)


# --- Workers -------------------------------------------------------------------------------------


class Impatient(Plan):
    """Grants nothing beyond three time limits."""

    hanging = 0.9


def one_worker() -> ProcessPoolExecutor:
    """An executor that is broken as a whole by a process that ends, and is made again."""
    return ProcessPoolExecutor(1, mp_context=get_context("spawn"))


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["processes", f"{__name__}:one_worker"])
def test_hanging_and_crashing_cases_are_rows_and_the_others_have_results(executor: str) -> None:
    wanted = sweep(f"mu=0.1,{CRASHES},0.2,{HANGS},0.3", scenario=WAYWARD, end=0.02, time_limit=0.3)
    wanted = replace(wanted, plan=Impatient(**asdict(wanted.plan)))
    with open_pool(executor, workers=1) as pool:
        table = swept(wanted, pool=pool).columns
    assert table["status"].tolist() == [DONE, "crashed", DONE, "too slow", DONE]
    assert table["friction.coefficient"].tolist() == [0.1, CRASHES, 0.2, HANGS, 0.3]


def test_quick_cases_go_out_in_larger_and_larger_chunks() -> None:
    sizes: list[int] = []
    swept(sweep("spin=30:40:40"), told=lambda rows: sizes.append(len(rows)))
    assert sum(sizes) == 40
    # The first chunk has one case, and two chunks at most come in together.
    assert sizes[0] <= 2
    assert max(sizes) > 8


def one_thread() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1)


def test_own_executor_forgets_what_it_has_not_begun_once_it_is_left() -> None:
    forgotten = Event()
    with open_pool(f"{__name__}:one_thread", workers=1) as pool:
        begun, waiting = pool.executor.submit(forgotten.wait, 5.0), pool.executor.submit(print)
        waiting.add_done_callback(lambda _: forgotten.set())
    assert begun.result()
    assert waiting.cancelled()


def broken() -> ThreadPoolExecutor:
    """An executor that takes nothing."""
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    return executor


def test_executor_that_takes_nothing_ends_the_sweep_with_what_to_do() -> None:
    with (
        pytest.raises(OSError, match="the workers are lost; what is done is stored, and the same"),
        open_pool(f"{__name__}:broken", workers=1) as pool,
    ):
        swept(WANTED, pool=pool)


# --- Looking ahead -------------------------------------------------------------------------------


def test_look_ahead_refuses_what_cannot_run_and_reckons_with_witnesses() -> None:
    with pytest.raises(ValueError, match="witness_step must be left out"):
        look_ahead(sweep("spin=30,40", scenario=Scenario(), source="engine", witness_step=1e-3))
    seconds = [look_ahead(sweep("mu=0.2,0.3", witnesses=each))[0] for each in (0, 2, 200)]
    assert seconds[1] > 1.5 * seconds[0]
    assert seconds[2] == seconds[1]
    # A case that is refused takes no time.
    half = sweep("mu=0.2,-0.1")
    whole = half.plan.effort(half.scenario_of(0)).seconds
    assert look_ahead(half)[0] == pytest.approx(0.5 * whole)
