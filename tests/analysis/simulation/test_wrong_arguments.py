"""Arguments out of range or that do not fit each other are refused by name, before any run."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload"

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analysis
from analysis import (
    Ensemble,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Table,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from tests.helpers import model

TIMES = [0.0, 0.01]
PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))

CALLS: dict[str, Callable[..., Any]] = {
    "in-house": lambda **how: simulate(**{"scenario": Scenario(), "times": TIMES} | how),
    "many": lambda **how: simulate_many(
        **{"scenarios": [Scenario()], "times": TIMES, "workers": 1} | how
    ),
    "in-house rest": lambda **how: simulate_to_rest(
        **{"scenario": Scenario.rest(), "end": 0.01} | how
    ),
    "ensemble": lambda **fields: Ensemble(scenario=Scenario(), fields=fields),
    "penalty ensemble": lambda **fields: Ensemble(scenario=PENALTY, fields=fields),
}

REDUCED: dict[str, Any] = {"formulation": "reduced"}
SHARP = Scenario.rest(contact=PenaltyContact(stiffness=1e6))
CONDITIONS: list[Any] = [lambda state: 1.0 - state.rates[3], lambda state: state.rates[3] - 1.0]

WRONG: list[tuple[str, dict[str, Any], str]] = [
    ("in-house", {"local_tolerance": 2.0}, "local_tolerance must lie from 3e-14 to less than 1"),
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
    ("in-house", {"stop_when": "asleep"}, "stop_when must be one of inverted, lost, module:func"),
    ("in-house", {"stop_when": "math:pi"}, "stop_when must hold names or functions of a State"),
    ("in-house", {"stop_when": lambda _: "low"}, "stop_when <lambda> must say a number of"),
    ("in-house", {"stop_when": "no.such:thing"}, "stop_when 'no.such:thing' cannot be loaded: No"),
    ("in-house", {"stop_when": CONDITIONS}, "stop_when .* different names, got <lambda> twice"),
    ("many", {"scenarios": 2 * [Scenario()], "workers": 2, "method": "RK45",
              "stop_when": CONDITIONS[0]}, "stop_when must hold functions that worker processes"),
    ("many", {"workers": 0}, "workers must be at least 1, got 0"),
    ("in-house rest", {"local_tolerance": 2.0}, "local_tolerance must lie from 1e-13 to less th"),
    ("in-house rest", {"scenario": SHARP}, "half_thickness must be positive for the disk"),
    ("in-house rest", {"scenario": Scenario()}, "contact must be a PenaltyContact, got None"),
    ("in-house rest", {"spacing": 2.0}, "spacing must not exceed end = 0.01"),
    ("in-house rest", {"tolerance": 1e-3, "local_tolerance": 1e-8}, "give either tolerance or l"),
    ("in-house rest", {"method": "Radau"}, "method must be one of"),
    ("ensemble", {}, "fields must map names to arrays"),
    ("ensemble", {"spin": np.ma.array([1.0], mask=[True])}, "start.spin must hold no masked valu"),
    ("ensemble", {"spim": [1.0]}, "fields must be a field of a scenario"),
    ("ensemble", {"spin": [1.0], "start.spin": [2.0]}, "fields .* start.spin twice"),
    ("ensemble", {"spin": [1.0, 2.0], "mu": [0.1]}, r"fields .* got \(2,\) of start.spin"),
    ("ensemble", {"spin": 3.0}, r"start.spin must have shape \(m,\)"),
    ("penalty ensemble", {"stiffness": [1e5, 1.0]}, "member 1 of fields: stiffness must be at le"),
]  # fmt: skip
"""A call, its arguments, and how its message begins."""


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
