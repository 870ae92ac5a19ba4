"""The disk on its table, drawn: instants side by side, and the frames of an animated GIF."""

from collections.abc import Callable, Iterator
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from PIL import Image

from analysis import Body, StoredRun
from analysis.problem.checks import Array, within
from analysis.problem.limits import PLAYBACK_SPEEDS, SLOWEST_FRAMES, WIDEST_PICTURE
from validation.animation.body import LOOK, Shape, circle, in_sight, outline, shape
from validation.animation.keyframes import SHORT, SLOW, between
from validation.display.progress import counted

MOST_FRAMES = 2000
FASTEST = 50.0
"""Frames per second above which browsers slow a GIF down."""

Pose = tuple[Array, Array]
"""Place of the geometric centre in m, shape (3,), and rotation of the body axes, shape (3, 3)."""

_ELEVATION = np.radians(14.0)
_DPI = 100


class Camera(NamedTuple):
    """What is seen: from where, about which point in m, and how large.

    Parameters
    ----------
    target : ndarray, shape (3,)
    azimuth : float
        Angle in rad from the x axis.
    radius : float
        Length in m that becomes 1 in the picture.
    scale : float
        Of lines and letters.
    """

    target: Array
    azimuth: float
    radius: float
    scale: float = 1.0

    @staticmethod
    def aim(middle: Array, height: float, radius: float) -> Array:
        """Target that shows the table above a place on it and a body at a height in m over it.

        One that is dropped is in the middle.
        """
        least = LOOK["height"] * radius
        return np.append(middle, max(least, height - radius + least))

    @property
    def axes(self) -> Array:
        """Directions to the right, up and to the eye, shape (3, 3)."""
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        level, up = np.cos(_ELEVATION), np.sin(_ELEVATION)
        return np.array([(-s, c, 0.0), (-up * c, -up * s, level), (level * c, level * s, up)])

    def project(self, points: Array) -> Array:
        """Orthographic picture coordinates, shape (n, 2), of points in m, shape (n, 3)."""
        return (points - self.target) / self.radius @ self.axes[:2].T


def draw(axes: Axes, body: Body, pose: Pose, camera: Camera, trail: Array | None = None) -> None:
    """Draw one instant into axes of which nothing else is seen.

    Parameters
    ----------
    axes : Axes
    body : Body
    pose : Pose
    camera : Camera
    trail : ndarray, shape (n, 3), optional
        Contact points of the last moments in m.
    """
    axes.set_axis_off()
    axes.set(xlim=(-1.4, 1.4), ylim=(-1.05, 1.75), aspect="equal")
    for order, artist in enumerate(_artists(shape(body), pose, camera, trail)):
        axes.add_artist(artist).set_zorder(order)


def _artists(body: Shape, pose: Pose, camera: Camera, trail: Array | None) -> Iterator[Artist]:
    """What is seen of one instant, the farthest first."""
    place, turned = pose[0], pose[1].T
    scale, project, eye = camera.scale, camera.project, camera.axes[2]

    def placed(outline: Array) -> Array:
        return place + outline @ turned[: outline.shape[1]]

    def covered(points: Array) -> Array:
        seen = project(points)
        return outline(seen) if body.solid else seen

    yield from _table(camera)
    yield _filled(covered(placed(body.area) * (1.0, 1.0, 0.0)), LOOK["shadow"])
    if trail is not None:
        yield _line(project(trail * (1.0, 1.0, 0.0)), LOOK["path"], 1.6 * scale)
    light, heavy = LOOK["front" if body.solid or turned[2] @ eye > 0.0 else "back"]
    for areas, colour in (([body.area], light), (body.heavy, heavy), (body.masses, LOOK["ink"])):
        for area in areas:
            yield _filled(covered(placed(area)), colour)
    if body.solid:
        yield _line(covered(placed(body.area)), heavy, 1.2 * scale)
    for line in map(placed, body.lines):
        visible = in_sight(line, place, eye) if body.solid else line
        yield _line(project(visible), heavy, 1.2 * scale)
    for point, marker, inner, edge in (
        (body.mark, "o", "white", LOOK["ink"]),
        (body.cog, "o", "black", "white"),
        ((0.0, 0.0), "+", "none", LOOK["ink"]),
    ):
        mark: dict[str, Any] = {"ms": 7 * scale, "mew": scale, "mfc": inner, "mec": edge}
        yield Line2D(*project(placed(np.array([point]))).T, marker=marker, **mark)


def _table(camera: Camera) -> Iterator[Artist]:
    """A round piece of the table, with lines by which the eye sees it pass."""
    reach, cell = LOOK["reach"] * camera.radius, LOOK["cell"] * camera.radius
    middle = camera.target * (1.0, 1.0, 0.0)
    yield _filled(camera.project(np.pad(circle(reach), ((0, 0), (0, 1))) + middle), LOOK["table"])
    lines = []
    for axis in (0, 1):
        lowest = np.ceil((middle[axis] - reach) / cell)
        for value in cell * np.arange(lowest, (middle[axis] + reach) / cell):
            half = np.sqrt(max(0.0, reach**2 - (value - middle[axis]) ** 2))
            line = np.tile(middle, (3, 1))
            line[:, axis] = value
            line[:, 1 - axis] += (-half, half, np.nan)
            lines.append(line)
    yield _line(camera.project(np.vstack(lines)), LOOK["grid"], 0.7 * camera.scale)


def _filled(outline: Array, colour: str) -> Artist:
    return Polygon(outline, color=colour, linewidth=0.0)


