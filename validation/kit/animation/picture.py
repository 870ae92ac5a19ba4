"""The disk on its table, drawn: for each frame of a GIF, and for instants side by side."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from analysis.data.checks import Array
from validation.kit.animation.body import circle, hull, in_sight, shape
from validation.kit.animation.keyframes import Keyframes

FRONT, BACK = ("#8cc6ee", "#0b5c97"), ("#f7cf86", "#b85300")
"""Light and heavy half of each face, as in the player."""

_PATH = "#00795b"
_ELEVATION = np.radians(14.0)


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
    def to_eye(self) -> Array:
        """Direction to the eye, shape (3,)."""
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        level, up = np.cos(_ELEVATION), np.sin(_ELEVATION)
        return np.array((level * c, level * s, up))

    def project(self, points: Array) -> Array:
        """Orthographic picture coordinates, shape (n, 2), of points in m, shape (n, 3)."""
        x, y, z = ((np.atleast_2d(points) - self.target) / self.radius).T
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        up = np.cos(_ELEVATION) * z - np.sin(_ELEVATION) * (c * x + s * y)
        return np.column_stack((c * y - s * x, up))


def scene(axes: Axes) -> Axes:
    """Empty axes of the size that `artists` fill."""
    axes.set_axis_off()
    axes.set(xlim=(-2.04, 2.04), ylim=(-1.25, 1.85))
    return axes


def artists(pose: Keyframes, camera: Camera, trail: Array | None = None) -> Iterator[Artist]:
    """What is seen of one instant, the farthest first.

    Parameters
    ----------
    pose : Keyframes
        One alone.
    camera : Camera
    trail : ndarray, shape (n, 2), optional
        Contact points of the last moments in m.
    """
    place, scale, body = pose.positions[0], camera.scale, shape(pose.disk)
    axes = pose.rotations[0].T

    def placed(outline: Array) -> Array:
        points: Array = place + outline @ axes[: outline.shape[1]]
        return points

    def seen(outlines: list[Array]) -> list[Array]:
        return [camera.project(placed(outline)) for outline in outlines]

    def area(outlines: list[Array]) -> list[Array]:
        """What a solid covers is the hull of its lines."""
        return [hull(np.vstack(outlines))] if body.lines else outlines

    yield from _table(camera)
    shadow = [camera.project(placed(each) * (1.0, 1.0, 0.0)) for each in (*body.face, *body.lines)]
    yield _filled(area(shadow), "#000000", alpha=0.13)
    if trail is not None:
        yield _line(camera.project(np.pad(trail, ((0, 0), (0, 1)))), _PATH, 1.6 * scale)
    # The body's x axis turns into its y axis counterclockwise if its z axis points to the eye.
    counterclockwise = np.linalg.det(camera.project(camera.target + axes[:2])) > 0.0
    light, heavy = FRONT if counterclockwise or body.lines else BACK
    whole = seen(body.face)
    yield _filled(area(seen([*body.face, *body.lines])), light)
    if body.heavy:
        yield _filled(seen(body.heavy), heavy)
    for number, outline in enumerate(whole):
        yield _line(outline, heavy, (0.8 if number else 2.0) * scale)
    for mass in seen([*body.masses]):
        yield _filled([mass], "#222222")
    for line in body.lines:
        visible = in_sight(placed(line), place, camera.to_eye)
        yield _line(camera.project(visible), FRONT[1], 0.8 * scale)
    for point, marker, inner, edge in (
        (body.mark, "o", "white", "#222222"),
        (body.cog, "o", "black", "white"),
        ((0.0, 0.0), "+", "none", "#222222"),
    ):
        look: dict[str, Any] = {"ms": 7 * scale, "mew": scale, "mfc": inner, "mec": edge}
        yield Line2D(*seen([np.array([point])])[0].T, marker=marker, **look)


def _table(camera: Camera) -> Iterator[Artist]:
    """A round piece of the table, with lines by which the eye sees it pass."""
    reach, cell = 3.0 * camera.radius, 0.5 * camera.radius
    middle = camera.target * (1.0, 1.0, 0.0)
    yield _filled([camera.project(np.pad(circle(reach), ((0, 0), (0, 1))) + middle)], "#f3f3f0")
    lines = []
    for axis in (0, 1):
        lowest = np.ceil((middle[axis] - reach) / cell)
        for value in cell * np.arange(lowest, (middle[axis] + reach) / cell):
            half = np.sqrt(max(0.0, reach**2 - (value - middle[axis]) ** 2))
            line = np.tile(middle, (3, 1))
            line[:, axis] = value
            line[:, 1 - axis] += (-half, half, np.nan)
            lines.append(line)
    yield _line(camera.project(np.vstack(lines)), "#d9d9d4", 0.7 * camera.scale)


def _filled(outlines: list[Array], colour: str, alpha: float = 1.0) -> Artist:
    """Area within outlines, shape (n, 2) each; those that turn the other way are holes."""
    path = Path.make_compound_path(*(Path(outline, closed=True) for outline in outlines))
    return PathPatch(path, color=colour, alpha=alpha, linewidth=0.0)


def _line(points: Array, colour: str, width: float) -> Artist:
    return Line2D(*points.T, color=colour, linewidth=width)
