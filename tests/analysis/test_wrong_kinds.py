"""Analyses refuse by name what is nothing of the kind that they take, before they compute."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload, dict-item, list-item"

import traceback
from collections.abc import Callable
from math import nan
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import MODELS, Ensemble, Scenario, Trajectory, simulate, simulate_many
from analysis.mechanics import paper
from analysis.nonlinear import families, following, heteroclinic, hopf, slow_manifold
from analysis.nonlinear.stationary import (
    Parameter,
    StationaryMotion,
    stationary_branch,
    stationary_motions,
)
from analysis.stability import chart, critical, linearisation, spectra
from analysis.stability.sensitivities import sensitivities
from mbs_models import Newton
from validation.sweeps.plan import Plan

REDUCED = Scenario(constraints=MODELS[4])
RUN = simulate(Scenario(), [0.0, 0.01])
SPINS = [30.0]

TILTED = StationaryMotion(
    spin=30.0, x=0.0, y=0.0, beta=1.0, gamma=1.0, eigenvalues=np.zeros(1, complex), value=30.0
)

OF_A_SCENARIO: dict[str, Callable[[Any], Any]] = {
    "energies": lambda given: analysis.energies(given, RUN.coordinates, RUN.rates),
    "scenario_text": analysis.scenario_text,
    "ensemble": lambda given: Ensemble(scenario=given, fields={"spin": SPINS}),
    "formulations": analysis.formulations,
    "engine's formulations": mbs_models.formulations,
    "critical_speeds": critical.critical_speeds,
    "critical_speed": paper.critical_speed,
    "closed_form": lambda given: paper.closed_form(given, SPINS),
    "eigenvalues": lambda given: spectra.eigenvalues(given, SPINS),
    "branches": lambda given: spectra.branches(given, SPINS),
    "spinning": linearisation.spinning,
    "stationary": lambda given: linearisation.stationary_eigenvalues(
        given, 30.0, (0.0, 0.0, 1.5, 1.5)
    ),
    "unstable_start": linearisation.unstable_start,
    "stability_chart": lambda given: chart.stability_chart(given, SPINS, [3.0]),
    "hopf_curves": lambda given: chart.hopf_curves(given, [3.0]),
    "corners": lambda given: chart.corners(given, [3.0]),
    "cycle_family": families.cycle_family,
    "rotating_family": families.rotating_family,
    "cycle_at": lambda given: families.cycle_at(given, 30.5),
    "cycles_over": lambda given: families.cycles_over([given], amplitude=1.0),
    "connection": heteroclinic.heteroclinic_connection,
    "hopf_type": hopf.hopf_type,
    "slow_cycle": lambda given: slow_manifold.slow_cycle(given, 1.0),
    "slow_connection": slow_manifold.slow_connection,
    "stationary_motions": lambda given: stationary_motions(given, 30.0),
    "stationary_branch": lambda given: stationary_branch(given, TILTED, (20.0, 40.0)),
}
OF_A_TRAJECTORY: dict[str, Callable[[Any], Any]] = {
    "contact_forces": analysis.contact_forces,
    "power": analysis.power,
    "energy_residual": analysis.energy_residual,
    "constraint_drift": analysis.constraint_drift,
}


@pytest.mark.parametrize(
    "given", [None, 5, "x", Scenario, [Scenario()], RUN.coordinates], ids=type
)
@pytest.mark.parametrize("call", OF_A_SCENARIO | OF_A_TRAJECTORY)
def test_what_is_no_scenario_or_trajectory_is_refused_by_name(call: str, given: Any) -> None:
    kind = "scenario must be a Scenario" if call in OF_A_SCENARIO else "trajectory must be a Traj"
    with pytest.raises(ValueError, match=f"^{kind}"):
        (OF_A_SCENARIO | OF_A_TRAJECTORY)[call](given)


PLATE = (0.045, 0.01, 7700.0)


def _place(*place: Any, spin: Any = 30.0) -> Any:
    return linearisation.stationary_eigenvalues(REDUCED, spin, place)


def _trajectory(**changes: Any) -> Any:
    names = ("times", "coordinates", "rates", "multipliers", "scenario", "source", "method")
    return Trajectory(**{name: getattr(RUN, name) for name in names} | changes)


WRONG: dict[str, Callable[[], Any]] = {
    "disk must be a Body, got 3": lambda: analysis.PenaltyContact.damped(1e5, 3),
    "disk must be a Body, got None": lambda: analysis.PenaltyContact.rounded(None),
    "disk must be a Body, got 'x'": lambda: Scenario.rest(disk="x"),
    "holes must be a list of Hole, got 5": lambda: analysis.Disk.of_parts(PLATE, 5),
    "masses must be a list of PointMass, got 'x'": lambda: analysis.Disk.of_parts(PLATE, (), "x"),
    "constraints must be one of contact, .* got 'x'": lambda: analysis.multiplier_names(["x"]),
    "constraints must be one of contact, .* got array": lambda: Scenario(
        constraints=["contact", np.zeros(2)]
    ),
    "fields must be named by text, got 5": lambda: Ensemble(
        scenario=Scenario(), fields={5: [1.0]}
    ),
    "fields must map names to arrays, got Scenario": lambda: Ensemble(
        scenario=Scenario(), fields=Scenario()
    ),
    "motions must be a list of motions and errors, got 5": lambda: analysis.outcomes(5),
    r"motions\[1\] must be a SampledMotion, got 'x'": lambda: analysis.outcomes([RUN, "x"]),
    "executor must be an Executor or act as one, got 'x'": lambda: simulate_many(
        [Scenario()], [0.0, 0.01], executor="x"
    ),
    "ax must be the axes of a figure, got 5": lambda: RUN.plot("beta", ax=5),
    "times must hold no masked values, got": lambda: simulate(
        Scenario(), np.ma.array([0.0, 1.0, 2.0], mask=[False, True, False])
    ),
    "index must be at most 1, got 2": lambda: RUN.state(2),
    "index must be at least -2, got -3": lambda: RUN.state(-3),
    "index must be a whole number, got None": lambda: RUN.state(None),
    "path must be the path of a file, got 5": lambda: analysis.load_run(5),
    "path must be the path of a file, got None": lambda: analysis.load_scenario(None),
    "path must be the path of a file, got True": lambda: RUN.to_csv(True),
    r"path must be the path of a file, got 'a\\x00b'": lambda: RUN.save("a\0b"),
    "kind must be one of None, .* got 5": lambda: analysis.load_run("run.npz", 5),
    "scenario must be a Scenario, got 5": lambda: _trajectory(scenario=5),
    "ending must be an Ending, got 'x'": lambda: _trajectory(ending="x"),
    "method must be a mapping, got int": lambda: _trajectory(method=5),
    "solver_seconds must not be negative, got -1": lambda: _trajectory(solver_seconds=-1.0),
    "pulling must hold first and last times, got": lambda: _trajectory(pulling=[(1.0,)]),
    "coordinates must have shape .* got": lambda: analysis.energies(
        Scenario(), np.zeros((3, 5)), RUN.rates
    ),
    "rates must have shape .* got": lambda: analysis.energies(
        Scenario(), RUN.coordinates, np.zeros((3, 6))
    ),
    "spin must be a finite number, got nan": lambda: _place(0.0, 0.0, 1.5, 1.5, spin=nan),
    "spin must be a finite number, got True": lambda: analysis.Start(spin=True),
    "spin must lie from -100000 to 100000": lambda: stationary_motions(REDUCED, 1e6),
    "starts must be at most 10000": lambda: stationary_motions(REDUCED, 30.0, 10**9),
    "place must hold x, y, beta and gamma": lambda: _place(1.0, 2.0),
    "place must be finite": lambda: _place(0.0, nan, 1.5, 1.5),
    "beta must lie in the open interval": lambda: _place(0.0, 0.0, 0.0, 1.5),
    "gradients must lie from 0 to 1e\\+12": lambda: chart.hopf_curves(Scenario(), [1e15]),
    "crossing must be a Crossing, got 5": lambda: sensitivities(REDUCED, 5),
    "breaking must be an Event, got 'x'": lambda: families.asymmetric_family("x"),
    "family must be a Family, got None": lambda: following.events(None),
    "scenarios must be a list of Scenario, got 5": lambda: families.cycles_over(5, amplitude=1.0),
    "progress must be a function, got 3": lambda: families.cycle_family(REDUCED, progress=3),
    "progress must be a function, got 'x'": lambda: families.rotating_family(
        REDUCED, progress="x"
    ),
    "start must be a StationaryMotion, got 5": lambda: stationary_branch(REDUCED, 5, (20.0, 40.0)),
    "interval must be lowest and highest value": lambda: stationary_branch(REDUCED, TILTED, [1.0]),
    "parameter must be a Parameter, got 5": lambda: stationary_branch(
        REDUCED, TILTED, (20.0, 40.0), 5
    ),
    "change must be a function, got 'x'": lambda: Parameter(change="x", value=1.0, unit=1.0),
    "time must be a finite number, got nan": lambda: analysis.Ending(
        reason="x", time=nan, value=0.0
    ),
    "relative must be a finite number, got nan": lambda: Newton(relative=nan),
    "keep must be one of .* got 'nothing'": lambda: Plan(keep=("nothing",)),
}
"""How a message begins, and the call."""


@pytest.mark.parametrize("message", WRONG)
def test_wrong_value_is_told_in_one_short_line(message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}") as raised:
        WRONG[message]()
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 320
    # What is frozen is assigned to on the way.
    assert "__setattr__" not in "".join(traceback.format_exception(raised.value))


@pytest.mark.parametrize("member", [2, -3, "x", None])
def test_member_that_an_ensemble_does_not_have_is_refused_by_name(member: Any) -> None:
    ensemble = Ensemble(scenario=Scenario(), fields={"spin": [30.0, 40.0]})
    runs = simulate_many(ensemble, [0.0, 0.01], workers=1)
    for call in (ensemble.__getitem__, runs.__getitem__, runs.outcome):
        with pytest.raises(IndexError, match=rf"^member must lie from -2 to 1, got {member!r}$"):
            call(member)
    assert runs[-1].scenario == ensemble[-1] == ensemble[1]
