"""The disk until rest: agreement before the fall, energy, either face, phases, endings."""

from dataclasses import replace
from itertools import pairwise
from math import log2, pi
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mbs_models
from analysis import (
    CENTRED_DISK,
    STEEL_DISK,
    Disk,
    Dissipation,
    PenaltyContact,
    RestCriterion,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Sphere,
    Start,
    State,
    Table,
    TimeLimitError,
    ToleranceError,
    Trajectory,
    outcomes,
    simulate,
    simulate_to_rest,
)
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES, Source
from analysis.simulation.to_rest import REST_METHODS, RestMethod
from analysis.solve.until_rest import until_agreement
from tests.bodies import of_six
from tests.helpers import angles_apart, mostly_slow, not_none, reaching
from validation.run import run_to_rest

SETTLING = Dissipation(rolling_viscous=2e-3, pivoting=2e-4)


@pytest.fixture(scope="module")
def settled() -> SpatialMotion:
    return simulate_to_rest(Scenario.rest(dissipation=SETTLING), 60.0, local_tolerance=1e-10)


def standing(stiffness: float, half_thickness: float) -> Trajectory:
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    return simulate_to_rest(Scenario.rest(contact=contact), 1.0, spacing=1e-2).to_trajectory()


def test_inversion_tends_to_that_of_model_1_and_to_that_of_a_thin_disk() -> None:
    ideal = Scenario(friction=SmoothCoulomb(load="contact"))
    model_1 = simulate(ideal, np.linspace(0.0, 1.0, 101), local_tolerance=1e-11)
    stiffer = [standing(stiffness, half_thickness=1e-6) for stiffness in (2e5, 4e5, 8e5)]
    thinner = [standing(2e5, half_thickness) for half_thickness in (4e-4, 2e-4, 1e-4)]
    for runs, limit, order, last in ((stiffer, model_1, 1, 1e-5), (thinner, stiffer[0], 2, 2e-5)):
        errors = [angles_apart(run, limit) for run in runs]
        assert errors[-1] < last
        for coarse, fine in pairwise(errors):
            assert log2(coarse / fine) == pytest.approx(order, abs=0.05)


def test_motion_ends_where_the_disk_is_at_rest(settled: SpatialMotion) -> None:
    ending = not_none(settled.ending)
    assert ending.reason == "at rest"
    assert ending.time == settled.times[-1]
    assert ending.value == pytest.approx(settled.energies[-1, 0], rel=1e-6, abs=1e-15)
    assert settled.rest_time == pytest.approx(settled.times[-1] - 0.1, abs=1e-9)
    # On a spheroid the disk lies still with its centre of gravity over the contact point.
    disk, contact = settled.scenario.disk, settled.scenario.penalty_contact
    balance = disk.eccentricity * contact.half_thickness / disk.radius**2
    assert settled.leaning[-1] == pytest.approx(balance, rel=0.05)
    assert settled.normal_force[-1] == pytest.approx(settled.scenario.weight, rel=1e-3)


def test_a_disk_lies_at_rest_by_its_own_measures() -> None:
    # With a hundredth of the usual criterion's energy, this one still spins on its face.
    tiny = Disk.ring(
        radius=2e-3, hole_radius=6e-4, hole_distance=8e-4, thickness=2e-4, density=1200.0
    )
    scenario = Scenario.rest(
        disk=tiny,
        contact=PenaltyContact.rounded(tiny, stiffness=1e3, half_thickness=2e-5),
        dissipation=Dissipation(rolling_viscous=1e-3),
        start=Start(beta=1e-3, spin=15.0, gamma_rate=0.0),
    )
    spinning = simulate_to_rest(scenario, 0.5)
    assert spinning.rest_time is None
    assert spinning.spin[-1] == pytest.approx(15.0, rel=1e-3)
    # The centre of gravity near the edge, it lies where it leans by more than a usual flat disk.
    e, c = 0.0425, 2e-4
    heavy = of_six(0.045, 0.44, e, 1e-4, 0.44 * e**2 + 1e-4, 0.44 * e**2 + 2e-4)
    loss = Dissipation(rolling_viscous=5e-3, pivoting=1e-3)
    start = Start(beta=0.2, spin=3.0)
    lying = simulate_to_rest(Scenario.rest(disk=heavy, dissipation=loss, start=start), 2.0)
    assert not_none(lying.phases.flat) < not_none(lying.phases.rest)
    lean = e * c / (0.045 * np.sqrt(0.045**2 - e**2))
    assert lying.leaning[-1] == pytest.approx(lean, rel=1e-2)


