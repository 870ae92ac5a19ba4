"""The page on which the disk is spun: its code against the in-house equations, in Node."""

import json
from typing import Any

import numpy as np
import pytest

from analysis import Disk, Scenario, SmoothCoulomb, Start, simulate
from analysis.motion import frames
from tests.node import in_node, needs_node
from validation.kit.animation import play

CHOICES = [
    {"spin": 40.0, "beta": 1.57, "coefficient": 0.3, "smoothing": 0.1, "hole": 20},
    {"spin": 25.0, "beta": 1.0, "coefficient": 0.8, "smoothing": 0.02, "hole": 12},
    {"spin": 60.0, "beta": 0.3, "coefficient": 0.02, "smoothing": 0.5, "hole": 28},
]

pytestmark = needs_node


def spun(chosen: dict[str, float]) -> Any:
    return in_node("play_harness.js", play.page().text, json.dumps(chosen))


@pytest.mark.parametrize("chosen", CHOICES, ids=lambda chosen: f"{chosen['spin']:g}")
def test_disk_on_the_page_moves_as_the_equations_say(chosen: dict[str, float]) -> None:
    found = spun(chosen)
    times = np.array(found["times"])
    times = times[times <= 2.0]
    scenario = Scenario(
        disk=Disk.ring(hole_distance=1e-3 * chosen["hole"]),
        friction=SmoothCoulomb(coefficient=chosen["coefficient"], smoothing=chosen["smoothing"]),
        start=Start(spin=chosen["spin"], beta=chosen["beta"]),
    )
    run = simulate(scenario, times, tolerance=1e-8)
    columns = {name: np.array(each)[: times.size] for name, each in found["columns"].items()}
    positions, rotations = frames.poses(run.coordinates)
    quaternions = np.column_stack([columns[name] for name in ("qw", "qx", "qy", "qz")])
    turned = frames.rotations(quaternions) @ rotations.transpose(0, 2, 1)
    angles = np.arccos(np.clip((np.trace(turned, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))
    assert angles.max() < 1e-3
    centres = np.column_stack([columns[name] for name in "xyz"])
    np.testing.assert_allclose(centres, positions, atol=1e-3 * scenario.disk.radius)
    turning = run.poses.angular_velocities[:, 2]
    np.testing.assert_allclose(columns["spin"], turning, atol=1e-3 * chosen["spin"])
    assert times.size > 100


def test_page_ends_where_the_table_would_have_to_hold_the_disk_down() -> None:
    chosen = {**CHOICES[0], "spin": 150.0}
    found = spun(chosen)
    assert found["ending"] == "the table would have to hold the disk down"
    ending = simulate(Scenario(start=Start(spin=150.0, beta=1.57)), [0.0, 5.0]).ending
    assert ending is not None
    assert found["times"][-1] == pytest.approx(ending.time, abs=8e-3)
