"""The disk on its table, drawn: for each frame of a GIF, and for instants side by side."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from analysis.problem.checks import Array
from validation.kit.animation.body import circle, in_sight, shape
from validation.kit.animation.keyframes import Keyframes

FRONT, BACK = ("#8cc6ee", "#0b5c97"), ("#f7cf86", "#b85300")
"""Light and heavy half of each face, as in the player."""

_PATH, _INK, _SHADOW = "#00795b", "#222222", "#d3d3d1"
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
    def axes(self) -> Array:
        """Directions to the right, up and to the eye, shape (3, 3)."""
        c, s = np.cos(self.azimuth), np.sin(self.azimuth)
        level, up = np.cos(_ELEVATION), np.sin(_ELEVATION)
        return np.array([(-s, c, 0.0), (-up * c, -up * s, level), (level * c, level * s, up)])

    def project(self, points: Array) -> Array:
        """Orthographic picture coordinates, shape (n, 2), of points in m, shape (n, 3)."""
        result: Array = (points - self.target) / self.radius @ self.axes[:2].T
        return result


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
        points: Array = place + outline @ turned[: outline.shape[1]]
        return points

    yield from _table(camera)
    for area in body.areas:
        yield _filled(project(placed(area) * (1.0, 1.0, 0.0)), _SHADOW)
    if trail is not None:
        yield _line(project(np.pad(trail, ((0, 0), (0, 1)))), _PATH, 1.6 * scale)
    light, heavy = FRONT if body.solid or turned[2] @ eye > 0.0 else BACK
    for areas, colour in ((body.areas, light), (body.heavy, heavy), (body.masses, _INK)):
        for area in areas:
            yield _filled(project(placed(area)), colour)
    for line in map(placed, body.lines):
        visible = in_sight(line, place, eye) if body.solid else line
        yield _line(project(visible), heavy, 1.2 * scale)
    for point, marker, inner, edge in (
        (body.mark, "o", "white", _INK),
        (body.cog, "o", "black", "white"),
        ((0.0, 0.0), "+", "none", _INK),
    ):
        look: dict[str, Any] = {"ms": 7 * scale, "mew": scale, "mfc": inner, "mec": edge}
        yield Line2D(*project(placed(np.array([point]))).T, marker=marker, **look)


def _table(camera: Camera) -> Iterator[Artist]:
    """A round piece of the table, with lines by which the eye sees it pass."""
    reach, cell = 3.0 * camera.radius, 0.5 * camera.radius
    middle = camera.target * (1.0, 1.0, 0.0)
    yield _filled(camera.project(np.pad(circle(reach), ((0, 0), (0, 1))) + middle), "#f3f3f0")
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


def _filled(outline: Array, colour: str) -> Artist:
    return Polygon(outline, color=colour, linewidth=0.0)


def _line(points: Array, colour: str, width: float) -> Artist:
    return Line2D(*points.T, color=colour, linewidth=width)