@pytest.mark.parametrize("source", mostly_slow(SOURCES, ["in-house"]))
def test_a_tippe_top_lies_still_on_a_leaning_table_where_it_is_balanced(source: Source) -> None:
    top = of_six(0.02, 0.02, 3e-3, 2e-6, 3e-6, 3e-6, kind=Sphere)
    scenario = Scenario.rest(
        disk=top,
        table=Table(inclination=0.02),
        friction=SmoothCoulomb(smoothing=3e-4, load="contact"),
        dissipation=Dissipation(rolling_viscous=0.5, pivoting=1e-3),
        start=Start(beta=pi / 2, gamma=-1.5, spin=1.0),
    )
    motion = run_to_rest(scenario, 6.0, source=source)
    assert not_none(motion.ending).reason == "at rest"
    # By statics, the centre of gravity is above the contact point.
    turned = np.arcsin(top.radius * np.sin(0.02) / top.eccentricity)
    rise = motion.cog_height[-1] - (top.radius - top.eccentricity)
    assert 0.5 < rise / (top.eccentricity * (1.0 - np.cos(turned))) < 1.1


def test_error_between_samples_covers_a_touch_down() -> None:
    start = Start(beta=0.567, gamma=-1.604, spin=-51.99, beta_rate=1.123, gamma_rate=12.37)
    scenario = Scenario.rest(start=start)
    usual = simulate_to_rest(scenario, 0.2)
    fine = simulate_to_rest(scenario, 0.2, spacing=2e-4, tolerance=1e-6)
    with pytest.raises(ToleranceError, match=r"the samples around t = 0\.05"):
        usual.resampled(fine.times)
    between = usual.resampled(fine.times, tolerance=1.0)
    off = np.linalg.norm(between.rotations - fine.rotations, axis=(1, 2)) / np.sqrt(2.0)
    assert 1e-3 < off.max() < not_none(between.error_estimate)


def test_rest_may_have_to_last_longer_than_the_stretches_of_a_run() -> None:
    loss = Dissipation(rolling_viscous=5e-3, pivoting=1e-3)
    scenario = Scenario.rest(dissipation=loss, start=Start(beta=0.05, spin=0.0))
    short, long = (
        simulate_to_rest(scenario, 7.0, spacing=1e-2, local_tolerance=1e-8, criterion=criterion)
        for criterion in (None, RestCriterion(duration=3.5))
    )
    assert long.rest_time == short.rest_time is not None
    assert long.times[-1] == pytest.approx(not_none(long.rest_time) + 3.5)


def test_phases_follow_each_other_from_the_first_samples_at_which_they_hold(
    settled: SpatialMotion,
) -> None:
    times, contact, disk = settled.times, settled.scenario.penalty_contact, settled.scenario.disk
    phases = settled.phases
    order = (phases.inversion, phases.inversion_lost, phases.rolling, phases.flat, phases.rest)
    assert list(order) == sorted(map(not_none, order))
    assert phases.inversion == settled.inversion_time
    (row,) = outcomes([settled]).rows()
    told = ("inverted_at", "lost_at", "rolling_from", "flat_from", "rest_from")
    assert tuple(row[name] for name in told) == order
    assert row["lost_at_error"] == settled.inversion.lost_error

    def mean(speeds: Array, around: float) -> float:
        ends = np.clip([around - 0.25, around + 0.25], times[0], times[-1])
        inside = times[(times > ends[0]) & (times < ends[1])]
        places = np.concatenate((ends[:1], inside, ends[1:]))
        return float(np.trapezoid(np.interp(places, times, speeds), places) / np.ptp(ends))

    def is_rolling(time: float) -> bool:
        return mean(settled.slip_speeds, time) < 0.1 * mean(settled.contour_speeds, time)

    flat = settled.leaning < np.arctan(2.0 * contact.half_thickness / disk.radius)
    first = int(np.searchsorted(times, not_none(phases.flat)))
    assert np.all(flat[first:])
    assert not flat[first - 1]
    begin = int(np.searchsorted(times, not_none(phases.rolling)))
    assert not is_rolling(times[begin - 1])
    assert all(map(is_rolling, times[begin : first + 1 : 20]))


