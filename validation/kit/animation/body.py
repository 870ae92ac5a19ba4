"""What is drawn of a body: the one description for the player, the GIF and pictures."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from analysis import Body, Disk, EllipticDisk
from analysis.data.checks import Array

_CORNERS = 73
"""Points of a circle, the last one the first again."""

_MASS = 0.05
"""Radius of a small mass in radii of the body."""


class Shape(NamedTuple):
    """Outlines and points of a plate in its x and y axes, or lines on a solid, in m.

    Parameters
    ----------
    face : list of ndarray, shape (n, 2)
        The edge of a plate, counterclockwise, and those of its holes, clockwise.
    heavy : list of ndarray, shape (n, 2)
        The same of the half that holds the centre of gravity; none where that is the middle.
    cog, mark : tuple of 2 float
        Centre of gravity, and a point of the edge by which the eye sees the body turn.
    masses : list of ndarray, shape (n, 2)
        Outlines of small masses on a plate.
    lines : list of ndarray, shape (n, 3)
        Closed lines on the surface of a solid, which has no face; together they fill its outline.
    """

    face: list[Array]
    heavy: list[Array]
    cog: tuple[float, float]
    mark: tuple[float, float]
    masses: tuple[Array, ...] = ()
    lines: tuple[Array, ...] = ()


def shape(body: Body) -> Shape:
    """Shape of a body: a disk with its holes and masses, an ellipse, or a solid."""
    cog = (body.eccentricity, 0.0)
    if isinstance(body, Disk):
        holes, masses = body.outline()
        edges = [circle(body.radius)]
        edges += [circle(hole.radius, hole.x, hole.y)[::-1] for hole in holes]
        mark = (body.radius, 0.0)
        added = [circle(_MASS * body.radius, each.x, each.y) for each in masses]
    elif isinstance(body, EllipticDisk):
        c, s = np.cos(body.long_axis), np.sin(body.long_axis)
        straight = circle(1.0) * (body.radius, body.other_radius)
        edges, added = [straight @ np.array([[c, s], [-s, c]])], []
        mark = float(body.radius * c), float(body.radius * s)
    else:
        top = body.lowest_point((-1.0, 0.0, 0.0))
        return Shape(face=[], heavy=[], cog=cog, mark=(top[0], top[1]), lines=tuple(surface(body)))
    right = [edge.clip(min=(0.0, -np.inf)) for edge in edges]
    heavy = right if body.eccentricity else []
    return Shape(face=edges, heavy=heavy, cog=cog, mark=mark, masses=tuple(added))


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


def hull(points: Array) -> Array:
    """Outline of the points of a picture, shape (n, 2)."""
    found: Array = points[ConvexHull(points).vertices]
    return found


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
    result: Array = np.where(((line - middle) @ eye >= 0.0)[:, None], line, np.nan)
    return result
