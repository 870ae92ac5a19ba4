"""The chart over spin and friction gradient, and sensitivities."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from analysis import MODELS, STEEL_DISK, Level, Scenario
from analysis.mechanics.paper import critical_speed
from analysis.stability.chart import stability_chart, static_gradient, with_gradient
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.sensitivities import POWERS, sensitivities
from analysis.stability.spectra import eigenvalues
from tests.bodies import ELLIPSE, TIPPE_TOP

PAPER = Scenario()


def test_noninverted_spinning_is_unstable_with_every_friction() -> None:
    gradients = np.geomspace(1e-3, 1e4, 40)
    chart = stability_chart(PAPER, np.linspace(0.0, 200.0, 60), gradients, "noninverted")
    assert np.all(chart % 2 == 1)
    assert np.all(np.isnan(static_gradient(PAPER, np.linspace(0, 200, 60), "noninverted")))
    assert critical_speed(Scenario(constraints=MODELS[4]), "noninverted").kind == "saddle"


def test_chart_counts_what_the_eigenvalues_of_the_whole_system_say() -> None:
    spins, gradients = np.linspace(1.0, 59.0, 12), np.array([0.4, 1.3, 3.0])
    chart = stability_chart(PAPER, spins, gradients)
    for row, gradient in enumerate(gradients):
        scenario = with_gradient(PAPER, gradient)
        values = eigenvalues(scenario, spins, "numeric")
        np.testing.assert_array_equal(chart[row], np.sum(values.real > 1e-8, axis=1))


def crossings(scenario: Scenario, steps: Mapping[str, float]) -> tuple[Crossing, ...]:
    """Of the body with its fields times powers of e."""
    fields = {name: getattr(scenario.disk, name) * np.exp(step) for name, step in steps.items()}
    changed = replace(scenario, disk=replace(scenario.disk, **fields))
    return critical_speeds(changed, (20.0, 80.0)).crossings


UPRIGHT = replace(ELLIPSE, long_axis=0.0, inertia_xy=0.0)
MOVED = {
    "Model 1": PAPER,
    "Model 4": Scenario(constraints=MODELS[4]),
    "steep friction": with_gradient(PAPER, 1e4),
    "tippe top": Scenario(disk=TIPPE_TOP),
    "ellipse": Scenario(disk=UPRIGHT),
}


@pytest.mark.parametrize("name", MOVED)
def test_sensitivities_are_derivatives_of_the_critical_speeds(name: str) -> None:
    scenario = MOVED[name]
    # All lengths of a surface grow together.
    surface = {"radius": 1, **({"other_radius": 1} if scenario.disk == UPRIGHT else {})}
    together = {"radius": surface, "size": {**POWERS, **surface}}
    # Rounding beside steep friction shows in differences over small steps.
    step, least = (3e-3, 2e-4) if "steep" in name else (1e-4, 1e-7)
    found = [sensitivities(scenario, each) for each in crossings(scenario, {})]
    assert found
    for parameter, powers in {**{each: {each: 1} for each in POWERS}, **together}.items():
        ahead, behind = (
            [each.spin for each in crossings(scenario, {n: side * powers[n] for n in powers})]
            for side in (step, -step)
        )
        expected = np.log(np.divide(ahead, behind)) / (2.0 * step)
        assert [each[parameter] for each in found] == pytest.approx(expected, rel=1e-4, abs=least)


@pytest.mark.parametrize("level", [1, 4])
def test_sensitivities_beside_any_steep_friction_are_those_of_its_limit(level: Level) -> None:
    limit = with_gradient(Scenario(constraints=MODELS[level]), 1e3)
    expected = [sensitivities(limit, each) for each in critical_speeds(limit).crossings]
    for gradient in (2e3, 1e4, 1e5):
        steep = with_gradient(limit, gradient)
        found = [sensitivities(steep, each) for each in critical_speeds(steep).crossings]
        for one, other in zip(found, expected, strict=True):
            assert one == pytest.approx(other, abs=4e-9 * gradient + 2e-5)


def test_chart_counts_the_same_beside_any_steep_friction() -> None:
    counts = stability_chart(Scenario(), np.linspace(4.0, 54.0, 11), (1e3, 1e4, 1e5))
    assert np.max(counts) > 0
    np.testing.assert_array_equal(counts, np.broadcast_to(counts[0], counts.shape))


def test_sensitivities_need_one_eigenvalue_that_crosses_alone() -> None:
    # A centred disk spins at any gamma: one eigenvalue is always zero.
    scenario = Scenario(constraints=MODELS[4], disk=replace(STEEL_DISK, eccentricity=0.0))
    found = critical_speeds(scenario, (5.0, 80.0)).crossings
    assert found
    assert {each.kind for each in found} == {"static"}
    for each in found:
        with pytest.raises(ValueError, match=r"one eigenvalue or pair.* got 2 eigenvalues"):
            sensitivities(scenario, each)
