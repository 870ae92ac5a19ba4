"""Pictures and the report's section on nonlinear dynamics."""

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes

from analysis import Scenario, SmoothCoulomb
from analysis.nonlinear.family import CycleFamily, cycle_family
from analysis.nonlinear.heteroclinic import Connection, NoConnectionError
from tests.helpers import model
from validation.kit.figures import new_figure
from validation.studies.nonlinear import figures, portraits, section
from validation.studies.nonlinear.passage import DelayLaw

PAPER = model(4)


@pytest.fixture(scope="module")
def family() -> CycleFamily:
    """Of friction so weak and smooth that its larger cycles are unstable."""
    weak = SmoothCoulomb(coefficient=0.1, smoothing=0.4)
    return cycle_family(model(4, friction=weak), (0.5, 1.2, 1.7, 1.9))


def lines(axes: Axes, style: str) -> list[Any]:
    return [line for line in axes.get_lines() if line.get_linestyle() == style]


def test_stable_cycles_are_solid_and_unstable_ones_dashed(family: CycleFamily) -> None:
    axes = new_figure()[1]
    figures.family_lines(axes, family, family.values("amplitude"), 0.0)
    (solid,), (dashed,) = lines(axes, "-"), lines(axes, "--")
    np.testing.assert_equal(solid.get_ydata(), [0.0, 0.5, 1.2, 1.7, np.nan])
    np.testing.assert_equal(dashed.get_ydata(), [np.nan, np.nan, np.nan, 1.7, 1.9])


def test_the_diagram_holds_engine_connection_and_hopf_point(family: CycleFamily) -> None:
    axes = figures.bifurcation_diagram(
        family, connection=29.9, slow=[(30.0, 1.0), (30.5, 0.5)], engine=[(30.2, 0.9)]
    )
    shown = {text.get_text() for text in axes.get_legend().get_texts()}
    assert {"engine", "heteroclinic", "slow manifold", "Hopf point"} <= shown
    assert axes.get_xlim()[0] < 29.9 < family.hopf.spin < axes.get_xlim()[1]
    panels = figures.period_diagram(family, connection=29.9)
    assert len(panels) == 3


@pytest.mark.slow
def test_above_the_hopf_point_the_unstable_manifold_leads_to_inverted_spinning() -> None:
    found = portraits.portrait(PAPER, 33.0)
    assert found.cycle is None
    for curve in found.unstable:
        assert abs(abs(curve[0, 0] - np.pi / 2) - np.pi) < 0.01
        np.testing.assert_allclose(curve[-1], np.pi / 2, atol=0.3)
    # What ends in noninverted spinning separates what inverts from what falls.
    for curve in found.stable:
        assert abs(abs(curve[0, 0] - np.pi / 2) - np.pi) < 0.01
    axes = portraits.draw([found])
    assert "33 rad/s" in axes[0].get_title()


def test_below_the_connection_it_goes_over() -> None:
    curve = portraits.portrait(PAPER, 29.6).unstable[0]
    assert curve[-1, 0] > 1.5 * np.pi


def test_curves_are_broken_where_they_leave_the_cylinder() -> None:
    axes = new_figure(3, columns=2, share=False)[1].ravel()
    portraits.draw([portraits.portrait(PAPER, 29.6)], axes)
    for line in axes[0].get_lines():
        gamma = np.asarray(line.get_xdata(), dtype=float)
        steps = np.diff(gamma[np.isfinite(gamma)])
        broken = np.any(np.isnan(gamma))
        assert np.all(np.abs(steps) < 1.0) or broken or gamma.size == 2


def test_the_plane_and_the_law_are_drawn() -> None:
    axes = figures.plane(30.9, {0.3: [(0.01, 30.19), (0.1, 30.12)]}, {0.3: 30.2})
    assert len(axes.get_lines()) == 3
    law = DelayLaw(
        rates=np.array((0.1, 0.4)),
        delays=np.array((1.0, 2.0)),
        exponent=0.5,
        error=0.0,
        growth=1.0,
    )
    measured, root = figures.delay_diagram(law).get_lines()
    np.testing.assert_allclose(measured.get_ydata(), root.get_ydata())


def test_jobs_of_the_section_have_names_of_their_own() -> None:
    keys = [job.key for job in section.jobs()]
    assert len(keys) == len(set(keys))


def test_friction_without_a_connection_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(scenario: Scenario) -> Connection:
        raise NoConnectionError(f"none of {scenario.name}")

    monkeypatch.setattr(section, "heteroclinic_connection", none)
    assert section.connection(0.1, 0.4) is None
    assert figures.limit(model(4, friction=SmoothCoulomb(coefficient=0.02))) is None
