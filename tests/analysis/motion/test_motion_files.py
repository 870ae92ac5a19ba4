"""Files of motions: exact, free of pickle, whole or not at all, and read with suspicion."""

import errno
import io
import json
import os
import sys
import zipfile
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Ending, Scenario, SpatialMotion, StoredRun, load_run, simulate_to_rest
from analysis.motion import files
from tests.helpers import random_trajectory

Stored = dict[str, Any]

ARRAYS = ("times", "coordinates", "rates", "multipliers")

STILL = simulate_to_rest(Scenario.rest(), 4e-3, spacing=1e-3)
ENDED: Stored = {"reason": "low", "time": 2 / 3, "value": -1e-8 / 7}
MOTIONS = [
    replace(random_trajectory(4), ending=Ending(**ENDED), pulling=((0.1, 1 / 3), (0.4, 0.7))),
    replace(STILL, rest_time=0.0),
]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """File of a trajectory."""
    random_trajectory().save(tmp_path / "run.npz")
    return tmp_path / "run.npz"


def rewrite(path: Path, **changed: Any) -> None:
    """Store again what a file holds, with other arrays, or without those that are None.

    A mapping as `meta` changes entries of the description.
    """
    with np.load(path, allow_pickle=False) as stored:
        held = dict(stored)
    if isinstance(changed.get("meta"), dict):
        changed["meta"] = json.dumps(json.loads(str(held["meta"])) | changed["meta"])
    held |= changed
    np.savez(path, **{name: each for name, each in held.items() if each is not None})


def assert_same(found: StoredRun, saved: StoredRun) -> None:
    assert type(found) is type(saved)
    for field in fields(saved):
        np.testing.assert_equal(getattr(found, field.name), getattr(saved, field.name))


@pytest.mark.parametrize("saved", MOTIONS, ids=repr)
def test_file_gives_back_exactly_what_was_saved(saved: StoredRun, tmp_path: Path) -> None:
    saved.save(tmp_path / "motion")
    assert [entry.name for entry in tmp_path.iterdir()] == ["motion"]
    assert_same(load_run(tmp_path / "motion", type(saved)), saved)


def test_what_files_called_form_is_the_formulation(path: Path) -> None:
    rewrite(path, meta={"method": {"form": "reduced", "step": 1e-3}})
    assert load_run(path).method == {"formulation": "reduced", "step": 1e-3}


@pytest.mark.skipif(os.name != "posix", reason="permissions follow the umask on POSIX alone")
def test_file_has_the_permissions_of_any_new_file(path: Path) -> None:
    (path.parent / "plain").touch()
    assert path.stat().st_mode == (path.parent / "plain").stat().st_mode


