"""Trajectory files: exact, free of pickle, whole or not at all."""

import errno
import io
import json
import os
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import LEVELS, Level, Trajectory, load_run
from analysis.data.files import whole_file
from tests.helpers import random_trajectory

ARRAYS = ("times", "coordinates", "rates", "multipliers")
MEMBERS = ("t", "q", "u", "normal_force", "multipliers", "meta")
META = ("scenario", "source", "method", "error_estimate", "counts", "versions")


def members(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as stored:
        return dict(stored)


@pytest.mark.parametrize("level", LEVELS)
def test_file_gives_back_exactly_what_was_saved(level: Level, tmp_path: Path) -> None:
    saved = random_trajectory(level)
    saved.save(tmp_path / "motion.npz")
    loaded = load_run(tmp_path / "motion.npz", Trajectory)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(loaded, name), getattr(saved, name))
    for name in META:
        assert getattr(loaded, name) == getattr(saved, name)


def test_file_keeps_a_missing_error_estimate(tmp_path: Path) -> None:
    replace(random_trajectory(), error_estimate=None).save(tmp_path / "motion.npz")
    assert load_run(tmp_path / "motion.npz", Trajectory).error_estimate is None


def test_file_is_written_where_it_was_asked_for(tmp_path: Path) -> None:
    random_trajectory().save(str(tmp_path / "motion"))
    assert [entry.name for entry in tmp_path.iterdir()] == ["motion"]


def test_file_holds_no_pickle(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    random_trajectory().save(path)
    with zipfile.ZipFile(path) as archive:
        assert sorted(archive.namelist()) == sorted(f"{name}.npy" for name in MEMBERS)
        for name in archive.namelist():
            array = np.load(io.BytesIO(archive.read(name)), allow_pickle=False)
            assert not array.dtype.hasobject


def test_file_offers_the_normal_force_by_name(tmp_path: Path) -> None:
    saved = random_trajectory()
    saved.save(tmp_path / "motion.npz")
    stored = members(tmp_path / "motion.npz")["normal_force"]
    np.testing.assert_array_equal(stored, saved.multipliers[:, 0])


@pytest.mark.skipif(os.name != "posix", reason="permissions follow the umask on POSIX alone")
def test_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    random_trajectory().save(tmp_path / "motion.npz")
    (tmp_path / "plain").touch()
    assert (tmp_path / "motion.npz").stat().st_mode == (tmp_path / "plain").stat().st_mode


def check_named(path: Path, cause: str = ".") -> None:
    with pytest.raises(ValueError, match=rf"{path.name} is not a readable trajectory: {cause}"):
        load_run(path, Trajectory)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """File of a trajectory."""
    random_trajectory().save(tmp_path / "motion.npz")
    return tmp_path / "motion.npz"


@pytest.mark.parametrize("part", [0.0, 0.01, 0.3, 0.6, 0.9, 0.999])
def test_truncated_file_is_named(part: float, path: Path) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[: int(part * len(whole))])
    check_named(path)


@pytest.mark.parametrize("seed", range(5))
def test_file_of_random_bytes_is_named(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "noise.npz"
    path.write_bytes(np.random.default_rng(seed).bytes(3000))
    check_named(path)


# Flags "encrypted" and "needs ZIP version 25.5" in the archive's own directory: `zipfile` answers
# with errors that say neither OSError nor BadZipFile.
@pytest.mark.parametrize(("offset", "value"), [(8, 1), (6, 255)])
def test_file_with_a_damaged_directory_is_named(offset: int, value: int, path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\x01\x02") + offset] = value
    path.write_bytes(content)
    check_named(path)


def test_file_with_a_flipped_bit_is_named(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[content.index(random_trajectory().rates.tobytes()) + 17] ^= 1
    path.write_bytes(content)
    check_named(path)


@pytest.mark.parametrize("key", ["t", "q", "u", "multipliers", "meta"])
def test_missing_member_is_named(key: str, path: Path) -> None:
    stored = members(path)
    del stored[key]
    np.savez(path, **stored)
    check_named(path, rf".*lacks .*\b{key}\b")


@pytest.mark.parametrize("key", META)
def test_missing_piece_of_the_description_is_named(key: str, path: Path) -> None:
    meta = json.loads(str(members(path)["meta"]))
    del meta[key]
    np.savez(path, **(members(path) | {"meta": np.array(json.dumps(meta))}))
    check_named(path, f"lacks '{key}'")


@pytest.mark.parametrize(
    "meta", ["{", "[]", "", '{"format": 2, "scenario": {"disk": {"mass": 1}}}']
)
def test_unreadable_description_is_named(meta: str, path: Path) -> None:
    np.savez(path, **(members(path) | {"meta": np.array(meta)}))
    check_named(path)


def test_single_array_is_not_a_trajectory(tmp_path: Path) -> None:
    path = tmp_path / "motion.npy"
    np.save(path, np.arange(3.0))
    check_named(path)


def test_pickled_member_is_refused(path: Path) -> None:
    times = np.array(list(random_trajectory().times), dtype=object)
    np.savez(path, allow_pickle=True, **(members(path) | {"t": times}))
    check_named(path, ".*allow_pickle")


def test_missing_file_is_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        load_run(tmp_path / "nothing.npz", Trajectory)


def test_a_full_disk_is_told_with_its_file(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    full = OSError(errno.ENOSPC, "No space left on device")
    message = rf"No space left on device: '.*{path.name}'$"
    with pytest.raises(OSError, match=message) as told, whole_file(path):
        raise full
    assert (told.value.errno, told.value.filename) == (errno.ENOSPC, str(path))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
@pytest.mark.parametrize("before", [None, b"an older result"])
def test_interrupted_save_leaves_the_folder_as_it_was(
    error: type[BaseException],
    before: bytes | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = tmp_path / "motion.npz"
    if before is not None:
        path.write_bytes(before)

    def stop_half_way(stream: Any, **_: Any) -> None:
        stream.write(b"half of the file")
        raise error

    monkeypatch.setattr(np, "savez", stop_half_way)
    with pytest.raises(error):
        random_trajectory().save(path)
    left = {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()}
    assert left == ({} if before is None else {"motion.npz": before})


def test_new_file_replaces_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    random_trajectory(1).save(path)
    random_trajectory(2).save(path)
    assert load_run(path, Trajectory).scenario.model == 2
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(("stored", "age"), [(3, "a newer"), (1, "an older"), (None, "an older")])
def test_file_of_another_format_says_so(stored: int | None, age: str, path: Path) -> None:
    meta = json.loads(str(members(path)["meta"])) | {"format": stored}
    if stored is None:
        del meta["format"]
    np.savez(path, **(members(path) | {"meta": np.array(json.dumps(meta))}))
    check_named(path, rf"format must be 2, got .* from {age} version")


def test_save_into_a_missing_folder_fails(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        random_trajectory().save(tmp_path / "nowhere" / "motion.npz")
