"""Calls that are nearly right are taken, or told in one line how they would be right."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-arg, index, dict-item"

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import LAWS, MODELS, Ensemble, Scenario, SmoothCoulomb, Start, simulate
from mbs_models import Scene
from tests.calls import printed
from validation.sweeps.axes import axis_from_text

TIMES = [0.0, 0.01]
UPRIGHT = Scenario(start=Start.stationary(31.0))


@pytest.mark.parametrize(
    "call",
    [
        lambda given: mbs_models.simulate(given, TIMES, step=1e-3).coordinates,
        lambda given: mbs_models.acceleration(given)[0],
        mbs_models.eigenvalues,
        mbs_models.state_matrix,
        mbs_models.stock_eigenvalues,
    ],
)
def test_engine_takes_a_scenario_for_its_default_scene(call: Callable[[Any], Any]) -> None:
    np.testing.assert_array_equal(call(UPRIGHT), call(Scene(UPRIGHT)))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: simulate(Scenario, TIMES), r"^scenario .* got the class: write Scenario\(\)$"),
        (lambda: MODELS[5], r"^.MODELS holds 1, 2, 3, 4, and no 5.$"),
        (lambda: SmoothCoulomb(mu=0.3), r"^SmoothCoulomb takes .* did you mean coefficient\?$"),
        (lambda: Start(spn=3.0), r"^Start takes beta, .*, and no spn; did you mean spin\?$"),
        (lambda: Ensemble(scenario=Scenario(), fields={"spn": [1.0]}), r"did you mean spin\?$"),
        (lambda: simulate(Scenario(), TIMES, method="DOP835"), r"did you mean DOP853\?$"),
        (lambda: Start(gamma=" -22.5 deg"), r"write np.radians\(-22.5\)$"),
        (lambda: LAWS.find("smooth-columb"), r"did you mean smooth-coulomb\?$"),
        (lambda: Scenario.from_values({"start": {"spn": 3.0}}), r"^spn .* mean spin\?$"),
        (lambda: axis_from_text("viscous=1:2:3"), r"did you mean viscosity or rolling_viscous\?$"),
    ],
)  # fmt: skip
def test_one_line_says_what_is_right(call: Callable[[], Any], message: str) -> None:
    with pytest.raises((ValueError, TypeError, KeyError), match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_negative_values_are_taken(capsys: pytest.CaptureFixture[str]) -> None:
    for written, read in {"-1e-1": "-0.1", "-90deg": '"-pi/2"', "-pi/2": '"-pi/2"'}.items():
        assert f"\ngamma = {read}  # rad" in printed(capsys, "scenario --gamma", written)


def test_script_without_guard_is_told_so_and_gets_nothing(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "from analysis import Scenario, simulate_many\n"
        "runs = simulate_many([Scenario()] * 4, [0.0, 0.01], method='DOP853', workers=2)\n"
        "print(runs)\n"
    )
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.count("Traceback") == 1
    assert done.stderr.splitlines()[-1].endswith(
        'which must do so below `if __name__ == "__main__":`, or with workers=1'
    )
