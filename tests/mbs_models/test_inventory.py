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
from analysis.data.constraint_set import set_name
from mbs_models import Formulation, Scene
from mbs_models.ballast import BALLAST, six_axes
from mbs_models.integrators import find_integrator
from mbs_models.inventory import Inventory, inventory
from mbs_models.model import Model
from mbs_models.runs import run
from mbs_models.scene import build
from tests.calls import printed
from tests.helpers import model
from tests.scenes import scene_of

SMOOTH = SmoothCoulomb(coefficient=0.0)
READ = ["sensor Node"]
FORCES = ["sensor UserFunction"]

TREE = ["node GenericODE2", "object KinematicTree"]
TABLE = ["object Ground", "marker BodyRigid"]
CONTACT = ["object JointRollingDisc"]
COG = ["object JointSpherical"]
SPIN = [
    "node PointGround",
    "marker NodeCoordinate",
    "marker NodeCoordinate",
    "object ConnectorCoordinate",
]
BODY = ["object RigidBody", "marker BodyMass", "load MassProportional"]
FRICTION = ["marker BodyRigid", "object ConnectorRigidBodySpringDamper"]
HELD_BODY = [*BODY, *TABLE, "marker BodyRigid", FRICTION[1], *(4 * READ)]
CARRIER = ["node 1D", "object RotationalMass1D", "marker BodyRigid", "object JointGeneric"]


def expected(level: Level, formulation: Formulation, *, rough: bool) -> list[str]:
    if formulation == "contact-tree":
        return TREE + 3 * READ
    if formulation == "euler-tree":
        marker = ["marker KinematicTreeRigid"]
        listed = TREE + 2 * READ + FORCES + TABLE + CONTACT + marker
        listed += COG + marker if level >= 2 else []
        return listed + (SPIN if level >= 4 else [])
    node = "RigidBodyEP" if formulation == "floating" else "RigidBodyRotVecLG"
    listed = [f"node {node}", *BODY, *(4 * READ), *FORCES, *TABLE, *CONTACT, "marker BodyRigid"]
    listed += FRICTION if rough else []
    listed += [*COG, "marker BodyRigid"] if level >= 2 else []
    return listed + (CARRIER + SPIN if level >= 4 else [])


def listed(found: Inventory) -> list[str]:
    return sorted(f"{item.kind} {item.type}" for item in found.items)


def unused_markers(scene: Scene) -> set[int]:
    """Markers that no object and no load refers to."""
    system = build(scene).system
    data, used = system.systemData, set()
    for number in range(data.NumberOfObjects()):
        used |= {int(each) for each in system.GetObject(number).get("markerNumbers", ())}
    used |= {int(system.GetLoad(number)["markerNumber"]) for number in range(data.NumberOfLoads())}
    return set(range(data.NumberOfMarkers())) - used


SCENES = [
    (level, formulation, rough)
    for level in LEVELS
    for formulation in mbs_models.formulations(model(level))
    for rough in (True, False)
]


@pytest.mark.parametrize(("level", "formulation", "rough"), SCENES)
def test_scene_holds_what_it_needs_and_nothing_else_and_counts_as_the_assembled_system(
    level: Level, formulation: Formulation, rough: bool
) -> None:
    scene = scene_of(level, formulation, friction=SmoothCoulomb() if rough else SMOOTH)
    found = inventory(scene)
    assert listed(found) == sorted(expected(level, formulation, rough=rough))
    assert found.user_functions == scene.has_constraints + rough
    assert not unused_markers(scene)
    built = build(scene)
    data = built.system.systemData
    assert found.coordinates == len(data.GetODE2Coordinates())
    assert found.equations == len(data.GetAECoordinates())
    # Contact; COG (2); rolling; spin; and what a formulation adds for itself.
    extra = (formulation == "floating") + (formulation.startswith("floating") and level == 4)
    closed = formulation == "contact-tree"
    assert found.constraints == {1: 1, 2: 3, 3: 4, 4: 5}[level] + extra - closed
    assert scene.has_constraints is (found.constraints > 0)


@pytest.mark.parametrize("rough", [True, False])
@pytest.mark.parametrize(
    ("formulation", "items"),
    [
        ("euler-tree", [*TREE, *(2 * READ)]),
        ("floating", ["node RigidBodyEP", *HELD_BODY, *FORCES]),
        ("floating-lie", ["node RigidBodyRotVecLG", *HELD_BODY]),
    ],
)
def test_penalty_contact_needs_one_force_law_and_no_joint(
    formulation: Any, items: list[str], rough: bool
) -> None:
    scene = scene_of(
        1,
        formulation,
        contact=PenaltyContact(stiffness=1e5),
        friction=SmoothCoulomb() if rough else SMOOTH,
    )
    assert listed(inventory(scene)) == sorted(items)
    assert not unused_markers(scene)


def test_command_prints_items_reasons_and_sums(capsys: pytest.CaptureFixture[str]) -> None:
    shown = printed(capsys, "scene --model 3 --formulation euler-tree")
    assert "JointRollingDisc" in shown
    assert "without slip along the edge" in shown
    assert "6 coordinates, 6 algebraic equations (4 constraints" in shown


def change_of_the_end(
    formulation: Formulation, load: Callable[[Model], object], **fields: Any
) -> float:
    """Largest change of the last sample of a short run by what is loaded onto its model."""
    ends = []
    for loaded in (False, True):
        scene = scene_of(2, formulation, **fields)
        model = build(scene)
        if loaded:
            load(model)
        integrator = find_integrator(scene, None)
        samples = run(model, integrator, spacing=1e-2, intervals=3, substeps=10)
        ends.append(samples.records[-1])
    return float(abs(ends[0] - ends[1]).max())


@pytest.mark.parametrize("part", BALLAST)
def test_ballast_does_not_change_the_motion(part: str) -> None:
    assert change_of_the_end("floating", BALLAST[part], friction=SMOOTH) < 1e-12


def test_joint_with_six_axes_holds_the_same_motion() -> None:
    assert change_of_the_end("euler-tree", six_axes) < 1e-9


def test_default_formulation_is_the_most_accurate_one_of_each_level() -> None:
    assert [scene_of(level).built_as for level in LEVELS] == [
        "contact-tree",
        "euler-tree",
        "euler-tree",
        "euler-tree",
    ]


@pytest.mark.parametrize("level", LEVELS)
def test_engine_starts_where_the_scene_says(level: Any) -> None:
    start = Start(beta=1.1, gamma=0.7, spin=-23.0, beta_rate=3.0)
    for formulation in mbs_models.formulations(model(level)):
        built = build(scene_of(level, formulation, start=start))
        coordinates, rates = built.decode(built.record()[None])
        state = built.scenario.initial_state
        np.testing.assert_allclose(coordinates[0], state.coordinates, atol=1e-12)
        np.testing.assert_allclose(rates[0], state.rates, atol=1e-11)


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_friction_is_in_a_scene_only_where_some_slip_is_left(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    slips = not {"no-slip-along", "no-slip-across"} <= set(constraints)
    for formulation in mbs_models.formulations(scenario):
        scene = Scene(scenario, formulation)
        found = inventory(scene)
        # Another user function samples the constraint forces.
        assert found.user_functions == scene.has_constraints + slips
        assert any("friction" in item.why for item in found.items) is slips