@pytest.mark.parametrize("method", REST_METHODS)
@pytest.mark.parametrize(
    ("contact", "start"),
    [
        (PenaltyContact.damped(1e7, STEEL_DISK, ratio=2.0, half_thickness=2e-4),
         Start(beta=0.3, spin=20.0, height=0.03)),
        (PenaltyContact(stiffness=1e5, damping=800.0, half_thickness=1e-3),
         Start(beta=1.2, spin=1.0, height=0.01)),
    ],
    ids=["hard", "soft"],
)  # fmt: skip
def test_a_touch_down_too_hard_for_the_shortest_steps_ends_no_run(
    contact: PenaltyContact, start: Start, method: RestMethod
) -> None:
    drop = Scenario.rest(contact=contact, start=start)
    # It touches down after 0.067 s or 0.045 s.
    fine, coarse = (
        simulate_to_rest(drop, 0.07, method=each, local_tolerance=local, time_limit=60.0)
        for each, local in ((method, 1e-13), ("LSODA", 1e-10))
    )
    assert fine.ending is None
    assert fine.deviation(coarse) < 1e-7


@pytest.mark.parametrize(("part", "is_ever_flat"), [(0.9999, False), (0.5, True)])
def test_what_is_too_thick_to_lie_is_never_flat(part: float, is_ever_flat: bool) -> None:
    contact = PenaltyContact.rounded(STEEL_DISK, half_thickness=part * STEEL_DISK.radius)
    start = Start(spin=0.0, beta=0.3, gamma=-pi / 2)
    motion = simulate_to_rest(Scenario.rest(contact=contact, start=start), 0.02)
    assert (motion.phases.flat is not None) == is_ever_flat


def off(motion: SpatialMotion, part: float) -> SpatialMotion:
    """A motion that has lost another part of its energy."""
    return replace(motion, dissipated=motion.dissipated + part * motion.energies[0].sum())


def estimate(tolerance: float, *motions: SpatialMotion) -> float:
    """Estimated error of the first of some runs in turn that agrees with the one before."""
    turns = iter(motions)
    return not_none(until_agreement(lambda _: next(turns), tolerance).error_estimate)


def test_runs_that_disagree_or_agree_by_chance_are_no_result(settled: SpatialMotion) -> None:
    with pytest.raises(ToleranceError, match=r"2\.0e-01, 1\.0e-01, 5\.0e-02, the last two by 5e"):
        estimate(1e-3, *(off(settled, part) for part in (0.8, 0.4, 0.2, 0.1, 0.05)))
    # The whole difference is the estimate.
    for parts, last in (((3e-3, 1.5e-3, 0.75e-3), 7.5e-4), ((0.0, 1e-4, 5e-3, 4.9e-3), 4.9e-4)):
        assert estimate(1e-3, *(off(settled, part) for part in parts)) == pytest.approx(last)
    # At its time limit a run tells how far it is from the one before.
    limit = replace(not_none(settled.ending), reason="time limit")
    limited = replace(settled, ending=limit)
    assert estimate(1e-6, off(settled, 0.1), limited) == pytest.approx(0.1)


def later(motion: SpatialMotion, time: float) -> SpatialMotion:
    """A motion whose last sample and ending come later."""
    times = np.append(motion.times[:-1], motion.times[-1] + time)
    ending = replace(not_none(motion.ending), time=float(times[-1]))
    return replace(motion, times=times, ending=ending)


