"""What several tests share: random disks and states, own kinematics, derivatives, Lagrange."""

from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pytest
import sympy
from scipy.spatial.transform import Rotation
from sympy import rot_ccw_axis1, rot_ccw_axis3

from analysis import (
    COORDINATES,
    MODELS,
    POSSIBLE_SETS,
    ConstraintSet,
    Disk,
    FrictionLaw,
    Level,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Table,
    Trajectory,
    multiplier_names,
    simulate,
)
from analysis.problem.body import PRODUCTS, Body
from analysis.problem.checks import Array
from analysis.problem.constraints import independent_coordinates

T = TypeVar("T")

Generator = np.random.Generator

OUTER_STEP = 8e-3
"""Step for derivatives of derivatives: keeps the inner one's rounding error small."""


def mostly_slow(values: Iterable[Any], quick: Container[Any]) -> list[Any]:
    """Values of a parameter of which only some run by default."""
    return [
        value if value in quick else pytest.param(value, marks=pytest.mark.slow)
        for value in values
    ]


def not_none(value: T | None) -> T:
    """What must not be None."""
    assert value is not None
    return value


def assert_close(actual: Any, expected: Any, relative: float = 1e-12) -> None:
    """Shapes agree, and no entry differs by more than `relative` times the largest expected."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    assert actual.shape == expected.shape
    scale = float(np.max(np.abs(expected)))
    assert scale > 0.0
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=relative * scale)


def derivative(function: Callable[[float], Array], step: float = 4e-3) -> Array:
    """Derivative at 0 by the central difference of eighth order.

    Truncation and rounding both stay near 1e-13 if the function varies over about 1.
    """
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    total = sum(
        weight * (function(k * step) - function(-k * step)) for k, weight in enumerate(weights, 1)
    )
    return np.asarray(total) / step


def jacobian(function: Callable[[Array], Array], place: Array, step: float = 4e-3) -> Array:
    """Jacobian matrix at `place`, one `derivative` for each column."""

    def along(axis: Array) -> Array:
        return derivative(lambda t: function(place + t * axis), step)

    return np.column_stack([along(axis) for axis in np.eye(place.size)])


def second_derivative(function: Callable[[float], Array]) -> Array:
    """Second derivative at 0, good to about 1e-11 of the function's size."""

    def slope(time: float) -> Array:
        return derivative(lambda inner: function(time + inner), OUTER_STEP)

    return derivative(slope, OUTER_STEP)


def angles_apart(first: Trajectory, second: Trajectory) -> float:
    """Largest difference in beta and gamma in rad."""
    return float(np.max(np.abs(first.coordinates - second.coordinates)[:, 4:]))


def shifted(start: State, field: str, index: int, amount: float) -> State:
    """A state with one of its coordinates or rates changed."""
    values = list(getattr(start, field))
    values[index] += amount
    return replace(start, **{field: tuple(values)})


def random_disk(random: Generator, products: float = 0.0) -> Disk:
    """Disk with all parameters of order one, so that no term of an equation can hide.

    Products of inertia are up to a given size.
    """
    a, b, c = random.uniform(0.5, 1.5, size=3)
    radius, mass = random.uniform(0.8, 1.6, size=2)
    eccentricity = random.uniform(0.3, 0.7)
    shift = mass * eccentricity**2
    return Disk(
        radius=radius,
        mass=mass,
        eccentricity=eccentricity,
        inertia_x=b + c,
        inertia_y=a + c + shift,
        inertia_z=a + b + shift,
        **{name: random.uniform(-products, products) for name in PRODUCTS if products},
    )


def random_state(random: Generator) -> tuple[Array, Array]:
    """Coordinates and rates of order one that know of no constraint."""
    z = random.uniform(-1.0, 1.0, size=6)
    z[3], z[5] = random.uniform(-3.0, 3.0, size=2)
    z[4] = random.uniform(0.4, 2.7)
    return z, random.uniform(-1.5, 1.5, size=6)


def model(level: Level = 1, **fields: Any) -> Scenario:
    """Scenario of one of the paper's models."""
    return Scenario(constraints=MODELS[level], **fields)


def random_table(random: Generator) -> Table:
    """Leaning table."""
    inclination, downhill = random.uniform(0.1, 0.6), random.uniform(-3.0, 3.0)
    return Table(gravity=random.uniform(2.0, 12.0), inclination=inclination, downhill=downhill)


