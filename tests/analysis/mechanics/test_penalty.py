"""The body on a table that yields: what an open contact does, both charts, and the energy lost."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    GRAVITY,
    LOADS,
    MODELS,
    STEEL_DISK,
    AnisotropicCoulomb,
    Body,
    Dissipation,
    FrictionLaw,
    Load,
    LubricatedCoulomb,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    simulate,
)
from analysis.mechanics.attitude import Quaternion
from analysis.mechanics.dual import of_floats
from analysis.mechanics.penalty import YieldingTable, free_solver
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from analysis.problem.contact import CAUSES
from analysis.simulation.to_rest import start_vector
from mbs_models import Formulation
from tests.bodies import EGG, ELLIPSE
from tests.helpers import derivative
from tests.scenes import scene_of

# --- A contact that may open --------------------------------------------------------------------


CONTACT = PenaltyContact(stiffness=1e5, damping=10.0)
UPRIGHT = Start(spin=0.0, gamma=np.pi / 2)

every_formulation = pytest.mark.parametrize(
    "formulation", ["euler-tree", "floating-lie", "floating"]
)


def moved(
    formulation: Formulation, sunk: float, falling: float = 0.0, **fields: Any
) -> tuple[Array, float]:
    """Accelerations and normal force of both sides, of an upright disk that slips and has sunk."""
    x, y, z, *angles = replace(UPRIGHT, height=0.0).state(MODELS[1], STEEL_DISK).coordinates
    place, rates = (x, y, z - sunk, *angles), (0.2, 0.0, -falling, 0.0, 0.0, 0.0)
    scene = scene_of(1, formulation, start=State(coordinates=place, rates=rates), **fields)
    found, (normal,) = mbs_models.acceleration(scene)
    in_house, (force,) = accelerations(scene.scenario, place, rates)
    np.testing.assert_allclose(found, in_house, rtol=1e-8, atol=1e-7)
    assert normal == pytest.approx(force, rel=1e-9)
    return found, normal


@every_formulation
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("law", [SmoothCoulomb, AnisotropicCoulomb])
@pytest.mark.parametrize("bilateral", [False, True])
def test_in_the_air_a_bilateral_contact_alone_acts_and_rubs_under_the_weight_alone(
    formulation: Formulation, load: Load, law: type[FrictionLaw], *, bilateral: bool
) -> None:
    # What falls onto the table feels no damper before it touches.
    height, falling = 1e-5, 0.0 if bilateral else 1.0
    contact = replace(CONTACT, bilateral=bilateral)
    found, force = moved(formulation, -height, falling, friction=law(load=load), contact=contact)
    assert force == pytest.approx(-CONTACT.stiffness * height * bilateral, rel=1e-9)
    lifting = force / STEEL_DISK.mass - GRAVITY
    is_smooth = np.allclose(found, [0, 0, lifting, 0, 0, 0], rtol=1e-9, atol=1e-9)
    assert is_smooth == (not bilateral or load == "contact")


@every_formulation
@pytest.mark.parametrize(
    ("law", "fades"),
    [
        (SmoothCoulomb(), True),
        (LubricatedCoulomb(load="contact"), True),
        (AnisotropicCoulomb(load="contact"), False),
    ],
    ids=str,
)
def test_friction_that_does_not_follow_the_force_of_the_contact_fades_with_its_last_hundredth(
    formulation: Formulation, law: FrictionLaw, *, fades: bool
) -> None:
    pushed, weight = [], Scenario().weight
    for part in (1.0, 0.5):
        force = 0.01 * part * weight
        found, normal = moved(
            formulation, force / CONTACT.stiffness, friction=law, contact=CONTACT
        )
        assert normal == pytest.approx(force, rel=1e-6)
        slipping = law.force(0.2, 0.0, weight if law.load == "weight" else force)[0]
        pushed.append(found[0] / (slipping * (part if fades else 1.0)))
    assert pushed[0] == pytest.approx(pushed[1], rel=1e-6)


def test_damping_ratio_is_that_of_the_upright_disk_on_its_spring() -> None:
    ratio, offset = 0.3, 1e-5
    damped = PenaltyContact.damped(1e5, STEEL_DISK, ratio=ratio)
    # The centre of gravity above the contact point: the disk moves up and down alone.
    upright = Scenario(contact=replace(damped, bilateral=True), start=UPRIGHT)
    resting = upright.initial_state
    x, y, z, *angles = resting.coordinates
    lifted = replace(resting, coordinates=(x, y, z + offset, *angles))
    times = np.linspace(0.0, 0.02, 41)
    run = simulate(replace(upright, start=lifted), times, local_tolerance=1e-11)
    frequency = np.sqrt(1e5 / STEEL_DISK.mass)
    ringing, decay = frequency * np.sqrt(1.0 - ratio**2), ratio * frequency
    shape = np.cos(ringing * times) + decay / ringing * np.sin(ringing * times)
    expected = offset * np.exp(-decay * times) * shape
    np.testing.assert_allclose(run.coordinate("z") - z, expected, atol=1e-11)


# --- The way to rest ----------------------------------------------------------------------------


HALF = 2e-3


SURFACES = ((STEEL_DISK, 0.0), (STEEL_DISK, HALF), (ELLIPSE, HALF), (EGG, 0.0))
# Air presses on the faces of a round disk alone; its drag is the last cause.
TAKEN = [(*each, cause) for each in SURFACES for cause in CAUSES[2 : 5 + each[0].is_round_disk]]


def moving(
    body: Body, half: float, damping: float = 0.0, **losses: float
) -> tuple[YieldingTable, Array, Array]:
    """A body that presses on the table and moves in every way; its state, and how that changes."""
    # A contact that may open has a kink where it does.
    contact = PenaltyContact(stiffness=1e5, damping=damping, half_thickness=half, bilateral=True)
    start = Start(beta=1.1, gamma=0.3, spin=9.0, x_rate=0.2, y_rate=0.4, beta_rate=2.0)
    scenario = Scenario(disk=body, contact=contact, dissipation=Dissipation(**losses), start=start)
    state = start_vector(body, scenario.initial_state)
    state[9] -= 0.1
    solve = free_solver(scenario, Quaternion, of_floats(scenario.friction))
    return YieldingTable.of(scenario), state, np.array(solve(*state[:13].tolist()))


@pytest.mark.parametrize(("body", "half", "cause"), TAKEN)
def test_energy_falls_by_what_is_taken(body: Body, half: float, cause: str) -> None:
    table, state, change = moving(body, half, 50.0, **{cause: 1e-2})
    powers = change[13:]
    # The contact's damper and sliding are always there.
    np.testing.assert_array_equal(powers > 0.0, [each in (*CAUSES[:2], cause) for each in CAUSES])

    def energy(time: float) -> Array:
        return table.readings((state + time * change)[None])["energies"].sum(axis=1)

    assert derivative(energy, 1e-4) == pytest.approx(-powers.sum(), rel=1e-9)


@pytest.mark.parametrize(("body", "half"), SURFACES)
def test_rolling_resistance_is_its_coefficient_times_the_force_and_the_speed_on_the_contour(
    body: Body, half: float
) -> None:
    table, state, change = moving(body, half, rolling_dry=0.01, rolling_viscous=0.02)
    powers, found = dict(zip(CAUSES, change[13:], strict=True)), table.readings(state[None])
    force, speed = (float(found[name][0]) for name in ("normal_force", "contour_speeds"))
    assert force != pytest.approx(1.0, rel=0.1)
    dry = 0.01 * force * speed**2 / (speed + table.scenario.dissipation.rolling_smoothing)
    assert powers["rolling_dry"] == pytest.approx(dry, rel=1e-9)
    assert powers["rolling_viscous"] == pytest.approx(0.02 * force * speed**2, rel=1e-9)
