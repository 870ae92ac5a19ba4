"""Rotating motions beyond the heteroclinic connection."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis import SmoothCoulomb, Start
from analysis.data.checks import Array
from analysis.mechanics import reduced
from analysis.nonlinear.rotating import Rotation, RotationFamily, folds, rotating_family
from tests.calls import printed
from tests.calls import run as call
from tests.helpers import model, reduced_run
from validation.run import run

PAPER = model(4)


@pytest.fixture(scope="module")
def family() -> RotationFamily:
    return rotating_family(PAPER, (1e-4, 0.01, 0.08, 0.12, 0.14, 0.3))


def turned(rotation: Rotation, begin: Array) -> Array:
    """State a period later, gamma turned back."""
    found = reduced_run(PAPER, rotation.spin, begin, rotation.period)
    return np.asarray(found - np.array((0.0, 2.0 * np.pi, 0.0)))


@pytest.mark.slow
def test_rotating_motions_begin_in_the_connection_and_fold(family: RotationFamily) -> None:
    assert family.reason is None
    first = family.rotations[0]
    assert first.spin == pytest.approx(family.connection.spin, abs=1e-6)
    assert [each.stable for each in family.rotations] == [True, True, True, True, False, False]
    (fold,) = folds(family)
    assert fold.multiplier == pytest.approx(1.0, abs=1e-6)
    assert fold.spin == pytest.approx(30.0820066, abs=1e-6)
    assert all(each.spin > fold.spin for each in family.rotations)


@pytest.mark.slow
def test_the_reduced_system_comes_back_after_a_turn(family: RotationFamily) -> None:
    for rotation in family.rotations[1:]:
        begin = rotation.states[0]
        np.testing.assert_allclose(turned(rotation, begin), begin, rtol=0.0, atol=1e-7)


@pytest.mark.slow
def test_deviations_of_rotating_motions_grow_by_the_multiplier(family: RotationFamily) -> None:
    for rotation in (family.rotations[2], family.rotations[5]):
        begin, size = rotation.states[0], 1e-5
        along = np.array(reduced.solver(PAPER, rotation.spin)(*begin.tolist())[:3])
        deviation, sizes = np.array((size, 0.0, 0.0)), []
        for _ in range(2):
            deviation = (
                turned(rotation, begin + deviation) - turned(rotation, begin - deviation)
            ) / 2
            deviation -= along * (along @ deviation) / (along @ along)
            sizes.append(float(np.linalg.norm(deviation)))
        assert sizes[1] / sizes[0] == pytest.approx(rotation.multiplier, rel=1e-4)


@pytest.mark.slow
def test_the_engine_rotates_alike(family: RotationFamily) -> None:
    rotation = family.rotations[2]
    beta, gamma, rate = rotation.states[0].tolist()
    start = Start(beta=beta, gamma=gamma, beta_rate=rate, spin=rotation.spin)
    times = np.array((0.0, rotation.period / 2.0, rotation.period))
    motion = run(
        replace(PAPER, start=start),
        times,
        source="engine",
        formulation="floating",
        tolerance=1e-8,
    )
    assert motion.coordinate("beta")[-1] == pytest.approx(beta, abs=1e-8)
    assert motion.coordinate("gamma")[-1] == pytest.approx(gamma + 2.0 * np.pi, abs=1e-8)


@pytest.mark.slow
def test_the_command_tells_and_draws_them(
    family: RotationFamily,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("analysis.nonlinear.rotating.rotating_family", lambda *_, **__: family)
    picture = tmp_path / "rotating.svg"
    found = json.loads(printed(capsys, f"cycles --rotating --json --plot {picture}"))
    assert [each["tilt"] for each in found["motions"]] == family.values("tilt").tolist()
    assert found["motions"][-1]["stable"] is False
    assert found["events"][0]["spin"] == pytest.approx(30.0820066, abs=1e-6)
    assert "<svg" in picture.read_text()


@pytest.mark.slow
def test_rotating_motions_are_found_beside_a_saddle_focus_too() -> None:
    soft = model(4, friction=SmoothCoulomb(smoothing=1.0))
    found = rotating_family(soft, (0.2,))
    (rotation,) = found.rotations
    end = reduced_run(soft, rotation.spin, rotation.states[0], rotation.period)
    end[1] -= 2.0 * np.pi
    np.testing.assert_allclose(end, rotation.states[0], rtol=0.0, atol=1e-7)
    assert 0.0 < found.connection.spin - rotation.spin < 0.02


def test_bad_calls_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for tilts in ((), (0.0, 0.1), (0.2, 0.1), (0.1, 1.6)):
        with pytest.raises(ValueError, match="tilts must rise strictly between 0 and pi/2"):
            rotating_family(PAPER, tilts)
    with pytest.raises(ValueError, match="Model 4"):
        rotating_family(model(1))
    assert call("cycles --rotating --spin 30.1") == 2
    assert "--spin: spin does not go together" in capsys.readouterr().err
