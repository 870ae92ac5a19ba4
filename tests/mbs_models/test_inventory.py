"""What is in a scene: this list holds it, item by item; and where it starts."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    LEVELS,
    POSSIBLE_SETS,
    ConstraintSet,
    Level,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
)
from mbs_models import Formulation, Scene
from mbs_models.integrators import find_integrator
from mbs_models.inventory import BALLAST, Item, inventory, six_axes
from mbs_models.model import Model
from mbs_models.runs import run
from mbs_models.scene import build
from tests.calls import printed
from tests.helpers import model
from tests.scenes import scene_of

SMOOTH = SmoothCoulomb(coefficient=0.0)
ROUGHNESS = pytest.mark.parametrize("friction", [SmoothCoulomb(), SMOOTH], ids=["rough", "smooth"])

TREE = "node GenericODE2, object KinematicTree"
TABLE = "object Ground, marker BodyRigid"
JOINT = "object JointRollingDisc"
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
    held = [TABLE, JOINT]
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
    [(level, each) for level in LEVELS for each in mbs_models.formulations(model(level))],
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
    for formulation in mbs_models.formulations(scenario):
        found = inventory(Scene(scenario, formulation))
        assert sum(len(item.user_functions) for item in found) == slips
        assert any("friction" in item.why for item in found) is slips


def test_command_prints_items_reasons_and_sums() -> None:
    shown = printed("scene --model 3 --formulation euler-tree")
    assert "JointRollingDisc" in shown
    assert "without slip along the edge" in shown
    assert "6 coordinates, 6 algebraic equations (4 constraints" in shown
    assert "1 user function." in shown


@pytest.mark.parametrize(
    ("part", "scene", "most"),
    [
        *((part, scene_of(2, "floating", friction=SMOOTH), 1e-12) for part in BALLAST.values()),
        (six_axes, scene_of(2, "euler-tree"), 1e-9),
    ],
    ids=[*BALLAST, "six axes"],
)
def test_ballast_does_not_change_the_motion(
    part: Callable[[Model], object], scene: Scene, most: float
) -> None:
    ends = []
    for load in (lambda _: None, part):
        loaded = build(scene)
        load(loaded)
        loaded.system.Assemble()
        integrator = find_integrator(scene, None)
        times = np.linspace(0.0, 3e-2, 4)
        records = run(loaded, integrator, times, np.full(3, 10)).records
        ends.append(np.hstack(loaded.decode(records))[-1])
    assert float(abs(ends[0] - ends[1]).max()) < most


@pytest.mark.parametrize("level", LEVELS)
def test_the_default_is_the_most_accurate_formulation_and_all_start_where_the_scene_says(
    level: Any,
) -> None:
    assert scene_of(level).built_as == ("contact-tree" if level == 1 else "euler-tree")
    assert scene_of(level, start=Start(beta=1e-3)).built_as == "floating"
    start = Start(beta=1.1, gamma=0.7, spin=-23.0, beta_rate=3.0)
    for formulation in mbs_models.formulations(model(level)):
        built = build(scene_of(level, formulation, start=start))
        coordinates, rates = built.decode(built.record()[None])
        state = built.scenario.initial_state
        np.testing.assert_allclose(coordinates[0], state.coordinates, atol=1e-12)
        np.testing.assert_allclose(rates[0], state.rates, atol=1e-11)
