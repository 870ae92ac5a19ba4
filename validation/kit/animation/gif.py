"""A motion of the disk as an animated GIF, for slides and wherever scripts do not run."""

from typing import Any, BinaryIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from analysis.data.checks import Array, within
from analysis.data.limits import PLAYBACK_SPEEDS, SLOWEST_FRAMES, WIDEST_PICTURE
from validation.kit.animation import picture
from validation.kit.animation.keyframes import Keyframes
from validation.kit.animation.picture import Camera
from validation.kit.progress import counted

MOST_FRAMES = 2000
FASTEST = 50.0
"""Frames per second above which browsers slow a GIF down."""

_AZIMUTH = -1.25
_TRAIL = 0.5
_DPI = 100


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


def write(
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
    picture = _Picture(poses, width)
    # One palette for all frames, from a few of them, keeps the colours from flickering.
    sample = [picture.draw(time) for time in np.linspace(times[0], times[-1], 8)]
    palette = Image.fromarray(np.vstack(sample)).quantize(128)

    def frame(time: float) -> Image.Image:
        image = Image.fromarray(picture.draw(time))
        return image.quantize(palette=palette, dither=Image.Dither.NONE)

    rest = counted(times[1:], "frames")
    frame(times[0]).save(
        stream,
        format="GIF",
        save_all=True,
        append_images=(frame(time) for time in rest),
        duration=10 * shown,
        loop=0,
    )
    return times.size


class _Picture:
    """A figure whose disk is drawn anew for each frame, over what stays: the story below."""

    def __init__(self, poses: Keyframes, width: int) -> None:
        self.poses, self.scale = poses, width / 480
        self.figure = Figure(figsize=(width / _DPI, width / _DPI), dpi=_DPI)
        canvas: Any = FigureCanvasAgg(self.figure)  # its methods carry no types
        self.canvas = canvas
        self.scene = picture.scene(self.figure.add_axes((0.0, 0.24, 1.0, 0.76)))
        self.cursor = self._draw_strip(self.figure.add_axes((0.1, 0.08, 0.86, 0.12)))
        self.canvas.draw()
        self.background = self.canvas.copy_from_bbox(self.figure.bbox)
        low, high = poses.contact_points.min(axis=0), poses.contact_points.max(axis=0)
        self.follows = bool(np.max(high - low) > 2.0 * poses.disk.radius)
        self.middle = 0.5 * (low + high)

    def _draw_strip(self, axes: Axes) -> Line2D:
        """Height of the centre of gravity over time; returns the cursor."""
        poses, size, thin = self.poses, 8.0 * self.scale, 0.8 * self.scale
        axes.plot(poses.times, 1e3 * poses.positions[:, 2], color="#999999", linewidth=thin)
        axes.plot(poses.times, 1e3 * poses.cog_height, color="#222222", linewidth=1.5 * thin)
        axes.set_xlim(poses.times[0], poses.times[-1])
        title = "height of the COG in mm (grey: of the centre) over time in s"
        axes.set_title(title, loc="left", pad=2.0 * self.scale, fontsize=size)
        axes.tick_params(labelsize=size, length=2.0 * self.scale, pad=2.0 * self.scale)
        axes.spines[["top", "right"]].set_visible(False)
        return axes.axvline(
            poses.times[0], color="#d00000", linewidth=1.2 * self.scale, animated=True
        )

    def draw(self, time: float) -> np.ndarray:
        """Pixels at a time in s, shape (width, width, 3)."""
        self.canvas.restore_region(self.background)
        self.cursor.set_xdata([time, time])
        renderer = self.canvas.get_renderer()
        self.cursor.draw(renderer)
        pose, radius = self.poses.at(np.array([time])), self.poses.disk.radius
        middle = pose.positions[0, :2] if self.follows else self.middle
        camera = Camera(np.append(middle, 0.75 * radius), _AZIMUTH, radius, self.scale)
        readout = Text(-1.95, 1.78, _readout(pose), va="top", fontsize=9.0 * self.scale)
        for artist in (*picture.artists(pose, camera, self._trail(time)), readout):
            artist.set_figure(self.figure)
            artist.set_transform(self.scene.transData)
            artist.set_clip_box(self.scene.bbox)
            artist.draw(renderer)
        return np.asarray(self.canvas.buffer_rgba())[:, :, :3].copy()

    def _trail(self, now: float) -> Array:
        """Contact points of the last moments, shape (n, 2)."""
        times = self.poses.times
        since = max(float(times[0]), now - _TRAIL)
        inside = times[(times > since) & (times < now)]
        return self.poses.at(np.concatenate(([since], inside, [now]))).contact_points


def _readout(pose: Keyframes) -> str:
    lift = 1e3 * float(pose.cog_height[0] - pose.positions[0, 2])
    sine, cosine, up = pose.rotations[0, 2]
    gamma = "–" if np.hypot(sine, cosine) < 1e-3 else f"{np.arctan2(sine, cosine):.2f} rad"
    beta = np.arccos(np.clip(up, -1.0, 1.0))
    return (
        f"t = {pose.times[0]:.3f} s,  β = {beta:.2f} rad,  γ = {gamma},  "
        f"spin {pose.spins[0]:.1f} rad/s\n"
        f"COG {abs(lift):.1f} mm {'above' if lift >= 0.0 else 'below'} the centre"
    )
