"""What the engine side refuses, runs that come to nothing, and what Python raises within one."""

# Wrong on purpose.
# mypy: disable-error-code="arg-type"

import re
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    STEEL_DISK,
    Dissipation,
    FlatError,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Table,
    ToleranceError,
)
from analysis.problem.constraints import DEMANDS
from mbs_models import FORMULATIONS, EngineError, Integrator, Newton, Scene
from mbs_models.integrators import FINEST_ABSOLUTE, FINEST_LOCAL
from tests.bodies import EGG, TIPPE_TOP
from tests.calls import python
from tests.helpers import model, shifted
from tests.scenes import JAMMING, LOADED, TIMES, rest_scene, runner, scene_of

simulate = partial(mbs_models.simulate, scene_of(2), TIMES)
explicit = partial(mbs_models.simulate, Scene(), TIMES)
to_rest = mbs_models.simulate_to_rest

YIELDING, ROUNDED = PenaltyContact(stiffness=1e6), PenaltyContact.rounded(STEEL_DISK)

SPINNING = Start.stationary(30.0)

SPRING = PenaltyContact(stiffness=1e8, half_thickness=2e-4)
ROD = replace(STEEL_DISK, eccentricity=0.0, inertia_x=2e-4, inertia_y=2e-5, inertia_z=2e-4)
PIVOTING: dict[str, Any] = {
    "disk": ROD,
    "contact": PenaltyContact(stiffness=1e4, half_thickness=2e-4),
    "dissipation": Dissipation(pivoting=0.05),
}

# Upright, its tilt is held twice.
TWICE = Scenario(
    constraints=("contact", "fixed-cog", "no-slip-across", "held-tilt-rate"), start=SPINNING
)

RISING = State(coordinates=Scenario().initial_state.coordinates, rates=(0, 0, 2e-9, 0, 0, 0))


REFUSED: list[tuple[Callable[[], object], str]] = [
    (partial(simulate, step=1e-3, tolerance=1e-3), "either step or tolerance"),
    (partial(simulate, integrator="DOPRI5"), "explicit and cannot take the constraints"),
    (partial(explicit, tolerance=1e-6, integrator="DOPRI5"), "tolerance must be left out for"),
    *((partial(Integrator, name=name, local_tolerance=1e-14),
       f"local_tolerance must lie from {least:g} to less than 1")
      for name, least in (("DOP853", FINEST_LOCAL), ("DOPRI5", FINEST_ABSOLUTE))),
    (partial(Integrator, name="RK44", newton=Newton()), "newton is no option of"),
    (partial(Integrator, name="RK67", spectral_radius=0.9), "spectral_radius is no option"),
    (partial(Integrator, name="GeneralizedAlpha", spectral_radius=1.5), "from 0 to 1, got 1.5"),
    (partial(mbs_models.acceleration, scene_of(start=RISING)),
     "breaks the constraint 'contact' of Model 1 on velocity level by 2.000e-09 m/s"),
    *((partial(call, TWICE), "start must be one where the constraints of contact .* depend on")
      for call in (mbs_models.eigenvalues, mbs_models.acceleration)),
    (partial(scene_of, 2, "contact-tree"), "exists for Model 1 alone, got Model 2"),
    (partial(scene_of, 1, "contact-tree", friction=LOADED),
     "load 'contact' of the friction law .* use one of euler-tree"),
    (partial(scene_of, formulation="contact-tree", contact=YIELDING),
     "no room for a penalty contact; use one of euler-tree, floating, floating-lie"),
    (partial(scene_of, formulation="euler-tree", contact=ROUNDED),
     "singular .* half_thickness = 0.0002 .*; use one of floating-lie, floating"),
    (partial(scene_of, formulation="euler-tree", contact=YIELDING,
             dissipation=Dissipation(pivoting=1e-5)),
     "knows no dissipation .* use one of floating-lie, floating"),
    (partial(Scene, Scenario(disk=TIPPE_TOP), "contact-tree"),
     "'contact-tree' has a round disk at its end; use one of euler-tree, floating"),
    (partial(Scene, Scenario(disk=EGG), "floating"),
     "holds round disks and spheres alone on the ideal contact; use one of euler-tree"),
    (partial(mbs_models.eigenvalues, scene_of(
        contact=YIELDING, start=SPINNING, dissipation=Dissipation(pivoting=1e-4))),
     "linearisation .* must have neither pivoting friction nor air drag"),
    (partial(mbs_models.eigenvalues, scene_of(table=Table(inclination=0.1), start=SPINNING)),
     "linearisation .* needs a horizontal table, got an inclination"),
    (partial(Integrator, name="GeneralizedAlpha", newton={"relative": 1e-9}),
     "newton must be a Newton, got"),
    (partial(mbs_models.simulate, scene_of(3, "floating"), [0.0, 1e-9, 1e-2], step=5e-3,
             integrator="GeneralizedAlpha"),
     "times ask for steps of 1e-09 and 0.005 s, which differ too much for GeneralizedAlpha"),
    (partial(mbs_models.simulate, Scene(), [0.0, 1e-16]),
     "times must be 1e-15 s apart or more for the engine, got 1e-16 s"),
    # Of damper, spring and pivoting friction, the last about the axis of the least moment.
    *((partial(to_rest, rest_scene(**fields), 0.01, step=step), "the predicted stability limit")
      for fields, step in (({}, 5e-4), ({"contact": SPRING}, 1.2e-4), (PIVOTING, 1e-4))),
    (partial(to_rest, rest_scene(), 1.0, step=1e-4, tolerance=1e-3), "either step or tolerance"),
    (partial(to_rest, scene_of(1, "floating", contact=ROUNDED), 1.0),
     "must be of formulation 'floating-lie'"),
]  # fmt: skip


