"""The paper's printed matrices and closed forms, and its numbers; see also the linearisation."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis import (
    MODELS,
    MOTIONS,
    Motion,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Table,
)
from analysis.stability.chart import hopf_curves, stability_chart
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import spinning
from analysis.stability.printed import (
    closed_form,
    critical_speed,
    full_matrices,
    reduced_matrices,
    static_gradient,
)
from analysis.stability.spectra import branches, eigenvalues

FULL = Scenario()
PAPER = Scenario(constraints=MODELS[4])


@pytest.mark.parametrize(("coefficient", "smoothing"), [(1e-3, 10.0), (50.0, 1e-3)])
def test_critical_speed_depends_on_neither_friction_parameter(
    coefficient: float, smoothing: float
) -> None:
    friction = SmoothCoulomb(coefficient=coefficient, smoothing=smoothing)
    critical, scenario = critical_speed(PAPER), replace(PAPER, friction=friction)
    values = np.linalg.eigvals(reduced_matrices(scenario, critical.spin)[0])
    tolerance = 1e-12 * np.max(np.abs(values)) + 1e-11
    assert np.min(np.abs(values - 1j * critical.frequency)) < tolerance


@pytest.mark.parametrize("motion", MOTIONS)
def test_closed_form_converges_with_the_smoothing(motion: Motion) -> None:
    errors = []
    for smoothing in (1e-2, 1e-3, 1e-4):
        scenario = replace(PAPER, friction=SmoothCoulomb(smoothing=smoothing))
        values = np.linalg.eigvals(reduced_matrices(scenario, 40.0, motion)[0])
        approximate = closed_form(scenario, 40.0, motion).eigenvalues[0]
        errors.append([np.min(np.abs(values - value)) for value in approximate])
    rates = np.log10(np.array(errors)[:-1] / np.array(errors)[1:])
    # lambda_1,2 are off by O(epsilon²), lambda_3 by O(epsilon), as Eq. (122) says
    assert np.all(rates[:, 2] == pytest.approx(1.0, abs=0.05))
    assert np.all(rates[:, :2] > 0.95)


CALLS: dict[str, tuple[str, Any]] = {
    "full matrices": ("full", full_matrices),
    "reduced matrices": ("reduced", reduced_matrices),
    "closed form": ("closed", closed_form),
    "spectra": ("any", eigenvalues),
    "static": ("full", static_gradient),
    "chart": ("full", lambda s, spins=1.0, **more: stability_chart(s, spins, [1.0], **more)),
    "hopf curves": ("full", lambda s, **more: hopf_curves(s, [1.0], **more)),
    "critical speed": ("closed", critical_speed),
    "critical speeds": ("any", critical_speeds),
    "linearisation": ("any", spinning),
}
"""What takes a scenario, spins if it is one of the first six, and a motion, with its system."""


@pytest.mark.parametrize("name", CALLS)
def test_other_scenarios_motions_and_spins_are_refused(name: str) -> None:
    system, call = CALLS[name]
    fitting = PAPER if system == "reduced" else FULL
    takes_spins = name in [*CALLS][:6]
    some: dict[str, Any] = {"spins": 1.0} if takes_spins else {}
    with pytest.raises(ValueError, match="needs a horizontal table"):
        call(replace(fitting, table=Table(inclination=0.1)), **some)
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        call(fitting, **some, motion="upright")
    # A penalty contact takes no further constraint.
    if system in ("full", "any"):
        with pytest.raises(ValueError, match="needs the ideal contact, got a Penalty"):
            call(replace(fitting, contact=PenaltyContact(stiffness=1e5)), **some)
    if system in ("full", "reduced"):
        with pytest.raises(ValueError, match=rf"the {system} system is that of Model .*numeric"):
            call(replace(fitting, constraints=MODELS[2]), **some)
    for spins in ([], [[1.0]], [1.0, np.nan], "fast") if takes_spins else ():
        with pytest.raises(ValueError, match=r"spins must be .*(dimensional|numbers)"):
            call(fitting, spins=spins)


SLIPPERY = replace(PAPER, friction=SmoothCoulomb(coefficient=0.0))
UNKNOWN: Any = "model1"

REFUSED: dict[str, Callable[[], object]] = {
    "gradients must be one-dimensional": lambda: stability_chart(FULL, [1.0], []),
    "must not be negative, got -1": lambda: stability_chart(FULL, [1.0], [-1.0]),
    "must be finite numbers, got nan": lambda: stability_chart(FULL, [1.0], [np.nan]),
    "lowest < highest spin, got 5 to 1": lambda: hopf_curves(FULL, [1.0], (5.0, 1.0)),
    "gradients must be positive": lambda: hopf_curves(FULL, [1.0, 0.0]),
    "spins must increase strictly, got 1 before 1": lambda: branches(FULL, [1.0, 1.0]),
    "friction must have a positive gradient": lambda: closed_form(SLIPPERY, 1.0),
    "scenario must be a Scenario, got 'S'": lambda: critical_speeds("S"),  # type: ignore[arg-type]
    "system must be one of full, reduced, numeric": lambda: eigenvalues(FULL, [1.0], UNKNOWN),
}


@pytest.mark.parametrize("message", REFUSED)
def test_other_bad_calls_are_refused(message: str) -> None:
    with pytest.raises(ValueError, match=message):
        REFUSED[message]()
