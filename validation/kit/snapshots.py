"""The disk seen at a few instants, drawn from any trajectory."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from analysis import Trajectory
from analysis.data import frames
from analysis.data.checks import Array
from validation.kit import figures
from validation.kit.animation import body

_VIEW_ELEVATION = np.radians(14.0)


def project(points: Array, azimuth: float) -> Array:
    """Orthographic picture coordinates, shape (n, 2), of inertial points, shape (n, 3)."""
    c, s = np.cos(azimuth), np.sin(azimuth)
    across = -s * points[:, 0] + c * points[:, 1]
    depth = c * points[:, 0] + s * points[:, 1]
    up = np.cos(_VIEW_ELEVATION) * points[:, 2] - np.sin(_VIEW_ELEVATION) * depth
    return np.column_stack((across, up))


def to_eye(azimuth: float) -> Array:
    """Direction to the eye, shape (3,)."""
    level = np.cos(_VIEW_ELEVATION)
    return np.array(
        (level * np.cos(azimuth), level * np.sin(azimuth), np.sin(_VIEW_ELEVATION)), dtype=float
    )


def draw_disk(trajectory: Trajectory, index: int, axes: Any) -> Any:
    """Draw the disk at one sample, seen from a camera that turns with it.

    Parameters
    ----------
    trajectory : Trajectory
    index : int
        Sample.
    axes : Axes
    """
    disk = trajectory.scenario.disk
    position, rotation = frames.poses(trajectory.coordinates[index : index + 1])
    # From a quarter to the side, so that the disk shows its face whatever its spin.
    azimuth = trajectory.coordinates[index, 3] - np.pi / 2 + 0.35
    centre = np.array([0.0, 0.0, position[0, 2]])

    def place(points: Array) -> Array:
        """Points in axes of the body, shape (n, 2) or (n, 3), in the picture."""
        return project(points @ rotation[0, :, : points.shape[1]].T + centre, azimuth)

    drawn = body.shape(disk)
    edge, *holes = map(place, drawn.face or [np.vstack(drawn.lines)])
    if drawn.lines:
        edge = body.hull(edge)
    middle, cog = place(np.array([[0.0, 0.0], drawn.cog]))
    table = project(np.pad(body.circle(1.6 * disk.radius), ((0, 0), (0, 1))), azimuth)
    axes.fill(*table.T, color="#eeeeee", zorder=0)
    axes.fill(*edge.T, facecolor="#9fc5e8", edgecolor="#0b3d61", linewidth=1.2)
    for hole in holes:
        axes.fill(*hole.T, facecolor="white", edgecolor="#0b3d61", linewidth=0.8)
    for mass in map(place, drawn.masses):
        axes.fill(*mass.T, color="#0b3d61")
    eye = to_eye(azimuth) @ rotation[0]
    for line in drawn.lines:
        seen = body.in_sight(line, np.zeros(3), eye)
        axes.plot(*place(seen).T, color="#0b3d61", linewidth=0.6)
    axes.plot(*middle, marker="+", color="#0b3d61", markersize=6)
    axes.plot(*cog, marker="o", color="black", markersize=5)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(-1.65 * disk.radius, 1.65 * disk.radius)
    axes.set_ylim(-0.5 * disk.radius, 2.3 * disk.radius)
    return axes


def strip(trajectory: Trajectory, times: Sequence[float]) -> Figure:
    """Draw the disk at some instants side by side, above the angle gamma over time.

    Parameters
    ----------
    trajectory : Trajectory
    times : sequence of float
        Instants in s; the nearest samples are drawn.
    """
    figure, _ = figures.new_figure(width=9.0, height=4.0)
    figure.clear()
    upper, lower = figure.subfigures(2, 1, height_ratios=(0.8, 1.0), squeeze=False)[:, 0]
    indices = [int(np.argmin(np.abs(trajectory.times - time))) for time in times]
    for index, axes in zip(indices, upper.subplots(1, len(indices)), strict=True):
        draw_disk(trajectory, index, axes)
        axes.set_title(f"{trajectory.times[index]:.2f} s", fontsize=10)
    axes = lower.subplots()
    until = max(indices) + 1
    axes.plot(trajectory.times[:until], trajectory.coordinate("gamma")[:until], color="#0072b2")
    axes.plot(
        trajectory.times[indices], trajectory.coordinate("gamma")[indices], "o", color="black"
    )
    axes.axhline(-np.pi / 2, color="#999999", linewidth=0.8)
    axes.axhline(np.pi / 2, color="#999999", linewidth=0.8)
    axes.annotate(
        "COG below the centre",
        (trajectory.times[until - 1], -np.pi / 2),
        ha="right",
        va="bottom",
        fontsize=9,
    )
    axes.annotate("COG above the centre", (0.0, np.pi / 2), va="bottom", fontsize=9)
    figures.angle_axis(axes)
    axes.set(xlabel="time in s", ylabel="γ in rad")
    return figure
