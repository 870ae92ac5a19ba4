"""Bodies: mass properties of composed disks, lowest points, files, refusals, what takes them."""

from collections.abc import Callable
from dataclasses import asdict, replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    MODELS,
    STEEL_DISK,
    Body,
    Disk,
    Dissipation,
    Ensemble,
    PenaltyContact,
    Scenario,
    Sphere,
    simulate,
    simulate_to_rest,
)
from analysis.mechanics.paper import critical_speed
from analysis.problem import bodies
from analysis.problem.checks import Array
from analysis.problem.elementary import sqrt
from analysis.problem.quantities import SIX
from analysis.problem.variations import changed
from analysis.stability.critical import critical_speeds
from tests.bodies import BODIES, COMPOSED, EGG, ELLIPSE, RINGS, TIPPE_TOP, Egg
from tests.calls import printed
from tests.helpers import jacobian, refusals, turn_z

every_body = pytest.mark.parametrize("body", (BODIES | RINGS).values(), ids=BODIES | RINGS)

PLATE, HOLES = (0.05, 0.01, 8000.0), [(-0.02, 0.01, 0.012), (0.02, 0.02, 0.004)]
MASSES = [(0.0, 0.04, 0.03), (0.01, -0.03, 0.02)]


def by_cells() -> tuple[float, Array, Array]:
    """Mass, centre of gravity, and inertia about it, of small cells of a plate."""
    edges = np.linspace(-PLATE[0], PLATE[0], 2001)
    middle, area = 0.5 * (edges[1:] + edges[:-1]), (edges[1] - edges[0]) ** 2
    x, y = (each.ravel() for each in np.meshgrid(middle, middle))
    inside = np.hypot(x, y) < PLATE[0]
    for a, b, radius in HOLES:
        inside &= np.hypot(x - a, y - b) > radius
    places = np.column_stack((x[inside], y[inside]))
    weights = np.full(len(places), PLATE[1] * PLATE[2] * area)
    thickness = np.sum(weights) * PLATE[1] ** 2 / 12
    places = np.vstack((places, [each[:2] for each in MASSES]))
    weights = np.append(weights, [each[2] for each in MASSES])
    mass = float(np.sum(weights))
    (xx, xy), (_, yy) = mass * np.cov(places.T, aweights=weights, bias=True)
    tensor = np.array([[yy + thickness, -xy, 0], [-xy, xx + thickness, 0], [0, 0, xx + yy]])
    return mass, weights @ places / mass, tensor


def test_composed_disk_has_the_mass_properties_of_its_cells() -> None:
    mass, centre, tensor = by_cells()
    disk = Disk.of_parts(PLATE, HOLES, MASSES)
    assert disk.mass == pytest.approx(mass, rel=1e-4)
    assert disk.eccentricity == pytest.approx(np.hypot(*centre), rel=1e-3)
    turn = turn_z(np.arctan2(centre[1], centre[0]))
    np.testing.assert_allclose(
        disk.tensor_about_cog, turn.T @ tensor @ turn, atol=1e-4 * tensor[2, 2]
    )
    assert abs(disk.inertia_xy) > 0.01 * disk.inertia_z


def test_composed_disk_that_is_symmetric_is_on_principal_axes() -> None:
    aside = [(-0.02, 0.015, 0.01), (-0.02, -0.015, 0.01)]
    turned = [(*(turn_z(0.7) @ (x, y, 0.0))[:2], r) for x, y, r in aside]
    one, other = (Disk.of_parts(PLATE, each) for each in (aside, turned))
    assert one.is_plain
    assert other.is_plain
    assert other.inertia_x == pytest.approx(one.inertia_x, rel=1e-12)
    for y in (0.02, 0.0):
        balanced = Disk.of_parts(PLATE, masses=[(0.03, y, 0.1), (-0.03, -y, 0.1)])
        assert (balanced.eccentricity, balanced.products) == (0.0, (0.0, 0.0, 0.0))


def test_ring_is_a_plate_with_a_hole_and_stays_one_unless_its_mass_changes() -> None:
    ring = Disk.ring(hole_radius=0.01, hole_distance=0.03)
    assert ring == Disk.of_parts((0.045, 0.01, 7700.0), [(-0.03, 0.0, 0.01)])
    assert replace(ring, mass=1.0).parts is None


@every_body
def test_to_name_what_a_body_is_changes_nothing(body: Body) -> None:
    scenario = Scenario(disk=body)
    named = changed(scenario, {"disk.body": bodies.BODIES.name_of(type(body))})
    assert named.values() == scenario.values()