def random_start(constraints: ConstraintSet, random: Generator) -> Start:
    """Start that is free in everything that the constraints leave free."""
    free = [each for each in independent_coordinates(constraints) if each not in ("beta", "gamma")]
    return Start(
        alpha=random.uniform(-3.0, 3.0),
        beta=random.uniform(0.4, 2.7),
        gamma=random.uniform(-3.0, 3.0),
        spin=random.uniform(-1.5, 1.5),
        **{name: random.uniform(-1.5, 1.5) for name in free},
    )


def random_scenario(
    constraints: ConstraintSet,
    seed: int,
    friction: FrictionLaw | None = None,
    products: float = 0.0,
) -> tuple[Scenario, Array, Array]:
    """Random disk and start on a leaning table, with coordinates and rates at the start."""
    random = np.random.default_rng(seed)
    scenario = Scenario(
        constraints=constraints,
        disk=random_disk(random, products),
        friction=friction or SmoothCoulomb(),
        table=random_table(random),
        start=random_start(constraints, random),
    )
    state = scenario.initial_state
    return scenario, np.array(state.coordinates), np.array(state.rates)


def reaching(quantity: str, limit: float, sign: float = 1.0) -> Callable[[State], float]:
    """Condition that ends a motion where a coordinate or rate comes up to a limit, or down: -1."""
    field = "rates" if quantity.endswith("_rate") else "coordinates"
    at = COORDINATES.index(quantity.removesuffix("_rate"))

    def condition(state: State) -> float:
        return sign * (limit - getattr(state, field)[at])

    condition.__name__ = f"{quantity} {limit}"
    return condition


needs_heyoka = pytest.mark.skipif(
    find_spec("heyoka") is None, reason="heyoka has wheels for Linux alone"
)

EITHER_METHOD = ("DOP853", pytest.param("taylor", marks=needs_heyoka))
"""Of either kind: pure and compiled."""

all_sets = pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids="+".join)

ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")

TILTED: tuple[ConstraintSet, ...] = (
    ("contact", "held-tilt-rate"),
    ("contact", "fixed-cog", "constant-spin", "held-tilt-rate"),
)
"""Two of the sets that hold the rate of the tilt, too."""

more_sets = pytest.mark.parametrize("constraints", [*POSSIBLE_SETS, *TILTED], ids="+".join)


def arc(z: Array, u: Array, a: Array) -> Callable[[float], Array]:
    """Path with these coordinates, rates and accelerations at time 0."""
    return lambda t: z + t * u + t * t / 2 * a


def random_trajectory(level: Level = 3) -> Trajectory:
    """Five samples that are no motion; none of the numbers has a short decimal form."""
    random = np.random.default_rng(level)
    return Trajectory(
        times=np.cumsum(random.uniform(0.1, 1.0, size=5)),
        coordinates=random.uniform(0.1, 3.0, size=(5, 6)),
        rates=random.normal(size=(5, 6)),
        multipliers=random.normal(size=(5, len(multiplier_names(MODELS[level])))),
        scenario=model(
            level,
            disk=random_disk(random),
            friction=SmoothCoulomb(coefficient=1 / 3, smoothing=0.01, load="contact"),
            table=random_table(random),
        ),
        source="engine",
        method={"formulation": "tree", "step": 1 / 7, "stages": 4, "event": None},
        error_estimate=1e-8 / 3,
        counts={"steps": 12},
        versions={"numpy": np.__version__},
    )


@cache
def short_run() -> Trajectory:
    """A motion that can be played."""
    return simulate(Scenario(), np.linspace(0.0, 0.1, 11), local_tolerance=1e-6)


def turn_z(angle: float) -> Array:
    """Rotation matrix about the vertical."""
    return np.array(Rotation.from_euler("Z", angle).as_matrix())


def rotation(z: Array) -> Array:
    """Rotation matrix A_IB of the three Euler turns."""
    return np.array(Rotation.from_euler("ZXZ", z[3:]).as_matrix())


def centre(z: Array) -> Array:
    """Inertial position of G."""
    return turn_z(z[3]) @ z[:3]


def cog(disk: Body, z: Array) -> Array:
    """Inertial position of S."""
    return centre(z) + disk.eccentricity * rotation(z)[:, 0]


def contact_arm(disk: Body, z: Array) -> Array:
    """Inertial vector from G to the lowest point of the rim: down, within the disk's plane."""
    normal = rotation(z)[:, 2]
    down = normal[2] * normal - np.array([0.0, 0.0, 1.0])
    return disk.radius * down / np.linalg.norm(down)


def angular_velocity(path: Callable[[float], Array], time: float = 0.0) -> Array:
    """Inertial angular velocity along a path of coordinates, from the rotation matrix alone."""
    change = derivative(lambda s: rotation(path(time + s)))
    skew = change @ rotation(path(time)).T
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


