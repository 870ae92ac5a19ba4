"""A motion of the disk as an animated GIF, for slides and wherever scripts do not run."""

from typing import Any, BinaryIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from analysis.problem.checks import Array, within
from analysis.problem.limits import PLAYBACK_SPEEDS, SLOWEST_FRAMES, WIDEST_PICTURE
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
    told: dict[str, Any] = {"format": "GIF", "save_all": True, "duration": 10 * shown, "loop": 0}
    next(frames).save(stream, append_images=frames, **told)
    return times.size


def _pixels(axes: Axes, poses: Keyframes, now: float, middle: Array | None) -> np.ndarray:
    """Picture at a time in s, of a place or else of the disk, shape (width, width, 3)."""
    for artist in (*axes.lines, *axes.patches, *axes.texts):
        artist.remove()
    figure: Any = axes.figure
    canvas: Any = FigureCanvasAgg(figure)  # its methods carry no types
    radius, scale = poses.disk.radius, canvas.get_width_height()[0] / 480
    before = poses.times[(poses.times > now - _TRAIL) & (poses.times < now)]
    pose, trail = poses.at(np.array([now])), poses.at(np.append(before, now)).contact_points
    target = np.append(pose.positions[0, :2] if middle is None else middle, 0.75 * radius)
    picture.draw(axes, pose, Camera(target, _AZIMUTH, 1.5 * radius, scale), trail)
    axes.text(-1.25, 1.7, _readout(pose), va="top", fontsize=9.0 * scale)
    canvas.draw()
    pixels: np.ndarray = np.asarray(canvas.buffer_rgba())[:, :, :3]
    return pixels


def _readout(pose: Keyframes) -> str:
    sine, cosine, up = pose.rotations[0, 2]
    gamma = "–" if np.hypot(sine, cosine) < 1e-3 else f"{np.arctan2(sine, cosine):.2f} rad"
    beta, lift = np.arccos(np.clip(up, -1.0, 1.0)), 1e3 * pose.disk.eccentricity * sine
    return (
        f"t = {pose.times[0]:.3f} s,  β = {beta:.2f} rad,  γ = {gamma},  "
        f"spin {pose.table[0, -1]:.1f} rad/s\n"
        f"COG {abs(lift):.1f} mm {'above' if lift >= 0.0 else 'below'} the centre"
    )
