"""Whatever is public refuses by name what is of no kind that it takes, or out of range."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload, dict-item, list-item"

import re
import traceback
from collections.abc import Callable, Iterator
from dataclasses import fields
from importlib import import_module
from inspect import Parameter, isfunction, signature
from math import nan
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    CENTRED_DISK,
    LAWS,
    STEEL_DISK,
    Disk,
    Dissipation,
    Ending,
    Ensemble,
    PenaltyContact,
    RestCriterion,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    Trajectory,
    simulate,
    simulate_many,
)
from analysis.nonlinear import families, stationary
from analysis.nonlinear.collocation import hopf_cycle
from analysis.nonlinear.following import Family
from analysis.nonlinear.heteroclinic import fall
from analysis.nonlinear.motions import Event
from analysis.stability import stationary_rolling
from analysis.stability.boundaries import hopf_curves
from analysis.stability.chart import static_gradient
from analysis.stability.critical import Crossing
from analysis.stability.linearisation import stationary_eigenvalues
from mbs_models import Integrator, Newton, Scene
from tests.calls import ROOT
from tests.helpers import model, refusals
from validation.studies import crosscheck
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan

FULL, REDUCED, REST = Scenario(), model(4), Scenario.rest()
TIMES = [0.0, 0.01]
RUN, REST_RUN = simulate(FULL, TIMES), analysis.simulate_to_rest(REST, 0.01)
TILTED = stationary.StationaryMotion(
    spin=30.0, x=0.0, y=0.0, beta=1.0, gamma=1.0, eigenvalues=np.zeros(1, complex), value=30.0
)
BORN = Event("symmetry-breaking", hopf_cycle(REDUCED))

FITTING: dict[str, Any] = {
    "amplitude": 1.0,
    "beta": 0.5,
    "breaking": BORN,
    "constraints": ("contact",),
    "coordinates": RUN.coordinates,
    "crossing": Crossing(spin=30.0, frequency=1.0, kind="hopf", stable_side="above"),
    "disk": STEEL_DISK,
    "end": 0.01,
    "family": Family(motions=(BORN.motion,), begins=30.0, born=BORN),
    "fields": {"spin": [30.0]},
    "formulation": "floating",
    "gradients": [3.0, 4.0],
    "index": 0,
    "interval": (20.0, 40.0),
    "motions": [RUN],
    "other": REST_RUN,
    "path": "run.npz",
    "place": (0.0, 0.0, 1.5, 1.5),
    "precession": 10.0,
    "plate": (0.045, 0.01, 7700.0),
    "rates": RUN.rates,
    "scenarios": [REDUCED],
    "scene": Scene(),
    "spin": 30.0,
    "spins": [30.0],
    "start": TILTED,
    "state": FULL.initial_state,
    "stiffness": 1e5,
    "time": 0.0,
    "times": TIMES,
    "trajectory": RUN,
    "values": [2.0, 1.0],
}
"""What goes for an argument of this name that has no default."""

OBJECTS = (
    FULL, FULL.initial_state, Start(), Table(), STEEL_DISK, crosscheck.ELLIPSE, crosscheck.TOP,
    *(law() for law in LAWS.values()), PenaltyContact(stiffness=1e5), Dissipation(), RUN, REST_RUN,
    Ending(reason="x", time=1.0, value=0.0), RestCriterion(), Scene(), Newton(),
    Integrator(name="DOPRI5"), stationary.Parameter(change=len, value=1.0, unit=1.0), Plan(),
    Design(axes=(Axis(field="spin", first=0.0, last=1.0),), layout="random", number=3),
)  # fmt: skip
"""One of each class that checks its fields."""

NAMES = re.findall(
    r"^   ((?:analysis|mbs_models)(?:\.\w+)*)\.(\w+)$",
    (ROOT / "docs" / "api.md").read_text("utf-8"),
    re.MULTILINE,
)
PUBLIC = [getattr(import_module(module), name) for module, name in NAMES]
OTHERS = (
    Ensemble, Disk.of_parts, Disk.ring, PenaltyContact.damped, PenaltyContact.rounded,
    Start.stationary, RUN.at, RUN.resampled, RUN.save, RUN.state, RUN.to_csv, REST_RUN.deviation,
    REST_RUN.to_trajectory, families.first_asymmetric_family, fall, static_gradient,
)  # fmt: skip
"""Methods, and what no page lists."""

CENTRED = Scenario.rest(disk=CENTRED_DISK, dissipation=Dissipation(rolling_dry=1e-3))
CLOSED_FORMS = (
    stationary_rolling.axial_spin, stationary_rolling.upright_rolling_spin,
    stationary_rolling.euler_disk_precession, stationary_rolling.euler_disk_energy,
    stationary_rolling.time_to_flat,
)  # fmt: skip
"""Of a disk that rolls, whose centre of gravity is its centre."""

CALLS: dict[Any, dict[str, Any]] = {
    **{call: {} for call in (*filter(isfunction, PUBLIC), *OTHERS)},
    families.cycle_family: {"amplitudes": (0.1,)},
    families.cycles_over: {"amplitude": None, "spin": 30.0},
    analysis.simulate_to_rest: {"scenario": REST},
    mbs_models.simulate_to_rest: {"scene": Scene(REST)},
    **{call: {"scenario": CENTRED} for call in CLOSED_FORMS},
    stationary_rolling.rolling_start: {"disk": CENTRED_DISK},
    **{type(each): {field.name: getattr(each, field.name) for field in fields(each)}
       for each in OBJECTS},
}  # fmt: skip
"""What may be called, and what goes for its arguments where that is another or has a default."""

SAID = {(Integrator, "name"): "integrator", (families.cycles_over, "scenarios"): "scenario"}
"""Arguments that are spoken of by another name."""


NEVER_ZERO = (
    "tolerance", "local_tolerance", "time_limit", "step", "spacing", "end", "beta", "precession",
    "stiffness", "least_leaning", "unit", "energy", "duration", "relative", "absolute", "workers",
    "starts",
)  # fmt: skip
NEVER_NEGATIVE = ("ratio", "solver_seconds", "error_estimate", "rest_time")


def parameters(call: Any) -> dict[str, Parameter]:
    found = dict(signature(call).parameters)
    # What it hands on to each run.
    if found.pop("how", None):
        found = {**signature(simulate).parameters, **found}
        del found["scenario"]
    return {name: each for name, each in found.items() if each.kind != Parameter.VAR_KEYWORD}


def wrong_values(name: str, default: Any) -> Iterator[Any]:
    """Values of kinds that nothing takes, and of those that this argument does not."""
    yield object()
    yield np.array([None, None])
    yield np.ma.array([0.0, 1.0, 2.0], mask=[False, True, False])
    yield nan
    if name in NEVER_ZERO:
        yield 0
    if name in NEVER_NEGATIVE:
        yield -1.0
    if default is not None and name != "time_limit":
        yield None
    if not (isinstance(default, bool) or name == "constrained"):
        yield True
    if name not in ("path", "reason"):
        yield "glue"


EVERY = [(call, name) for call in CALLS for name in parameters(call)]


@pytest.mark.parametrize(
    ("call", "name"),
    EVERY,
    ids=[f"{call.__module__}.{call.__qualname__}-{name}" for call, name in EVERY],
)
def test_what_is_of_the_wrong_kind_is_refused_in_one_line_by_the_name_of_its_argument(
    call: Any, name: str
) -> None:
    known = parameters(call)
    given = {"scenario": REDUCED if "nonlinear" in call.__module__ else FULL} | CALLS[call]
    needed = [each for each in known if known[each].default is Parameter.empty]
    given = CALLS[call] | {each: (FITTING | given)[each] for each in needed}
    for wrong in wrong_values(name, known[name].default):
        with pytest.raises(ValueError, match=f"^{SAID.get((call, name), name)}") as raised:
            call(**{**given, name: wrong})
        assert "\n" not in str(raised.value)
        assert len(str(raised.value)) < 320
        # What is frozen is assigned to on the way.
        assert "__setattr__" not in "".join(traceback.format_exception(raised.value))


def _place(*place: Any) -> Any:
    return stationary_eigenvalues(REDUCED, 30.0, place)


def _trajectory(**changes: Any) -> Any:
    return Trajectory(**CALLS[Trajectory] | changes)


def _full(**how: Any) -> Any:
    return simulate(**{"scenario": FULL, "times": TIMES} | how)


def _reduced(scenario: Scenario) -> Any:
    return simulate(scenario, TIMES, formulation="reduced")


def _many(scenarios: Any = (FULL,), **how: Any) -> Any:
    return simulate_many(list(scenarios), TIMES, **{"workers": 1} | how)


def _rest(scenario: Scenario = REST, **how: Any) -> Any:
    return analysis.simulate_to_rest(scenario, 0.01, **how)


def _ensemble(scenario: Scenario = FULL, **fields: Any) -> Any:
    return Ensemble(scenario=scenario, fields=fields)


PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))
SHARP = Scenario.rest(contact=PenaltyContact(stiffness=1e6))
CONDITIONS: list[Any] = [lambda state: 1.0 - state.rates[3], lambda state: state.rates[3] - 1.0]

WRONG: dict[str, Callable[[], Any]] = {
    "constraints must be one of contact, .* got array": lambda: Scenario(
        constraints=["contact", np.zeros(2)]
    ),
    "fields must be named by text, got 5": lambda: Ensemble(scenario=FULL, fields={5: [1.0]}),
    r"motions\[1\] must be a SampledMotion, got 'x'": lambda: analysis.outcomes([RUN, "x"]),
    r"scenarios\[1\] must be a Scenario, got 3": lambda: _many([FULL, 3]),
    "ax must be the axes of a figure, got 5": lambda: RUN.plot("beta", ax=5),
    "index must be at most 1, got 2": lambda: RUN.state(2),
    "index must be at least -2, got -3": lambda: RUN.state(-3),
    r"path must be the path of a file, got 'a\\x00b'": lambda: RUN.save("a\0b"),
    "pulling must hold first and last times, got": lambda: _trajectory(pulling=[(1.0,)]),
    "coordinates must have shape .* got": lambda: analysis.energies(
        FULL, np.zeros((3, 5)), RUN.rates
    ),
    "rates must have shape .* got": lambda: analysis.energies(
        FULL, RUN.coordinates, np.zeros((3, 6))
    ),
    "spin must lie from -100000 to 100000": lambda: stationary.stationary_motions(REDUCED, 1e6),
    "starts must be at most 10000": lambda: stationary.stationary_motions(REDUCED, 30.0, 10**9),
    "place must hold x, y, beta and gamma": lambda: _place(1.0, 2.0),
    "beta must lie in the open interval": lambda: _place(0.0, 0.0, 0.0, 1.5),
    "stiffness must be above 0 and at most 1e": lambda: PenaltyContact(stiffness=2e12),
    "gradients must lie from 0 to 1e\\+12": lambda: hopf_curves(FULL, [1e15]),
    "interval must be lowest and highest value": lambda: stationary.stationary_branch(
        REDUCED, TILTED, [1.0]
    ),
    "local_tolerance must lie from 3e-14 to less than 1": lambda: _full(local_tolerance=2.0),
    "give either tolerance or": lambda: _full(tolerance=1e-6, local_tolerance=1e-6),
    "formulation 'reduced' exists for Model 4 alone, got": lambda: _reduced(model(3)),
    "formulation 'reduced' takes the load 'weight'": lambda: _reduced(
        model(4, friction=SmoothCoulomb(load="contact"))
    ),
    "formulation 'reduced' needs a hor": lambda: _reduced(model(4, table=Table(inclination=0.1))),
    "formulation 'free-body' needs a penalty contact, got": lambda: _full(formulation="free-body"),
    "formulation 'index-1' takes no penalty contact, got": lambda: _full(
        scenario=PENALTY, formulation="index-1"
    ),
    "stop_when must be one of inverted, lost, module:func": lambda: _full(stop_when="asleep"),
    "stop_when must hold names or functions of a State": lambda: _full(stop_when="math:pi"),
    "stop_when <lambda> must say a number of": lambda: _full(stop_when=lambda _: "low"),
    "stop_when 'no.such:thing' cannot be loaded: No": lambda: _full(stop_when="no.such:thing"),
    "stop_when .* different names, got <lambda> twice": lambda: _full(stop_when=CONDITIONS),
    "stop_when must hold functions that worker processes": lambda: _many(
        2 * [FULL], workers=2, method="RK45", stop_when=CONDITIONS[0]
    ),
    "local_tolerance must lie from 1e-13 to less th": lambda: _rest(local_tolerance=2.0),
    "half_thickness must be positive for the disk": lambda: _rest(SHARP),
    "contact must be a PenaltyContact, got None": lambda: _rest(FULL),
    "spacing must not exceed end = 0.01": lambda: _rest(spacing=2.0),
    "give either tolerance or l": lambda: _rest(tolerance=1e-3, local_tolerance=1e-8),
    "method must be one of": lambda: _rest(method="Radau"),
    "fields must map names to arrays": _ensemble,
    "start.spin must hold no masked valu": lambda: _ensemble(spin=np.ma.array([1.0], mask=[True])),
    "fields must be a field of a scenario": lambda: _ensemble(spim=[1.0]),
    "fields .* start.spin twice": lambda: _ensemble(**{"spin": [1.0], "start.spin": [2.0]}),
    r"fields .* got \(2,\) of start.spin": lambda: _ensemble(spin=[1.0, 2.0], mu=[0.1]),
    r"start.spin must have shape \(m,\)": lambda: _ensemble(spin=3.0),
    "member 1 of fields: stiffness must be at le": lambda: _ensemble(
        PENALTY, stiffness=[1e5, 1.0]
    ),
}
"""How a message begins, and the call."""

test_wrong_value_is_told_with_what_is_allowed = refusals(
    {f"^{message}": call for message, call in WRONG.items()}
)


@pytest.mark.parametrize("member", [2, -3, "x", None])
def test_member_that_an_ensemble_does_not_have_is_refused_by_name(member: Any) -> None:
    ensemble = Ensemble(scenario=FULL, fields={"spin": [30.0, 40.0]})
    runs = simulate_many(ensemble, TIMES, workers=1)
    for call in (ensemble.__getitem__, runs.__getitem__, runs.outcome):
        with pytest.raises(IndexError, match=rf"^member must lie from -2 to 1, got {member!r}$"):
            call(member)
    assert runs[-1].scenario == ensemble[-1] == ensemble[1]


def test_truth_values_of_numpy_are_switches() -> None:
    assert _full(allow_pulling=np.True_).ending is None
    assert PenaltyContact(stiffness=1e5, bilateral=np.True_).bilateral is True