def test_deviation_is_that_of_the_vertical_or_of_an_energy(settled: SpatialMotion) -> None:
    for turn, expected in (([0.0, 0.0, 0.3], 0.0), ([2e-3, 0.0, 0.0], 2e-3)):
        turned = Rotation.from_rotvec(turn) * Rotation.from_matrix(settled.rotations)
        other = replace(settled, quaternions=turned.as_quat(scalar_first=True))
        assert settled.deviation(other) == pytest.approx(expected, rel=1e-5, abs=1e-12)
    energies = settled.energies.copy()
    energies[-1, 1] += 0.01 * energies[0].sum()
    assert settled.deviation(replace(settled, energies=energies)) == pytest.approx(0.01)
    with pytest.raises(ValueError, match=r"other must be sampled at the same times, got t = 0\.1"):
        settled.deviation(settled.resampled(np.linspace(0.0, 1.0, 11)))


@pytest.mark.parametrize(
    ("source", "how", "limit"),
    [("in-house", {}, 4000.0), ("engine", {"step": 1e-4}, 2500.0), ("engine", {}, 150.0)],
)
def test_time_limit_ends_runs_with_what_they_reached(
    source: Source, how: dict[str, Any], limit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter(range(10**9))
    monkeypatch.setattr("analysis.solve.watch.time.process_time", lambda: float(next(clock)))
    told: list[tuple[float, float]] = []
    how = how | {"time_limit": limit, "progress": lambda *reached: told.append(reached)}
    found = run_to_rest(Scenario.rest(), 5.0, source=source, **how)
    ending = not_none(found.ending)
    assert ending.reason == "time limit"
    assert ending.value > limit
    assert ending.time == found.times[-1] < 5.0
    assert {end for _, end in told} == {5.0}
    assert max(told)[0] >= ending.time > 0.1
    assert found.rest_time is found.error_estimate is None
    with pytest.raises(TimeLimitError, match="before the first sample"):
        run_to_rest(Scenario.rest(), 5.0, source=source, time_limit=1e-9)


def test_flat_motion_has_no_trajectory_but_its_beginning_has(settled: SpatialMotion) -> None:
    with pytest.raises(ValueError, match="end must lie before the disk lies flat"):
        settled.to_trajectory()
    begin = settled.to_trajectory(1.0)
    np.testing.assert_allclose(begin.coordinate("beta"), settled.tilt[: begin.times.size])


def test_turns_of_a_nearly_flat_disk_are_told_by_close_samples_alone() -> None:
    smooth = SmoothCoulomb(coefficient=0.0, load="contact")
    contact = PenaltyContact(stiffness=1e5, half_thickness=2e-4)
    start = Start(beta=1.0, spin=0.5, gamma_rate=0.0)
    scenario = Scenario.rest(disk=CENTRED_DISK, friction=smooth, contact=contact, start=start)
    close, coarse = (
        simulate_to_rest(scenario, 0.2, spacing=spacing, local_tolerance=1e-10)
        for spacing in (5e-4, 1e-2)
    )
    expected = simulate(scenario, close.times, local_tolerance=1e-10).coordinates
    np.testing.assert_allclose(close.to_trajectory().coordinates, expected, atol=1e-3)
    assert np.ptp(expected[:, 3]) > 3.0 * pi
    with pytest.raises(ValueError, match="before alpha and gamma may turn unseen between two"):
        coarse.to_trajectory()


@pytest.mark.parametrize("disk", [STEEL_DISK, CENTRED_DISK])
@pytest.mark.parametrize(("tilt", "gamma"), [(0.0, -pi / 2), (1e-12, pi / 2), (1e-5, pi / 2)])
def test_disk_balanced_on_its_rim_is_not_at_rest(disk: Body, tilt: float, gamma: float) -> None:
    start = Start(beta=pi / 2 - tilt, gamma=gamma, spin=0.0)
    scenario = Scenario.rest(disk=disk, start=start)
    assert simulate_to_rest(scenario, 0.5, spacing=1e-2).rest_time is None


def test_disk_slides_down_a_slope_until_friction_carries_it() -> None:
    # The regularised law never sticks: the slope makes it creep at a speed that can be told.
    lean, friction = 0.035, SmoothCoulomb(load="contact")
    slope = Table(inclination=lean, downhill=0.7)
    start = Start(beta=0.005, gamma=-pi / 2, spin=0.0, alpha=0.3)
    low = Scenario.rest(friction=friction, table=slope, start=start, dissipation=SETTLING)
    motion = simulate_to_rest(low, 3.0, spacing=1e-2, tolerance=1e-4)
    assert np.max(np.abs(motion.energy_residual)) < 1e-5 * motion.energies[0].sum()
    creep = friction.smoothing * np.tan(lean) / (friction.coefficient - np.tan(lean))
    expected = creep * np.array([np.cos(0.7), np.sin(0.7), 0.0])
    np.testing.assert_allclose(motion.velocities[-1], expected, rtol=0.0, atol=1e-3 * creep)


SCENARIO = Scenario.rest(start=Start(spin=40.0))
LIMIT = 1.6
TILTED = reaching("beta", LIMIT)


@pytest.fixture(scope="module")
def ended() -> SpatialMotion:
    return simulate_to_rest(SCENARIO, 0.3, tolerance=1e-3, stop_when=TILTED)


def test_a_condition_is_told_the_state_in_the_papers_coordinates() -> None:
    told: list[State] = []

    def turned(state: State) -> float:
        told.append(state)
        return 1.0 - state.coordinates[3]

    how: dict[str, Any] = {"stop_when": turned, "local_tolerance": 1e-9}
    last = simulate_to_rest(SCENARIO, 0.1, **how).to_trajectory().state(-1)
    np.testing.assert_allclose(told[-1].coordinates, last.coordinates, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(told[-1].rates, last.rates, rtol=1e-9, atol=1e-9)


def test_motion_in_the_papers_coordinates_keeps_its_ending_and_its_error(
    ended: SpatialMotion,
) -> None:
    run = ended.to_trajectory()
    assert run.ending == ended.ending
    # It is of the vertical's direction, which gamma moves by the sine of the tilt.
    steepest = not_none(ended.error_estimate) / np.sin(ended.leaning.min())
    assert run.error_estimate == pytest.approx(steepest)
    assert ended.to_trajectory(0.5 * ended.times[-1]).ending is None


@pytest.fixture(scope="module")
def truth() -> float:
    """Time at which the disk of `SCENARIO` is `TILTED`, by another solver in short steps."""
    how: dict[str, Any] = {"method": "DOP853", "spacing": 1e-3, "local_tolerance": 1e-12}
    return not_none(simulate_to_rest(SCENARIO, 0.1, stop_when=TILTED, **how).ending).time


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("spacing", [0.002, 0.1])
@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-6, None], [1e-3, None]))
def test_ending_does_not_depend_on_how_far_apart_the_samples_are(
    source: Source, spacing: float, tolerance: float | None, truth: float
) -> None:
    how: dict[str, Any] = {"step": 5e-5} if source == "engine" else {"local_tolerance": 1e-10}
    if tolerance is not None:
        how = {"tolerance": tolerance}
    motion = run_to_rest(SCENARIO, 0.1, source=source, spacing=spacing, stop_when=TILTED, **how)
    ending = not_none(motion.ending)
    assert (ending.reason, ending.time) == (TILTED.__name__, motion.times[-1])
    assert ending.value == 0.0
    assert motion.rest_time is None
    assert abs(ending.time - truth) <= (motion.error_estimate or 1e-7)
    assert motion.tilt[-1] == pytest.approx(LIMIT, abs=1e-9)
    np.testing.assert_allclose(motion.times[:-1], spacing * np.arange(motion.times.size - 1))


