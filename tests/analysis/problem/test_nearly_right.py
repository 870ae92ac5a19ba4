"""Calls that are nearly right are taken, or told in one line how they would be right.

Numbers that look as if they were meant in another unit are taken, with a warning.
"""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-arg, index, dict-item"

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    LAWS,
    MODELS,
    FrictionLaw,
    Scenario,
    Start,
    load_scenario,
    scenario_text,
    simulate,
)
from analysis.problem.values import UnitWarning
from mbs_models import Scene
from tests.calls import answer, python
from tests.helpers import refusals
from tests.validation.cli.test_refusals import RING
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


class Made(FrictionLaw):
    finest_speed = 0.1

    def __init__(self, strength: float) -> None:
        self.strength = strength

    def per_speed(self, speed: float) -> float:
        return self.strength / (0.1 + speed)


class Derived(Made):
    """One that has it from another class."""


NEARLY: dict[str, Callable[[], object]] = {
    r"^scenario .* got the class: write Scenario\(\)$": lambda: simulate(Scenario, TIMES),
    r"^.MODELS holds 1, 2, 3, 4, and no 5.$": lambda: MODELS[5],
    r"^Start takes beta, .*, and no spn; did you mean spin\?$": lambda: Start(spn=3.0),
    r"^Scenario .*, and no model; write constraints=MODELS\[\.\.\.\]$": lambda: Scenario(model=2),
    r"and no mu; coefficient belongs to the friction$": lambda: Scenario(mu=0.2),
    r"did you mean DOP853\?$": lambda: simulate(Scenario(), TIMES, method="DOP835"),
    r"write np.radians\(-22.5\)$": lambda: Start(gamma=" -22.5 deg"),
    "^Made must be a frozen dataclass, .* no __init__ of its own$": lambda: Made(0.3),
    "^Derived must be a frozen dataclass": lambda: Derived(0.3),
    r"did you mean smooth-coulomb\?$": lambda: LAWS.find("smooth-columb"),
    r"^spn .* mean spin\?$": lambda: Scenario.from_values({"start": {"spn": 3.0}}),
    r"did you mean viscosity or rolling_viscous\?$": lambda: axis_from_text("viscous=1:2:3"),
}

test_one_line_says_what_is_right = refusals(NEARLY, (ValueError, TypeError, KeyError))


MANY = """
from analysis import Scenario, simulate_many
print(simulate_many([Scenario()] * 4, [0.0, 0.01], method="DOP853", workers=2))
"""
SWEEP = """
from tests.sweeps import sweep
from validation.sweeps.runner import run_sweep
print(run_sweep(sweep("spin=30,40"), "a.db", workers=2))
"""


@pytest.mark.slow
@pytest.mark.parametrize("script", [MANY, SWEEP])
def test_script_without_guard_is_told_so_and_gets_nothing(script: str, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(script)
    done = python("script.py", folder=tmp_path, code=1)
    assert done.stdout == ""
    assert done.stderr.count("Traceback") == 1
    assert done.stderr.splitlines()[-1].endswith(
        'which must do so below `if __name__ == "__main__":`, or with workers=1'
    )


@pytest.fixture
def mine(folder: Path) -> Path:
    """File with an angle in degrees, in the working directory."""
    path = folder / "mine.toml"
    path.write_text(scenario_text(Scenario()).replace('gamma = "-pi/2 + 0.1"', "gamma = 90"))
    return path


IN_DOUBT = {
    "--gamma=-90 --alpha 1": "gamma is in rad, and above a turn; degrees are written with",
    RING.replace("0.05", "40", 1): "radius is in m, and above 1 m",
    "mine.toml": "gamma is in rad, and above a turn",
    "--gamma -450deg --alpha -10*pi": "",
}


@pytest.mark.parametrize("words", IN_DOUBT)
@pytest.mark.usefixtures("mine")
def test_units_that_are_in_doubt_are_warned_of_once(words: str) -> None:
    shown, said = answer("scenario", words), IN_DOUBT[words]
    lines = shown.err.splitlines()
    assert len(lines) == bool(said)
    assert all(line.startswith(f"tippedisk scenario: {said}") for line in lines)
    assert "[start]" in shown.out


def test_units_of_a_file_and_of_an_axis_are_warned_of(mine: Path) -> None:
    with pytest.warns(UnitWarning, match="^gamma is in rad, and above a turn"):
        assert load_scenario(mine).start.gamma == 90.0  # type: ignore[union-attr]
    # Refused before anything runs.
    shown = answer("sweep gamma=0,90,180 --most 1 --out out.db")
    assert (shown.code, shown.err.count("gamma is in rad, and above a turn")) == (2, 1)
