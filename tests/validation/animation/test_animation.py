"""Animations show the motion that was stored, and the page to play on one by the equations."""

import html
import io
import json
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from PIL.GifImagePlugin import GifImageFile

from analysis import (
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Sphere,
    Start,
    StoredRun,
    Trajectory,
    simulate,
    simulate_to_rest,
)
from analysis.motion import frames
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.disk import CENTRED_DISK
from tests.bodies import COMPOSED, EGG, ELLIPSE, TIPPE_TOP
from tests.helpers import mostly_slow, not_none
from validation import play
from validation.animation import picture as drawing
from validation.animation.body import LOOK, in_sight, outline, shape
from validation.animation.keyframes import between, keyframes
from validation.animation.player import animate, render
from validation.studies.inversion import draw_instants


@cache
def inversion() -> Trajectory:
    return simulate(Scenario(), np.linspace(0.0, 1.6, 161), tolerance=1e-6)


@cache
def resting(spacing: float = 5e-3) -> SpatialMotion:
    """A way to rest, said to have ended after 0.75 s."""
    scenario = Scenario.rest(start=Start(spin=40.0, beta=1.0))
    return replace(simulate_to_rest(scenario, 1.0, spacing=spacing), rest_time=0.75)


needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="needs Node")


def in_node(harness: str, page: str, *words: str) -> Any:
    """What the code of a page makes of some words, run in Node."""
    call = ["node", str(Path(__file__).with_name(harness)), "/dev/stdin", *words]
    return json.loads(subprocess.check_output(call, input=page, text=True))


MOTIONS: dict[str, Callable[[], StoredRun]] = {"trajectory": inversion, "spatial": resting}


