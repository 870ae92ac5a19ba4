"""Bodies of any shape on both contacts, against Newton's and Euler's laws along a path."""

from dataclasses import fields, replace

import numpy as np
import pytest

from analysis import (
    LOADS,
    Body,
    Load,
    Scenario,
    SmoothCoulomb,
    Table,
    energy_residual,
    simulate,
    simulate_to_rest,
)
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from tests.bodies import BODIES, random_start, spinning_top
from tests.helpers import (
    OUTER_STEP,
    angular_velocity,
    arc,
    centre,
    cog,
    derivative,
    not_none,
    rotation,
    second_derivative,
    spin_momentum,
)


def lowest(body: Body, z: Array) -> Array:
    """Inertial lowest point."""
    turn = rotation(z)
    point: Array = centre(z) + turn @ np.array(body.lowest_point(turn[2]))
    return point


def enlarged(body: Body) -> Body:
    """The same of radius and mass one, so that it moves as slowly as differences want."""
    length, mass = 1.0 / body.radius, 1.0 / body.mass
    scales = {"radius": length, "other_radius": length, "eccentricity": length, "mass": mass}
    values = {each.name: getattr(body, each.name) for each in fields(body)}
    for name in values:
        scale = mass * length**2 if name.startswith("inertia") else scales.get(name, 1.0)
        values[name] *= scale
    return replace(body, **values)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("body", [*map(enlarged, BODIES.values())], ids=list(BODIES))
def test_forces_at_the_lowest_point_change_the_momenta(body: Body, seed: int, load: Load) -> None:
    friction = SmoothCoulomb(load=load)
    table = Table(inclination=0.2, downhill=0.5)
    scenario = Scenario(disk=body, friction=friction, table=table, start=random_start(seed, 0.05))
    state = scenario.initial_state
    z, u = np.array(state.coordinates), np.array(state.rates)
    acceleration, (normal,) = accelerations(scenario, z, u)
    path = arc(z, u, acceleration)
    point, middle = lowest(body, z), cog(body, z)
    omega = angular_velocity(path)
    slip = derivative(lambda t: centre(path(t))) + np.cross(omega, point - centre(z))
    assert abs(slip[2]) < 1e-9
    pressing = max(0.0, normal) if load == "contact" else scenario.weight
    force = -pressing * friction.per_speed(float(np.hypot(*slip[:2]))) * slip
    force[2] = normal
    pulled = force / body.mass + table.vector
    scale = float(np.max(np.abs(pulled))) + 1.0
    found = second_derivative(lambda t: cog(body, path(t)))
    np.testing.assert_allclose(found, pulled, atol=1e-9 * scale)
    torque = np.cross(point - middle, force)
    turning = derivative(lambda t: spin_momentum(body, path, t), OUTER_STEP)
    size = float(np.max(np.abs(torque)) + np.max(np.abs(turning)))
    np.testing.assert_allclose(turning, torque, atol=1e-9 * size)
    rise = second_derivative(lambda t: lowest(body, path(t)))[2]
    assert abs(rise) < 1e-9 * scale


def test_tippe_top_turns_over_by_friction_alone() -> None:
    motion = simulate_to_rest(spinning_top(), 1.5, stop_when="inverted")
    assert not_none(motion.ending).reason == "inverted"
    assert motion.times[-1] == pytest.approx(1.228924, abs=2e-6)
    ideal = replace(spinning_top(), contact=None)
    run = simulate(ideal, np.linspace(0.0, 1.5, 601), stop_when="inverted")
    assert run.times[-1] == pytest.approx(1.22861, abs=1e-5)
    assert np.max(np.abs(energy_residual(run))) < 1e-4 * motion.energies[0].sum()
    smooth = simulate_to_rest(spinning_top(0.0), 1.5)
    assert smooth.cog_direction.max() < -0.9
