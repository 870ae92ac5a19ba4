"""The chart over spin and friction gradient: its Hopf curves, corners, counts, sensitivities."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from analysis import MODELS, MOTIONS, STEEL_DISK, Level, Motion, Scenario, SmoothCoulomb
from analysis.mechanics.paper import critical_speed
from analysis.problem.checks import Array
from analysis.stability.boundaries import HopfCurve, corners, hopf_curves
from analysis.stability.chart import stability_chart, static_gradient, with_gradient
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.sensitivities import POWERS, sensitivities
from analysis.stability.spectra import eigenvalues, full_matrices
from tests.bodies import ELLIPSE, TIPPE_TOP, of_six
from tests.helpers import mostly_slow

PAPER = Scenario()

GRADIENTS = np.geomspace(0.01, 1000.0, 13)


def disk(e: float, *inertia: float) -> Scenario:
    """A disk of another eccentricity and other moments of inertia, in mm and g m²."""
    own = (1e-3 * each for each in (e, *inertia))
    return Scenario(disk=of_six(STEEL_DISK.radius, STEEL_DISK.mass, *own))


CURVES: dict[str, tuple[Scenario, Motion]] = {
    **{motion: (PAPER, motion) for motion in MOTIONS},
    "the faster one begins first": (disk(7.4195, 0.15598, 0.33092, 0.47757), "inverted"),
    "a fold like a hairpin": (disk(11.222, 0.16472, 0.37811, 0.421), "noninverted"),
    "a gap between real eigenvalues": (disk(2.1688, 0.39021, 0.25515, 0.35682), "inverted"),
}


def passing(curves: tuple[HopfCurve, ...], gradient: float) -> Array:
    """Spins and frequencies at which curves pass a gradient, nearly, shape (n, 2)."""
    found = []
    for spins, gradients, frequencies in curves:
        away = np.log(gradients / gradient)
        for step in np.flatnonzero((away[:-1] < 0.0) != (away[1:] < 0.0)):
            part = away[step] / (away[step] - away[step + 1])
            both = np.column_stack((spins, frequencies))[step : step + 2]
            found.append((1.0 - part) * both[0] + part * both[1])
    return np.array(found).reshape(-1, 2)


@pytest.mark.parametrize("name", mostly_slow(CURVES, MOTIONS))
def test_hopf_curves_pass_every_crossing_once(name: str) -> None:
    scenario, motion = CURVES[name]
    curves = hopf_curves(scenario, GRADIENTS, motion=motion)
    for gradient in (0.03, 0.5, 1.3, 2.1, 7.0, 300.0):
        rubbing = with_gradient(scenario, gradient)
        crossings = critical_speeds(rubbing, (0.0, 100.0), motion=motion).hopf
        expected = np.array([(each.spin, each.frequency) for each in crossings]).reshape(-1, 2)
        found = passing(curves, gradient)
        assert found.shape == expected.shape
        order, wanted = (np.lexsort(each.T) for each in (found, expected))
        np.testing.assert_allclose(found[order], expected[wanted], atol=0.05)


def test_hopf_curves_go_on_to_friction_so_steep_that_hardly_anything_slips() -> None:
    curves = hopf_curves(Scenario(), np.geomspace(0.3, 1e5, 9))
    # Without slip, by polynomials in rational numbers.
    assert np.sort(passing(curves, 9e4)[:, 0]) == pytest.approx([25.435972, 30.272197], abs=1e-5)


@pytest.mark.parametrize("name", CURVES)
def test_hopf_curves_have_a_pair_on_the_axis_that_changes_little_along_them(name: str) -> None:
    scenario, motion = CURVES[name]
    for curve in hopf_curves(scenario, GRADIENTS, motion=motion):
        spins, gradients, frequencies = curve
        matrices = full_matrices(scenario, spins, motion, gradient=gradients)
        values = np.linalg.eigvals(matrices)
        off = np.min(np.abs(values - 1j * frequencies[:, None]), axis=1)
        # Rounding splits a double zero by its root.
        assert np.max(off) < 1e-9 * np.max(np.abs(values)) + 1e-6 * (np.min(frequencies) < 1e-6)
        assert max(np.max(np.abs(np.diff(each))) for each in (spins, frequencies)) < 3.0
        for spin, gradient, frequency in np.column_stack(curve)[[0, -1]]:
            away = [spin, spin - 100.0, frequency, *np.log(gradient / GRADIENTS[[0, -1]])]
            assert np.min(np.abs(away)) < 1e-9


def test_corners_enclose_the_region_in_which_inverted_spinning_is_stable() -> None:
    found = {each.kind: each for each in corners(PAPER, np.geomspace(0.3, 30.0, 5))}
    expected = {
        "double zero": (28.60972, 0.881178),
        "zero hopf": (36.83647, 1.347031),
        "double hopf": (29.84697, 1.851081),
    }
    assert {kind: (each.spin, each.gradient) for kind, each in found.items()} == {
        kind: pytest.approx(place, abs=5e-6) for kind, place in expected.items()
    }
    double = found["double hopf"]
    np.testing.assert_allclose(double.frequencies, (5.23009, 25.80421), atol=1e-5)
    spins, gradients = np.linspace(10.0, 90.0, 161), np.geomspace(0.1, 100.0, 120)
    rows, columns = np.nonzero(stability_chart(PAPER, spins, gradients) == 0)
    assert 28.6 < spins[columns].min() < spins[columns].max() < 36.9
    assert 0.88 < gradients[rows].min() < gradients[rows].max() < 1.852
    assert not corners(PAPER, (2.0, 30.0))


@pytest.mark.parametrize("name", CURVES)
def test_corners_have_as_many_eigenvalues_on_the_axis_as_their_kind_says(name: str) -> None:
    scenario, motion = CURVES[name]
    for each in corners(scenario, GRADIENTS, motion=motion):
        matrix = full_matrices(scenario, each.spin, motion, gradient=each.gradient)[0]
        critical = np.sum(np.abs(np.linalg.eigvals(matrix).real) < 1e-6)
        assert critical == {"double zero": 2, "zero hopf": 3, "double hopf": 4}[each.kind]
        if "zero" in each.kind:
            (static,) = static_gradient(scenario, [each.spin], motion)
            assert each.gradient == pytest.approx(static, rel=1e-9)


# --- Counts and sensitivities ------------------------------------------------------------------


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


@pytest.mark.parametrize("level", [3, 4])
def test_static_crossings_of_a_disk_with_products_move_as_their_closed_form(level: Level) -> None:
    leaning = of_six(0.045, 0.4, 0.004, 2e-4, 2.5e-4, 4.3e-4, inertia_yz=3e-5)
    e, r = leaning.eccentricity, leaning.radius
    expected = {"mass": 1.0, "eccentricity": (r + 2 * e) / (r + e), "radius": r / (r + e),
                "friction_gradient": 1.0, "size": 0.0}  # fmt: skip
    static = 0
    for coefficient in np.linspace(0.05, 0.3, 11).tolist():
        scenario = Scenario(disk=leaning, friction=SmoothCoulomb(coefficient=coefficient),
                            constraints=MODELS[level])  # fmt: skip
        for crossing in critical_speeds(scenario).crossings:
            if crossing.frequency == 0.0:
                moment = scenario.friction_gradient * scenario.weight * e * (r + e)
                assert crossing.spin == pytest.approx(moment / leaning.inertia_yz, rel=1e-9)
                found = sensitivities(scenario, crossing)
                assert {name: found[name] for name in expected} == pytest.approx(expected)
                static += 1
    assert static > 2