def test_estimate_covers_the_time_of_an_ending_but_rest_which_both_runs_must_have(
    settled: SpatialMotion, ended: SpatialMotion
) -> None:
    assert estimate(1e-3, settled, later(settled, 2e-3)) < 1e-9
    # Both end at the same tilt: by the states alone, they would not differ.
    moved = 1e-5 * float(np.hypot(*ended.angular_velocities[-1, :2]))
    expected = pytest.approx(max(moved, 1e-5), rel=1e-6)
    assert estimate(1.0, ended, later(ended, 1e-5)) == expected
    # What is left at the ending counts, too.
    taken = ended.dissipated.copy()
    taken[-1] += 1e-4 * ended.energies[0].sum()
    ahead = replace(later(ended, 1e-5), dissipated=taken)
    assert estimate(1.0, ended, ahead) == pytest.approx(1e-4 + 1e-5)
    with pytest.raises(ToleranceError, match="differ by inf"):
        estimate(1.0, *[ended, replace(ended, ending=None)] * 5)


ROLLING_LOW = Scenario.rest(
    dissipation=Dissipation(rolling_viscous=5e-3, pivoting=1e-3), start=Start(beta=0.1, spin=0.0)
)


def nearly_flat(state: State) -> float:
    beta = state.coordinates[4]
    return min(beta, pi - beta) - 1e-4