def test_a_body_of_ones_own_is_told_by_an_option() -> None:
    own = printed("scenario --radius 0.03 --body", "tests.bodies:Egg,waist=0.9")
    for line in ("radius = 0.03", 'body = "tests.bodies:Egg"', "waist = 0.9"):
        assert f"\n{line}" in own


def attitudes(count: int) -> Array:
    up = np.random.default_rng(1).normal(size=(count, 3))
    up = up / np.linalg.norm(up, axis=1)[:, None]
    return np.array(up)


@pytest.mark.parametrize("half", [0.0, 2e-3])
@every_body
def test_surface_lies_above_its_lowest_point_whose_depth_is_the_clearance(
    body: Body, half: float
) -> None:
    """All lowest points together are the surface, or what of it can touch a table."""
    up = attitudes(300)
    points = np.array([body.lowest_point(tuple(each), half) for each in up.tolist()])
    heights = up @ points.T
    assert np.all(heights >= np.diag(heights)[:, None] - 1e-15)
    assert np.max(np.linalg.norm(points, axis=1)) <= body.radius * (1.0 + 1e-12)

    def depth(angles: Array) -> Array:
        (sb, sg), (cb, cg) = np.sin(angles), np.cos(angles)
        up = (float(sb * sg), float(sb * cg), float(cb))
        return np.array(-np.dot(body.lowest_point(up, half), up))

    place = np.array((1.1, 0.4))
    over, *slopes = body.clearance(place[0], place[1], half)
    assert over == pytest.approx(depth(place), rel=1e-12)
    np.testing.assert_allclose(slopes, jacobian(depth, place)[0], atol=1e-9 * body.radius)


def test_a_rounded_rim_is_a_spheroid_that_lies_on_the_middle_of_either_face() -> None:
    up = np.vstack((attitudes(300), [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]))
    x, y, z = STEEL_DISK.lowest_point(up.T, 2e-3)
    square = (x**2 + y**2) / STEEL_DISK.radius**2 + (z / 2e-3) ** 2
    np.testing.assert_allclose(square, 1.0, rtol=1e-12)
    assert z[-2:].tolist() == [-2e-3, 2e-3]


@every_body
def test_resting_place_is_the_lowest_of_all_attitudes(body: Body) -> None:
    half = 2e-3
    height, lean = body.resting_place(half if body.has_edge else 0.0)
    up = attitudes(20000)
    points = np.column_stack(body.lowest_point(up.T, half))
    heights = body.eccentricity * up[:, 0] - np.sum(points * up, axis=1)
    assert height <= heights.min()
    assert height == pytest.approx(heights.min(), abs=0.03 * body.radius)
    assert (lean < 0.1) == body.has_edge


@pytest.mark.parametrize("half", [2e-3, STEEL_DISK.radius])
def test_ellipse_of_equal_axes_rests_as_the_disk_does(half: float) -> None:
    circle = replace(ELLIPSE, **asdict(STEEL_DISK), other_radius=STEEL_DISK.radius)
    (height, lean), expected = circle.resting_place(half), STEEL_DISK.resting_place(half)
    assert height == pytest.approx(expected[0], rel=1e-12)
    assert lean == pytest.approx(expected[1], rel=1e-5)


NUMBERS = {name: getattr(EGG, name) for name in SIX}


def odd(kind: type[Body] = Egg, **own: Any) -> Body:
    """A body whose class has something of its own."""
    return type("Odd", (kind,), own)(**NUMBERS)


def level_elsewhere(body: Body, up: Any, _: Any = 0.0) -> Any:
    """A point on an ellipsoid, and elsewhere than where that is level."""
    x, y, z = (-body.radius * each for each in up)
    return x, 0.5 * y, 0.5 * z


def folded(body: Body, up: Any, _: Any = 0.0) -> Any:
    """A point whose slope is lost where a size is taken of a complex number."""
    square = up[0] * up[0] + 0.5 * (up[1] * up[1] + abs(up[2]) ** 2)
    height = sqrt(square) / body.radius
    return -up[0] / height, -0.5 * up[1] / height, -0.5 * up[2] / height


def of_numpy(body: Body, up: Any, _: Any = 0.0) -> Any:
    """A sphere, in functions that know no symbols."""
    size = np.sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2])
    return tuple(-body.radius * each / size for each in up)


def with_poles(body: Body, up: Any, _: Any = 0.0) -> Any:
    """A sphere that is told in another way where it stands upright."""
    x, y, z = (-body.radius * each for each in up)
    return (0.0, 0.0, z) if up[2] == 1.0 else (x, y, z)


def with_a_waist(body: Body, up: Any, _: Any = 0.0) -> Any:
    """A sphere that is told in another way where it lies."""
    x, y, z = (-body.radius * each for each in up)
    return (x, y, z) if up[2] else (x, y, 0.0)


