"""What figures share."""

from itertools import pairwise
from math import inf, nan, pi

import numpy as np
import pytest

from analysis import Disk, PenaltyContact, Scenario, Start, simulate, simulate_to_rest
from tests.helpers import not_none
from validation.display.figures import (
    LOOKS,
    against_limits,
    angle_axis,
    comparison,
    draw_still,
    draw_story,
    legend_above,
    new_figure,
)

LABELS = {
    (0.0, 0.6): ["0.0", "0.2", "0.4"],
    (-0.75 * pi, 0.75 * pi): ["−3π/4", "−π/2", "−π/4", "0", "π/4", "π/2", "3π/4"],
    (-pi, 3.25 * pi): ["−π", "0", "π", "2π", "3π"],
    (-100.0 * pi, 0.0): ["−96π", "−32π", "−16π", "0"],
}


@pytest.mark.parametrize("turned", LABELS, ids=str)
def test_angles_have_some_labels_however_far_they_turn(turned: tuple[float, float]) -> None:
    axes = new_figure()[1]
    axes.plot([0.0, 1.0], turned)
    angle_axis(axes)
    axes.figure.draw_without_rendering()
    seen = [each.get_text() for each in axes.get_yticklabels()]
    assert set(LABELS[turned]) <= set(seen)
    assert len(seen) < 14


def test_what_fails_stands_right_of_its_limit_and_what_tells_of_none_is_not_drawn() -> None:
    found = [
        ("a", 1e-3, 1e-2, True),
        ("a", 5, 5, True),
        ("a", 0.0, 1e-2, True),
        ("b", None, 1e-2, None),
        ("b", 2e-2, 1e-2, False),
        *(("c", value, 1e-2, False) for value in (inf, nan, None)),
        ("c", "other", "this", False),
    ]
    (axes,) = against_limits(found).axes
    holding, failing, limit = (
        np.array([*map(np.asarray, each.get_data())]) for each in axes.lines
    )
    assert [each.get_text() for each in axes.get_yticklabels()] == ["a", "b", "c"]
    np.testing.assert_allclose(holding, [(0.1, nan, 1e-6), (0, 0, 0)])
    np.testing.assert_allclose(failing, [(2.0, *[100.0] * 4), (-1, *[-2] * 4)])
    assert (limit[0] == 1.0).all()


def test_a_legend_of_long_names_neither_is_cut_off_nor_takes_the_axes_their_width() -> None:
    axes = new_figure()[1]
    for n in range(4):
        axes.plot([0.0, 1.0], [1.5708, 1.5709], label=f"{n}, a curve of a rather long name")
    legend_above(axes)
    axes.figure.draw_without_rendering()
    assert axes.get_legend().get_window_extent().x1 < axes.figure.bbox.width
    assert axes.get_position().width > 0.75
    # Numbers that hardly differ stand in full, rather than as what has to be added to another.
    assert axes.yaxis.get_offset_text().get_text() == ""


def test_no_two_looks_of_lines_are_alike() -> None:
    assert len({(each["color"], each["linestyle"]) for each in LOOKS}) == len(LOOKS) == 16


@pytest.mark.parametrize("start", [Start(beta=0.05), Start(beta=3.09), Start(height=0.2)], ids=str)
def test_a_still_shows_all_of_a_disk_also_of_one_that_lies_or_is_dropped(start: Start) -> None:
    scenario = Scenario(contact=PenaltyContact(stiffness=1e5), start=start)
    axes = new_figure()[1]
    draw_still(axes, scenario.disk, np.array(scenario.initial_state.coordinates))
    # Lines of the table, then the edge, the hole, the mark and two centres.
    for each in axes.lines[1:]:
        for values, (low, high) in zip(
            each.get_data(), (axes.get_xlim(), axes.get_ylim()), strict=True
        ):
            assert low < np.min(values) <= np.max(values) < high


def test_names_of_many_constraints_and_long_ones_of_files_are_not_cut_off() -> None:
    every = Scenario(
        constraints=(
            "contact",
            "no-slip-along",
            "no-slip-across",
            "constant-spin",
            "held-tilt-rate",
        )
    )
    for label in (every.name, 20 * "file_"):
        figure = comparison([(label, simulate(every, [0.0, 0.1]))])
        figure.draw_without_rendering()
        assert not_none(figure.axes[0].get_legend()).get_window_extent().x1 < figure.bbox.width
        assert figure.axes[0].get_position().width > 0.75


def test_labels_of_short_motions_and_of_small_energies_do_not_lie_on_each_other() -> None:
    disk = Disk.ring(
        radius=1e-3, hole_radius=3e-4, hole_distance=4e-4, thickness=1e-4, density=7700.0
    )
    short = simulate_to_rest(Scenario.rest(disk=disk), 0.002)
    for figure in (draw_story(short), comparison([("short", short)])):
        figure.draw_without_rendering()
        times = [each.get_window_extent() for each in figure.axes[-1].get_xticklabels()]
        assert all(left.x1 < right.x0 for left, right in pairwise(times))
    figure = draw_story(short)
    figure.draw_without_rendering()
    energies = figure.axes[3]
    power = energies.yaxis.get_offset_text()
    assert power.get_text()
    legend = not_none(energies.get_legend())
    assert not legend.get_window_extent().overlaps(power.get_window_extent())


def test_phases_that_begin_together_are_named_side_by_side() -> None:
    lying = Scenario.rest(start=Start(beta=1e-3, spin=0.0))
    motion = simulate_to_rest(lying, 0.1)
    assert motion.phases.rolling == motion.phases.flat == 0.0
    assert [each.get_text() for each in draw_story(motion).axes[0].texts] == ["rolling, flat"]
