"""Scenarios and spins that a linear system does not take."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from analysis import MODELS, PenaltyContact, Scenario, SmoothCoulomb, Table
from analysis.mechanics.paper import closed_form, critical_speed
from analysis.stability.boundaries import hopf_curves
from analysis.stability.chart import stability_chart, static_gradient
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import spinning
from analysis.stability.spectra import branches, eigenvalues
from tests.helpers import refusals

FULL = Scenario()
PAPER = Scenario(constraints=MODELS[4])


CALLS: dict[str, tuple[str, Any]] = {
    "full system": ("full", partial(eigenvalues, system="full")),
    "reduced system": ("reduced", partial(eigenvalues, system="reduced")),
    "closed form": ("closed", closed_form),
    "spectra": ("any", eigenvalues),
    "static": ("full", static_gradient),
    "chart": ("full", lambda s, spins=1.0, **more: stability_chart(s, spins, [1.0], **more)),
    "hopf curves": ("full", lambda s, **more: hopf_curves(s, [1.0], **more)),
    "critical speed": ("closed", critical_speed),
    "critical speeds": ("any", critical_speeds),
    "linearisation": ("any", spinning),
}
"""What takes a scenario, and spins if it is one of the first six, with its system."""


@pytest.mark.parametrize("name", CALLS)
def test_other_scenarios_and_spins_are_refused(name: str) -> None:
    system, call = CALLS[name]
    fitting = PAPER if system == "reduced" else FULL
    takes_spins = name in [*CALLS][:6]
    some: dict[str, Any] = {"spins": 1.0} if takes_spins else {}
    with pytest.raises(ValueError, match="needs a horizontal table"):
        call(replace(fitting, table=Table(inclination=0.1)), **some)
    # A penalty contact takes no further constraint.
    if system in ("full", "any"):
        with pytest.raises(ValueError, match="needs the ideal contact, got a Penalty"):
            call(replace(fitting, contact=PenaltyContact(stiffness=1e5)), **some)
    if system in ("full", "reduced"):
        # What takes others is told where eigenvalues are asked for, and nowhere else.
        hint = (
            "; eigenvalues .* are those of the system 'numeric'" if name.endswith("system") else ""
        )
        message = rf"^the {system} system is that of Model \d, got Model 2{hint}$"
        with pytest.raises(ValueError, match=message):
            call(replace(fitting, constraints=MODELS[2]), **some)
    for spins in ([], [[1.0]], [1.0, np.nan]) if takes_spins else ():
        with pytest.raises(ValueError, match=r"spins must be .*(dimensional|finite)"):
            call(fitting, spins=spins)


SLIPPERY = replace(PAPER, friction=SmoothCoulomb(coefficient=0.0))

REFUSED: dict[str, Callable[[], object]] = {
    "gradients must be one-dimensional": lambda: stability_chart(FULL, [1.0], []),
    "must not be negative, got -1": lambda: stability_chart(FULL, [1.0], [-1.0]),
    "interval must have .* got 10 to 10": lambda: critical_speeds(FULL, (10.0, 10.0)),
    "interval must have .* got -5 to 10": lambda: critical_speeds(FULL, (-5.0, 10.0)),
    "interval must lie from -100000 to 100000": lambda: critical_speeds(FULL, (0.0, 1e6)),
    "gradients must be two or more": lambda: hopf_curves(FULL, [1.0, 1.0]),
    "gradients must be positive": lambda: hopf_curves(FULL, [1.0, 0.0]),
    "spins must increase strictly, got 1 before 1": lambda: branches(FULL, [1.0, 1.0]),
    "friction must have a positive gradient": lambda: closed_form(SLIPPERY, 1.0),
}

test_other_bad_calls_are_refused = refusals(REFUSED)
