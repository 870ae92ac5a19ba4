"""What the in-house simulation refuses, and how it reports what it cannot do."""

from collections.abc import Callable
from math import nan
from typing import Any

import numpy as np
import pytest

from analysis import (
    METHODS,
    Level,
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


def test_integration_that_gives_up_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    # gamma = 1 / (1.005 - t) has no value at t = 1.005 s.
    scenario = model(4, start=Start(gamma=1 / 1.005))

    def diverging(*_: object) -> Callable[[float, Array], tuple[float, ...]]:
        return lambda _, x: (0.0, x[1] ** 2, 0.0)

    monkeypatch.setattr(reduced, "right_hand_side", diverging)
    with pytest.raises(ArithmeticError, match=r"^DOP853 stopped after t = 1\.005 s: "):
        simulate(scenario, np.linspace(0.0, 2.0, 201), form="reduced")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"times": [0.0, 1.0, 1.0]}, "times must increase strictly, got 1 before 1"),
        ({"times": [0.0, nan]}, "times must be finite"),
        ({"times": [0.0]}, "times must be one-dimensional with at least 2 entries"),
        ({"method": "RK4"}, "method must be one of DOP853, RK45, .*, got 'RK4'"),
        ({"form": "index-2"}, "form must be one of index-1, reduced, free-body, got 'index-2'"),
        ({"tolerance": -1e-6}, "tolerance must be positive, got -1e-06"),
        ({"tolerance": 0.0}, "tolerance must be positive, got 0"),
        ({"tolerance": nan}, "tolerance must be a finite number, got nan"),
        ({"local_tolerance": -1e-6}, "local_tolerance must be positive, got -1e-06"),
        ({"local_tolerance": 1.0}, r"local_tolerance must lie in \[3e-14, 1\), got 1"),
        ({"local_tolerance": 1e-15}, r"local_tolerance must lie in \[3e-14, 1\), got 1e-15"),
        (
            {"tolerance": 1e-6, "local_tolerance": 1e-6},
            "give either tolerance or local_tolerance, not both",
        ),
    ],
)
def test_argument_out_of_range_is_named(arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"scenario": Scenario(), "times": [0.0, 0.01]}
    with pytest.raises(ValueError, match=f"^{message}"):
        simulate(**(good | arguments))


@pytest.mark.parametrize("level", [1, 2, 3])
def test_reduced_form_exists_for_model_4_alone(level: Level) -> None:
    with pytest.raises(
        ValueError, match=rf"'reduced' exists for Model 4 alone, got Model {level}$"
    ):
        simulate(model(level), [0.0, 0.01], form="reduced")


def test_reduced_form_takes_the_weight_alone() -> None:
    with pytest.raises(
        ValueError, match=r"'reduced' takes the load 'weight' alone, got 'contact'$"
    ):
        simulate(model(4, friction=SmoothCoulomb(load="contact")), [0.0, 0.01], form="reduced")


def test_start_that_breaks_a_constraint_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^start breaks 'fixed centre of gravity"):
        simulate(model(2, start=Scenario().initial_state), [0.0, 0.01])


def test_reduced_form_refuses_a_leaning_table() -> None:
    with pytest.raises(ValueError, match=r"^form 'reduced' needs a horizontal table, got .* 0.1"):
        simulate(model(4, table=Table(inclination=0.1)), [0.0, 0.01], form="reduced")


def test_form_must_fit_the_contact() -> None:
    with pytest.raises(ValueError, match=r"^form 'free-body' needs penalty contact, got"):
        simulate(Scenario(), [0.0, 0.01], form="free-body")
    soft = Scenario(contact=PenaltyContact(stiffness=1e5))
    with pytest.raises(ValueError, match=r"^form 'index-1' knows no penalty contact"):
        simulate(soft, [0.0, 0.01], form="index-1")


@pytest.mark.parametrize("method", [each for each in METHODS if each != "taylor"])
def test_unreachable_tolerance_is_refused(method: Method) -> None:
    message = rf"^tolerance 1e-16 rad cannot be reached with {method}: .* is \d\.\de-\d\d rad$"
    with pytest.raises(ToleranceError, match=message):
        simulate(Scenario(), [0.0, 0.01], method=method, tolerance=1e-16)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-11, 1e-12, 1e-13, 1e-16])
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