FINELY: dict[Source, Any] = {"in-house": {"local_tolerance": 1e-9}, "engine": {"step": 2e-5}}


@pytest.mark.parametrize("source", FINELY)
def test_a_condition_that_is_met_for_less_than_a_sample_ends_the_motion(source: Source) -> None:
    fine: dict[str, Any] = {"local_tolerance": 1e-11, "spacing": 2e-5}
    low = simulate_to_rest(ROLLING_LOW, 0.05, **fine)
    below = low.times[low.leaning < 1e-4]
    # Twenty steps of those below, and not one sample.
    assert 3e-4 < np.ptp(below) < 5e-4
    how = FINELY[source] | {"source": source}
    motion = run_to_rest(ROLLING_LOW, 0.05, stop_when=nearly_flat, **how)
    assert not_none(motion.ending).time == pytest.approx(below[0], abs=2e-5)


@pytest.mark.parametrize("source", FINELY)
def test_rest_ends_a_motion_before_a_condition_that_is_met_later(source: Source) -> None:
    patient = RestCriterion(energy=1.0, height=1.0, duration=0.03)
    simulated = simulate_to_rest if source == "in-house" else mbs_models.simulate_to_rest
    how = FINELY[source] | {"criterion": patient}
    motion = simulated(ROLLING_LOW, 0.05, stop_when=nearly_flat, **how)
    assert motion.rest_time == 0.0
    assert (not_none(motion.ending).reason, motion.times[-1]) == ("at rest", pytest.approx(0.03))


@pytest.mark.parametrize(("part", "rests"), [(0.99, False), (1.01, True)])
def test_heights_at_rest_are_told_in_radii(part: float, *, rests: bool) -> None:
    contact, weight = ROLLING_LOW.penalty_contact, ROLLING_LOW.weight
    falling = simulate_to_rest(ROLLING_LOW, 0.01)
    rise = falling.cog_height[0] - contact.resting_height(STEEL_DISK, weight)
    height = part * rise / STEEL_DISK.radius
    criterion = RestCriterion(energy=1.0, height=height, duration=0.01)
    motion = simulate_to_rest(ROLLING_LOW, 0.02, criterion=criterion)
    assert (motion.rest_time == 0.0) == rests


@pytest.mark.parametrize(
    ("source", "how"), [("in-house", {}), ("engine", {}), ("engine", {"step": 1e-4})]
)
def test_errors_on_a_leaning_table_do_not_depend_on_the_place(
    source: Source, how: dict[str, Any]
) -> None:
    slope = Table(inclination=0.3)
    starts = (Start(beta=0.8, spin=0.0, x=x, y=0.0, x_rate=0.0, y_rate=0.0) for x in (0.0, 0.5))
    here, there = (
        run_to_rest(Scenario.rest(table=slope, start=start), 0.1, source=source, **how)
        for start in starts
    )
    # From the first place on, it has less energy than nothing.
    assert there.energies[0].sum() < 0.0 < here.energies[0].sum()
    assert there.starting_energy == pytest.approx(here.starting_energy, rel=1e-12)
    if here.error_estimate is not None:
        assert there.error_estimate == pytest.approx(here.error_estimate, rel=0.01)
