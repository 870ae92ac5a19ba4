"""Arguments of the wrong kind are refused by name on every side, before anything runs."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload"

from collections.abc import Callable
from math import nan
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    Ensemble,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    State,
    Table,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from analysis.nonlinear.heteroclinic import fall
from analysis.nonlinear.stationary import stationary_motions
from analysis.stability.critical import critical_speeds
from mbs_models import Newton, Scene
from tests.helpers import model

TIMES = [0.0, 0.01]
PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))
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
    "scenario": Scenario,
    "newton": Newton,
    "ensemble": lambda **fields: Ensemble(scenario=Scenario(), fields=fields),
    "penalty ensemble": lambda **fields: Ensemble(scenario=PENALTY, fields=fields),
    "state": lambda rates: State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.0), rates=rates),
    "critical": lambda interval: critical_speeds(model(4), interval),
    "stationary": lambda starts: stationary_motions(Scenario(), 30.0, starts),
    "fall": lambda spin: fall(model(4), spin),
    "acceleration": lambda state: mbs_models.acceleration(Scene(), state),
}

RUNS = ("in-house", "engine", "many")
WAYS = ("in-house rest", "engine rest")
ONE: list[tuple[str, str, Any, str]] = [
    *((side, "times", MASKED, "must hold no masked values, got") for side in RUNS),
    *((side, "allow_pulling", 1, "must be True or False, got 1") for side in RUNS),
    *((side, "stop_when", 2.0, "must hold names or functions of a State") for side in RUNS),
    *((side, "progress", 3, "must be a function, got 3") for side in (*RUNS, *WAYS)),
    *((side, "time_limit", True, "must be a finite number, got True") for side in RUNS),
    ("in-house", "local_tolerance", 2.0, "must lie from 3e-14 to less than 1, got 2"),
    ("in-house rest", "local_tolerance", 2.0, "must lie from 1e-13 to less than 1, got 2"),
    ("many", "workers", 0, "must be at least 1, got 0"),
    ("many", "scenarios", Scenario(), "must be an Ensemble or a list of Scenario, got"),
    ("many", "scenarios", [Scenario(), 3], r"\[1\] must be a Scenario, got 3"),
    ("in-house", "scenario", 5, "must be a Scenario, got 5"),
    ("in-house", "method", np.zeros(2), "must be one of DOP853"),
    ("in-house rest", "scenario", Scene(), "must be a Scenario, got Scene"),
    ("engine", "scene", "euler-tree", "must be a Scene or a Scenario, got 'euler-tree'"),
    ("engine rest", "step", 0.0, "must be positive, got 0"),
    *((side, "criterion", 1.0, "must be a RestCriterion, got 1") for side in WAYS),
    ("scenario", "disk", 3, "must be a Body, got 3"),
    ("scenario", "friction", "stick", "must be a FrictionLaw, got 'stick'"),
    ("scenario", "table", None, "must be a Table, got None"),
    ("scenario", "contact", 1e6, "must be a PenaltyContact, got 1000000.0"),
    ("scenario", "start", (1, 2), r"must be a Start or a State, got \(1, 2\)"),
    ("newton", "modified", "yes", "must be True or False, got 'yes'"),
    ("ensemble", "spin", np.ma.array([1.0], mask=[True]), "must hold no masked values"),
    ("state", "rates", 5, "must hold 6 numbers, got 5"),
    ("critical", "interval", 5.0, "must be lowest and highest spin, got 5.0"),
    ("stationary", "starts", True, "must be a whole number, got True"),
    ("fall", "spin", float("nan"), "must be a finite number, got nan"),
    ("acceleration", "state", 5, "must be a State, got 5"),
]  # fmt: skip
"""A call, an argument and its value, and what is said behind its name."""

REDUCED: dict[str, Any] = {"formulation": "reduced"}
SHARP = Scenario.rest(contact=PenaltyContact(stiffness=1e6))
CONDITIONS: list[Any] = [lambda state: 1.0 - state.rates[3], lambda state: state.rates[3] - 1.0]

SEVERAL: list[tuple[str, dict[str, Any], str]] = [
    ("in-house", {"formulation": "index-2"},
     "formulation must be one of index-1, reduced, free-body, got"),
    ("in-house", {"tolerance": nan}, "tolerance must be a finite number, got nan"),
    ("in-house", {"tolerance": 1e-6, "local_tolerance": 1e-6}, "give either tolerance or"),
    ("in-house", {"time_limit": 0.0}, "time_limit must be positive, got 0"),
    ("in-house", {"scenario": model(3)} | REDUCED,
     "formulation 'reduced' exists for Model 4 alone, got"),
    ("in-house", {"scenario": model(4, friction=SmoothCoulomb(load="contact"))} | REDUCED,
     "formulation 'reduced' takes the load 'weight'"),
    ("in-house", {"scenario": model(4, table=Table(inclination=0.1))} | REDUCED,
     "formulation 'reduced' needs a hor"),
    ("in-house", {"scenario": model(2, start=Scenario().initial_state)},
     "start breaks 'fixed centre of gravity"),
    ("in-house", {"formulation": "free-body"},
     "formulation 'free-body' needs a penalty contact, got"),
    ("in-house", {"scenario": PENALTY, "formulation": "index-1"},
     "formulation 'index-1' takes no penalty contact, got"),
    ("in-house", {"stop_when": "asleep"},
     "stop_when must be one of inverted, lost, module:function, got 'asleep'"),
    ("in-house", {"stop_when": "math:pi"}, "stop_when must hold names or functions of a State"),
    ("in-house", {"stop_when": lambda _: "low"}, "stop_when <lambda> must say a number of"),
    ("in-house", {"stop_when": "no.such:thing"}, "stop_when 'no.such:thing' cannot be loaded: No"),
    ("in-house", {"stop_when": CONDITIONS}, "stop_when .* different names, got <lambda> twice"),
    ("many", {"scenarios": 2 * [Scenario()], "workers": 2, "method": "RK45",
              "stop_when": CONDITIONS[0]}, "stop_when must hold functions that worker processes"),
    ("in-house rest", {"scenario": SHARP}, "half_thickness must be positive for the disk"),
    ("in-house rest", {"scenario": Scenario()}, "contact must be a PenaltyContact, got None"),
    ("in-house rest", {"spacing": 2.0}, "spacing must not exceed end = 0.01"),
    ("in-house rest", {"tolerance": 1e-3, "local_tolerance": 1e-8}, "give either tolerance or l"),
    ("in-house rest", {"method": "Radau"}, "method must be one of"),
    ("ensemble", {}, "fields must map names to arrays"),
    ("ensemble", {"spim": [1.0]}, "fields must be a field of a scenario"),
    ("ensemble", {"spin": [1.0], "start.spin": [2.0]}, "fields .* start.spin twice"),
    ("ensemble", {"spin": [1.0, 2.0], "mu": [0.1]}, r"fields .* got \(2,\) of start.spin"),
    ("ensemble", {"spin": 3.0}, r"start.spin must have shape \(m,\)"),
    ("penalty ensemble", {"stiffness": [1e5, 1.0]}, "member 1 of fields: stiffness must be at le"),
]  # fmt: skip
"""A call, its arguments, and how its message begins."""

WRONG = [
    *((call, {name: value}, f"(start.)?{name} ?{message}") for call, name, value, message in ONE),
    *SEVERAL,
]


@pytest.mark.parametrize(
    ("call", "given", "message"),
    WRONG,
    ids=[f"{call}-{message}" for call, _, message in WRONG],
)
def test_wrong_argument_is_named(call: str, given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        CALLS[call](**given)


def test_truth_values_of_numpy_are_switches() -> None:
    assert analysis.simulate(Scenario(), TIMES, allow_pulling=np.True_).ending is None
    assert PenaltyContact(stiffness=1e5, bilateral=np.True_).bilateral is True
