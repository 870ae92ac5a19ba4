"""Whatever is public refuses by name what is of no kind that it takes, or out of range."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type, call-overload, dict-item, list-item"

import re
import traceback
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from fractions import Fraction
from functools import partial
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
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    ConstraintSet,
    Disk,
    Dissipation,
    Ending,
    Ensemble,
    PenaltyContact,
    RestCriterion,
    Scenario,
    SmoothCoulomb,
    Sphere,
    Start,
    Table,
    Trajectory,
    scenario_text,
    simulate,
    simulate_many,
)
from analysis.mechanics.paper import closed_form, critical_speed
from analysis.mechanics.recorded import accelerations
from analysis.nonlinear import families, stationary
from analysis.nonlinear.collocation import hopf_cycle
from analysis.nonlinear.following import Family
from analysis.nonlinear.heteroclinic import Connection, fall, period_growth, saddle
from analysis.nonlinear.motions import Event
from analysis.nonlinear.slow_manifold import slow_connection
from analysis.problem.limits import LEAST_TILT
from analysis.problem.variations import changed
from analysis.stability import stationary_rolling as rolling
from analysis.stability.boundaries import hopf_curves
from analysis.stability.chart import stability_chart, static_gradient
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.linearisation import (
    Linearisation,
    spinning,
    stationary_eigenvalues,
    upright,
)
from analysis.stability.spectra import branches, eigenvalues
from analysis.stability.stationary_rolling import fit_power_law
from mbs_models import Integrator, Newton, Scene
from tests.calls import ROOT
from tests.helpers import model, refusals
from tests.wayward_law import Answering, Own
from validation.studies import crosscheck
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan

FULL, REDUCED, REST = Scenario(), model(4), Scenario.rest()
TIMES = [0.0, 0.01]
to_rest = analysis.simulate_to_rest
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
    rolling.axial_spin, rolling.upright_rolling_spin,
    rolling.euler_disk_precession, rolling.euler_disk_energy,
    rolling.time_to_flat,
)  # fmt: skip
"""Of a disk that rolls, whose centre of gravity is its centre."""

CALLS: dict[Any, dict[str, Any]] = {
    **{call: {} for call in (*filter(isfunction, PUBLIC), *OTHERS)},
    families.cycle_family: {"amplitudes": (0.1,)},
    families.cycles_over: {"amplitude": None, "spin": 30.0},
    to_rest: {"scenario": REST},
    mbs_models.simulate_to_rest: {"scene": Scene(REST)},
    **{call: {"scenario": CENTRED} for call in CLOSED_FORMS},
    rolling.rolling_start: {"disk": CENTRED_DISK},
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


def fitting(call: Any) -> dict[str, Any]:
    """What goes for the arguments of a call that have no default, or that it wants otherwise."""
    known, given = parameters(call), CALLS.get(call, {})
    usual = REDUCED if "nonlinear" in getattr(call, "__module__", "") else FULL
    fits = FITTING | {"scenario": usual} | given
    needed = [each for each in known if known[each].default is Parameter.empty]
    return given | {each: fits[each] for each in needed if each in fits}


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
    given = fitting(call)
    for wrong in wrong_values(name, parameters(call)[name].default):
        with pytest.raises(ValueError, match=f"^{SAID.get((call, name), name)}") as raised:
            call(**{**given, name: wrong})
        assert "\n" not in str(raised.value)
        assert len(str(raised.value)) < 320
        # What is frozen is assigned to on the way.
        assert "__setattr__" not in "".join(traceback.format_exception(raised.value))


PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))
BALL = Sphere(
    mass=0.1, radius=0.045, eccentricity=0.0, inertia_x=1e-4, inertia_y=1e-4, inertia_z=1e-4
)
SHARP = Scenario.rest(contact=PenaltyContact(stiffness=1e6))
LEANING = Table(inclination=0.1)
LOADED = SmoothCoulomb(load="contact")
GENERAL = [law for law in (kind() for kind in LAWS.values()) if not law.is_simple]
CONDITIONS: list[Any] = [lambda state: 1.0 - state.rates[3], lambda state: state.rates[3] - 1.0]
TUGGED = Scenario(start=Start(beta=0.5, spin=0.0, beta_rate=-40.0, gamma_rate=0.0))
TWICE: ConstraintSet = ("contact", "fixed-cog", "no-slip-across", "held-tilt-rate")
FOLD = Event("fold", BORN.motion)
UPRIGHT = replace(TILTED, beta=np.pi / 2, gamma=np.pi / 2)
PIVOTING = replace(CENTRED, dissipation=Dissipation(rolling_dry=1e-3, pivoting=0.01))
ROLLING_BOTH = Scenario.rest(
    disk=CENTRED_DISK, dissipation=Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3)
)
HERE = Connection(spin=1, below=1, above=1, growing=1, slow=-1, strong=-2)
MASKED = np.ma.array([1.0], mask=[True])


def rubbing(**law: Any) -> dict[str, Any]:
    """Model 4 with other friction."""
    return {"scenario": model(4, friction=SmoothCoulomb(**law))}


FULL_SYSTEM = (
    partial(eigenvalues, system="full"), static_gradient, stability_chart, hopf_curves,
)  # fmt: skip
ANY_SYSTEM = (eigenvalues, critical_speeds, spinning)
REDUCED_SYSTEM = partial(eigenvalues, system="reduced")
# What takes others is told where eigenvalues are asked for, and nowhere else.
HINT = "; eigenvalues .* are those of the system 'numeric'$"

WRONG: list[tuple[Any, dict[str, Any], str]] = [
    (Scenario, {"constraints": ["contact", np.zeros(2)]}, "constraints .* contact, .* got array"),
    (Ensemble, {"fields": {5: [1.0]}}, "fields must be named by text, got 5"),
    (Ensemble, {"fields": {}}, "fields must map names to arrays"),
    (Ensemble, {"fields": {"spin": MASKED}}, "start.spin must hold no masked valu"),
    (Ensemble, {"fields": {"spim": [1.0]}}, "fields must be a field of a scenario"),
    (Ensemble, {"fields": {"spin": [1.0], "start.spin": [2.0]}}, "fields .* start.spin twice"),
    (Ensemble, {"fields": {"spin": [1.0, 2.0], "mu": [0.1]}}, r"fields .* got \(2,\) of start.sp"),
    (Ensemble, {"fields": {"spin": 3.0}}, r"start.spin must have shape \(m,\)"),
    (Ensemble, {"fields": {"contact.stiffness": [1e5]}}, ".*needs a penalty contact"),
    (Ensemble, {"fields": {"friction.static": [0.1]}}, ".*static is unknown here; .* takes law"),
    (Ensemble, {"fields": {"disk.radius": [0.05], "disk.mass": [0.4]}},
     ".*mass does not go with hole_ra.*; or radius, m"),
    (Ensemble, {"fields": {"disk.density": [1.0], "disk.mass": [0.4]}},
     ".*mass does not go with density; .disk"),
    (Ensemble, {"scenario": Scenario(disk=ROUNDED_STEEL_DISK), "fields": {"disk.radius": [0.05]}},
     ".*radius varies a ring alone"),
    (Ensemble, {"scenario": replace(FULL, start=FULL.initial_state)},
     ".*the start is told by its coordinates and"),
    (analysis.outcomes, {"motions": [RUN, "x"]}, r"motions\[1\] must be a SampledMotion, got 'x'"),
    (lambda ax: RUN.plot("beta", ax=ax), {"ax": 5}, "ax must be the axes of a figure, got 5"),
    (RUN.state, {"index": 2}, "index must be at most 1, got 2"),
    (RUN.state, {"index": -3}, "index must be at least -2, got -3"),
    (RUN.save, {"path": "a\0b"}, r"path must be the path of a file, got 'a\\x00b'"),
    (scenario_text, {"scenario": Scenario(friction=Own(kind={1}))},
     r"kind cannot be written to a scenario's file"),
    (Trajectory, {"pulling": [(1.0,)]}, "pulling must hold first and last times, got"),
    (Trajectory, {"times": [[0.0], [1.0, 2.0]]}, "times must be an array of real numbers, got"),
    (Trajectory, {"counts": {3: 1}}, "counts must have names as its keys, got 3"),
    (analysis.energies, {"coordinates": np.zeros((3, 5))}, "coordinates must have shape .* got"),
    (analysis.energies, {"rates": np.zeros((3, 6))}, "rates must have shape .* got"),
    (PenaltyContact, {"stiffness": 2e12}, "stiffness must be above 0 and at most 1e"),
    # What a run would not see leave the table: by the sine of its tilt, it lies flat.
    *((Start, {"beta": beta}, "beta must keep more than 1e-06 rad")
      for beta in (LEAST_TILT, np.nextafter(LEAST_TILT, 1.0))),
    # Upright, a disk whose centre of gravity may not slip sideways cannot tilt.
    (Scenario, {"disk": CENTRED_DISK, "constraints": TWICE}, "constraints must be independent: "),
    *((partial(changed, FULL), {"changes": {"model": each}}, "model must be one of 1, 2, 3, 4, g")
      for each in (True, 2.0)),
    *((run.at, {"time": time}, "times must lie within the samples, from 0 to 0")
      for run in (RUN, REST_RUN) for time in (-1e-6, 0.6)),
    (REST_RUN.to_trajectory, {"end": 1e-6}, r"end must lie from 0\.0\d+ to inf, got 1e-06$"),
    (Start, {"spin": np.timedelta64(5, "ns")}, "spin must be a finite number, got"),
    (RUN.state, {"index": np.timedelta64(0, "ns")}, "index must be a whole number, got"),
    # Runs.
    (simulate, {"scenario": TUGGED}, "start needs a contact that pulls, with a normal force"),
    (mbs_models.simulate, {"scene": TUGGED}, "start needs a contact that pulls, with a normal f"),
    (simulate, {"scenario": Scenario(constraints=TWICE, start=Start.stationary(30.0))},
     "start must be one where the constraints of contact .* do not depend on each other, as"),
    (simulate, {"local_tolerance": 2.0}, "local_tolerance must lie from 3e-14 to less than 1"),
    (simulate, {"tolerance": 1e-6, "local_tolerance": 1e-6}, "give either tolerance or"),
    (simulate, {"scenario": model(3), "formulation": "reduced"},
     "formulation 'reduced' exists for Model 4 alone, got"),
    (simulate, {"scenario": model(4, friction=LOADED), "formulation": "reduced"},
     "formulation 'reduced' takes the load 'weight'"),
    *((simulate, {"scenario": model(1, friction=law), "method": "taylor"},
       ".*takes friction that is isotropic") for law in GENERAL),
    (simulate, {"scenario": model(4, table=LEANING), "formulation": "reduced"},
     "formulation 'reduced' needs a hor"),
    (simulate, {"formulation": "free-body"}, "formulation 'free-body' needs a penalty contact, g"),
    (simulate, {"scenario": PENALTY, "formulation": "index-1"},
     "formulation 'index-1' takes no penalty contact, got"),
    (simulate, {"stop_when": "asleep"}, "stop_when must be one of inverted, lost, module:func"),
    (simulate, {"stop_when": "math:pi"}, "stop_when must hold names or functions of a State"),
    (simulate, {"stop_when": lambda _: "low"}, "stop_when <lambda> must say a number of"),
    (simulate, {"stop_when": "no.such:thing"}, "stop_when 'no.such:thing' cannot be loaded: No"),
    (simulate, {"stop_when": CONDITIONS}, "stop_when .* different names, got <lambda> twice"),
    (simulate_many, {"scenarios": [FULL, 3]}, r"scenarios\[1\] must be a Scenario, got 3"),
    (simulate_many,
     {"scenarios": 2 * [FULL], "workers": 2, "method": "RK45", "stop_when": CONDITIONS[0]},
     "stop_when must hold what worker processes"),
    (simulate_many,
     {"scenarios": 2 * [model(1, friction=Answering(says=lambda _: 1.0))], "workers": 2,
      "method": "RK45"}, "scenarios must hold what worker processes import by name, or"),
    (Table, {"gravity": 5e-324}, "gravity must be at least 2.23e-308, got 4.94e-324"),
    (to_rest, {"end": Fraction(10**9), "spacing": 1e6}, r"end = 1e\+09 s at stiffness .* would"),
    (mbs_models.simulate_to_rest, {"end": Fraction(1, 100), "step": Fraction(1, 1000)},
     "step must not exceed .*, got 0.001"),
    (to_rest, {"local_tolerance": 2.0}, "local_tolerance must lie from 1e-13 to less th"),
    (to_rest, {"scenario": SHARP}, "half_thickness must be positive for the disk"),
    (to_rest, {"scenario": FULL}, "contact must be a PenaltyContact, got None"),
    (to_rest, {"spacing": 2.0}, "spacing must not exceed end = 0.01"),
    (to_rest, {"tolerance": 1e-3, "local_tolerance": 1e-8}, "give either tolerance or l"),
    (to_rest, {"method": "Radau"}, "method must be one of"),
    # Linear systems.
    *((call, {"scenario": Scenario(table=LEANING)}, ".*needs a horizontal table")
      for call in (*FULL_SYSTEM, *ANY_SYSTEM, closed_form, critical_speed)),
    (REDUCED_SYSTEM, {"scenario": model(4, table=LEANING)}, ".*needs a horizontal table"),
    *((call, {"scenario": PENALTY}, ".*needs the ideal contact, got a Penalty")
      for call in FULL_SYSTEM),
    *((call, {"scenario": replace(PENALTY, dissipation=Dissipation(pivoting=1e-4))},
       ".* must have neither .* the spin decays, got 0.0001 m and 0 kg/m")
      for call in ANY_SYSTEM),
    *((REDUCED_SYSTEM, {"scenario": model(4, friction=law)},
       ".*has no force for each newton of load and each m/s") for law in GENERAL),
    (FULL_SYSTEM[0], {"scenario": model(2)}, rf"the full .* of Model 1, got Model 2{HINT}"),
    (REDUCED_SYSTEM, {"scenario": model(2)}, rf"the reduced .* of Model 4, got Model 2{HINT}"),
    *((call, {"scenario": model(2)}, "the full system is that of Model 1, got Model 2$")
      for call in FULL_SYSTEM[1:]),
    (stability_chart, {"gradients": []}, "gradients must be one-dimensional"),
    (stability_chart, {"gradients": [-1.0]}, "gradients must not be negative, got -1"),
    (critical_speeds, {"interval": (10.0, 10.0)}, "interval must have .* got 10 to 10"),
    (critical_speeds, {"interval": (0.0, 1e6)}, "interval must lie from -100000 to 100000"),
    (hopf_curves, {"gradients": [1e15]}, "gradients must lie from 0 to 1e\\+12"),
    (hopf_curves, {"gradients": [1.0, 1.0]}, "gradients must be two or more"),
    (hopf_curves, {"gradients": [1.0, 0.0]}, "gradients must be positive"),
    (branches, {"spins": [1.0, 1.0]}, "spins must increase strictly, got 1 before 1"),
    (closed_form, rubbing(coefficient=0.0), "friction must have a positive grad"),
    # Rolling.
    (rolling.euler_disk_precession, {"scenario": FULL}, "disk must be .*, centred"),
    (rolling.rolling_start, {"disk": BALL, "beta": 0.8, "precession": 20.0, "spin": -10.0},
     "disk must be a round one"),
    (rolling.euler_disk_energy, {"scenario": replace(CENTRED, table=LEANING)}, ".*horizontal"),
    (rolling.time_to_flat, {"scenario": ROLLING_BOTH}, ".*either rolling_dry or rolling_viscous"),
    (fit_power_law, {"times": [0.0, 1.0], "values": [0.0, 1.0]}, "values must be positive, got 0"),
    (rolling.time_to_flat, {"scenario": PIVOTING}, "pivoting must be 0, .* got 0.01"),
    (fit_power_law, {"times": [0.0, 1.0], "values": [1.0, 0.5]}, "times must be 4 or more, got 2"),
    (fit_power_law, {"values": [1.0]}, r"values must have shape \(2,\), got \(1,\)"),
    (fit_power_law, {"end": 0.005}, "end must lie behind the last time"),
    # Stationary and periodic motions.
    (stationary.stationary_motions, {"spin": 1e6}, "spin must lie from -100000 to 100000"),
    (stationary.stationary_motions, {"spin": 0.0}, "spin must not be 0"),
    (stationary.stationary_motions, {"starts": 10**9}, "starts must be at most 10000"),
    *((stationary.stationary_motions, {"scenario": Scenario(disk=disk, friction=friction)},
       rf"eccentricity must be {least}\S* m or more here, got {disk.eccentricity:g}:")
      for disk, friction, least in (
          (CENTRED_DISK, SmoothCoulomb(), r"9\.5"),
          (replace(STEEL_DISK, eccentricity=9e-7), SmoothCoulomb(), r"9\.8"),
          (STEEL_DISK, SmoothCoulomb(smoothing=1e-9), r"0\.01"))),
    (stationary.stationary_motions, {"scenario": Scenario(table=LEANING)}, ".*horizontal table"),
    (stationary.stationary_motions, {"scenario": REST}, ".*ideal contact"),
    (stationary.stationary_branch, {"interval": [1.0]}, "interval must hold lowest, highest val"),
    (stationary.stationary_branch, {"start": UPRIGHT}, "start must be tilted"),
    (stationary.stationary_branch, {"interval": (40.0, 50.0)}, r".*spins about 30, got \(4"),
    (stationary_eigenvalues, {"place": (1.0, 2.0)}, "place must hold x, y, beta, gamma"),
    (stationary_eigenvalues, {"place": (0.0, 0.0, 0.0, 1.5)}, "beta must lie in the open int"),
    (families.rotating_family, {"scenario": FULL}, ".*is that of Model 4"),
    (families.cycle_family, {"scenario": model(4, disk=CENTRED_DISK)}, ".*eccentricity"),
    (families.cycle_family, rubbing(coefficient=0.0), "friction must have a positive"),
    (families.cycle_family, rubbing(load="contact"), ".*load must be 'weight'"),
    (families.cycle_family, rubbing(smoothing=1e-5), ".*gradient of at most 10000 s/m"),
    (families.cycle_family, {"amplitudes": (1.0, 6.3)}, r".*2 pi, got \(1.0, 6.3\)"),
    (families.rotating_family, {"tilts": (0.1, 1.6)}, "tilts must rise .* 0 and pi/2"),
    (families.asymmetric_family, {"breaking": FOLD}, ".*must be symmetry-breaking, got 'fold'"),
    (families.asymmetric_family, {"amplitudes": (0.2, 0.1)}, ".* rise strictly beyond 1e-06, got"),
    (families.cycles_over, {"amplitude": 1.0}, "amplitude or spin must be given"),
    (families.cycles_over, {"amplitude": 4.0, "spin": None},
     r"amplitude must lie in the open interval \(0, pi\)"),
    (families.cycles_over, {"scenarios": []}, "scenarios must be 1 or more"),
    (families.cycle_at, {"spin": 100.0}, r"spin must lie in the open interval \(15.* got 100"),
    (fall, rubbing(smoothing=1e-6), r".*gradient of at most 100000 s/m .* got 300000"),
    (saddle, {"scenario": FULL}, "the reduced system is that of Model 4, got Model 1"),
    (fall, {"spin": -30.0}, "spin must be positive"),
    (partial(period_growth, connection=HERE), {"cycles": []}, "cycles must hold 4"),
]  # fmt: skip
"""A call, arguments of which the others are those that go, and how the message begins."""


@pytest.mark.parametrize(("call", "wrong", "message"), WRONG)
def test_wrong_value_is_told_with_what_is_allowed(
    call: Any, wrong: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{message}") as raised:
        call(**fitting(call) | wrong)
    assert "\n" not in str(raised.value)


def linearised(radius: float) -> object:
    """Inverted spinning whose tilt is held twice: exactly so, or but for rounding."""
    disk = replace(STEEL_DISK, radius=radius)
    return spinning(Scenario(constraints=TWICE, disk=disk)).matrices(SPINS)


SPINS = np.array([30.0])
ASLANT = Linearisation(FULL, upright(FULL, np.pi / 2 - 0.2))
FLAT = Scenario(disk=replace(STEEL_DISK, eccentricity=0.0)), np.zeros(6), np.ones(6)

NONE_THERE: dict[str, Callable[[], object]] = {
    "singular index-1 system of Model 1": partial(accelerations, *FLAT),
    "singular index-1 system of contact": partial(linearised, 0.05),
    "singular linearisation of contact .*: one of": partial(linearised, 0.1),
    "change of the spin or of the place of Model 1": partial(ASLANT.matrices, SPINS),
    "friction law cannot give": lambda: slow_connection(**rubbing(coefficient=0.02)),
    "is no saddle with one growing": lambda: saddle(REDUCED, 0.0),
    "no cycle of the family loses its symmetry": lambda: families.first_asymmetric_family(
        replace(families.cycle_family(REDUCED, (0.15,)), born=FOLD)
    ),
}

test_what_there_is_not_is_no_wrong_value = refusals(NONE_THERE, ArithmeticError)


@pytest.mark.parametrize("member", [2, -3, "x", None])
def test_member_that_an_ensemble_does_not_have_is_refused_by_name(member: Any) -> None:
    ensemble = Ensemble(scenario=FULL, fields={"spin": [30.0, 40.0]})
    runs = simulate_many(ensemble, TIMES, workers=1)
    for call in (ensemble.__getitem__, runs.__getitem__, runs.outcome):
        with pytest.raises(IndexError, match=rf"^member must lie from -2 to 1, got {member!r}$"):
            call(member)
    assert runs[-1].scenario == ensemble[-1] == ensemble[1]


def test_truth_values_of_numpy_are_switches() -> None:
    assert simulate(FULL, TIMES, allow_pulling=np.True_).ending is None
    assert PenaltyContact(stiffness=1e5, bilateral=np.True_).bilateral is True