def test_saving_changes_nothing_that_other_threads_make_files_with(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(os, "umask")
    random_trajectory().save(path)


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_interrupted_save_leaves_the_folder_as_it_was(
    error: type[BaseException], path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop_half_way(stream: Any, **_: Any) -> None:
        stream.write(b"half of the file")
        raise error

    before = path.read_bytes()
    monkeypatch.setattr(np, "savez", stop_half_way)
    for name in (path.name, "new.npz"):
        with pytest.raises(error):
            random_trajectory().save(path.parent / name)
    assert [entry.read_bytes() for entry in path.parent.iterdir()] == [before]


def test_a_full_disk_and_missing_folders_are_told_with_their_file(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    full = OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(OSError, match=rf"No space .*: '.*{path.name}'$"), files.whole_file(path):
        raise full
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(FileNotFoundError):
        load_run(path)
    with pytest.raises(FileNotFoundError, match=r"nowhere'$"):
        random_trajectory().save(tmp_path / "nowhere" / path.name)


def test_a_file_is_written_over_where_standard_output_is_closed(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "__stdout__", None)
    saved = random_trajectory(1)
    saved.save(path)
    assert_same(load_run(path), saved)


def assert_refused(path: Path, cause: str = ".") -> None:
    with pytest.raises(ValueError, match=rf"run\.npz is not a readable motion: {cause}") as found:
        load_run(path)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize("damage", ["cut", "encrypted", "bit flipped"])
def test_damaged_file_is_refused(damage: str, path: Path) -> None:
    content = bytearray(path.read_bytes())
    if damage == "cut":
        del content[len(content) // 2 :]
    elif damage == "encrypted":
        # `zipfile` answers with an error that says neither OSError nor BadZipFile.
        content[content.index(b"PK\x01\x02") + 8] ^= 1
    else:
        content[content.index(random_trajectory().rates.tobytes()) + 17] ^= 1
    path.write_bytes(content)
    assert_refused(path)


REAL = "must be an array of real numbers, got"
FORCES = r"multipliers must have shape \(5, 1\), got \(5, 4\)"

TRAJECTORIES: list[tuple[Stored, str]] = [
    ({"coordinates": np.ones((5, 5))}, r"coordinates must have shape \(5, 6\), got \(5, 5\)"),
    ({"meta": {"scenario": Scenario().values()}}, FORCES),
    ({"times": [0.0, 1.0, 1.0, 2.0, 3.0]}, "times must increase strictly, got 1 before 1"),
    ({"times": [0.0]}, "times must be one-dimensional with 2 or more entries"),
    *(({name: np.full((5, 6), np.nan)}, f"{name} must be finite") for name in ARRAYS),
    ({"times": None}, "lacks 'times'"),
    ({"meta": '{"format": 3}'}, "lacks 'scenario'"),
    ({"times": np.ones(5, dtype=object)}, ".*allow_pickle"),
    ({"coordinates": np.ones((5, 6), dtype=complex)}, f"coordinates {REAL} complex"),
    ({"rates": np.full((5, 6), -1e300)}, r"rates must not exceed 1e\+100"),
    ({"meta": {"method": "RK44"}}, "method must be a mapping, got str"),
    ({"meta": {"method": {"step": [1.0]}}}, r"method\['step'\] must be text, a number"),
    ({"meta": {"counts": {"steps": np.nan}}}, r"counts\['steps'\] must be text, a number or None"),
    ({"meta": {"source": "me"}}, "source must be one of engine, in-house"),
    ({"meta": {"scenario": {"wind": 3}}}, "scenario must be one of"),
    ({"meta": {"scenario": 3}}, "scenario must be a Mapping, got 3"),
    ({"meta": {"pulling": [[2, 1]]}}, "pulling must hold rising times"),
    ({"meta": {"ending": ENDED | {"reason": 3}}}, "reason must be text, got 3"),
    ({"meta": {"colour": "red"}}, "meta must be one of .*colour"),
    ({"meta": {"format": 99}}, "format must be 3, got 99: .* from a newer version"),
    ({"meta": "{}"}, "format must be 3, got 1: .* from an older"),
    ({"meta": "[]"}, "meta must be a mapping, got list"),
    ({"meta": "[" * 100_000}, "."),
]
REST: list[tuple[Stored, str]] = [
    ({"meta": {"rest_time": 99.0}}, "rest_time must lie from 0 to 0.004, got 99"),
    ({"quaternions": 2.0 * STILL.quaternions}, "quaternions must have unit length"),
]


@pytest.mark.parametrize(
    ("saved", "change", "cause"),
    [*((random_trajectory(), *case) for case in TRAJECTORIES), *((STILL, *case) for case in REST)],
)
def test_foreign_file_is_refused_with_its_cause(
    saved: StoredRun, change: Stored, cause: str, path: Path
) -> None:
    saved.save(path)
    rewrite(path, **change)
    assert_refused(path, cause)


def test_file_of_something_else_is_refused(path: Path) -> None:
    with pytest.raises(ValueError, match="kind must be SpatialMotion, got Trajectory"):
        load_run(path, SpatialMotion)
    with path.open("wb") as stream:
        np.save(stream, np.arange(3.0))
    assert_refused(path)


@pytest.mark.parametrize("count", [10**30, 10**12, 10**9, 6])
def test_header_that_claims_more_than_there_is_is_refused_and_takes_no_memory(
    count: int, path: Path
) -> None:
    rewrite(path, times=None)
    header = io.BytesIO()
    claimed = {"descr": "<f8", "fortran_order": False, "shape": (count,)}
    np.lib.format.write_array_header_1_0(header, claimed)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("times.npy", header.getvalue() + bytes(8 * 5))
    usage = pytest.importorskip("resource")
    before = usage.getrusage(usage.RUSAGE_SELF).ru_maxrss
    assert_refused(path)
    assert usage.getrusage(usage.RUSAGE_SELF).ru_maxrss < 1.5 * before


def test_array_that_is_larger_than_what_is_read_is_refused(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "LARGEST_STORAGE", 1000)
    assert_refused(path, r"meta\.npy has .* bytes, and at most 1e\+03 are read")
