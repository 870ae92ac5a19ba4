"""What the in-house simulation refuses, and how it reports what it cannot do."""

from collections.abc import Callable
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np
import pytest

from analysis import (
    METHODS,
    Method,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    ToleranceError,
    simulate,
)
from analysis.data.checks import Array
from analysis.mechanics import reduced
from analysis.models import simulation
from analysis.solve.stepping import Run
from tests.helpers import model

MODEL_4 = model(4)
REDUCED: dict[str, Any] = {"form": "reduced"}
LOADED = SmoothCoulomb(load="contact")
PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))


@pytest.mark.parametrize(
    ("scenario", "given", "message"),
    [
        (Scenario(), {"times": [0.0, 1.0, 1.0]}, "times must increase strictly, got 1 before 1"),
        (Scenario(), {"times": [0.0]}, "times must be one-dimensional with at least 2 entries"),
        (Scenario(), {"method": "RK4"}, "method must be one of DOP853, RK45, .*, got 'RK4'"),
        (Scenario(), {"form": "index-2"}, "form must be one of index-1, reduced, free-body, got"),
        (Scenario(), {"tolerance": nan}, "tolerance must be a finite number, got nan"),
        (Scenario(), {"tolerance": 1e-6, "local_tolerance": 1e-6}, "give either tolerance or"),
        (Scenario(), {"time_limit": 0.0}, "time_limit must be positive, got 0"),
        (model(3), REDUCED, "form 'reduced' exists for Model 4 alone, got Model 3$"),
        (replace(MODEL_4, friction=LOADED), REDUCED, "form 'reduced' takes the load 'weight'"),
        (replace(MODEL_4, table=Table(inclination=0.1)), REDUCED, "form 'reduced' needs a hor"),
        (model(2, start=Scenario().initial_state), {}, "start breaks 'fixed centre of gravity"),
        (Scenario(), {"form": "free-body"}, "form 'free-body' needs penalty contact, got"),
        (PENALTY, {"form": "index-1"}, "form 'index-1' knows no penalty contact"),
    ],
)
def test_what_cannot_be_run_is_refused_by_name(
    scenario: Scenario, given: dict[str, Any], message: str
) -> None:
    call: dict[str, Any] = {"scenario": scenario, "times": [0.0, 0.01]} | given
    with pytest.raises(ValueError, match=f"^{message}"):
        simulate(**call)


def test_integration_that_gives_up_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    # gamma = 1 / (1.005 - t) has no value at t = 1.005 s.
    scenario = model(4, start=Start(gamma=1 / 1.005))

    def diverging(*_: object) -> Callable[[float, Array], tuple[float, ...]]:
        return lambda _, x: (0.0, x[1] ** 2, 0.0)

    monkeypatch.setattr(reduced, "right_hand_side", diverging)
    with pytest.raises(ArithmeticError, match=r"^DOP853 stopped after t = 1\.005 s: "):
        simulate(scenario, np.linspace(0.0, 2.0, 201), form="reduced")


@pytest.mark.parametrize("method", [each for each in METHODS if each != "taylor"])
def test_unreachable_tolerance_is_refused(method: Method) -> None:
    message = rf"^tolerance 1e-16 rad cannot be reached with {method}: .* is \d\.\de-\d\d rad$"
    with pytest.raises(ToleranceError, match=message):
        simulate(Scenario(), [0.0, 0.01], method=method, tolerance=1e-16)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-13, 1e-16])
def test_compared_runs_differ_threefold_in_their_local_tolerance(
    tolerance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Two runs of nearly the same local tolerance agree without being right.
    used: list[float] = []

    def never_agree(_: Any, times: Array, __: Method, local_tolerance: float, **___: Any) -> Run:
        used.append(local_tolerance)
        return Run(times, np.full((len(times), 12), float(len(used))), 1, None, ())

    monkeypatch.setattr(simulation, "integrate", never_agree)
    with pytest.raises(ToleranceError):
        simulate(Scenario(), [0.0, 0.01], tolerance=tolerance)
    assert len(used) >= 2
    assert np.min(np.divide(used[:-1], used[1:])) >= 3.0