def slip(disk: Body, path: Callable[[float], Array], time: float = 0.0) -> Array:
    """Velocity of the disk's material point at the contact, in R-frame axes, shape (2,)."""
    speed = derivative(lambda s: centre(path(time + s)))
    speed = speed + np.cross(angular_velocity(path, time), contact_arm(disk, path(time)))
    return (turn_z(-path(time)[3]) @ speed)[:2]


class Lagrange(NamedTuple):
    """Terms of M u' - h = f + w_N lambda_N + W_T lambda_T, and directions that move S."""

    mass_matrix: Array
    gyroscopic_forces: Array
    gravity_forces: Array
    normal_direction: Array
    tangential_directions: Array
    cog_directions: Array


@cache
def lagrange(*, rotating: bool = True) -> Callable[[Body, Table, Array, Array], Lagrange]:
    """Lagrange's equations from the position of G and the rotation matrix alone.

    G is given in the frame R if `rotating`, in the inertial frame otherwise.
    """
    parameters = sympy.symbols("m r e A B C", positive=True) + sympy.symbols("D E F", real=True)
    m, r, e, A, B, C, D, E, F = parameters
    inertia = sympy.Matrix([[A, D, E], [D, B, F], [E, F, C]])
    gravity = sympy.symbols("g_x g_y g_z", real=True)
    z = sympy.Matrix(sympy.symbols("x y z alpha beta gamma"))
    u = sympy.Matrix(sympy.symbols("u1:7"))

    def rate(matrix: Any) -> Any:
        terms = (matrix.diff(place) * speed for place, speed in zip(z, u, strict=True))
        return sum(terms, sympy.zeros(*matrix.shape))

    frame = rot_ccw_axis3(z[3]) if rotating else sympy.eye(3)
    turn = rot_ccw_axis3(z[3]) * rot_ccw_axis1(z[4]) * rot_ccw_axis3(z[5])
    centre, to_cog = frame * z[:3, :], sympy.Matrix([e, 0, 0])
    spin = turn.T * rate(turn)
    omega = sympy.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])
    speed = rate(centre)
    kinetic = (
        m * speed.dot(speed) / 2
        + m * speed.dot(turn * omega.cross(to_cog))
        + (omega.T * inertia * omega)[0] / 2
    )
    potential = -m * sympy.Matrix(gravity).dot(centre + turn * to_cog)
    momenta = sympy.Matrix([kinetic]).jacobian(u).T
    # The contact point is the lowest one of the rim: down the plane of the disk from G.
    normal = turn[:, 2]
    down = normal[2] * normal - sympy.Matrix([0, 0, 1])
    arm = r * down / sympy.sqrt(1 - normal[2] ** 2)
    contact_speed = frame.T * (speed + (turn * omega).cross(arm))
    cog = frame.T * (centre + turn * to_cog)
    terms = [
        momenta.jacobian(u),
        sympy.Matrix([kinetic]).jacobian(z).T - momenta.jacobian(z) * u,
        -sympy.Matrix([potential]).jacobian(z).T,
        sympy.Matrix([(centre + arm)[2]]).jacobian(z).T,
        contact_speed[:2, :].jacobian(u).T,
        cog.jacobian(z)[:2, :].T,
    ]
    function = sympy.lambdify([(*parameters, *gravity), z, u], terms, cse=True)

    def evaluated(disk: Body, table: Table, z: Array, u: Array) -> Lagrange:
        moments = (disk.inertia_x, disk.inertia_y, disk.inertia_z, *disk.products)
        numbers = (disk.mass, disk.radius, disk.eccentricity, *moments, *table.vector)
        return Lagrange(*(each.squeeze() for each in function(numbers, z, u)))

    return evaluated


def refusals(
    calls: Mapping[str, Callable[[], object]],
    errors: type[Exception] | tuple[type[Exception], ...] = ValueError,
) -> Callable[[str], None]:
    """A test that each call is refused in one line that has its message in it."""

    @pytest.mark.parametrize("message", calls)
    def test(message: str) -> None:
        with pytest.raises(errors, match=message) as refused:
            calls[message]()
        assert "\n" not in str(refused.value)

    return test


def failing(checks: Iterable[Any]) -> set[str]:
    """Names of the checks that do not hold."""
    return {check.name for check in checks if not check.holds}


def planted(table: Any, at: Any, column: str, value: Any) -> Any:
    """A table with one value replaced: by another, or by what a function makes of it."""
    other = table.astype({column: object})
    other.at[at, column] = value(other.at[at, column]) if callable(value) else value
    return other.infer_objects()


def is_running(process: int) -> bool:
    """Whether a process is alive, by /proc."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"
