"""Files that someone else has written, or that were meant to break the reader."""

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Scenario, SpatialMotion, Trajectory, load_run
from analysis.data.limits import LARGEST_STORAGE
from tests.calls import refusal
from tests.helpers import random_trajectory

Stored = dict[str, Any]
Kind = type[Trajectory] | type[SpatialMotion]

SAMPLES = 5


def still_motion() -> SpatialMotion:
    """A disk that lies still."""
    vectors, numbers = np.zeros((SAMPLES, 3)), np.zeros(SAMPLES)
    return SpatialMotion(
        times=np.arange(float(SAMPLES)),
        positions=vectors,
        quaternions=np.tile([1.0, 0.0, 0.0, 0.0], (SAMPLES, 1)),
        velocities=vectors,
        angular_velocities=vectors,
        contact_points=vectors,
        slip_speeds=numbers,
        contour_speeds=numbers,
        normal_force=numbers,
        energies=vectors,
        dissipated=np.zeros((SAMPLES, 6)),
        scenario=Scenario.rest(),
        source="in-house",
        rest_time=0.0,
        method={"method": "LSODA"},
        counts={"right_hand_sides": 1},
        versions={"numpy": "2"},
    )


def stored(kind: Kind, path: Path) -> Stored:
    """Arrays of a good file of this kind."""
    (random_trajectory() if kind is Trajectory else still_motion()).save(path)
    with np.load(path, allow_pickle=False) as arrays:
        return dict(arrays)


def described(meta: str, **changes: Any) -> Callable[[Stored], Stored]:
    """A change of the description that a file carries."""

    def change(arrays: Stored) -> Stored:
        description = json.loads(str(arrays[meta]))
        for name, value in changes.items():
            *outer, last = name.split("__")
            place = description
            for each in outer:
                place = place[each]
            place[last] = value
        return arrays | {meta: np.array(json.dumps(description))}

    return change


def sampled(name: str, convert: Callable[[Any], Any]) -> Callable[[Stored], Stored]:
    return lambda arrays: arrays | {name: convert(arrays[name])}


def last_is(value: float) -> Callable[[Any], Any]:
    """Replace the last number of an array."""

    def change(values: Any) -> Any:
        values.flat[-1] = value
        return values

    return change


REAL = "must be an array of real numbers, got"
NUMBER = "must be a finite number, got"

TRAJECTORIES = {
    "complex coordinates": (sampled("q", lambda q: q + 1j), f"coordinates {REAL} complex128"),
    "complex times": (sampled("t", lambda t: t + 0j), f"times {REAL} complex128"),
    "rates as text": (sampled("u", lambda u: u.astype(str)), f"rates {REAL} <U"),
    "truth values": (sampled("q", lambda q: q > 0.0), f"coordinates {REAL} bool"),
    "dates": (sampled("t", lambda t: t.astype("datetime64[s]")), f"times {REAL} datetime64"),
    "nan": (sampled("q", last_is(np.nan)), "coordinates must be finite"),
    "infinite time": (sampled("t", last_is(np.inf)), "times must be finite"),
    "huge": (sampled("u", last_is(-1e300)), r"rates must not exceed 1e\+100"),
    "times that fall": (sampled("t", lambda t: t[::-1]), "times must increase strictly"),
    "no sample": (sampled("t", lambda t: t[:0]), "times must be one-dimensional with at least 2"),
    "lost column": (sampled("q", lambda q: q[:, 1:]), r"coordinates must have shape \(5, 6\)"),
    "method is text": (described("meta", method="RK44"), "method must be a mapping, got str"),
    "method is a list": (described("meta", method=[1]), "method must be a mapping, got list"),
    "list in method": (
        described("meta", method__step=[1.0]),
        r"method\['step'\] must be text, a number or None, got \[1.0\]",
    ),
    "nan in method": (described("meta", method__step=np.nan), r"method\['step'\] .* got nan"),
    "counts are a number": (described("meta", counts=3), "counts must be a mapping, got int"),
    "versions are null": (described("meta", versions=None), "versions must be a mapping"),
    "error as text": (described("meta", error_estimate="small"), f"error_estimate {NUMBER}"),
    "negative error": (described("meta", error_estimate=-1.0), "error_estimate must not be neg"),
    "nan error": (described("meta", error_estimate=np.nan), f"error_estimate {NUMBER} nan"),
    "constraints are a number": (
        described("meta", scenario__constraints=3),
        "constraints must be a list of names, got 3",
    ),
    "constraints are text": (
        described("meta", scenario__constraints="contact"),
        "constraints must be a list of names, got 'contact'",
    ),
    "unknown constraint": (
        described("meta", scenario__constraints=["contact", "glue"]),
        "constraints must be one of contact, fixed-cog",
    ),
    "no scenario": (described("meta", scenario=None), "."),
    "foreign part of the scenario": (
        described("meta", scenario__wind=3),
        "scenario must be one of",
    ),
    "start is null": (described("meta", scenario__start=None), "start must be a table, got None"),
    "spin as text": (described("meta", scenario__start__spin="40"), f"spin {NUMBER} '40'"),
    "newer format": (
        described("meta", format=99),
        "format must be 2, got 99: the file comes from a newer version",
    ),
    "no format": (
        lambda arrays: arrays | {"meta": np.array("{}")},
        "format must be 2, got 1: the file comes from an older version",
    ),
    "unknown source": (described("meta", source="me"), "source must be one of engine, in-house"),
    "disk is null": (described("meta", scenario__disk=None), "."),
    "radius as text": (
        described("meta", scenario__disk__radius="0.045"),
        f"radius {NUMBER} '0.045'",
    ),
    "huge mass": (described("meta", scenario__disk__mass=10**400), "mass must be a finite number"),
    "mass is true": (described("meta", scenario__disk__mass=True), f"mass {NUMBER} True"),
    "pulling as text": (described("meta", pulling=["ab"]), f"pulling {NUMBER} 'a'"),
    "pulling backwards": (described("meta", pulling=[[2, 1]]), "pulling must hold rising times"),
    "ending is text": (described("meta", ending="soon"), "."),
    "ending without reason": (
        described("meta", ending={"reason": 3, "time": 1.0, "value": 0.0}),
        "reason must be text, got 3",
    ),
    "unknown load": (described("meta", scenario__friction__load="none"), "load must be one of"),
    "foreign piece": (described("meta", scenario__friction__colour="red"), ".*colour"),
    "description is a number": (
        lambda arrays: arrays | {"meta": np.array(3.0)},
        "meta must be a mapping, got float",
    ),
    "deep description": (lambda arrays: arrays | {"meta": np.array("[" * 100_000)}, "."),
}

