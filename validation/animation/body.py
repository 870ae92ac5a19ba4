"""What is drawn of a body: the one description for the player, the GIF and pictures."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from analysis import Body, Disk, EllipticDisk
from analysis.problem.checks import Array

LOOK: dict[str, Any] = {
    "front": ("#8cc6ee", "#0b5c97"),
    "back": ("#f7cf86", "#b85300"),
    "table": "#f3f3f0",
    "grid": "#d9d9d4",
    "shadow": "#d3d3d1",
    "path": "#00795b",
    "ink": "#222222",
    "reach": 3.0,
    "cell": 0.5,
    "height": 0.75,
    "azimuth": -1.25,
    "trail": 0.5,
}
"""Of every picture: colours, of each face those of its light and its heavy half; radius of the
table that is seen, width of a cell of its grid and height of the middle of the picture in radii of
the body; where the eye is at first, in rad from the x axis; and for how long the path of the
contact point is seen, in s."""

_CORNERS = 73
"""Points of a circle, the last one the first again."""

_SPREAD = 1200
"""Points of a solid, whose hull lies within 0.3 % of the radius of its outline."""

_MASS = 0.05
"""Radius of a small mass in radii of the body."""


class Shape(NamedTuple):
    """Outlines, lines and points of a body in m, of a plate in its x and y axes alone.

    Parameters
    ----------
    area : ndarray, shape (n, k)
        What covers the body: the outline of a plate, counterclockwise, from which the eye goes to
        its holes and around them clockwise; of a solid, points in whose hull it is seen.
    lines : list of ndarray, shape (n, k)
        Closed lines that are drawn on it: the edge and those of holes, or a net over a solid.
    cog, mark : tuple of 2 float
        Centre of gravity, and a point of the edge by which the eye sees the body turn.
    heavy : list of ndarray, shape (n, 2)
        Outline of the half that holds the centre of gravity; none where that is the middle.
    masses : list of ndarray, shape (n, 2)
        Outlines of small masses on a plate.
    solid : bool
        Whether it has an outline that hides half of its lines, and no two faces.
    """

    area: Array
    lines: list[Array]
    cog: tuple[float, float]
    mark: tuple[float, float]
    heavy: Sequence[Array] = ()
    masses: Sequence[Array] = ()
    solid: bool = False


def shape(body: Body) -> Shape:
    """Shape of a body: a disk with its holes and masses, an ellipse, or a solid."""
    cog, masses = (body.eccentricity, 0.0), []
    if isinstance(body, Disk):
        holes, added = body.outline()
        edges = [circle(body.radius)]
        edges += [circle(hole.radius, hole.x, hole.y)[::-1] for hole in holes]
        masses = [circle(_MASS * body.radius, each.x, each.y) for each in added]
    elif isinstance(body, EllipticDisk):
        c, s = np.cos(body.long_axis), np.sin(body.long_axis)
        straight = circle(1.0) * (body.radius, body.other_radius)
        edges = [straight @ np.array([[c, s], [-s, c]])]
    else:
        top = body.lowest_point((-1.0, 0.0, 0.0))
        return Shape(_points(body), surface(body), cog, mark=(top[0], top[1]), solid=True)
    area = np.vstack([part for edge in edges for part in (edge, edges[0][:1])])
    heavy = [area.clip(min=(0.0, -np.inf))] if body.eccentricity else []
    mark = float(edges[0][0, 0]), float(edges[0][0, 1])
    return Shape(area, edges, cog, mark, heavy, masses)


def circle(radius: float, x: float = 0.0, y: float = 0.0) -> Array:
    """Points of a circle about a place, counterclockwise, shape (n, 2)."""
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS)
    return np.column_stack((x + radius * np.cos(angle), y + radius * np.sin(angle)))


def surface(body: Body) -> list[Array]:
    """Lines on a surface: where it is level for directions around x, and around it through x."""
    turn = circle(1.0)
    around = [
        np.column_stack((np.full(_CORNERS, np.sin(lift)), np.cos(lift) * turn))
        for lift in np.radians(np.arange(-70.0, 71.0, 20.0))
    ]
    through = [
        np.column_stack((turn[:, 0], np.outer(turn[:, 1], (np.cos(side), np.sin(side)))))
        for side in np.radians(np.arange(0.0, 180.0, 20.0))
    ]
    return [np.column_stack(body.lowest_point(each.T)) for each in (*around, *through)]


def _points(body: Body) -> Array:
    """Points of a surface, lowest for directions that a spiral spreads evenly, shape (n, 3)."""
    numbers = np.arange(_SPREAD)
    x = 1.0 - (2.0 * numbers + 1.0) / _SPREAD
    around, level = np.pi * (3.0 - np.sqrt(5.0)) * numbers, np.sqrt(1.0 - x**2)
    lowest = body.lowest_point((x, level * np.cos(around), level * np.sin(around)))
    return np.column_stack(lowest)


def outline(points: Array) -> Array:
    """Closed hull of points of a picture, as the player has it, shape (n, 2)."""
    corners: Array = points[ConvexHull(points).vertices]
    return np.append(corners, corners[:1], axis=0)


def in_sight(line: Array, middle: Array, eye: Array) -> Array:
    """The part of a line on a surface that the eye sees; what it does not see is nan.

    Parameters
    ----------
    line : ndarray, shape (n, 3)
    middle : ndarray, shape (3,)
        Of the body.
    eye : ndarray, shape (3,)
        Direction to the eye.
    """
    return np.where(((line - middle) @ eye >= 0.0)[:, None], line, np.nan)
