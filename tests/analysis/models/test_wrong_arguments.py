"""Arguments of the wrong kind are refused by name on every side, before anything runs."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload"

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    MODELS,
    Ensemble,
    PenaltyContact,
    Scenario,
    State,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from analysis.nonlinear.heteroclinic import fall
from analysis.nonlinear.stationary import stationary_motions
from analysis.stability.critical import critical_speeds
from analysis.stability.spectra import eigenvalues
from mbs_models import Integrator, Newton, Scene

TIMES = [0.0, 0.01]
MODEL_4 = Scenario(constraints=MODELS[4])
MASKED = np.ma.array([0.0, 0.005, 0.01], mask=[False, True, False])

CALLS: dict[str, Callable[..., Any]] = {
    "in-house": lambda **how: simulate(**{"scenario": Scenario(), "times": TIMES} | how),
    "engine": lambda **how: mbs_models.simulate(**{"scene": Scene(), "times": TIMES} | how),
    "many": lambda **how: simulate_many(
        **{"scenarios": [Scenario()], "times": TIMES, "workers": 1} | how
    ),
    "in-house rest": lambda **how: simulate_to_rest(
        **{"scenario": Scenario.rest(), "end": 0.01} | how
    ),
    "engine rest": lambda **how: mbs_models.simulate_to_rest(
        **{"scene": Scene(Scenario.rest()), "end": 0.01} | how
    ),
    "integrator": lambda **how: Integrator(**{"name": "DOPRI5"} | how),
    "newton": Newton,
    "contact": lambda **how: PenaltyContact(**{"stiffness": 1e5} | how),
    "spins": lambda spin: Ensemble(scenario=Scenario(), fields={"spin": spin}),
    "state": lambda rates: State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.0), rates=rates),
    "eigenvalues": lambda spins: eigenvalues(Scenario(), spins),
    "critical": lambda interval: critical_speeds(MODEL_4, interval),
    "stationary": lambda starts: stationary_motions(Scenario(), 30.0, starts),
    "fall": lambda spin: fall(MODEL_4, spin),
    "acceleration": lambda state: mbs_models.acceleration(Scene(), state),
}

RUNS = ("in-house", "engine", "many")
WAYS = ("in-house rest", "engine rest")
WRONG = [
    *((side, "times", MASKED, "must hold no masked values, got") for side in RUNS),
    *((side, "allow_pulling", 1, "must be True or False, got 1") for side in RUNS),
    *((side, "stop_when", 2.0, "must hold names or functions of a State") for side in RUNS),
    *((side, "progress", 3, "must be a function, got 3") for side in (*RUNS, *WAYS)),
    *((side, "time_limit", True, "must be a finite number, got True") for side in RUNS),
    ("in-house", "local_tolerance", 2.0, "must lie from 3e-14 to less than 1, got 2"),
    ("in-house rest", "local_tolerance", 2.0, "must lie from 1e-13 to less than 1, got 2"),
    ("integrator", "local_tolerance", 2.0, "must be less than 1, got 2"),
    ("many", "tolerance", [1e-6, 1e-8], "must be a finite number, got .1e-06, 1e-08"),
    ("many", "workers", True, "must be a whole number, got True"),
    ("many", "workers", 0, "must be at least 1, got 0"),
    ("many", "scenarios", Scenario(), "must be an Ensemble or a list of Scenario, got"),
    ("many", "scenarios", [Scenario(), 3], r"\[1\] must be a Scenario, got 3"),
    ("in-house", "scenario", 5, "must be a Scenario, got 5"),
    ("in-house", "method", np.zeros(2), "must be one of DOP853"),
    ("in-house rest", "scenario", Scene(), "must be a Scenario, got Scene"),
    ("engine", "scene", "euler-tree", "must be a Scene, got 'euler-tree'"),
    ("engine rest", "step", 0.0, "must be positive, got 0"),
    *((side, "criterion", 1.0, "must be a RestCriterion, got 1") for side in WAYS),
    ("newton", "modified", "yes", "must be True or False, got 'yes'"),
    ("contact", "bilateral", 1, "must be True or False, got 1"),
    ("spins", "spin", np.ma.array([1.0, 2.0], mask=[True, False]), "must hold no masked values"),
    ("state", "rates", 5, "must hold 6 numbers, got 5"),
    ("eigenvalues", "spins", MASKED, "must hold no masked values"),
    ("eigenvalues", "spins", ["30"], "must be an array of real numbers, got <U2 values"),
    ("critical", "interval", 5.0, "must be lowest and highest spin, got 5.0"),
    ("stationary", "starts", True, "must be a whole number, got True"),
    ("fall", "spin", float("nan"), "must be a finite number, got nan"),
    ("acceleration", "state", 5, "must be a State, got 5"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("side", "name", "value", "message"),
    WRONG,
    ids=[f"{side}-{name}-{value!r:.20}" for side, name, value, _ in WRONG],
)
def test_wrong_argument_is_named(side: str, name: str, value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^(start.)?{name} ?{message}"):
        CALLS[side](**{name: value})


def test_truth_values_of_numpy_are_switches() -> None:
    assert analysis.simulate(Scenario(), TIMES, allow_pulling=np.True_).ending is None
    assert PenaltyContact(stiffness=1e5, bilateral=np.True_).bilateral is True
