"""Animations: the page and the GIF show the motion that was stored."""

import base64
import io
import json
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL.GifImagePlugin import GifImageFile

from analysis import STEEL_DISK, Scenario, SpatialMotion, StoredRun, Trajectory, simulate
from analysis.data import frames
from analysis.data.checks import Array
from tests.calls import refusal, run
from tests.helpers import mostly_slow, not_none, random_trajectory
from validation.kit.animation import gif as animation_gif
from validation.kit.animation.keyframes import keyframes
from validation.kit.animation.player import LEVELS, Animation, encode, player


@cache
def inversion() -> Trajectory:
    return simulate(Scenario(), np.linspace(0.0, 1.6, 161), tolerance=1e-6)


def turning(samples: int, spin: float) -> Trajectory:
    """Uniform turn about the vertical and about the disk's own axis, over 2 s."""
    times = np.linspace(0.0, 2.0, samples)
    rates = np.tile([0.0, 0.0, 0.0, spin, 0.0, -0.3 * spin], (samples, 1))
    height = STEEL_DISK.radius * np.sin(1.2)
    start = np.array([0.01, 0.02, height, 0.3, 1.2, -1.0])
    return Trajectory(
        times=times,
        coordinates=start + times[:, None] * rates,
        rates=rates,
        multipliers=np.ones((samples, 1)),
        scenario=Scenario(),
        source="in-house",
        method={},
    )


def tumbling(samples: int = 101, rate: float = 2.0) -> SpatialMotion:
    """Turn about the inertial x axis over 1 s that passes through the flat attitude midway."""
    times = np.linspace(0.0, 1.0, samples)
    half = 0.5 * rate * (times - 0.5)
    zeros = np.zeros((samples, 3))
    return SpatialMotion(
        times=times,
        positions=np.column_stack((times, 2.0 * times, 0.05 + 0.0 * times)),
        quaternions=np.column_stack((np.cos(half), np.sin(half), 0 * half, 0 * half)),
        velocities=zeros,
        angular_velocities=zeros + np.array([rate, 0.0, 0.0]),
        contact_points=np.column_stack((times, np.cos(times), 0.0 * times)),
        slip_speeds=zeros[:, 0],
        contour_speeds=zeros[:, 0],
        normal_force=zeros[:, 0],
        energies=zeros,
        dissipated=np.zeros((samples, 6)),
        scenario=Scenario.rest(),
        source="engine",
        rest_time=0.75,
    )


_FACING = np.array([0.0, 0.0, STEEL_DISK.radius, -1.25 + np.pi / 2, np.pi / 2, -np.pi / 2])
"""Upright, with its face to the camera."""

MOTIONS: dict[str, Callable[[], StoredRun]] = {"trajectory": inversion, "spatial": tumbling}


