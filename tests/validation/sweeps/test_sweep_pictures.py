"""Pictures of sweeps, and series that they keep of each motion."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from analysis import MODELS, Scenario, Start, Table, Trajectory, simulate_to_rest
from analysis.problem import limits
from tests.sweeps import sweep, swept
from validation.maps.figures import check_drawable, draw_sweep
from validation.run import run
from validation.sweeps.case import COLUMNS, WITNESS_FAILED, run_chunk, series
from validation.sweeps.plan import TIME, series_known
from validation.sweeps.results import Results
from validation.sweeps.store import Store, expected_size


def drawn(*axes: str, **how: Any) -> tuple[Figure, Results]:
    results = swept(sweep(*axes, **how))
    return draw_sweep(results), results


def test_one_axis_is_drawn_as_curves_of_the_outcomes_in_order() -> None:
    figure, results = drawn("mu=-0.1,0.1,0.4")
    # None inverts, so that there are no times.
    outcomes, spins, forces = figure.axes
    assert [each.get_text() for each in outcomes.get_yticklabels()] == ["not inverted", "refused"]
    np.testing.assert_array_equal(outcomes.lines[0].get_ydata(), [1, 0, 0])
    np.testing.assert_array_equal(spins.lines[0].get_ydata(), results.columns["spin_end"])
    for line, name in zip(forces.lines, ("force_least", "force_largest"), strict=True):
        np.testing.assert_array_equal(line.get_ydata(), results.columns[name])
    assert forces.get_xlabel() == "friction coefficient μ"


@pytest.mark.parametrize("number", [1, 4])
def test_what_is_drawn_on_a_range_is_shown_in_order(number: int) -> None:
    figure, results = drawn("spin=30:40", layout={"layout": "random", "number": number})
    spins = figure.axes[0].lines[0].get_xdata()
    np.testing.assert_array_equal(spins, np.sort(results.columns["start.spin"]))
    with pytest.raises(ValueError, match=r"^layout must be grid, got random"):
        results.on_grid("end")


def test_two_axes_are_drawn_as_a_map_with_the_last_one_to_the_right() -> None:
    axes = drawn("mu=0.1:0.4:2:log", "gamma=0:0.5:2", end=1.5, tolerance=1e-3)[0].axes[0]
    assert axes.get_xlabel() == "γ at the start in rad"
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")


@pytest.mark.parametrize("how", [{}, {"layout": "latin-hypercube", "number": 24}], ids=str)
def test_several_axes_are_drawn_in_pairs(how: dict[str, Any]) -> None:
    axes = ("spin=30:44", "mu=-0.1:0.5") if how else ("spin=30:44:2", "mu=-0.1,0.3")
    figure, _ = drawn(*axes, "gamma=-1.5,-1", layout=how, end=4.0, tolerance=1e-2)
    shares, below, listed = (figure.axes[place] for place in (0, 3, 8))
    assert below.get_ylabel() == "friction coefficient μ"
    # A case that is refused counts in no share; where nothing else is, there is a cross.
    crosses = np.asarray(below.lines[0].get_ydata(), dtype=float)
    points = np.asarray(below.collections[0].get_offsets())
    assert crosses.max() < 0.0 < points[:, 1].min()
    assert len(crosses) + len(points) == (24 if how else 4)
    # What is drawn on a range is counted in tens, a list by its values, also among drawn cases.
    assert np.size(shares.lines[0].get_xdata()) == (10 if how else 2)
    np.testing.assert_array_equal(listed.lines[0].get_xdata(), [-1.5, -1.0])


def test_values_too_near_to_be_counted_in_tens_are_counted_in_as_many_as_there_are() -> None:
    layout = {"layout": "random", "number": 30}
    figure, _ = drawn("spin=40:40.00000000000002", "mu=0.1:0.3", layout=layout, end=0.01)
    assert 1 < np.size(figure.axes[0].lines[0].get_xdata()) < 10


def test_names_are_drawn_at_their_places() -> None:
    figure, results = drawn("model=4,1", scenario=Scenario())
    spins, forces = figure.axes[-2:]
    assert [each.get_text() for each in forces.get_xticklabels()] == ["4", "1"]
    np.testing.assert_array_equal(spins.lines[0].get_xdata(), [0, 1])
    np.testing.assert_array_equal(spins.lines[0].get_ydata(), results.columns["spin_end"])


def test_pictures_of_pairs_have_no_text_over_or_outside_of_another() -> None:
    names = ("contact+constant-spin", "contact+no-slip-along")
    axes = ("mu=0.05:0.5:2:log", f"constraints={','.join(names)}")
    figure, _ = drawn(*axes, scenario=Scenario(), end=0.01)
    assert figure.get_suptitle().startswith("Sweep of several models")
    figure.draw_without_rendering()
    box = figure.texts[0].get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width
    below, last = figure.axes[2:4]
    assert {*np.asarray(below.collections[0].get_offsets())[:, 1]} == {0.0, 1.0}
    assert [each.get_text() for each in below.get_xticklabels()] == ["0.05", "0.5"]
    assert not below.get_xticklabels(minor=True)
    first, second = last.get_xticklabels()
    assert (first.get_text(), second.get_text()) == names
    # Slanted, each ends at its own tick.
    assert first.get_rotation() == second.get_rotation() == 30.0
    assert first.get_window_extent().x1 < second.get_window_extent().x1 - 10.0


def test_what_is_not_decided_counts_in_no_share() -> None:
    axes = ("mu=0.29,0.3", "alpha=0,0.1", "spin=25,40")
    figure, results = drawn(*axes, end=1.3, tolerance=1e-3)
    ends = dict(zip(results.columns["start.spin"], results.columns["inversion"], strict=True))
    assert ends == {25.0: "not inverted", 40.0: "not decided"}
    shares = figure.axes[8]
    np.testing.assert_array_equal(shares.lines[0].get_xdata(), [25.0])
    # The axis goes over all values all the same.
    assert shares.get_xlim()[1] > 40.0


def test_face_that_is_up_is_drawn_where_a_table_is_level_in_all_cases() -> None:
    leaning = Scenario.rest(table=Table(inclination=0.1))
    check_drawable(sweep("inclination=0", scenario=leaning, to_rest=True))


REDUCED = Scenario(constraints=MODELS[4])
KEEP = ("beta", "normal_force")


def motion(scenario: Scenario, **how: Any) -> Trajectory:
    times = np.linspace(0.0, 0.05, 11)
    given: dict[str, Any] = {"source": "in-house", "formulation": "reduced", "tolerance": 1e-4}
    return run(scenario, times, **(given | how))


def test_what_can_be_kept_is_all_that_a_motion_holds() -> None:
    made = motion(REDUCED)
    rest = simulate_to_rest(Scenario.rest(start=Start(spin=5.0)), 0.02, local_tolerance=1e-3)
    known, known_to_rest = (series_known(to_rest=each) for each in (False, True))
    assert [TIME, *known_to_rest] == list(rest.columns())
    # The constraints that Model 4 does not have have these forces; the first two are groups.
    absent = {"lateral_force", "tilt_torque", "coordinates", "rates"}
    assert known.keys() - made.columns().keys() == absent
    assert made.columns().keys() <= {TIME, *known}
    # They share a dataset.
    assert not {"number", *COLUMNS} & {TIME, *known, *known_to_rest}


def test_kept_series_are_those_of_the_runs_themselves_with_gaps_where_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wanted = sweep("spin=30:40:2", "mu=0.3,-0.1", keep=KEEP)
    # A sweep that goes on keeps them, too.
    swept(wanted, numbers=[0, 1])
    results = swept(wanted)
    found, made = results.series(2), motion(replace(REDUCED, start=Start(spin=40.0)))
    assert tuple(found) == (TIME, *KEEP)
    np.testing.assert_array_equal(found["time"], made.times)
    np.testing.assert_array_equal(found["beta"], made.coordinate("beta"))
    np.testing.assert_array_equal(found["normal_force"], made.normal_force)
    none = swept(replace(wanted, plan=replace(wanted.plan, keep=())), Path("b.db"), numbers=[1])
    for held, said in ((results, " of case 1"), (none, ": its sweep was told to keep none")):
        with pytest.raises(ValueError, match=f"holds no series{said}"):
            held.series(1)
    pytest.importorskip("xarray")
    with monkeypatch.context() as patched:
        # All 4 cases have 11 samples of 3 numbers, of 8 bytes each.
        patched.setattr(limits, "LARGEST_STORAGE", 4 * 11 * 3 * 8 - 1)
        with pytest.raises(ValueError, match=r"^to_xarray asks for 44 samples of 3 numbers each"):
            results.to_xarray()
    cube = results.to_xarray()
    units = {name: cube[name].attrs["units"] for name in (TIME, *KEEP, "start.spin", "end")}
    assert units == {TIME: "s", "beta": "rad", "normal_force": "N", "start.spin": "rad/s"} | {
        "end": "s"
    }
    beta = cube["beta"]
    assert beta.dims == ("start.spin", "friction.coefficient", "sample")
    assert beta.shape == (2, 2, 11)
    np.testing.assert_array_equal(beta[1, 0], found["beta"])
    assert np.all(np.isnan(beta[:, 1]))


def test_case_that_ran_again_and_failed_has_no_series() -> None:
    wanted = sweep("spin=30", keep=KEEP, witnesses=1)
    (row,) = run_chunk(wanted, [0])
    with Store(Path("a.db"), wanted) as kept:
        kept.add([row | {"other_inversion": WITNESS_FAILED}])
    assert Results.load("a.db").series(0)
    slow = replace(wanted, plan=replace(wanted.plan, time_limit=1e-9))
    with pytest.raises(ValueError, match="holds no series of case 0"):
        swept(slow, retry=True).series(0)


def test_groups_stand_for_their_series_and_absent_forces_are_left_out() -> None:
    named = sweep("spin=1,2", keep=("gamma", "coordinates", "alpha_rate")).plan.keep
    assert named == ("gamma", "x", "y", "z", "alpha", "beta", "alpha_rate")
    pushed = motion(Scenario(), formulation="index-1")
    assert set(series(pushed, ("beta", "spin_torque"))) == {TIME, "beta"}


def test_series_count_in_the_size_of_a_store() -> None:
    plain, kept = (sweep("spin=0:60:1000", end=2.0, keep=names) for names in ((), KEEP))
    assert expected_size(kept) - expected_size(plain) >= 1000 * 3 * 401 * 8