composed, made = partial(partial, Disk.of_parts), partial(partial, bodies.BODIES.made)
scenario = partial(partial, Scenario)
DRAG = {"contact": PenaltyContact.rounded(ELLIPSE), "dissipation": Dissipation(air_drag=1.2)}
ROUNDED = PenaltyContact(stiffness=1e5, half_thickness=1e-3)
HALF_A_RING = {"disk": {"holes": [], "radius": 1.0}}
UNLIKE = {"inertia_xy": np.array([1e-6, 1.0])}
UNEVEN, HELD_UNEVEN = Scenario(disk=COMPOSED), Scenario(disk=COMPOSED, constraints=MODELS[4])

REFUSED: dict[str, Callable[[], Any]] = {
    "holes must lie": composed(PLATE, [(0.04, 0.0, 0.02)]),
    "holes must not be negative, got -0.01": composed(PLATE, [(0.0, 0.0, -0.01)]),
    "holes must not overlap": composed(PLATE, [(0.0, 0.0, 0.01), (0.01, 0.0, 0.005)]),
    "holes must hold x, y": composed(PLATE, [(0.0, 1.0)]),
    "masses must lie on": composed(PLATE, (), [(0.0, 1.0, 1.0)]),
    "masses must be positive": composed(PLATE, (), [(0.0, 0.0, 0.0)]),
    "thickness must be positive": composed((0.05, 0.0, 8e3)),
    "^member 1 of fields: inertia_xy must": partial(Ensemble, scenario=UNEVEN, fields=UNLIKE),
    "lacks thickness and density": partial(Scenario.from_values, HALF_A_RING),
    "other_radius must not": partial(replace, ELLIPSE, other_radius=1.0),
    "body must be one of disk, sphere": made(body="cube"),
    "must be a class derived from Body": made(body="math:pi"),
    "cannot be made": made(body="sphere"),
    r"depth of lowest_point\(.*\) must not be negative": scenario(
        disk=odd(lowest_point=lambda _, up, __=0.0: up)
    ),
    r"lowest_point\(.*\) must be told by the four": scenario(disk=odd(lowest_point=folded)),
    r"lowest_point\(.*\) must be where the surface is": scenario(
        disk=odd(lowest_point=level_elsewhere)
    ),
    # Its surface depends on more than it says.
    "SURFACE must name all that the surface depends on, and lacks waist": scenario(
        disk=odd(SURFACE=())
    ),
    "Odd': SURFACE must be a list of names of fields, got 'waist'": scenario(
        disk=odd(SURFACE="waist")
    ),
    "must tell its lowest point by the four .* of NumPy or": lambda: simulate(
        Scenario(disk=odd(lowest_point=of_numpy)), [0.0, 0.1]
    ),
    "by the same ones for all verticals: .* equals another": lambda: simulate(
        Scenario(disk=odd(lowest_point=with_poles)), [0.0, 0.1]
    ),
    "by the same ones for all verticals: .* is zero": lambda: simulate(
        Scenario(disk=odd(lowest_point=with_a_waist)), [0.0, 0.1]
    ),
    "by the same ones for all verticals: .* truth value of an array": lambda: simulate_to_rest(
        Scenario.rest(disk=odd(lowest_point=with_poles), contact=PenaltyContact(stiffness=1e5)),
        0.1,
    ),
    "products must be a finite number, got [(]0": scenario(disk=odd(SURFACE=("products",))),
    "Egg': TypeError: unhashable type: 'list'": scenario(disk=Egg(**NUMBERS, waist=[0.9])),  # type: ignore[arg-type]
    "lowest_point must be that of a Sphere, which": scenario(
        disk=odd(Sphere, lowest_point=Egg.lowest_point)
    ),
    "lowest_point must be that of a Disk, which": scenario(disk=odd(is_round_disk=True)),
    "half_thickness must be 0 for a Sphere": scenario(disk=TIPPE_TOP, contact=ROUNDED),
    "must be those of Model 1 for a Sphere": scenario(disk=TIPPE_TOP, constraints=MODELS[2]),
    "air_drag acts on the faces of a round disk alone": scenario(disk=ELLIPSE, **DRAG),
    # What is of the paper's disk alone refuses products of inertia.
    "needs a round disk whose line from centre to cen": partial(critical_speed, UNEVEN),
    "'reduced' needs a round disk": partial(simulate, HELD_UNEVEN, [0, 1], formulation="reduced"),
    "spin upright for that: the line .* of this Disk is not$": partial(critical_speeds, UNEVEN),
    "start must be a stationary motion": partial(mbs_models.eigenvalues, UNEVEN),
}

test_what_is_no_body_or_fits_none_is_refused = refusals(REFUSED)