def embedded(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json">(.*?)</script>', page, re.DOTALL)
    data: dict[str, Any] = json.loads(not_none(found)[1])
    return data


def decoded(data: dict[str, Any]) -> tuple[Array, Array]:
    """Times, shape (n,), and the ten columns, shape (n, 10), as the player reads them."""
    times = np.frombuffer(base64.b64decode(data["times"]), "<f4") + np.float64(data["begin"])
    integers = np.frombuffer(base64.b64decode(data["columns"]), "<u2")
    columns = integers.reshape(len(data["low"]), times.size).T
    low, step = (np.array(list(data[name].values())) for name in ("low", "step"))
    return times, low + step * columns


def poses(motion: StoredRun) -> tuple[Array, Array]:
    if isinstance(motion, SpatialMotion):
        return motion.positions, motion.rotations
    return frames.poses(motion.coordinates)


@pytest.mark.parametrize("kind", MOTIONS)
def test_keyframes_meet_every_sample_of_the_motion(kind: str) -> None:
    motion = MOTIONS[kind]()
    made = keyframes(motion).at(motion.times)
    position, rotation = poses(motion)
    np.testing.assert_allclose(made.positions, position, atol=1e-12)
    np.testing.assert_allclose(made.rotations, rotation, atol=1e-12)


@pytest.mark.parametrize("kind", MOTIONS)
def test_page_holds_the_motion_to_the_stated_rounding(kind: str) -> None:
    made = keyframes(MOTIONS[kind]())
    data = embedded(player(made, name="a", title="A").page)
    times, columns = decoded(data)
    np.testing.assert_allclose(times, made.times, rtol=0, atol=6e-8 * np.ptp(made.times))
    table = np.column_stack((made.positions, made.quaternions, made.contact_points, made.spins))
    assert np.all(np.abs(columns - table) <= 0.5001 / LEVELS * np.ptp(table, axis=0) + 1e-15)
    unit = columns[:, 3:7] / np.linalg.norm(columns[:, 3:7], axis=1)[:, None]
    off = np.linalg.norm(unit - made.quaternions, axis=1)
    assert np.max(2.0 * off) <= 7e-5


def test_whole_turns_between_coarse_samples_are_kept() -> None:
    made = keyframes(turning(samples=5, spin=40.0))
    fine = turning(samples=401, spin=40.0)
    position, rotation = poses(fine)
    shown = made.at(fine.times)
    np.testing.assert_allclose(shown.positions, position, atol=2e-4)
    np.testing.assert_allclose(shown.rotations, rotation, atol=4e-3)


def test_motion_passes_through_the_flat_attitude() -> None:
    made = keyframes(tumbling())
    times = np.linspace(0.0, 1.0, 777)
    np.testing.assert_allclose(made.at(times).tilt, np.abs(2.0 * (times - 0.5)), atol=1e-7)


def test_samples_half_a_turn_apart_are_refused() -> None:
    with pytest.raises(ValueError, match="too far apart to be animated: the disk turns by 4 rad"):
        keyframes(tumbling(samples=11, rate=40.0))


def test_interpolation_takes_the_shorter_way_round() -> None:
    motion = tumbling()
    signs = np.where(np.arange(motion.times.size) % 2, -1.0, 1.0)[:, None]
    times = np.linspace(0.0, 1.0, 333)
    flipped = keyframes(replace(motion, quaternions=signs * motion.quaternions)).at(times)
    np.testing.assert_allclose(
        flipped.rotations, keyframes(motion).at(times).rotations, atol=1e-12
    )


def test_contact_point_is_the_lowest_of_the_rim() -> None:
    made = keyframes(inversion())
    angle = np.linspace(0.0, 2 * np.pi, 20001)
    for index in range(0, made.times.size, 40):
        first, second, _ = made.rotations[index].T
        rim = np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second)
        lowest = made.positions[index] + made.disk.radius * rim[np.argmin(rim[:, 2])]
        np.testing.assert_allclose(made.contact_points[index], lowest[:2], atol=2e-5)
        assert lowest[2] == pytest.approx(0.0, abs=1e-6)


def test_spin_is_the_vertical_angular_velocity_of_either_kind() -> None:
    assert keyframes(inversion()).spins[0] == pytest.approx(40.0)
    made = keyframes(turning(samples=5, spin=40.0))
    np.testing.assert_allclose(made.spins, 40.0 - 12.0 * np.cos(1.2))


def test_gamma_is_that_of_the_motion() -> None:
    made = keyframes(inversion()).at(inversion().times)
    turns = (inversion().coordinate("gamma") - made.gamma) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.rint(turns), atol=1e-12)


def test_gif_shows_the_hole_as_a_hole() -> None:
    upright = replace(inversion(), coordinates=inversion().coordinates * 0.0 + _FACING)
    made = keyframes(replace(upright, rates=0.0 * upright.rates))
    shown = animation_gif._Picture(made, 300).draw(0.0).astype(int)
    blue = [
        np.max(np.abs(shown - [int(colour[k : k + 2], 16) for k in (1, 3, 5)]), axis=2) < 4
        for colour in animation_gif.FRONT
    ]
    light, heavy = (int(part.sum()) for part in blue)
    # The hole takes a ninth of the disk, all of it from the light half; its rim is drawn, too.
    assert 0.65 < light / heavy < 1.0 - 2.0 / 9.0