def long_steps(scene: Scene, step: float, **how: Any) -> Callable[[], object]:
    return partial(mbs_models.simulate, scene, [0.0, step, 2.0 * step], step=step, **how)


FAILING: list[tuple[Callable[[], object], type[Exception] | tuple[type, ...], str]] = [
    (long_steps(scene_of(1, "euler-tree"), 1.0), EngineError,
     r"stopped at t = .* s, before the end at 2 s: Newton's iteration"),
    (long_steps(scene_of(friction=SmoothCoulomb(smoothing=1e-6)), 5.0), EngineError,
     r"stopped at t = "),
    # Within the step, friction is asked for at infinite numbers, of which there is no sine.
    (long_steps(scene_of(1, "floating", friction=LOADED,
                         contact=PenaltyContact.damped(1e4, STEEL_DISK)),
                0.1, integrator="GeneralizedAlpha"), EngineError,
     "a step was so long that the motion exploded"),
    # It ends exactly flat, where a sharp rim touches the table all round.
    (partial(mbs_models.simulate,
             scene_of(1, "euler-tree", friction=LOADED,
                      contact=PenaltyContact(stiffness=42066.934554488995, bilateral=True),
                      start=Start(beta=0.2509332729589917, spin=5.688248758157979,
                                  gamma=-2.9190640927014524)),
             np.linspace(0.0, 0.3, 31), step=0.008746741891291529, allow_pulling=True,
             integrator=Integrator(name="GeneralizedAlpha", newton=Newton(modified=False))),
     # Whether it ends so near to flat, rounding decides.
     (EngineError, FlatError), r"stopped at t = .* s, .*: Newton's iteration did not converge \("),
    # So far off, a place has fewer digits.
    (partial(mbs_models.simulate, scene_of(start=Start(x=1e4)), TIMES,
             integrator=Integrator(name="DOPRI5", local_tolerance=FINEST_ABSOLUTE)), EngineError,
     "step control came down to its minimum step"),
    *((partial(mbs_models.simulate, Scene(JAMMING), TIMES, tolerance=1e-6, integrator=name),
       EngineError, "singular where the contact jams .*: each newton of its force calls for 1 N")
      for name in (None, "DOP853", "Radau", "LSODA")),
    (partial(explicit, tolerance=1e-16), ToleranceError,
     "cannot be reached: rounding leaves 2e-13 rad"),
    # It comes too near to flat for its steps.
    (partial(mbs_models.simulate, scene_of(1, "contact-tree", start=Start(beta=0.3, spin=0.0)),
             np.linspace(0.0, 0.2, 201), step=5e-3, integrator="RK44"), EngineError,
     r"stopped at t = 0\.06\d* s, before the end at 0\.2 s: the result is not finite"),
    # It lies flat after 3 ms.
    (partial(mbs_models.simulate, scene_of(1, "euler-tree", start=Start(beta=1e-3)), [0.0, 4e-3],
             tolerance=1e-7, time_limit=1.0), ToleranceError,
     "rounding leaves 1e-06 rad on 'euler-tree', which leans by 0.001 rad and falls; try form"),
    # With so small an error in a step, the second of these would be stepped by rounding.
    *((partial(mbs_models.simulate, scene_of(1, name, start=Start(beta=beta, spin=0.0)),
               [0.0, 0.1], tolerance=1e-8, integrator="DOP853", time_limit=2.0), FlatError,
       rf"^tolerance 1e-08 rad .* passes by flat after t = 0\.0.* '{name}' loses too many .*; try")
      for name, beta in (("euler-tree", 0.05), ("contact-tree", 0.3))),
    # No tree is proposed nearly flat.
    (partial(mbs_models.simulate, scene_of(1, start=Start(beta=0.3, spin=0.0)),
             np.linspace(0.0, 0.06, 13), tolerance=1e-11, integrator="DOP853"), ToleranceError,
     "the estimated error of the tightest run is .*; try the in-house equations"),
    (partial(mbs_models.simulate, scene_of(1, "floating-lie"), np.linspace(0.0, 0.1, 11),
             tolerance=2.1e-13), ToleranceError,
     r"tolerance 2\.1e-13 rad cannot be reached .* is \d"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [*((call, ValueError, message) for call, message in REFUSED), *FAILING],
)
def test_bad_input_is_refused_and_a_run_that_comes_to_nothing_says_why(
    call: Callable[[], object], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


BROKEN = {
    "normal_force": ("contact", 2, -2e-9),
    "cog_force_x": ("fixed-cog", 0, 2e-9),
    "cog_force_y": ("fixed-cog", 1, 2e-9),
    "tangential_force": ("no-slip-along", 3, None),
}
"""Constraint, the coordinate that breaks it and by how many m, if one does."""


@pytest.mark.parametrize("name", BROKEN)
def test_broken_constraint_is_named_with_its_amount_on_both_sides(name: str) -> None:
    constraint, index, place = BROKEN[name]
    scenario = model(3, start=Start(beta=1.0, gamma=0.3, spin=0.5))
    levels, lever = {"velocity": ("rates", 2e-9, "m/s")}, 1.0
    if place is not None:
        levels["position"] = ("coordinates", place, "m")
    else:
        # Turning faster about the COG moves the contact point at its distance from the axis.
        lever = (STEEL_DISK.radius + STEEL_DISK.eccentricity * np.sin(0.3)) * np.cos(1.0)
    for level, (field, amount, unit) in levels.items():
        start = shifted(scenario.initial_state, field, index, amount / lever)
        broken = replace(scenario, start=start)
        said = (
            f"'({re.escape(DEMANDS[name])}|{constraint})' of Model 3 on {level} level by "
            rf"{amount:.3e} {unit}, allowed is 1\.0e-09$"
        )
        calls: list[Callable[[], object]] = [partial(analysis.simulate, broken, [0.0, 0.1])]
        for formulation in mbs_models.formulations(broken):
            scene = Scene(broken, formulation)
            calls += (
                partial(mbs_models.simulate, scene, [0.0, 0.1]),
                partial(mbs_models.acceleration, scene),
                partial(mbs_models.eigenvalues, scene),
            )
        for call in calls:
            with pytest.raises(ValueError, match=said):
                call()


FURTHER = """
from analysis.problem import quantities
held = quantities.Held({"roll_torque": "constant rate of gamma"}, "N m", "gamma")
quantities.HELD["held-roll-rate"] = held
quantities.CONSTRAINTS = tuple(quantities.HELD)

from analysis import POSSIBLE_SETS, Scenario, Start
from analysis.mechanics import constraints, newton_euler, recorded
from analysis.mechanics.linear_algebra import NONE
from analysis.problem.elementary import cos, sin
from mbs_models import acceleration, formulations
known = constraints.directions

def directions(held, disk, angles):
    _, beta, gamma = angles
    turning = -cos(beta) * sin(gamma), -cos(beta) * cos(gamma), sin(beta)
    return [*known(held[:-1], disk, angles), constraints.Direction(NONE, turning, sin(beta))]

constraints.directions = newton_euler.directions = directions
start = Start(beta=1.0, gamma=0.4, spin=20.0, beta_rate=2.0, gamma_rate=3.0)
further = Scenario(constraints=("contact", "held-roll-rate"), start=start)
found, forces = acceleration(further)
state = further.initial_state
right, others = recorded.accelerations(further, state.coordinates, state.rates)
worst = max(abs(found - right).max() / abs(right).max(), abs(forces - others).max())
print(len(POSSIBLE_SETS), *formulations(further), float(worst))
"""


def test_a_further_constraint_needs_a_record_and_a_direction_alone() -> None:
    count, formulation, worst = python("-c", FURTHER).stdout.split()
    assert (count, formulation) == ("15", "euler-tree")
    assert float(worst) < 1e-10


class Beyond(BaseException):
    pass


PENDING: list[BaseException | None] = []
"""What calls of a law or a condition raise in turn, the last one first."""


def raise_in_turn() -> None:
    error = PENDING.pop() if PENDING else None
    if error is not None:
        raise error


@dataclass(frozen=True, slots=True, kw_only=True)
class Failing(SmoothCoulomb):
    def per_speed(self, speed: float) -> float:
        raise_in_turn()
        return SmoothCoulomb.per_speed(self, speed)


def failing(_: State) -> float:
    raise_in_turn()
    return 1.0


@pytest.mark.parametrize(
    "error",
    [LookupError("no such friction"), ValueError("law"), KeyboardInterrupt(), Beyond()],
    ids=lambda error: type(error).__name__,
)
@pytest.mark.parametrize("formulation", [*FORMULATIONS, "to rest"])
@pytest.mark.parametrize("by_steps", [False, True], ids=["tolerance", "step"])
@pytest.mark.parametrize("asked", ["law", "condition"])
def test_what_a_law_or_a_condition_raises_ends_a_run_and_comes_out_as_it_is(
    formulation: Any, asked: str, by_steps: bool, error: BaseException
) -> None:
    # Before a run, a law is looked at by some hundred calls.
    PENDING[:] = [error, *[None] * (500 if asked == "law" else 100)]
    how: dict[str, Any] = {"step": 1e-5} if by_steps else {"tolerance": 1e-6}
    how["stop_when"] = failing if asked == "condition" else ()
    friction = Failing() if asked == "law" else SmoothCoulomb()
    with pytest.raises(type(error)) as caught:
        runner(formulation, TIMES, friction=friction)(**how)
    assert caught.value is error
    assert caught.value.__cause__ is None


SMOOTH = SmoothCoulomb(coefficient=0.0)
long_run = partial(mbs_models.simulate, times=[0.0, 60.0])


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer that interrupts")
@pytest.mark.parametrize("call", [
    partial(long_run, scene_of(1, "contact-tree", friction=SMOOTH), step=1e-5),
    partial(long_run, scene_of(1, friction=LOADED), times=[0.0, 600.0]),
    partial(long_run, scene_of(2, "floating", friction=SMOOTH), step=1e-5),
    partial(long_run, scene_of(2, "euler-tree"), step=1e-5),
    partial(mbs_models.simulate_to_rest, rest_scene(), 600.0),
], ids=["no user function", "accelerations", "no friction", "friction", "to rest"])  # fmt: skip
def test_a_signal_ends_a_run_at_once(call: Callable[[], object]) -> None:
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    # Whole, it takes a minute or more.
    assert time.monotonic() - begin < 10.0
