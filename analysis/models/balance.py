"""Constraint drift and energy balance of a trajectory."""

import numpy as np
from scipy.integrate import cumulative_simpson

from analysis.data.checks import Array
from analysis.data.constraint_set import multiplier_names
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Trajectory
from analysis.models import constraints, equations
from analysis.models.index1 import friction_per_load


def energies(scenario: Scenario, coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Kinetic and potential energy in J, each shape (n,).

    Parameters
    ----------
    scenario : Scenario
    coordinates, rates : ndarray, shape (n, 6)
        Co-rotating coordinates and their rates. The potential energy counts from the table, on a
        leaning one from its origin.
    """
    disk, table = scenario.disk, scenario.table
    kinetic = [
        0.5 * u @ equations.mass_matrix(disk, z) @ u
        for z, u in zip(coordinates, rates, strict=True)
    ]
    x, y, z, alpha, beta, gamma = np.transpose(coordinates)
    e, sine = disk.eccentricity, np.sin(gamma)
    potential = table.pressing * (z + e * np.sin(beta) * sine)
    if not table.is_horizontal:
        # Of S in the R-frame, and gravity along the table in its axes.
        across, along = x + e * np.cos(gamma), y + e * np.cos(beta) * sine
        gx, gy, _ = table.vector
        potential -= across * (np.cos(alpha) * gx + np.sin(alpha) * gy)
        potential -= along * (np.cos(alpha) * gy - np.sin(alpha) * gx)
    return np.array(kinetic), disk.mass * potential


def constraint_drift(trajectory: Trajectory) -> tuple[Array, Array]:
    """Largest constraint residual at every sample.

    Returns
    -------
    position : ndarray, shape (n,)
        Largest position-level residual in m.
    velocity : ndarray, shape (n,)
        Largest velocity-level residual in m/s; a prescribed spin is left out.
    """
    held, disk = trajectory.scenario.constraints, trajectory.scenario.disk
    names = multiplier_names(held)
    count = len(names) - ("spin_torque" in names)
    position = np.empty(trajectory.times.size)
    velocity = np.empty(trajectory.times.size)
    for row, (z, u) in enumerate(zip(trajectory.coordinates, trajectory.rates, strict=True)):
        position[row] = np.max(np.abs(constraints.positions(held, disk, z)))
        velocity[row] = np.max(np.abs((constraints.directions(held, disk, z) @ u)[:count]))
    return position, velocity


def power(trajectory: Trajectory) -> Array:
    """Power of friction and of the prescribed spin at every sample in W, shape (n,).

    All other constraints do no work. Friction takes energy; the torque that keeps the spin
    constant may bring some.
    """
    scenario = trajectory.scenario
    result = np.zeros(trajectory.times.size)
    for row, (z, u) in enumerate(zip(trajectory.coordinates, trajectory.rates, strict=True)):
        load = (
            scenario.weight
            if scenario.friction.load == "weight"
            else max(0.0, trajectory.normal_force[row])
        )
        result[row] = load * (friction_per_load(scenario, z, u) @ u)
    if "constant-spin" in scenario.constraints:
        result += trajectory.multiplier("spin_torque") * trajectory.rate("alpha")
    return result


def energy_residual(trajectory: Trajectory) -> Array:
    """Energy now, less energy at the start, less work done since, in J, shape (n,).

    The work is the integral of `power` by Simpson's rule over the samples, so the residual also
    holds that rule's error, which falls with the fourth power of the sample spacing.

    Raises
    ------
    ValueError
        If something stored or took energy that the trajectory does not hold: the spring and the
        damper of a penalty contact, or one of the `Dissipation`.
    """
    if trajectory.scenario.contact is not None:
        raise ValueError(
            "trajectory must hold all that stores and takes energy, but a penalty contact does "
            "beside it; SpatialMotion.energy_residual holds all"
        )
    kinetic, potential = energies(trajectory.scenario, trajectory.coordinates, trajectory.rates)
    total = kinetic + potential
    work = cumulative_simpson(power(trajectory), x=trajectory.times, initial=0.0)
    residual: Array = total - total[0] - work
    return residual