def test_marks_tell_the_phases_that_are_there() -> None:
    ((name, time),) = keyframes(inversion()).marks
    assert name == "inversion"
    assert 0.45 < time < 0.52
    assert ("rest", 0.75) in keyframes(tumbling()).marks
    assert ("rest", 0.75) not in keyframes(tumbling()).between(0.0, 0.5).marks


def test_part_of_a_motion_begins_and_ends_where_asked() -> None:
    whole = keyframes(inversion())
    part = whole.between(0.1234, 0.4321)
    assert part.times[[0, -1]].tolist() == [0.1234, 0.4321]
    np.testing.assert_allclose(part.positions, whole.at(part.times).positions)
    assert embedded(player(part, name="a", title="A").page)["begin"] == 0.1234


@pytest.mark.parametrize(
    ("speed", "made", "shown"),
    [
        (None, "short", (0.1, None)),
        (None, "long", (None, 5.2)),
        (None, "long without inversion", (1.0, None)),
        (0.25, "long", (0.25, 5.2)),
    ],
)
def test_speed_lets_the_inversion_be_seen(
    speed: float | None, made: str, shown: tuple[float | None, float | None]
) -> None:
    short = keyframes(inversion())
    lasting = replace(short, times=10.0 * short.times, marks=(("inversion", 5.0),))
    chosen = {
        "short": short,
        "long": lasting,
        "long without inversion": replace(lasting, marks=()),
    }
    data = embedded(player(chosen[made], name="a", title="A", speed=speed).page)
    assert (data["speed"], data["slowUntil"]) == shown


def test_page_needs_nothing_from_elsewhere() -> None:
    page = player(random_trajectory(), name="a", title="A").page
    assert not re.search(r"https?:|src=|href=|import|fetch\(|url\(", page)


def test_text_cannot_break_the_page() -> None:
    made = replace(keyframes(inversion()), marks=(("</script><b>", 0.1),), source="<i>")
    page = player(made, name="a", title='"</canvas>', caption="<u>").page
    assert embedded(page)["marks"] == [["</script><b>", 0.1]]
    for unwanted in ("</script><b>", "<i>", '"</canvas>"', "<u>"):
        assert unwanted not in page


def test_installed_package_ships_the_player() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())
    shipped = project["tool"]["setuptools"]["package-data"]["validation.kit.animation"]
    assert set(shipped) == {"player.css", "player.js"}
    assert isinstance(player(inversion(), name="a", title="A"), Animation)


@pytest.mark.parametrize("kind", mostly_slow(MOTIONS, ["trajectory"]))
def test_gif_has_the_frames_the_size_and_the_speed_asked_for(kind: str) -> None:
    made, stream = keyframes(MOTIONS[kind]()).between(0.1, 0.5), io.BytesIO()
    # 30 frames per second are 3.3 hundredths of a second; 3 are shown, 0.03 s of the motion.
    assert animation_gif.write(made, stream, speed=1.0, fps=30.0, width=100) == 14
    with GifImageFile(io.BytesIO(stream.getvalue())) as picture:
        assert (picture.n_frames, picture.size) == (14, (100, 100))
        assert picture.info["duration"] == 30
        assert picture.info["loop"] == 0


def test_gif_shows_the_heavy_half_low_and_then_high() -> None:
    stream = io.BytesIO()
    animation_gif.write(keyframes(inversion()), stream, speed=2.0, fps=10.0, width=200)
    heights = []
    with GifImageFile(io.BytesIO(stream.getvalue())) as picture:
        for index in (0, picture.n_frames - 1):
            picture.seek(index)
            pixels = np.asarray(picture.convert("RGB"), dtype=int)
            halves = [[animation_gif.FRONT[k], animation_gif.BACK[k]] for k in (0, 1)]
            light, heavy = (
                np.concatenate([_rows(pixels, colour) for colour in colours]).mean()
                for colours in halves
            )
            heights.append(light - heavy)
    assert heights[0] < -20.0
    assert heights[1] > 20.0


