"""What is drawn of a body: the one description for the player, the GIF and pictures."""

from typing import NamedTuple

import numpy as np

from analysis import Disk
from analysis.data.checks import Array

_CORNERS = 73
"""Points of a circle, the last one the first again."""


class Shape(NamedTuple):
    """Outlines and points in the plane of a body, in its x and y axes, in m.

    Parameters
    ----------
    face : list of ndarray, shape (n, 2)
        Its edge, counterclockwise, and those of its holes, clockwise.
    heavy : list of ndarray, shape (n, 2)
        The same of the half that holds the centre of gravity; none where that is the middle.
    cog, mark : tuple of 2 float
        Centre of gravity, and a point of the edge by which the eye sees the body turn.
    """

    face: list[Array]
    heavy: list[Array]
    cog: tuple[float, float]
    mark: tuple[float, float]


def shape(disk: Disk) -> Shape:
    """Shape of a disk and its hole."""
    edges = [circle(disk.radius)]
    if disk.hole is not None:
        radius, distance = disk.hole
        edges.append(circle(radius, -distance)[::-1])
    right = [edge.clip(min=(0.0, -np.inf)) for edge in edges]
    return Shape(
        face=edges,
        heavy=right if disk.eccentricity else [],
        cog=(disk.eccentricity, 0.0),
        mark=(disk.radius, 0.0),
    )


def circle(radius: float, centre: float = 0.0) -> Array:
    """Points of a circle, counterclockwise, shape (n, 2); its centre lies on the x axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS)
    return np.column_stack((centre + radius * np.cos(angle), radius * np.sin(angle)))
