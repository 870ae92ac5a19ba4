"""What is in a scene, item by item, where it starts, and its accelerations, as in-house."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    LAWS,
    LEVELS,
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    Body,
    ConstraintSet,
    Dissipation,
    FrictionLaw,
    Level,
    Load,
    PenaltyContact,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.mechanics.recorded import accelerations
from mbs_models import Formulation, Scene, formulations
from mbs_models.friction import slip_velocity
from mbs_models.inventory import Item, inventory
from mbs_models.model import Model
from mbs_models.scene import build
from tests.bodies import BODIES, TIPPE_TOP
from tests.calls import printed
from tests.helpers import ROLLING, TILTED, model, random_scenario, slip
from tests.helpers import random_start as free_start
from tests.scenes import scene_of
from tests.wayward_law import Own
from validation.studies.comparisons import compare_scenario

SMOOTH = SmoothCoulomb(coefficient=0.0)
ROUGHNESS = pytest.mark.parametrize("friction", [SmoothCoulomb(), SMOOTH], ids=["rough", "smooth"])

TREE = "node GenericODE2, object KinematicTree"
TABLE = "object Ground, marker BodyRigid"
COG = "object JointSpherical"
RATE = "node PointGround, marker NodeCoordinate, marker NodeCoordinate, object ConnectorCoordinate"
BODY = "object RigidBody, marker BodyMass, load MassProportional, marker BodyRigid"
FRICTION = "marker BodyRigid, object ConnectorRigidBodySpringDamper"
CARRIER = "node 1D, object RotationalMass1D, marker BodyRigid, object JointGeneric"
ON_TREE, ON_BODY = "marker KinematicTreeRigid", "marker BodyRigid"
NODES: dict[Any, str] = {"floating": "node RigidBodyEP", "floating-lie": "node RigidBodyRotVecLG"}


def expected(level: Level, formulation: Formulation, *, rough: bool) -> list[str]:
    if formulation == "contact-tree":
        return [TREE]
    held = [TABLE, "object JointRollingDisc"]
    if formulation == "euler-tree":
        listed = [TREE, *held, ON_TREE] + ([COG, ON_TREE] if level >= 2 else [])
        return listed + ([RATE] if level >= 4 else [])
    listed = [NODES[formulation], BODY, *held] + ([FRICTION] if rough else [])
    listed += [COG, ON_BODY] if level >= 2 else []
    return listed + ([CARRIER, RATE] if level >= 4 else [])


def held_by(scene: Scene, *items: str) -> tuple[list[Item], Model]:
    """These items make up a scene, and each marker is used; what is listed, and the model."""
    found, built, used = inventory(scene), build(scene), set()
    held = sorted(f"{item.kind} {item.type}" for item in found)
    assert held == sorted(", ".join(items).split(", "))
    system, data = built.system, built.system.systemData
    for number in range(data.NumberOfObjects()):
        used |= {int(each) for each in system.GetObject(number).get("markerNumbers", ())}
    used |= {int(system.GetLoad(number)["markerNumber"]) for number in range(data.NumberOfLoads())}
    assert used == set(range(data.NumberOfMarkers()))
    return found, built


@pytest.mark.parametrize(
    ("level", "formulation"),
    [(level, each) for level in LEVELS for each in formulations(model(level))],
)
@ROUGHNESS
def test_scene_holds_what_it_needs_and_nothing_else_and_counts_as_the_assembled_system(
    level: Level, formulation: Formulation, friction: SmoothCoulomb
) -> None:
    scene, rough = scene_of(level, formulation, friction=friction), friction.coefficient > 0.0
    found, built = held_by(scene, *expected(level, formulation, rough=rough))
    data = built.system.systemData
    assert sum(len(item.user_functions) for item in found) == rough
    assert sum(item.coordinates for item in found) == len(data.GetODE2Coordinates())
    assert sum(item.equations for item in found) == len(data.GetAECoordinates())
    # Contact; COG (2); rolling; spin; and what a formulation adds for itself.
    extra = (formulation == "floating") + (formulation.startswith("floating") and level == 4)
    constraints = sum(item.equations - item.idle for item in found)
    closed = formulation == "contact-tree"
    assert constraints == {1: 1, 2: 3, 3: 4, 4: 5}[level] + extra - closed
    assert scene.has_constraints is (constraints > 0)


@ROUGHNESS
def test_penalty_contact_needs_one_force_law_and_no_joint(friction: SmoothCoulomb) -> None:
    given: Any = {"contact": PenaltyContact(stiffness=1e5), "friction": friction}
    held_by(scene_of(1, "euler-tree", **given), TREE)
    for formulation, node in NODES.items():
        items = (node, BODY, TABLE, FRICTION.split(", ")[1])
        held_by(scene_of(1, formulation, **given), *items)


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids="+".join)
def test_friction_is_in_a_scene_only_where_some_slip_is_left(constraints: ConstraintSet) -> None:
    slips = not {"no-slip-along", "no-slip-across"} <= set(constraints)
    scenario = Scenario(constraints=constraints)
    for formulation in formulations(scenario):
        found = inventory(Scene(scenario, formulation))
        assert sum(len(item.user_functions) for item in found) == slips
        assert any("friction" in item.why for item in found) is slips


def test_command_prints_items_reasons_and_sums() -> None:
    shown = " ".join(printed("scene --model 3 --formulation euler-tree").split())
    assert "JointRollingDisc" in shown
    assert "without slip along the edge" in shown
    assert "6 coordinates, 6 algebraic equations (2 of them idle: an unused" in shown
    assert "1 user function." in shown


@pytest.mark.parametrize("level", LEVELS)
def test_the_default_is_the_most_accurate_formulation_and_all_start_where_the_scene_says(
    level: Any,
) -> None:
    assert scene_of(level).built_as == ("contact-tree" if level == 1 else "euler-tree")
    assert scene_of(level, start=Start(beta=1e-3)).built_as == "floating"
    start = Start(beta=1.1, gamma=0.7, spin=-23.0, beta_rate=3.0)
    for formulation in formulations(model(level)):
        built = build(scene_of(level, formulation, start=start))
        coordinates, rates = built.decode(built.record()[None])
        state = built.scenario.initial_state
        np.testing.assert_allclose(coordinates[0], state.coordinates, atol=1e-12)
        np.testing.assert_allclose(rates[0], state.rates, atol=1e-11)


# --- Accelerations, forces and eigenvalues -----------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Slanted(SmoothCoulomb):
    """Law whose axes are not those of the edge: there is a left and a right."""

    IS_ISOTROPIC = False

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        x, y = SmoothCoulomb.force(self, along, across, load)
        return x + 0.5 * y, y + 0.5 * x


KINDS: list[type[FrictionLaw]] = [*LAWS.values(), Own]
ON_CONTACT = [kind(load="contact") for kind in KINDS[1:]]
STEEP = Table(inclination=0.2, downhill=0.5)
SOFT = PenaltyContact.damped(1e5, STEEL_DISK)
LOSSES = {"rolling_dry": 1e-3, "rolling_viscous": 1e-3, "pivoting": 1e-4}


def touching(body: Body, load: Load) -> Iterator[Scenario]:
    """A body on the ideal contact and on yielding ones, without and with losses."""
    ideal = Scenario(disk=body, table=STEEP, friction=SmoothCoulomb(load=load))
    losses = Dissipation(**LOSSES, air_drag=1.2 * body.is_round_disk)
    sharp = replace(ideal, contact=PenaltyContact.damped(1e5, body))
    rounded = PenaltyContact.rounded(body, stiffness=1e5)
    yield from (ideal, sharp, replace(sharp, dissipation=losses))
    yield replace(ideal, contact=rounded, dissipation=losses)


COMPARED: list[Scenario] = [
    *(Scenario(constraints=held) for held in POSSIBLE_SETS),
    *(random_scenario(held, 1, SmoothCoulomb(load=load), products)[0]
      for held in (*POSSIBLE_SETS, *TILTED) for load in LOADS for products in (0.0, 0.25)),
    *(each for body in BODIES.values() for load in LOADS for each in touching(body, load)),
    *(model(level, friction=law) for level in (1, 3) for law in (*ON_CONTACT, Slanted())),
    *(Scenario(contact=PenaltyContact(stiffness=2e5, damping=20.0), friction=law)
      for law in ON_CONTACT if not law.is_simple),
    *(Scenario(contact=PenaltyContact.damped(stiffness, STEEL_DISK, half_thickness=rim),
               dissipation=Dissipation(rolling_dry=1e-3, rolling_viscous=0.1))
      for stiffness in (1e5, 1e8) for rim in (0.0, 2e-4, STEEL_DISK.radius)),
    # What bends within less than differences are apart counts by its slope at no slip.
    Scenario(contact=SOFT, friction=SmoothCoulomb(smoothing=1e-5)),
    Scenario(contact=SOFT, dissipation=Dissipation(rolling_dry=1e-3, rolling_smoothing=1e-4)),
    *(Scenario(disk=TIPPE_TOP, friction=SmoothCoulomb(smoothing=0.01, load=load))
      for load in LOADS),
    # Where nothing rubs, it does not matter how finely friction would bend.
    Scenario(constraints=ROLLING, friction=SmoothCoulomb(smoothing=1e-5)),
]  # fmt: skip


@pytest.mark.parametrize("scenario", COMPARED, ids=lambda each: f"{each.friction} {each.name}")
def test_accelerations_forces_and_eigenvalues_of_every_formulation_are_those_in_house(
    scenario: Scenario,
) -> None:
    found = compare_scenario(scenario, states=3, end=None)
    assert {each.formulation for each in found} == set(formulations(scenario))
    for each in found:
        if each.difference is None:
            assert "eigenvalues" in each.quantity
            assert scenario.contact is not None or not scenario.table.is_horizontal
        else:
            assert each.difference < min(each.criterion, 5e-8), each


@pytest.mark.parametrize("spin", [-1000.0, 5.0])
@pytest.mark.parametrize("tilt", [1e-3, 1e-2])
@pytest.mark.parametrize("side", ["bottom", "top"])
@pytest.mark.parametrize("level", [2, 3, 4])
def test_accelerations_near_a_flat_disk(level: Level, side: str, tilt: float, spin: float) -> None:
    """Angles are ill-conditioned there: a tilt of 1e-3 loses six digits of alpha and gamma."""
    beta = tilt if side == "bottom" else pi - tilt
    for seed in range(4):
        start = free_start(MODELS[level], np.random.default_rng(seed))
        scenario = model(level, start=replace(start, beta=beta, spin=spin))
        state = scenario.initial_state
        moving, forces = accelerations(scenario, state.coordinates, state.rates)
        scale, most = (max(scenario.weight, *np.abs(each)) for each in (moving, forces))
        for formulation in formulations(scenario):
            one, other = mbs_models.acceleration(Scene(scenario, formulation))
            np.testing.assert_allclose(one, moving, rtol=0.0, atol=1e-10 / tilt**2 * scale)
            np.testing.assert_allclose(other, forces, rtol=0.0, atol=1e-7 * most)


ROOT = PowerLawCoulomb(
    coefficient=0.5, smoothing=1e-3, reference_load=7.0, exponent=0.5, load="contact"
)
STRONG = replace(ROOT, coefficient=2.1, smoothing=0.02, reference_load=49.0)
FLATTENED = replace(ROOT, coefficient=2.44, smoothing=0.012, reference_load=13.0, exponent=0.16)
CALLING = replace(ROOT, coefficient=1.56, smoothing=0.009, reference_load=60.0, exponent=0.47)


@pytest.mark.parametrize(
    ("law", "start"),
    [
        (ROOT, Start(beta=1.0, gamma=0.0, spin=-5.0, gamma_rate=30.0, beta_rate=-20.0)),
        # With some sixty times the force that there is without friction.
        (STRONG, Start(beta=1.76, gamma=-2.76, spin=17.0, gamma_rate=5.5, beta_rate=13.0)),
        # Secants alone lead away, and the force is small, but not the sizes that cancel in it.
        (FLATTENED, Start(beta=0.8, gamma=-1.1, spin=3.0, gamma_rate=10.0, beta_rate=8.0)),
        # To take what friction calls for as the next load leads nowhere within sixty steps.
        (CALLING, Start(beta=2.5, gamma=2.3, spin=-11.0, gamma_rate=-3.0, beta_rate=-4.0)),
    ],
)
def test_contact_force_is_found_where_friction_grows_less_than_in_proportion_to_it(
    law: FrictionLaw, start: Start
) -> None:
    # From no load on, the force that friction calls for at first grows faster than its load.
    scenario = Scenario(friction=law, start=start)
    state = scenario.initial_state
    right = accelerations(scenario, state.coordinates, state.rates)
    found = mbs_models.acceleration(scenario, state)
    for one, other in zip(found, right, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)


def test_slip_is_the_velocity_of_the_disk_where_it_touches_the_table() -> None:
    place, rates = np.random.default_rng(3).uniform(0.2, 1.4, size=(2, 6))
    found = slip_velocity(STEEL_DISK.radius, place, rates)
    np.testing.assert_allclose(found, slip(STEEL_DISK, lambda t: place + t * rates), rtol=1e-8)
