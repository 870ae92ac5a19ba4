"""Slow passage through the critical speed: the growth rate, the delay and its law."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import (
    STEEL_DISK,
    Disk,
    Dissipation,
    Scenario,
    SmoothCoulomb,
    Start,
    ViscousFriction,
    simulate,
)
from analysis.problem.choices import SOURCES, Source
from analysis.problem.disk import STEEL_RING
from analysis.stability import spectra
from tests.helpers import mostly_slow, not_none
from validation.nonlinear import passage
from validation.nonlinear.figures import passage_diagram
from validation.nonlinear.passage import Passage, SlowPair, delay_law, follow, measure, slowed

SOON_LOST = Scenario(start=Start(beta=np.pi / 2, gamma=np.pi / 2 + 0.02, spin=20.0))


@pytest.fixture(scope="module")
def pair() -> SlowPair:
    return SlowPair.of(Scenario())


@pytest.fixture(scope="module")
def paper() -> Passage:
    return follow(Scenario(), 11.0, "in-house")


@pytest.fixture(scope="module")
def soon() -> Passage:
    return follow(SOON_LOST, 3.0, "in-house")


def test_the_growth_rate_is_the_real_part_of_the_slow_pair(pair: SlowPair) -> None:
    rates, fast = pair.rates_at(np.array((25.0, 29.5, pair.spin, 40.0)))
    assert rates == pytest.approx([0.98801, 0.11146, 0.0, -1.93133], abs=2e-4)
    assert not_none(fast)[[0, -1]] == pytest.approx([20.423, 37.204], abs=2e-3)
    # Where the pair has become two real eigenvalues, it is that of the faster one.
    slow = np.array((2.0, 5.0))
    fastest = np.max(spectra.eigenvalues(Scenario(), slow).real, axis=1)
    assert pair.rates_at(slow)[0] == pytest.approx(fastest, abs=1e-3)


def test_a_stiff_contact_has_the_slow_pair_of_the_ideal_one(pair: SlowPair) -> None:
    assert SlowPair.of(Scenario.rest()).spin == pytest.approx(pair.spin, rel=1e-5)


def test_rolling_resistance_moves_the_hopf_point_and_the_loss_is_predicted_from_there() -> None:
    loss = Dissipation(rolling_viscous=0.1, pivoting=2e-4)
    start = Start(beta=np.pi / 2, gamma=np.pi / 2 + 0.02, spin=36.0)
    # It lies flat before a slow period has passed since the loss.
    found = follow(Scenario.rest(dissipation=loss, start=start), 9.0, "in-house")
    # By matrices of the rigid contact with the moment of the resistance, in 50 digits.
    assert found["hopf"] == pytest.approx(33.342173, abs=5e-4)
    assert found["predicted"] == pytest.approx(found["lost"], rel=0.05)


@pytest.mark.parametrize("power", [0.5, 0.8])
def test_the_power_of_a_delay_is_recognised(power: float) -> None:
    rates = np.array((0.1, 0.4, 1.6))
    found = delay_law(rates, 3.0 * rates**power)
    assert found.exponent == pytest.approx(power, abs=1e-12)
    if power == 0.5:
        assert found.growth == pytest.approx(0.18370 * 9.0 / 2.0, rel=5e-3)


@pytest.mark.parametrize("rates", [[], [0.1, 0.2], [0.1, 0.2, np.nan]])
def test_a_law_of_too_few_delays_is_refused(rates: list[float]) -> None:
    with pytest.raises(ValueError, match="rates must be 3 or more"):
        delay_law(rates, [1.0] * len(rates))


@pytest.mark.slow
def test_the_eigenvalues_alone_tell_when_model_1_is_lost() -> None:
    found = follow(Scenario(), 19.0, "in-house")
    assert found["lost"] - found["crossing"] > 9.0
    assert found["predicted"] == pytest.approx(found["lost"], rel=0.06)
    # What was lost on the way in is regained on the way out.
    smallest = found["times"][np.argmin(found["linear"])]
    assert smallest == pytest.approx(found["crossing"], abs=0.01)
    assert np.min(found["deviations"]) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("source", SOURCES)
def test_a_long_stay_upright_is_lost_when_it_is_and_not_by_the_error_of_the_run(
    source: Source,
) -> None:
    found = follow(Scenario(start=Start(spin=50.0)), 30.0, source)
    # By Lagrange's equations of Model 1 typed out apart, at 1e-11 and at 3e-13.
    assert found["lost"] == pytest.approx(27.4378, abs=1e-3)


def test_nothing_is_predicted_where_inverted_spinning_is_statically_unstable() -> None:
    found = follow(Scenario(friction=ViscousFriction(viscosity=1.0)), 6.0, "in-house")
    assert found["predicted"] is found["crossing"] is found["lost"] is None
    # Its eigenvalues alone would have it lost; it settles beside.
    assert np.isnan(found["linear"]).all()
    assert found["deviations"][-1] < 1.0


@pytest.mark.parametrize("lever", mostly_slow([5e-5, 2e-5], [5e-5]))
def test_a_loss_is_predicted_whether_or_not_the_disk_spins_up_as_it_falls(lever: float) -> None:
    found = slowed(lever)
    assert found["spins"][-1] > found["lowest_spin"] + 1.0
    assert found["predicted"] == pytest.approx(found["lost"], rel=0.03)


def test_a_disk_that_spins_the_other_way_passes_alike() -> None:
    # Its mirror image in the plane of the disk has the other sign of this product of inertia.
    found, mirrored = (
        follow(
            Scenario(
                disk=replace(STEEL_DISK, inertia_yz=sense * 2e-5), start=Start(spin=sense * 36.0)
            ),
            10.0,
            "in-house",
        )
        for sense in (1.0, -1.0)
    )
    for name in ("hopf", "crossing", "lost", "lowest_spin", "rate"):
        assert mirrored[name] == pytest.approx(found[name], rel=1e-6)
    assert mirrored["linear"] == pytest.approx(found["linear"], rel=1e-3)
    assert found["rate"] > 0.0


def test_a_passage_is_the_same_in_other_units_of_length_and_time(paper: Passage) -> None:
    small = {name: 0.1 * length for name, length in STEEL_RING.items()}
    small["density"] = STEEL_RING["density"]
    faster = 10.0**0.5
    scenario = Scenario(
        disk=Disk.ring(**small),
        friction=SmoothCoulomb(smoothing=0.1 / faster),
        start=Start(spin=40.0 * faster),
    )
    found = follow(scenario, 11.0 / faster, "in-house")
    assert found["hopf"] == pytest.approx(faster * paper["hopf"], rel=1e-9)
    assert found["crossing"] == pytest.approx(paper["crossing"] / faster, rel=1e-3)
    for name in ("deviations", "linear"):
        assert found[name] == pytest.approx(paper[name], rel=1e-4)


def test_a_disk_that_is_exactly_upright_and_slow_passes_nothing_and_is_not_lost() -> None:
    found = follow(Scenario(start=Start.stationary(29.0)), 3.0, "in-house")
    assert {found[name] for name in ("crossing", "rate", "predicted")} == {None}
    assert not np.any(found["linear"])


def test_what_follows_a_loss_is_left_out(soon: Passage) -> None:
    longer = follow(SOON_LOST, 4.0, "in-house")
    assert soon["times"][-1] == pytest.approx(soon["lost"], abs=passage.SPACING)
    for name in ("lost", "predicted", "lowest_spin", "deviations"):
        assert longer[name] == pytest.approx(soon[name], rel=1e-9)


def test_beyond_a_loss_the_predicted_deviation_grows_on_at_its_last_rate(soon: Passage) -> None:
    times, grown = soon["times"], np.log(soon["linear"])
    rate = (grown[-1] - grown[-2]) / (times[-1] - times[-2])
    expected = times[-1] + (np.log(np.pi / 2) - grown[-1]) / rate
    assert soon["predicted"] == pytest.approx(expected, rel=1e-9)


def test_a_passage_does_not_depend_on_when_its_motion_begins_and_on_whole_turns(
    pair: SlowPair,
) -> None:
    motion = simulate(SOON_LOST, np.linspace(0.0, 3.0, 601), local_tolerance=1e-9)
    turned = motion.coordinates + 4.0 * np.pi * np.eye(6)[5]
    elsewhere = replace(motion, times=motion.times + 100.0, coordinates=turned)
    found, later = (measure(each, pair) for each in (motion, elsewhere))
    for name in ("lost", "predicted"):
        assert later[name] == pytest.approx(100.0 + not_none(found[name]), abs=1e-6)
    np.testing.assert_allclose(later["linear"], found["linear"], rtol=1e-6)


def test_deviations_are_drawn_below_the_spins_with_what_is_predicted_of_them(
    soon: Passage,
) -> None:
    drawn = passage_diagram([("soon", soon)]).axes
    for panel, names in zip(drawn, (("spins",), ("deviations", "linear")), strict=True):
        paths = [line.get_ydata() for line in panel.lines if len(line.get_xdata()) > 2]
        np.testing.assert_array_equal(paths, [soon[name] for name in names])


def test_a_motion_that_ends_before_it_is_lost_tells_what_a_longer_one_does_and_no_more(
    paper: Passage,
) -> None:
    found = follow(Scenario(), 10.0, "in-house")
    count = found["times"].size
    assert count < paper["times"].size
    for name in ("spins", "deviations", "linear"):
        np.testing.assert_allclose(found[name], paper[name][:count], rtol=1e-2)
    assert found["predicted"] is found["lost"] is None
    too_soon = r"must go on for 2\.18 s after the inversion at t = 0\.4"
    with pytest.raises(ValueError, match=too_soon):
        follow(Scenario(), 2.5, "in-house")


def test_a_set_without_a_slow_pair_is_refused_before_its_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr(passage, "run")
    with pytest.raises(ValueError, match="must have a Hopf point"):
        follow(Scenario(constraints=("contact", "no-slip-along", "no-slip-across")), 1.0, "engine")
