"""The disk seen at a few instants, drawn from any trajectory."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from analysis import Trajectory
from validation.kit import figures
from validation.kit.animation import picture
from validation.kit.animation.keyframes import keyframes
from validation.kit.animation.picture import Camera


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
    poses, radius = keyframes(trajectory), trajectory.scenario.disk.radius
    indices = [int(np.argmin(np.abs(trajectory.times - time))) for time in times]
    for index, axes in zip(indices, upper.subplots(1, len(indices)), strict=True):
        pose = poses.at(trajectory.times[[index]])
        # From a quarter to the side, so that the disk shows its face whatever its spin.
        azimuth = trajectory.coordinate("alpha")[index] - np.pi / 2 + 0.35
        camera = Camera(np.append(pose.positions[0, :2], 0.75 * radius), azimuth, radius, 0.7)
        for order, artist in enumerate(picture.artists(pose, camera)):
            axes.add_artist(artist).set_zorder(order)
        picture.scene(axes).set(xlim=(-1.3, 1.3), ylim=(-0.95, 1.75), aspect="equal")
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