MOTIONS = {
    "complex positions": (sampled("positions", lambda p: p + 1j), f"positions {REAL} complex"),
    "rest time as text": (described("spatial_meta", rest_time="soon"), f"rest_time {NUMBER}"),
    "rest time is nan": (described("spatial_meta", rest_time=np.nan), f"rest_time {NUMBER} nan"),
    "rest time is a list": (described("spatial_meta", rest_time=[1]), f"rest_time {NUMBER}"),
    "rest time outside": (
        described("spatial_meta", rest_time=99.0),
        "rest_time must lie within the samples, from 0 to 4 s, got 99",
    ),
    "method is text": (described("spatial_meta", method="RK44"), "method must be a mapping"),
    "unknown source": (described("spatial_meta", source="me"), "source must be one of"),
    "unit quaternion lost": (
        sampled("quaternions", lambda q: 2.0 * q),
        "quaternions must have unit length",
    ),
    "huge quaternion": (sampled("quaternions", last_is(1e200)), "quaternions must not exceed"),
    "stiffness as text": (
        described("spatial_meta", scenario__contact__stiffness="1e6"),
        "stiffness must",
    ),
    "bilateral as text": (
        described("spatial_meta", scenario__contact__bilateral="no"),
        "bilateral must be True or False, got 'no'",
    ),
    "foreign piece": (described("spatial_meta", colour="red"), ".*colour"),
}

CASES: list[Any] = [
    pytest.param(kind, *case, id=f"{kind.__name__}: {name}")
    for kind, cases in ((Trajectory, TRAJECTORIES), (SpatialMotion, MOTIONS))
    for name, case in cases.items()
]


@pytest.mark.parametrize(("kind", "change", "cause"), CASES)
def test_foreign_file_is_refused_with_its_cause(
    kind: Kind, change: Callable[[Stored], Stored], cause: str, tmp_path: Path
) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, **change(stored(kind, path)))
    title = "trajectory" if kind is Trajectory else "spatial motion"
    with pytest.raises(ValueError, match=rf"run\.npz is not a readable {title}: {cause}") as found:
        load_run(path, kind)
    assert "\n" not in str(found.value)


def claim(path: Path, member: str, shape: tuple[int, ...]) -> None:
    """Let the header of one array of a file claim another shape than it holds."""
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    header = io.BytesIO()
    described_as = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(header, described_as)
    contents[member] = header.getvalue() + bytes(8 * SAMPLES)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(name, content)


@pytest.mark.parametrize(
    ("count", "cause"),
    [
        (10**12, r"t\.npy claims 8e\+12 bytes, and at most 2e\+09 are read"),
        (10**30, r"t\.npy claims 8e\+30 bytes, and at most 2e\+09 are read"),
        (LARGEST_STORAGE // 8, r"t\.npy claims 2000000000 bytes and holds 40"),
        (6, r"t\.npy claims 48 bytes and holds 40"),
    ],
)
def test_header_that_claims_more_than_there_is_takes_no_memory(
    count: int, cause: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.npz"
    random_trajectory().save(path)
    claim(path, "t.npy", (count,))
    read = np.lib.format.read_array

    def honest_ones(stream: Any, **options: Any) -> Any:
        assert stream.name != "t.npy", "memory was taken for what a header claims"
        return read(stream, **options)

    monkeypatch.setattr(np.lib.format, "read_array", honest_ones)
    with pytest.raises(ValueError, match=rf"run\.npz is not a readable trajectory: ({cause})"):
        load_run(path, Trajectory)


@pytest.mark.parametrize("command", ["show {} --plot {}.png", "animate {}"])
@pytest.mark.parametrize("name", ["complex coordinates", "method is text", "huge"])
def test_commands_answer_foreign_files_in_one_line(
    command: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, **TRAJECTORIES[name][0](stored(Trajectory, path)))
    said = refusal(capsys, command.format(path, path))
    assert "run.npz is not a readable trajectory" in said
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]


def test_disk_that_turns_too_often_between_samples_is_not_animated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, **sampled("q", last_is(1e15))(stored(Trajectory, path)))
    said = refusal(capsys, "animate", str(path))
    assert "the disk turns by 1e+15 rad between two samples" in said