def embedded(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json">(.*?)</script>', page, re.DOTALL)
    return json.loads(not_none(found)[1])


@pytest.mark.parametrize("kind", MOTIONS)
def test_keyframes_meet_every_sample_of_the_motion(kind: str) -> None:
    motion = MOTIONS[kind]()
    made = keyframes(motion)
    rows = np.searchsorted(made.times, motion.times - 1e-12)
    np.testing.assert_allclose(made.times[rows], motion.times, atol=1e-12)
    for shown, known in zip(made.poses[:2], motion.poses[:2], strict=True):
        np.testing.assert_allclose(shown[rows], known, atol=1e-12)


def test_a_motion_that_its_samples_do_not_tell_is_not_played() -> None:
    every = (np.linspace(0.0, 2.0, count) for count in (2, 5, 11, 15))
    coarse: list[Any] = [simulate(Scenario(), times, tolerance=1e-6) for times in every]
    for motion in (*coarse, resting(spacing=0.25)):
        with pytest.raises(ValueError, match=r"cannot be animated: .* run more closely$"):
            keyframes(motion)


def test_motion_between_coarse_samples_is_that_of_fine_ones() -> None:
    coarse = simulate(Scenario(), np.linspace(0.0, 1.6, 33), tolerance=1e-6)
    times, (position, rotation, *_) = inversion().times, inversion().poses
    made = keyframes(coarse)
    # In a picture, and in the player, which draws lines between the poses.
    shown = between(made, times).poses
    np.testing.assert_allclose(shown.positions, position, atol=2e-4)
    np.testing.assert_allclose(shown.rotations, rotation, atol=6e-3)
    for axis, values in enumerate(made.poses.positions.T):
        line = np.interp(times, made.times, values)
        np.testing.assert_allclose(line, position[:, axis], atol=2e-4)


@pytest.mark.parametrize("count", [21, 20_001])
def test_contact_of_a_nearly_flat_disk_moves_little_between_keyframes(count: int) -> None:
    radius, times = STEEL_DISK.radius, np.linspace(0.0, 0.2, count)
    speeds = np.tile([0.0, 0.0, 0.0, 100.0, 0.0, -100.0], (count, 1))
    places = times[:, None] * speeds + [0.0, 0.0, radius * np.sin(0.02), 0.0, 0.02, 0.0]
    wobbling = replace(
        inversion(),
        times=times,
        coordinates=places,
        rates=speeds,
        multipliers=np.zeros((count, 1)),
    )
    points = keyframes(wobbling).contact_points[:, :2]
    ways = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert 0.15 * radius < ways.max() < 0.21 * radius


def test_marks_tell_the_phases_that_are_there() -> None:
    def marks(motion: StoredRun, end: float | None = None) -> Any:
        return embedded(motion.animate(end=end).text)["marks"]

    ((name, time),) = marks(inversion())
    assert name == "inversion"
    assert 0.45 < time < 0.52
    assert ["rest", 0.75] in marks(resting())
    assert "rest" not in dict(marks(resting(), 0.5))


def test_part_of_a_motion_begins_and_ends_where_asked() -> None:
    whole, part = inversion(), keyframes(inversion(), 0.1234, 0.4321)
    assert part.times[[0, -1]].tolist() == [0.1234, 0.4321]
    positions = between(whole, part.times).poses.positions
    np.testing.assert_allclose(part.poses.positions, positions, atol=2e-5)
    assert embedded(whole.animate(begin=0.1234).text)["times"][0] == 0.1234


def test_speed_lets_the_inversion_be_seen() -> None:
    def shown(motion: StoredRun, **how: Any) -> tuple[Any, Any]:
        data = embedded(motion.animate(**how).text)
        return data["speed"], data["slowUntil"]

    short = inversion()
    lasting = replace(short, times=10.0 * short.times, rates=0.1 * short.rates)
    until = pytest.approx(not_none(lasting.inversion_time) + 0.2, abs=1e-12)
    assert shown(short) == (0.1, None)
    assert shown(lasting) == (None, until)
    assert shown(lasting, speed=0.25) == (0.25, until)
    assert shown(lasting, begin=10.0) == (1.0, None)
    # A GIF has one speed: the steps between its frames of 0.05 s.
    for end, speed in ((5.0, 0.1), (5.1, 1.0)):
        moments, hundredths = drawing.frame_times(0.0, end)
        assert (hundredths, moments[1]) == (5, pytest.approx(0.05 * speed))


def test_page_needs_nothing_from_elsewhere_and_no_text_breaks_it() -> None:
    made = replace(inversion(), method={"formulation": "<i>"})
    page = animate(made, title='"</canvas>', caption="<u>").text
    data = render("player.html", data={"marks": "</script><b>"})
    assert embedded(data)["marks"] == "</script><b>"
    for unwanted in ("</script><b>", "<i>", '"</canvas>"', "<u>"):
        assert unwanted not in page + data
    assert not re.search(r"https?:|src=|href=|import|fetch\(|url\(", page)


PLATES = [
    STEEL_DISK,
    CENTRED_DISK,
    ROUNDED_STEEL_DISK,
    Disk.of_parts((0.04, 0.01, 7700.0), [(-0.02, 0.01, 0.01), (0.01, -0.02, 0.005)]),
    ELLIPSE,
]


def _area(outline: Array) -> float:
    x, y = outline.T
    return 0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


@pytest.mark.parametrize("disk", PLATES)
def test_shape_of_a_body_is_that_of_its_mass(disk: Body) -> None:
    body = shape(disk)
    areas = [_area(line) for line in body.lines]
    middles = [np.mean(line[:-1], axis=0) for line in body.lines]
    balance = sum(a * m for a, m in zip(areas, middles, strict=True)) / sum(areas)
    assert _area(body.area) == pytest.approx(sum(areas))
    if len(areas) > 1:
        # What is drawn balances where the centre of gravity is drawn; 72 corners take 0.1 %.
        np.testing.assert_allclose(balance, body.cog, atol=1e-3 * disk.radius)
    assert bool(body.heavy) == (disk.eccentricity > 0.0)
    assert np.hypot(*body.mark) == pytest.approx(disk.radius)


@pytest.mark.parametrize("solid", [TIPPE_TOP, EGG], ids=["sphere", "own"])
def test_lines_and_outline_of_a_solid_are_those_of_its_surface(solid: Body) -> None:
    body, eye = shape(solid), np.array([0.6, 0.0, 0.8])
    points = np.vstack(body.lines)
    if isinstance(solid, Sphere):
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), solid.radius)
    across = np.array([[0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])
    drawn = outline(body.area @ across.T)
    for turn in np.linspace(0.0, 2.0 * np.pi, 50):
        sideways = np.array([np.cos(turn), np.sin(turn)])
        farthest = sideways @ across @ solid.lowest_point(sideways @ across)
        short = np.min(drawn @ sideways) - farthest
        assert -1e-12 < short < 3e-3 * solid.radius
    visible = in_sight(points, np.zeros(3), eye)
    assert 0.4 < np.mean(np.isnan(visible[:, 0])) < 0.6


def test_what_lies_towards_the_eye_is_seen_in_one_place_and_across_it_in_its_size() -> None:
    camera = drawing.Camera(np.array([0.1, -0.2, 0.3]), -1.25, radius=0.5)
    right, up, towards = camera.axes
    np.testing.assert_allclose(np.cross(right, up), towards, atol=1e-12)
    # A length of 1 m is two of the camera's radii.
    seen = camera.project(camera.target + camera.axes)
    np.testing.assert_allclose(seen, [(2.0, 0.0), (0.0, 2.0), (0.0, 0.0)], atol=1e-12)


@pytest.mark.parametrize("body", [COMPOSED, ELLIPSE, TIPPE_TOP], ids=["disk", "ellipse", "solid"])
def test_bodies_are_drawn_in_every_picture(body: Body) -> None:
    scenario = Scenario(disk=body, start=Start(beta=1.3, gamma=0.5, spin=5.0))
    made, stream = simulate(scenario, np.linspace(0.0, 0.05, 6)), io.BytesIO()
    assert drawing.write_gif(keyframes(made), stream, speed=1.0, fps=20.0, width=100) == 2
    assert draw_instants(made, [0.0, 0.05]).axes
    page = made.animate().text
    told = embedded(page)["shape"]
    assert (told["solid"], len(told["masses"])) == (isinstance(body, Sphere), body is COMPOSED)
    # What is not drawn has no key.
    assert [key in page for key in ("two faces of the disk", "Dark half")] == [
        not told["solid"]
    ] * 2


@needs_node
def test_player_draws_the_outline_of_a_solid() -> None:
    made = simulate(Scenario(disk=TIPPE_TOP), np.linspace(0.0, 0.05, 6)).animate()
    (shown,) = in_node("player_harness.js", made.text, "0.02")
    expected = outline(np.array(embedded(made.text)["shape"]["area"])[:, :2])
    assert {tuple(each) for each in shown["hull"]} == {tuple(each) for each in expected.tolist()}
    # Table, shadow, one surface, contact point, mark and centre of gravity.
    assert len(shown["drawn"]) == 6


@needs_node
@pytest.mark.parametrize("kind", MOTIONS)
def test_player_shows_the_motion(kind: str) -> None:
    motion = MOTIONS[kind]()
    rows = [0, 7, 33, -1]
    times = map(repr, motion.times[rows].tolist())
    played = in_node("player_harness.js", motion.animate().text, *times)
    position, rotation, _, turning = motion.poses
    for row, shown in zip(rows, played, strict=True):
        # The rounding that the player states.
        np.testing.assert_allclose(shown["centre"], position[row], atol=6e-6)
        axes = np.column_stack([shown[name] for name in ("ex", "ey", "ez")])
        np.testing.assert_allclose(axes, rotation[row], atol=3e-5)
        lift = motion.scenario.disk.eccentricity * rotation[row, 2, 0]
        assert shown["lift"] == pytest.approx(lift, abs=6e-6)
        assert shown["spin"] == pytest.approx(turning[row, 2], abs=1e-4)
        assert np.cos(shown["beta"]) == pytest.approx(rotation[row, 2, 2], abs=3e-5)
        sine = np.sin(shown["beta"]) * np.sin(shown["gamma"])
        assert sine == pytest.approx(rotation[row, 2, 0], abs=3e-5)
        # Table, shadow, light and heavy half, contact point, mark and centre of gravity.
        assert len(shown["drawn"]) == 7
        assert {LOOK["table"], LOOK["shadow"], LOOK["path"]} < set(shown["drawn"])


SMALL_DISK = Disk.ring(
    radius=2e-4, hole_radius=6e-5, hole_distance=8e-5, thickness=2e-5, density=7700.0
)


def test_a_gif_shows_a_disk_that_is_dropped_and_tells_lengths_of_a_small_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[str] = []
    monkeypatch.setattr(Axes, "text", lambda *given, **_: told.append(given[3]))
    contact = PenaltyContact(stiffness=1e5)
    for disk, height in ((SMALL_DISK, 0.0), (STEEL_DISK, 0.5)):
        start, stream = Start(spin=-0.01, height=height), io.BytesIO()
        dropped = simulate(Scenario(disk=disk, contact=contact, start=start), [0.0, 1e-4])
        drawing.write_gif(dropped, stream, width=100)
        with GifImageFile(io.BytesIO(stream.getvalue())) as picture:
            pixels = np.asarray(picture.convert("RGB")) / 255.0
        faces = [np.abs(pixels - to_rgb(each)).max(axis=2) < 0.1 for each in LOOK["front"]]
        assert np.sum(faces) > 500
    assert told[0].endswith("spin 0.0 rad/s\nCOG 0.008 mm below the centre")


def test_small_disks_are_played_as_finely_as_others() -> None:
    disk = SMALL_DISK
    told = embedded(simulate(Scenario(disk=disk), [0.0, 1e-5, 2e-5]).animate().text)
    assert np.ptp(told["times"]) == pytest.approx(2e-5)
    edge = np.array(told["shape"]["lines"][0])
    np.testing.assert_allclose(np.linalg.norm(edge, axis=1), disk.radius, rtol=1e-3)


def test_notebook_shows_the_page_in_a_frame_of_its_own() -> None:
    made = inversion().animate(end=0.2)
    for shown in (made, play()):
        told = shown._repr_html_()
        found = re.fullmatch(r'<iframe srcdoc="([^"]*)" .*</iframe>', told, re.DOTALL)
        assert html.unescape(not_none(found)[1]) == shown.text
        assert len(repr(shown)) < 100


def test_gif_has_the_frames_asked_for_and_shows_the_heavy_half_low_and_then_high() -> None:
    made, stream = keyframes(inversion()), io.BytesIO()
    # 30 frames per second are 3.3 hundredths of a second; 3 are shown, 0.09 s of the motion.
    assert drawing.write_gif(made, stream, speed=3.0, fps=30.0, width=200) == 18
    lifts, fronts = [], set()
    with GifImageFile(io.BytesIO(stream.getvalue())) as picture:
        assert (picture.n_frames, picture.size) == (18, (200, 200))
        assert (picture.info["duration"], picture.info["loop"]) == (30, 0)
        for index in range(picture.n_frames):
            picture.seek(index)
            pixels = np.asarray(picture.convert("RGB")) / 255.0
            # What is read off stands in the upper left corner.
            assert pixels[:20, :100].min() < 0.5
            rows = [
                np.nonzero(np.max(np.abs(pixels - to_rgb(colour)), axis=2) < 0.1)[0]
                for colour in (*LOOK["front"], *LOOK["back"])
            ]
            light, heavy = (np.concatenate(rows[half::2]).mean() for half in (0, 1))
            lifts.append(light - heavy)
            fronts.add(rows[0].size > rows[2].size)
    assert lifts[0] < -20.0
    assert lifts[-1] > 20.0
    assert fronts == {True, False}


CHOICES = [
    {"spin": 40.0, "beta": 1.57, "coefficient": 0.3, "smoothing": 0.1, "hole": 20},
    # Friction as stiff as the page lets it be: steps of 1 ms are unstable.
    {"spin": 55.0, "beta": 1.57, "coefficient": 1.0, "smoothing": 0.01, "hole": 28},
    {"spin": 60.0, "beta": 0.3, "coefficient": 0.02, "smoothing": 0.5, "hole": 28},
    # It passes by flat, and turns by half a turn in a millisecond there, or ends there.
    {"spin": 10.0, "beta": 0.3, "coefficient": 0.3, "smoothing": 0.1, "hole": 20},
    {"spin": 1.0, "beta": 1.2, "coefficient": 0.3, "smoothing": 0.1, "hole": 20},
]


def spun(chosen: dict[str, float]) -> Any:
    return in_node("play_harness.js", play().text, json.dumps(chosen))


@needs_node
@pytest.mark.parametrize("chosen", CHOICES, ids=lambda chosen: f"{chosen['spin']:g}")
def test_disk_on_the_page_moves_as_the_equations_say(chosen: dict[str, float]) -> None:
    found = spun(chosen)
    times = np.array(found["times"])
    times = times[times <= 2.0]
    scenario = Scenario(
        disk=Disk.ring(hole_distance=1e-3 * chosen["hole"]),
        friction=SmoothCoulomb(coefficient=chosen["coefficient"], smoothing=chosen["smoothing"]),
        start=Start(spin=chosen["spin"], beta=chosen["beta"]),
    )
    run = simulate(scenario, times, tolerance=1e-8)
    columns = {name: np.array(each)[: times.size] for name, each in found["columns"].items()}
    positions, rotations = frames.poses(run.coordinates)
    quaternions = np.column_stack([columns[name] for name in ("qw", "qx", "qy", "qz")])
    turned = frames.rotations(quaternions) @ rotations.transpose(0, 2, 1)
    angles = np.arccos(np.clip((np.trace(turned, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))
    assert angles.max() < 1e-3
    centres = np.column_stack([columns[name] for name in "xyz"])
    np.testing.assert_allclose(centres, positions, atol=1e-3 * scenario.disk.radius)
    contact = np.column_stack([columns[name] for name in ("contactX", "contactY")])
    np.testing.assert_allclose(
        contact, run.contact_points[:, :2], atol=1e-3 * scenario.disk.radius
    )
    turning = run.poses.angular_velocities[:, 2]
    np.testing.assert_allclose(columns["spin"], turning, atol=1e-3 * chosen["spin"])
    assert bool(found["ending"]) == (chosen["spin"] == 1.0)
    assert times.size > 100


@needs_node
@pytest.mark.parametrize(
    ("spin", "hole"), [(30.0, 20), (32.0, 20), (36.0, 20), (40.0, 20), (40.0, 0)]
)
@pytest.mark.parametrize("coefficient", mostly_slow([0.1, 0.3], [0.3]))
def test_page_says_what_an_inversion_is_everywhere_else(
    spin: float, hole: int, coefficient: float
) -> None:
    found = spun(CHOICES[0] | {"spin": spin, "hole": hole, "coefficient": coefficient})
    scenario = Scenario(
        disk=Disk.ring(hole_distance=1e-3 * hole),
        friction=SmoothCoulomb(coefficient=coefficient),
        start=Start(spin=spin, beta=1.57),
    )
    inversion = simulate(scenario, np.linspace(0.0, 5.0, 1251), tolerance=1e-6).inversion
    assert found["kept"] == (inversion.outcome in ("inverted", "lost"))
    times = [(inversion.lost, found["until"])]
    times += [(inversion.time, found["over"])] if found["kept"] else []
    for expected, told in times:
        assert (told is None) == (expected is None)
        assert told is None or told == pytest.approx(not_none(expected), abs=8e-3)


@needs_node
def test_page_ends_where_the_table_would_have_to_hold_the_disk_down() -> None:
    chosen = {**CHOICES[0], "spin": 150.0}
    found = spun(chosen)
    assert found["ending"] == "the table would have to hold the disk down"
    ending = simulate(Scenario(start=Start(spin=150.0, beta=1.57)), [0.0, 5.0]).ending
    assert ending is not None
    assert found["times"][-1] == pytest.approx(ending.time, abs=8e-3)