def _line(points: Array, colour: str, width: float) -> Artist:
    return Line2D(*points.T, color=colour, linewidth=width)


# --- Frames -------------------------------------------------------------------------------------


def frame_times(
    begin: float, end: float, *, speed: float | None = None, fps: float = 20.0
) -> tuple[Array, int]:
    """Times of the frames in s, and how long each is shown in hundredths of a second.

    A GIF counts in hundredths of a second; the frames lie such that the playback has the speed
    asked for exactly, and `fps` at least nearly.

    Parameters
    ----------
    begin, end : float
        Of the motion in s.
    speed : float, optional
        1 for real time; by default `SLOW` for motions up to `SHORT`, real time for longer ones.
    fps : float
        Frames per second, from `SLOWEST_FRAMES` to `FASTEST`.

    Raises
    ------
    ValueError
        If `speed` or `fps` is out of range, or these are more than `MOST_FRAMES`.
    """
    within("fps", fps, SLOWEST_FRAMES, FASTEST)
    if speed is None:
        speed = SLOW if end - begin <= SHORT else 1.0
    shown = round(100.0 / fps)
    step = within("speed", speed, *PLAYBACK_SPEEDS) * shown / 100.0
    count = int(np.floor((end - begin) / step + 1e-9)) + 1
    if count > MOST_FRAMES:
        raise ValueError(
            f"a GIF may have {MOST_FRAMES} frames, not {count}: raise the speed, lower fps, or "
            "bring begin and end closer together"
        )
    return begin + step * np.arange(count, dtype=float), shown


def write_gif(
    motion: StoredRun,
    stream: BinaryIO,
    *,
    speed: float | None = None,
    fps: float = 20.0,
    width: int = 480,
) -> int:
    """Draw a GIF with a progress bar, and return its number of frames.

    Parameters
    ----------
    motion : Trajectory or SpatialMotion
        With enough samples for the path of its contact point.
    stream : file
        Open for writing bytes.
    speed, fps : float
        As in `frame_times`.
    width : int
        In pixels, from 100 to `WIDEST_PICTURE`; the height is as large.

    Raises
    ------
    ValueError
        If an argument is out of range.
    """
    within("width", width, 100, WIDEST_PICTURE)
    begin, end = motion.times[[0, -1]].tolist()
    times, shown = frame_times(begin, end, speed=speed, fps=fps)
    times = times.clip(max=end)
    path = between(motion, np.union1d(motion.times, times))
    frame = _pictures(path, width)
    rows = np.searchsorted(path.times, times)
    # One palette for all frames, from a few of them, keeps the colours from flickering.
    some = np.linspace(0, rows.size - 1, 8).astype(int)
    palette = Image.fromarray(np.vstack([frame(row) for row in rows[some]])).quantize(128)
    frames = (
        Image.fromarray(frame(row)).quantize(palette=palette, dither=Image.Dither.NONE)
        for row in counted(rows, "frames")
    )
    how: dict[str, Any] = {"format": "GIF", "save_all": True, "duration": 10 * shown, "loop": 0}
    next(frames).save(stream, append_images=frames, **how)
    return times.size


def _pictures(motion: StoredRun, width: int) -> Callable[[int], np.ndarray]:
    """What draws a sample of a motion by its number, shape (width, width, 3).

    The camera looks at one place, or at a disk that rolls away from there.
    """
    body, poses, contact = motion.scenario.disk, motion.poses, motion.contact_points
    low, high = contact[:, :2].min(axis=0), contact[:, :2].max(axis=0)
    rolls_away = np.max(high - low) > 1.5 * body.radius
    scale = width / 480
    figure = Figure(figsize=(width / _DPI, width / _DPI), dpi=_DPI)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    canvas: Any = FigureCanvasAgg(figure)  # its methods carry no types

    def pixels(row: int) -> np.ndarray:
        for artist in (*axes.lines, *axes.patches, *axes.texts):
            artist.remove()
        pose, now = (poses.positions[row], poses.rotations[row]), motion.times[row]
        middle = pose[0][:2] if rolls_away else 0.5 * (low + high)
        target = Camera.aim(middle, pose[0][2], body.radius)
        camera = Camera(target, LOOK["azimuth"], 1.5 * body.radius, scale)
        trail = contact[(motion.times > now - LOOK["trail"]) & (motion.times <= now)]
        draw(axes, body, pose, camera, trail)
        told = _readout(now, pose[1], poses.angular_velocities[row, 2], body)
        axes.text(-1.25, 1.7, told, va="top", fontsize=9.0 * scale)
        canvas.draw()
        return np.array(canvas.buffer_rgba())[:, :, :3]

    return pixels


def _readout(time: float, rotation: Array, spin: float, body: Body) -> str:
    sine, cosine, up = rotation[2]
    gamma = "–" if np.hypot(sine, cosine) < 1e-3 else f"{np.arctan2(sine, cosine):.2f} rad"
    beta, lift = np.arccos(np.clip(up, -1.0, 1.0)), 1e3 * body.eccentricity * sine
    places = max(1, 2 - int(np.floor(np.log10(1e3 * body.radius))))
    spin = round(spin, 1) + 0.0  # a zero without a sign
    return (
        f"t = {time:.3f} s,  β = {beta:.2f} rad,  γ = {gamma},  spin {spin:.1f} rad/s\n"
        f"COG {abs(lift):.{places}f} mm {'above' if lift >= 0.0 else 'below'} the centre"
    )