def _rows(pixels: np.ndarray, colour: str) -> np.ndarray:
    """Rows of the pixels of nearly this colour."""
    wanted = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return np.nonzero(np.max(np.abs(pixels - wanted), axis=2) < 24)[0]


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    inversion().save(tmp_path / "run.npz")
    tumbling().save(tmp_path / "rest.npz")
    return tmp_path


@pytest.mark.parametrize("name", ["run", "rest"])
def test_command_writes_a_page_beside_either_kind_of_file(name: str, stored: Path) -> None:
    assert run("animate", str(stored / f"{name}.npz"), "--begin", "0.2", "--speed", "0.5") == 0
    data = embedded((stored / f"{name}.html").read_text())
    assert data["begin"] == 0.2
    assert data["speed"] == 0.5
    assert data["hole"] == pytest.approx([0.015, 0.02])


def test_command_writes_a_gif(stored: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = stored / "run.gif"
    call = f"--out {out} --end 0.2 --speed 1 --fps 20 --width 100"
    assert run("animate", str(stored / "run.npz"), *call.split()) == 0
    assert "0 to 0.2 s, 5 frames" in capsys.readouterr().out
    with GifImageFile(out) as picture:
        assert (picture.n_frames, picture.size) == (5, (100, 100))


BAD = [
    ("missing.npz", "FILE: must be a file that exists, got"),
    ("run.txt", "FILE: must end in .npz, got"),
    ("damaged.npz", "damaged.npz is not a readable motion"),
    ("truncated.npz", "truncated.npz is not a readable motion"),
    ("other.npz", "other.npz is not a readable motion: it holds 'numbers.npy'"),
    ("run.npz --out run.avi", "--out: must end in .html or .gif, got 'run.avi'"),
    ("run.npz --out nowhere/run.html", "--out: must lie in an existing folder"),
    ("run.npz --begin 0.5 --end 0.5", "--begin: begin must lie before 0.5, got 0.5"),
    ("run.npz --begin 1.6", "begin must lie before end, got 1.6 and 1.6"),
    ("run.npz --begin -1", "begin must lie within the data, from 0 to 1.6 s, got -1"),
    ("run.npz --end 3", "end must lie within the data, from 0 to 1.6 s, got 3"),
    ("run.npz --end nan", "--end: end must be a finite number, got nan"),
    ("run.npz --speed 0", "--speed: speed must be positive, got 0"),
    ("run.npz --fps 20", "--fps: fps needs --out FILE.gif"),
    ("run.npz --out run.gif --fps -5", "--fps: fps must be positive, got -5"),
    ("run.npz --out run.gif --fps 60", "fps must be at most 50 for a GIF, got 60"),
    ("run.npz --out run.gif --width 20", "width must lie from 100 to 2000 pixels, got 20"),
    ("run.npz --out run.gif --speed 1e-3", "may have 2000 frames, not 32001: raise the speed"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=[bad[0] for bad in BAD])
def test_bad_call_is_one_line_and_code_2_and_writes_nothing(
    arguments: str,
    message: str,
    stored: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (stored / "damaged.npz").write_bytes(b"no archive")
    whole = (stored / "rest.npz").read_bytes()
    (stored / "truncated.npz").write_bytes(whole[: len(whole) // 2])
    np.savez(stored / "other.npz", numbers=np.arange(3))
    before = sorted(stored.iterdir())
    monkeypatch.chdir(stored)
    assert message in refusal(capsys, "animate", arguments)
    assert sorted(stored.iterdir()) == before


def test_columns_that_do_not_change_are_kept() -> None:
    data = encode(keyframes(turning(samples=5, spin=0.0)))
    _, columns = decoded(data)
    assert np.ptp(columns, axis=0).tolist() == [0.0] * 10
    np.testing.assert_allclose(columns[0, :3], frames.poses(turning(5, 0.0).coordinates)[0][0])
