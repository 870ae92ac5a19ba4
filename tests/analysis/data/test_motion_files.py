"""Files of motions: exact, free of pickle, whole or not at all, and read with suspicion."""

import errno
import io
import json
import os
import zipfile
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Scenario, SpatialMotion, StoredRun, Trajectory, load_run, simulate_to_rest
from analysis.data.files import whole_file
from tests.calls import refusal
from tests.helpers import random_trajectory

Stored = dict[str, Any]
Change = Callable[[Stored], Stored]

STILL = simulate_to_rest(Scenario.rest(), 4e-3, spacing=1e-3)
MOTIONS = [random_trajectory(4), replace(STILL, rest_time=0.0)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """File of a trajectory."""
    random_trajectory().save(tmp_path / "run.npz")
    return tmp_path / "run.npz"


def members(path: Path) -> Stored:
    with np.load(path, allow_pickle=False) as stored:
        return dict(stored)


def assert_same(found: StoredRun, saved: StoredRun) -> None:
    assert type(found) is type(saved)
    for field in fields(saved):
        np.testing.assert_equal(getattr(found, field.name), getattr(saved, field.name))


@pytest.mark.parametrize("saved", MOTIONS, ids=repr)
def test_file_gives_back_exactly_what_was_saved(saved: StoredRun, tmp_path: Path) -> None:
    saved.save(tmp_path / "motion")
    assert [entry.name for entry in tmp_path.iterdir()] == ["motion"]
    assert_same(load_run(tmp_path / "motion", type(saved)), saved)
    for array in members(tmp_path / "motion").values():
        assert not array.dtype.hasobject


@pytest.mark.parametrize("saved", MOTIONS, ids=repr)
def test_file_of_format_2_loads(saved: StoredRun, path: Path) -> None:
    saved.save(path)
    arrays = described(format=2)(members(path))
    if isinstance(saved, Trajectory):
        older = {"times": "t", "coordinates": "q", "rates": "u"}
        arrays = {older.get(name, name): values for name, values in arrays.items()}
        arrays["normal_force"] = saved.normal_force
    else:
        arrays["spatial_meta"] = arrays.pop("meta")
    np.savez(path, **arrays)
    assert_same(load_run(path), saved)


@pytest.mark.skipif(os.name != "posix", reason="permissions follow the umask on POSIX alone")
def test_file_has_the_permissions_of_any_new_file(path: Path) -> None:
    (path.parent / "plain").touch()
    assert path.stat().st_mode == (path.parent / "plain").stat().st_mode


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
    with pytest.raises(OSError, match=rf"No space .*: '.*{path.name}'$"), whole_file(path):
        raise full
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(FileNotFoundError):
        load_run(path)
    with pytest.raises(FileNotFoundError):
        random_trajectory().save(tmp_path / "nowhere" / path.name)


def assert_refused(path: Path, cause: str = ".") -> None:
    with pytest.raises(ValueError, match=rf"run\.npz is not a readable motion: {cause}") as found:
        load_run(path)
    assert "\n" not in str(found.value)


def altered(mark: bytes, offset: int, bit: int) -> Callable[[bytes], bytes]:
    """Flip bits of the byte that lies so far behind a mark."""

    def change(content: bytes) -> bytes:
        place = content.index(mark) + offset
        return content[:place] + bytes([content[place] ^ bit]) + content[place + 1 :]

    return change


DIRECTORY = b"PK\x01\x02"

DAMAGED: dict[str, Callable[[bytes], bytes]] = {
    "nothing": lambda _: b"",
    "cut": lambda whole: whole[: len(whole) // 2],
    "random bytes": lambda _: np.random.default_rng(0).bytes(3000),
    # `zipfile` answers with errors that say neither OSError nor BadZipFile.
    "encrypted": altered(DIRECTORY, 8, 1),
    "of a later ZIP": altered(DIRECTORY, 6, 255),
    "bit flipped": altered(random_trajectory().rates.tobytes(), 17, 1),
}


@pytest.mark.parametrize("damage", DAMAGED.values(), ids=DAMAGED)
def test_damaged_file_is_refused(damage: Callable[[bytes], bytes], path: Path) -> None:
    path.write_bytes(damage(path.read_bytes()))
    assert_refused(path)


def described(**changes: Any) -> Change:
    """A change of the description that a file carries; None of a dotted name takes it out."""

    def change(arrays: Stored) -> Stored:
        description = json.loads(str(arrays["meta"]))
        for name, value in changes.items():
            *outer, last = name.split("__")
            place = description
            for each in outer:
                place = place[each]
            place[last] = value
        return arrays | {"meta": np.array(json.dumps(description))}

    return change


def sampled(name: str, convert: Callable[[Any], Any]) -> Change:
    return lambda arrays: arrays | {name: convert(arrays[name])}


def last_is(value: float) -> Callable[[Any], Any]:
    """Replace the last number of an array."""

    def change(values: Any) -> Any:
        values.flat[-1] = value
        return values

    return change


REAL = "must be an array of real numbers, got"

TRAJECTORIES: dict[str, tuple[Change, str]] = {
    "lacks times": (
        lambda arrays: {name: each for name, each in arrays.items() if name != "times"},
        "lacks 'times'",
    ),
    "lacks scenario": (sampled("meta", lambda _: '{"format": 3}'), "lacks 'scenario'"),
    "complex coordinates": (sampled("coordinates", lambda q: q + 1j), f"coordinates {REAL} compl"),
    "huge": (sampled("rates", last_is(-1e300)), r"rates must not exceed 1e\+100"),
    "method is text": (described(method="RK44"), "method must be a mapping, got str"),
    "list in method": (described(method__step=[1.0]), r"method\['step'\] must be text, a number"),
    "negative error": (described(error_estimate=-1.0), "error_estimate must not be negative"),
    "unknown source": (described(source="me"), "source must be one of engine, in-house"),
    "foreign part of the scenario": (described(scenario__wind=3), "scenario must be one of"),
    "pulling backwards": (described(pulling=[[2, 1]]), "pulling must hold rising times"),
    "ending without reason": (
        described(ending={"reason": 3, "time": 1.0, "value": 0.0}),
        "reason must be text, got 3",
    ),
    "foreign piece": (described(colour="red"), "meta must be one of .*colour"),
    "newer format": (described(format=99), "format must be 3, got 99: .* from a newer version"),
    "no format": (
        sampled("meta", lambda _: "{}"),
        "format must be 3, got 1: .* from an older",
    ),
    "description is a list": (sampled("meta", lambda _: "[]"), "meta must be a mapping, got list"),
    "deep description": (sampled("meta", lambda _: "[" * 100_000), "."),
}

REST: dict[str, tuple[Change, str]] = {
    "rest time outside": (
        described(rest_time=99.0),
        "rest_time must lie within the samples, from 0 to 0.004 s, got 99",
    ),
    "unit lost": (sampled("quaternions", lambda q: 2.0 * q), "quaternions must have unit length"),
}


@pytest.mark.parametrize(
    ("saved", "change", "cause"),
    [
        pytest.param(motion, *case, id=f"{type(motion).__name__}: {name}")
        for motion, cases in ((random_trajectory(), TRAJECTORIES), (STILL, REST))
        for name, case in cases.items()
    ],
)
def test_foreign_file_is_refused_with_its_cause(
    saved: StoredRun, change: Change, cause: str, path: Path
) -> None:
    saved.save(path)
    np.savez(path, **change(members(path)))
    assert_refused(path, cause)


def test_file_of_something_else_is_refused(path: Path) -> None:
    with pytest.raises(ValueError, match="kind must be SpatialMotion, got Trajectory"):
        load_run(path, SpatialMotion)
    np.savez(path, allow_pickle=True, **(members(path) | {"times": np.ones(5, dtype=object)}))
    assert_refused(path, ".*allow_pickle")
    with path.open("wb") as stream:
        np.save(stream, np.arange(3.0))
    assert_refused(path)


@pytest.mark.parametrize(
    ("count", "cause"),
    [
        (10**30, r"times\.npy claims 8e\+30 bytes, and at most 2e\+09 are read"),
        (6, r"times\.npy claims 48 bytes and holds 40"),
    ],
)
def test_header_that_claims_more_than_there_is_takes_no_memory(
    count: int, cause: str, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    header = io.BytesIO()
    claimed = {"descr": "<f8", "fortran_order": False, "shape": (count,)}
    np.lib.format.write_array_header_1_0(header, claimed)
    contents["times.npy"] = header.getvalue() + bytes(8 * 5)
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    read = np.lib.format.read_array

    def honest_ones(stream: Any, **options: Any) -> Any:
        assert stream.name != "times.npy", "memory was taken for what a header claims"
        return read(stream, **options)

    monkeypatch.setattr(np.lib.format, "read_array", honest_ones)
    assert_refused(path, cause)


@pytest.mark.parametrize("command", ["show {0} --plot {0}.png", "animate {0}"])
def test_commands_answer_a_foreign_file_in_one_line(
    command: str, path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    np.savez(path, **described(method="RK44")(members(path)))
    assert "run.npz is not a readable motion" in refusal(capsys, command.format(path))
    assert [entry.name for entry in path.parent.iterdir()] == ["run.npz"]
