"""Periodic motions of the reduced system: two methods, their multipliers, where they begin."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analysis import Disk, FrictionLaw, Scenario, SmoothCoulomb, Stribeck, Table, TanhCoulomb
from analysis.mechanics import reduced
from analysis.nonlinear import families, flow
from analysis.nonlinear.collocation import NoCycleError, hopf_cycle, solve
from analysis.nonlinear.families import (
    asymmetric_family,
    cycle_at,
    cycle_family,
    cycles_over,
    rotating_family,
)
from analysis.nonlinear.following import Family, events
from analysis.nonlinear.heteroclinic import heteroclinic_connection
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.motions import INVERTED, PeriodicMotion
from analysis.problem.checks import Array
from analysis.problem.disk import STEEL_RING
from analysis.stability.spectra import matrices_over_spin
from tests.helpers import model, mostly_slow, not_none

PAPER = model(4)
WEAK = model(4, friction=SmoothCoulomb(coefficient=0.1, smoothing=0.4))
"""Friction so weak and smooth that cycles lose their stability on the way."""

WEAKEST = model(4, friction=SmoothCoulomb(coefficient=0.02, smoothing=0.4))
"""So weak that the strong multiplier is no small number."""


@pytest.fixture(scope="module")
def family() -> Family:
    return cycle_family(PAPER, (0.15, 1.0, 2.0))


@pytest.fixture(scope="module")
def weak() -> Family:
    return cycle_family(WEAK, (0.5, 1.0, 1.5, 2.0, 2.5, 2.8, 3.0))


@pytest.fixture(scope="module")
def asymmetric() -> Family:
    return asymmetric_family(events(cycle_family(WEAK, (1.0, 1.7, 1.9)))[0], (2.0, 2.2, 2.4))


@pytest.fixture(scope="module")
def rotating() -> Family:
    return rotating_family(PAPER, (1e-4, 0.01, 0.08, 0.12, 0.14, 0.3))


def after_a_period(motion: PeriodicMotion, begin: Array) -> Array:
    """State of the reduced system a period after another one, shape (3,)."""
    rates, span = reduced.right_hand_side(motion.scenario, motion.spin), (0.0, motion.period)
    found = solve_ivp(rates, span, begin, method="LSODA", rtol=1e-12, atol=1e-13)
    return np.array(found.y[:, -1])


# --- Symmetric cycles ---------------------------------------------------------------------------


def multipliers_of_runs(cycle: PeriodicMotion) -> list[complex]:
    """Multipliers over `times` by rising size but for that along it, by integration."""

    def rates(_: float, values: Array) -> Array:
        right, slopes = (
            each(cycle.scenario, cycle.spin, values[:3, None])
            for each in (flow.right_hand_side, flow.jacobian)
        )
        return np.append(right, (slopes[0, :, :3] @ values[3:].reshape(3, 3)).ravel())

    begin = np.append(cycle.states[0] - INVERTED, np.eye(3))
    found = solve_ivp(
        rates, (0.0, cycle.times[-1]), begin, method="DOP853", rtol=1e-11, atol=1e-12
    )
    # The mirror image turns all deviations round.
    sign = -1.0 if cycle.ends.mirrored else 1.0
    values = np.linalg.eigvals(sign * found.y[3:, -1].reshape(3, 3))
    others = np.delete(values, np.argmin(np.abs(values - 1.0)))
    return sorted(others.tolist(), key=lambda each: (abs(each), each.imag))


def test_both_multipliers_are_those_of_the_variational_equations_over_half_a_period() -> None:
    (cycle,) = cycle_family(WEAKEST, (0.5,)).motions
    strong = -(10.0 ** (cycle.as_row()["log10_strong"] / 2.0))
    found = multipliers_of_runs(cycle)
    assert found == pytest.approx([strong, cycle.larger], rel=1e-7)
    assert cycle.stable == (max(map(abs, found)) < 1.0)


def test_either_multiplier_may_tell_that_the_stability_changes(family: Family) -> None:
    # Over half a period the smaller one has the opposite sign.
    for larger, at in ((1.3, -1.0), (-1.3, 1.0)):
        inside, outside = (
            replace(family.motions[0], larger=larger, log_strong=2.0 * np.log(size))
            for size in (0.9, 1.1)
        )
        assert inside.characteristic(at) * outside.characteristic(at) < 0.0
        assert inside.characteristic(-at) * outside.characteristic(-at) > 0.0


@pytest.mark.slow
def test_a_complex_pair_of_multipliers_is_told_whole_and_is_no_bifurcation() -> None:
    weaker = model(4, friction=SmoothCoulomb(coefficient=0.03, smoothing=0.4))
    (born,) = events(cycle_family(weaker, (0.5, 1.0, 1.5, 1.6)))
    found = asymmetric_family(born, born.motion.value + np.array((0.02, 0.1, 0.2, 0.35, 0.4)))
    before, after = found.motions[-2:]
    assert before.larger > 0.0 > after.larger
    for cycle in (before, after):
        pair = complex(cycle.larger, cycle.imaginary)
        assert multipliers_of_runs(cycle) == pytest.approx([pair.conjugate(), pair], abs=1e-6)
        assert cycle.log_strong == pytest.approx(np.log(abs(pair)), abs=1e-6)
        assert cycle.stable
    assert [each.kind for each in events(found)] == ["symmetry-breaking"]


@pytest.mark.parametrize("law", [SmoothCoulomb(), TanhCoulomb()], ids=["kink", "smooth"])
def test_growth_of_the_cycles_is_that_of_the_normal_form(law: FrictionLaw) -> None:
    scenario = replace(PAPER, friction=law)
    normal, amplitudes = hopf_type(scenario), np.arange(0.15, 1.0, 0.15)
    small = cycle_family(scenario, amplitudes).motions
    growth = not_none(fitted_growth(small, normal.spin))
    assert fitted_growth(small[:4], normal.spin) is None
    assert normal.kind == "supercritical"
    assert normal.slip < 1e-12
    assert abs(growth.curvature - normal.curvature) < 5.0 * growth.curvature_error + 1e-6
    assert abs(growth.curvature - normal.curvature) < 1e-4 * abs(normal.curvature)
    assert growth.exponent == pytest.approx(2.0, abs=1e-4)
    assert small[0].period == pytest.approx(2.0 * np.pi / normal.frequency, rel=2e-3)


def test_a_hopf_point_is_told_by_the_sign_of_its_coefficient_unless_it_is_rounding() -> None:
    normal = hopf_type(PAPER)
    kinds = [
        replace(normal, lyapunov=part * normal.frequency).kind
        for part in (-1e-3, -1e-13, 0.0, 1e-13, 1e-3)
    ]
    assert kinds == ["supercritical", *["degenerate"] * 3, "subcritical"]


@pytest.mark.slow
def test_stability_changes_where_events_are_found_and_the_spin_is_extreme_in_a_fold(
    weak: Family,
) -> None:
    found = events(weak)
    assert [each.kind for each in found] == ["symmetry-breaking", "symmetry-breaking", "fold"]
    for each, multiplier in zip(found, (-1.0, -1.0, 1.0), strict=True):
        assert each.motion.larger == pytest.approx(multiplier, abs=1e-6)
        low, high = weak.motions[int(each.place) :][:2]
        assert low.value < each.motion.value < high.value
    lost, regained, folded = (each.motion.value for each in found)
    for cycle in weak.motions:
        assert cycle.stable is not (lost < cycle.value < regained or cycle.value > folded)
    fold = found[-1].motion
    places = (fold.place_with(value=fold.value + side) for side in (-0.01, 0.01))
    before, after = (solve(fold, place).spin - fold.spin for place in places)
    assert before == pytest.approx(after, rel=0.05)
    assert before > 1e-6


@pytest.mark.parametrize("spin", [30.85, 30.916])
def test_a_cycle_at_a_spin_or_followed_over_a_parameter_is_that_of_the_family(spin: float) -> None:
    cycle = cycle_at(PAPER, spin)
    assert cycle.spin == spin
    assert solve(cycle).spin == pytest.approx(spin, rel=1e-11)
    softer = replace(PAPER, friction=SmoothCoulomb(smoothing=0.13))
    alone = cycle_family(softer, [cycle.value]).motions[0]
    followed = cycles_over([PAPER, softer], amplitude=cycle.value).motions[1]
    assert (followed.spin, followed.larger) == pytest.approx((alone.spin, alone.larger), abs=1e-8)
    held = cycles_over([PAPER, softer], spin=alone.spin).motions[1]
    assert held.value == pytest.approx(cycle.value, abs=1e-7)


@pytest.mark.slow
def test_a_large_cycle_of_another_disk_is_found_though_it_lies_far_from_the_hopf_point() -> None:
    inertia = {"inertia_x": 0.05, "inertia_y": 0.07, "inertia_z": 0.1}
    disk = Disk(mass=2.0, radius=0.3, eccentricity=0.03, **inertia)
    law = TanhCoulomb(coefficient=0.4, smoothing=0.01)
    (cycle,) = cycles_over([replace(PAPER, disk=disk, friction=law)], amplitude=2.0).motions
    # By small steps from the Hopf point.
    assert cycle.spin == pytest.approx(11.1339, abs=1e-4)


def test_a_cycle_that_ends_over_a_parameter_names_the_last_good_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(families, "_amplitudes", lambda _: np.array((0.2, 0.4)))
    # With the centre of gravity nearer to the middle the Hopf point falls below the held spin.
    nearer = replace(PAPER, disk=Disk.ring(**STEEL_RING | {"hole_distance": 0.0199}))
    found = cycles_over([PAPER, nearer], spin=30.91)
    assert len(found.motions) == 1
    assert found.reason is not None
    assert re.match(r"spin must lie between 30\.85.* and 30\.89.*, got 30\.91;", found.reason)
    assert found.reason.endswith(" at a spin of 30.91 rad/s")


def test_a_family_may_begin_with_the_motion_that_leads_to_it() -> None:
    born = hopf_cycle(PAPER).value
    told: list[tuple[float, float]] = []
    found = cycle_family(PAPER, (born, 0.1), progress=lambda *at: told.append(at))
    assert [each.value for each in found.motions] == [born, 0.1]
    assert found.reason is None
    assert told == [(1.0, 2.0), (2.0, 2.0)]


def test_cycles_may_fold_right_beside_the_hopf_point() -> None:
    disk = replace(PAPER.disk, eccentricity=0.0195)
    scenario = replace(PAPER, disk=disk, friction=SmoothCoulomb(smoothing=0.3))
    begun = cycle_family(scenario, families.AMPLITUDES[:3])
    assert [each.stable for each in begun.motions] == [False, True, True]
    ((kind, fold, _),) = events(begun)
    assert kind == "fold"
    near = cycle_family(scenario, fold.value * np.array((0.9, 1.0, 1.1))).motions
    assert fold.spin == pytest.approx(near[1].spin, abs=1e-11)
    assert fold.spin > max(near[0].spin, near[2].spin) > begun.begins + 1e-4


@pytest.mark.slow
def test_cycles_go_on_beyond_pi_where_they_come_to_no_connection_near() -> None:
    disk = replace(PAPER.disk, eccentricity=0.02)
    found = cycle_family(replace(PAPER, disk=disk, friction=SmoothCoulomb(smoothing=0.3)))
    assert not_none(found.reason).endswith(" of noninverted spinning with itself")
    # Closed by runs of other equations at 3.149 rad, which have a multiplier of 1.384.
    at = int(np.searchsorted([each.value for each in found.motions], 3.149))
    start = found.motions[at]
    cycle = solve(start, start.place_with(value=3.149))
    assert cycle.spin == pytest.approx(37.545483, abs=1e-6)
    assert cycle.larger == pytest.approx(1.384, abs=5e-3)
    assert [each.kind for each in events(found)][-3:] == ["symmetry-breaking", "fold", "fold"]


@pytest.mark.slow
def test_a_collocation_from_far_off_fails_instead_of_finding_something(family: Family) -> None:
    cycle = family.motions[1]
    with pytest.raises(NoCycleError, match="no symmetric motion of 1 rad found"):
        solve(replace(cycle, times=3.0 * cycle.times), cycle.place_with(spin=-10.0))


# --- Other kinds --------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", mostly_slow(("family", "asymmetric", "rotating"), ("family",)))
def test_motions_come_back_after_a_period_and_deviations_grow_by_the_multiplier(
    kind: str, request: pytest.FixtureRequest
) -> None:
    turn = np.array((0.0, 2.0 * np.pi * (kind == "rotating"), 0.0))
    for motion in request.getfixturevalue(kind).motions[1:]:
        begin, (times, states) = motion.states[0], motion.whole
        second = {"lowest": np.min(states[:, 1]), "largest_tilt": np.max(states[:, 0])}
        for name in second.keys() & motion.as_row():
            assert motion.as_row()[name] == pytest.approx(second[name] - np.pi / 2)
        end = partial(after_a_period, motion)
        np.testing.assert_allclose(end(begin) - turn, begin, rtol=0.0, atol=1e-7)
        np.testing.assert_allclose(states[-1] - turn, begin, rtol=0.0, atol=1e-9)
        assert times[-1] == pytest.approx(motion.period)
        along = np.array(reduced.solver(motion.scenario, motion.spin)(*begin.tolist())[:3])
        deviation, sizes = np.array((1e-5, 0.0, 0.0)), []
        for _ in range(2):
            deviation = (end(begin + deviation) - end(begin - deviation)) / 2
            deviation -= along * (along @ deviation) / (along @ along)
            sizes.append(float(np.linalg.norm(deviation)))
        assert sizes[1] / sizes[0] == pytest.approx(abs(motion.multiplier), rel=2e-3)


@pytest.mark.slow
def test_cycles_without_symmetry_leave_symmetric_ones_until_their_period_doubles(
    asymmetric: Family,
) -> None:
    assert [each.stable for each in asymmetric.motions] == [True, True, False]
    born, (kind, cycle, _) = events(asymmetric)
    assert (born.kind, kind) == ("symmetry-breaking", "period-doubling")
    near = asymmetric_family(born, (born.motion.value + 0.02,)).motions[0]
    # Growing with the amplitude, the asymmetry begins in the bifurcation.
    assert near.value + near.lowest == pytest.approx(0.04, abs=2e-3)
    assert near.spin == pytest.approx(born.motion.spin, abs=1e-3)
    assert cycle.multiplier == pytest.approx(-1.0, abs=1e-6)
    assert cycle.spin == pytest.approx(29.9690, abs=1e-4)


def falling(smoothing: float) -> Scenario:
    """Friction that falls so soon that motions may grow over a turn."""
    law = Stribeck(static=0.3, kinetic=0.05, stribeck_speed=0.02, smoothing=smoothing)
    return model(4, friction=law)


@pytest.mark.slow
def test_a_complex_pair_that_passes_the_unit_circle_is_a_torus() -> None:
    found = rotating_family(falling(0.0585), (0.2522, 0.2532))
    ((kind, torus, _),) = events(found)
    assert kind == "torus"
    # By shooting with other equations.
    assert (torus.value, torus.spin) == pytest.approx((0.252553, 29.9898), abs=5e-5)
    assert np.abs(multipliers_of_runs(torus)) == pytest.approx([1.0, 1.0], abs=1e-5)
    assert [each.stable for each in found.motions] == [False, True]


@pytest.mark.slow
def test_a_family_that_folds_does_not_leap_to_where_it_comes_back() -> None:
    found = rotating_family(falling(0.1), (0.135, 0.155, 0.175, 0.2))
    # By small steps of pseudo-arclength, it turns back at 0.15306 rad and 29.528 rad/s.
    assert [each.value for each in found.motions] == pytest.approx([0.155, 0.175, 0.2])
    assert not_none(found.reason)


@pytest.mark.whole
def test_cycles_without_symmetry_pass_the_fold_of_their_amplitude_to_other_symmetric_ones() -> (
    None
):
    scenario = model(4, friction=SmoothCoulomb(smoothing=1.0))
    found = events(cycle_family(scenario, (1.0, 1.8, 2.0, 2.6, 2.8)))
    (lost, regained) = (each for each in found if each.kind == "symmetry-breaking")
    family = asymmetric_family(lost)
    last, values = family.motions[-1], [each.value for each in family.motions]
    assert not_none(family.reason).endswith("it is a symmetric one")
    assert lost.motion.value < last.value < max(values) - 0.2
    # Symmetric cycles have the end alone: the family has come to it through its fold.
    assert last.spin == pytest.approx(regained.motion.spin, abs=1e-3)
    assert -last.lowest == pytest.approx(last.value, abs=0.02)
    assert last.multiplier == pytest.approx(1.0, abs=0.01)
    assert [each.kind for each in events(family)[1:]] == ["period-doubling"] * 2


@pytest.mark.whole
@pytest.mark.parametrize(
    ("follow", "end", "value"),
    [(cycle_family, -1, "last_amplitude"), (rotating_family, 0, "least_tilt")],
)
def test_motions_of_weak_friction_wind_through_folds_into_the_connection(
    follow: Callable[[Scenario], Family],
    end: int,
    value: str,
) -> None:
    scenario = model(4, friction=SmoothCoulomb(coefficient=0.05, smoothing=0.4))
    family, connection = follow(scenario), heteroclinic_connection(scenario)
    last, spins = family.motions[end], [each.spin for each in family.motions]
    assert not_none(family.reason).endswith(" of noninverted spinning with itself")
    # That is found from runs alone.
    assert last.spin == pytest.approx(connection.spin, abs=1e-7)
    assert last.value == pytest.approx(getattr(connection, value), abs=2e-5)
    assert np.sum(np.diff(np.sign(np.diff(spins))) != 0.0) > 5


@pytest.mark.slow
def test_a_cycle_is_found_at_a_spin_that_folds_between_two_of_the_family() -> None:
    law = TanhCoulomb(coefficient=0.1, smoothing=0.3)
    scenario = model(4, friction=law, table=Table(gravity=3.7))
    cycle = cycle_at(scenario, 18.084)
    assert cycle.spin == pytest.approx(18.084, abs=1e-12)
    # Between those at 2.82 and 2.825 rad by shooting with independent equations.
    assert 2.82 < cycle.value < 2.825


@pytest.mark.whole
def test_motions_of_weaker_friction_rotate_from_a_connection_of_inverted_spinning_on() -> None:
    family = rotating_family(WEAKEST)
    assert not_none(family.reason).endswith(" of inverted spinning with itself")

    def passes(spin: float) -> float:
        """To which side a motion leaves inverted spinning a turn before, backwards in time."""
        (matrix,) = matrices_over_spin(WEAKEST, "reduced")(np.array([spin]))
        values, vectors = np.linalg.eig(matrix)
        strong = vectors[:, np.argmin(values.real)].real
        rates = reduced.right_hand_side(WEAKEST, spin)

        def left(time: float, state: Array) -> float:
            return abs(state[1] + 1.5 * np.pi) - 1.0 if time > 2.1 else -1.0

        left.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            lambda time, state: -np.array(rates(time, state)),
            (0.0, 10.0),
            INVERTED - 1e-6 * strong / strong[1],
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
            events=left,
        )
        return float(found.y[1, -1] + 1.5 * np.pi)

    spin = family.motions[0].spin
    assert [passes(spin + side) for side in (-1e-6, 1e-6)] == pytest.approx([-1.0, 1.0])


@pytest.mark.slow
def test_rotating_motions_begin_in_the_connection_and_fold(rotating: Family) -> None:
    assert rotating.reason is None
    assert rotating.motions[0].spin == pytest.approx(rotating.begins, abs=1e-6)
    assert [each.stable for each in rotating.motions] == [True, True, True, True, False, False]
    ((kind, fold, _),) = events(rotating)
    assert kind == "fold"
    assert fold.multiplier == pytest.approx(1.0, abs=1e-6)
    assert fold.spin == pytest.approx(30.0820066, abs=1e-6)
    assert all(each.spin > fold.spin for each in rotating.motions)


@pytest.mark.slow
def test_rotating_motions_begin_with_a_tilt_where_the_connection_swings_beyond() -> None:
    scenario = model(4, friction=SmoothCoulomb(smoothing=1.0))
    least = heteroclinic_connection(scenario).least_tilt
    found = rotating_family(scenario, least + np.array((1e-4, 0.1)))
    assert found.reason is None
    assert 0.0 < found.begins - found.motions[0].spin < 1e-4
    assert found.motions[0].period > 2.0 * found.motions[1].period
    with pytest.raises(ValueError, match=r"tilts must rise strictly between 0\.0996"):
        rotating_family(scenario, (0.09, 0.2))
