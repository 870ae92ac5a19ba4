"""The disk on its table, drawn: instants side by side, and the frames of an animated GIF."""

from collections.abc import Iterator
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from PIL import Image

from analysis.problem.checks import Array, within
from analysis.problem.limits import PLAYBACK_SPEEDS, SLOWEST_FRAMES, WIDEST_PICTURE
from validation.kit.animation.body import LOOK, circle, in_sight, outline, shape
from validation.kit.animation.keyframes import Keyframes
from validation.kit.progress import counted

MOST_FRAMES = 2000
FASTEST = 50.0
"""Frames per second above which browsers slow a GIF down."""

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

    @property
    def axes(self) -> Array:
        """Directions to the right, up and to the eye, shape (3, 3)."""
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        level, up = np.cos(_ELEVATION), np.sin(_ELEVATION)
        return np.array([(-s, c, 0.0), (-up * c, -up * s, level), (level * c, level * s, up)])

    def project(self, points: Array) -> Array:
        """Orthographic picture coordinates, shape (n, 2), of points in m, shape (n, 3)."""
        return (points - self.target) / self.radius @ self.axes[:2].T


def draw(axes: Axes, pose: Keyframes, camera: Camera, trail: Array | None = None) -> None:
    """Draw one instant into axes of which nothing else is seen.

    Parameters
    ----------
    axes : Axes
    pose : Keyframes
        One alone.
    camera : Camera
    trail : ndarray, shape (n, 2), optional
        Contact points of the last moments in m.
    """
    axes.set_axis_off()
    axes.set(xlim=(-1.35, 1.35), ylim=(-0.95, 1.75), aspect="equal")
    for order, artist in enumerate(_artists(pose, camera, trail)):
        axes.add_artist(artist).set_zorder(order)


def _artists(pose: Keyframes, camera: Camera, trail: Array | None) -> Iterator[Artist]:
    """What is seen of one instant, the farthest first."""
    place, scale, body = pose.positions[0], camera.scale, shape(pose.disk)
    turned, project, eye = pose.rotations[0].T, camera.project, camera.axes[2]

    def placed(outline: Array) -> Array:
        return place + outline @ turned[: outline.shape[1]]

    def covered(points: Array) -> Array:
        seen = project(points)
        return outline(seen) if body.solid else seen

    yield from _table(camera)
    for area in body.areas:
        yield _filled(covered(placed(area) * (1.0, 1.0, 0.0)), LOOK["shadow"])
    if trail is not None:
        yield _line(project(np.pad(trail, ((0, 0), (0, 1)))), LOOK["path"], 1.6 * scale)
    light, heavy = LOOK["front" if body.solid or turned[2] @ eye > 0.0 else "back"]
    for areas, colour in ((body.areas, light), (body.heavy, heavy), (body.masses, LOOK["ink"])):
        for area in areas:
            yield _filled(covered(placed(area)), colour)
    if body.solid:
        yield _line(covered(placed(body.areas[0])), heavy, 1.2 * scale)
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
    poses: Keyframes, *, speed: float | None = None, fps: float = 20.0
) -> tuple[Array, int]:
    """Times of the frames in s, and how long each is shown in hundredths of a second.

    A GIF counts in hundredths of a second; the frames lie such that the playback has the speed
    asked for exactly, and `fps` at least nearly.

    Parameters
    ----------
    poses : Keyframes
    speed : float, optional
        1 for real time; by default a tenth for up to 4 s, real time for longer motions.
    fps : float
        Frames per second, from `SLOWEST_FRAMES` to `FASTEST`.

    Raises
    ------
    ValueError
        If `speed` or `fps` is out of range, or these are more than `MOST_FRAMES`.
    """
    within("fps", fps, SLOWEST_FRAMES, FASTEST)
    begin, end = float(poses.times[0]), float(poses.times[-1])
    if speed is None:
        speed = 0.1 if end - begin <= 4.0 else 1.0
    shown = max(2, round(100.0 / fps))
    step = within("speed", speed, *PLAYBACK_SPEEDS) * shown / 100.0
    count = int(np.floor((end - begin) / step + 1e-9)) + 1
    if count > MOST_FRAMES:
        raise ValueError(
            f"a GIF may have {MOST_FRAMES} frames, not {count}: raise the speed, lower fps, or "
            "bring begin and end closer together"
        )
    return begin + step * np.arange(count, dtype=float), shown


def write_gif(
    poses: Keyframes,
    stream: BinaryIO,
    *,
    speed: float | None = None,
    fps: float = 20.0,
    width: int = 480,
) -> int:
    """Draw a GIF with a progress bar, and return its number of frames.

    Parameters
    ----------
    poses : Keyframes
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
    times, shown = frame_times(poses, speed=speed, fps=fps)
    low, high = poses.contact_points.min(axis=0), poses.contact_points.max(axis=0)
    rolls_away = bool(np.max(high - low) > 1.5 * poses.disk.radius)
    middle = None if rolls_away else 0.5 * (low + high)

    figure = Figure(figsize=(width / _DPI, width / _DPI), dpi=_DPI)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))

    def frame(time: float) -> Image.Image:
        return Image.fromarray(_pixels(axes, poses, time, middle))

    # One palette for all frames, from a few of them, keeps the colours from flickering.
    sample = [np.asarray(frame(time)) for time in np.linspace(times[0], times[-1], 8)]
    palette = Image.fromarray(np.vstack(sample)).quantize(128)
    frames = (
        frame(time).quantize(palette=palette, dither=Image.Dither.NONE)
        for time in counted(times, "frames")
    )
    how: dict[str, Any] = {"format": "GIF", "save_all": True, "duration": 10 * shown, "loop": 0}
    next(frames).save(stream, append_images=frames, **how)
    return times.size


def _pixels(axes: Axes, poses: Keyframes, now: float, middle: Array | None) -> np.ndarray:
    """Picture at a time in s, of a place or else of the disk, shape (width, width, 3)."""
    for artist in (*axes.lines, *axes.patches, *axes.texts):
        artist.remove()
    figure: Any = axes.figure
    canvas: Any = FigureCanvasAgg(figure)  # its methods carry no types
    radius, scale = poses.disk.radius, canvas.get_width_height()[0] / 480
    before = poses.times[(poses.times > now - LOOK["trail"]) & (poses.times < now)]
    pose, trail = poses.at(np.array([now])), poses.at(np.append(before, now)).contact_points
    target = np.append(
        pose.positions[0, :2] if middle is None else middle, LOOK["height"] * radius
    )
    draw(axes, pose, Camera(target, LOOK["azimuth"], 1.5 * radius, scale), trail)
    axes.text(-1.25, 1.7, _readout(pose), va="top", fontsize=9.0 * scale)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3]


def _readout(pose: Keyframes) -> str:
    sine, cosine, up = pose.rotations[0, 2]
    gamma = "–" if np.hypot(sine, cosine) < 1e-3 else f"{np.arctan2(sine, cosine):.2f} rad"
    beta, lift = np.arccos(np.clip(up, -1.0, 1.0)), 1e3 * pose.disk.eccentricity * sine
    return (
        f"t = {pose.times[0]:.3f} s,  β = {beta:.2f} rad,  γ = {gamma},  "
        f"spin {pose.table[0, -1]:.1f} rad/s\n"
        f"COG {abs(lift):.1f} mm {'above' if lift >= 0.0 else 'below'} the centre"
    )
