"""Constraint drift and energy balance of a trajectory."""

from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from analysis.mechanics.attitude import EulerAngles, state_of
from analysis.mechanics.constraints import SLIPS, position_residuals, velocity_residuals
from analysis.mechanics.newton_euler import kinetic_energy
from analysis.mechanics.penalty import contact_functions
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array, instance, real_array
from analysis.problem.constraints import PRESCRIBED, multiplier_names, prescribed
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario


def energies(scenario: Scenario, coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Kinetic and potential energy in J, each shape (..., n).

    Parameters
    ----------
    scenario : Scenario
    coordinates, rates : ndarray, shape (..., n, 6)
        Co-rotating coordinates and their rates. The potential energy counts from the table, on a
        leaning one from its origin.

    Raises
    ------
    ValueError
        If the arrays are no such.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, energies, simulate
    >>> run = simulate(Scenario(), np.linspace(0.0, 0.1, 11))
    >>> kinetic, potential = energies(run.scenario, run.coordinates, run.rates)
    >>> bool(np.all(np.diff(kinetic + potential) < 0.0))  # friction only takes
    True
    """
    instance("scenario", scenario, Scenario)
    arrays = real_array("coordinates", coordinates), real_array("rates", rates)
    for name, array in zip(("coordinates", "rates"), arrays, strict=True):
        if array.shape[-1:] != (6,) or array.shape != arrays[0].shape:
            raise ArgumentError(name, f"must have shape (..., n, 6), got {array.shape}")
    return energies_of(scenario, *arrays)


def energies_of(scenario: Any, coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Those of a scenario, or of what has its disk and table, of clean arrays."""
    disk = scenario.disk
    x, y, z, *rest = state_of(disk, np.moveaxis(coordinates, -1, 0), np.moveaxis(rates, -1, 0))
    angular = EulerAngles.angular_velocity(rest[:3], rest[6:9])
    kinetic = kinetic_energy(disk, (rest[3], rest[4], rest[5]), angular)
    along, across, down = scenario.table.vector
    sine, cosine = np.sin(rest[0]), np.cos(rest[0])
    drop = (cosine * x - sine * y) * along + (sine * x + cosine * y) * across + z * down
    return kinetic, -disk.mass * drop


def constraint_drift(trajectory: Trajectory) -> tuple[Array, Array]:
    """Largest constraint residual at every sample.

    Returns
    -------
    position : ndarray, shape (n,)
        Largest position-level residual in m.
    velocity : ndarray, shape (n,)
        Largest velocity-level residual in m/s; a prescribed spin is left out.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, constraint_drift, simulate
    >>> position, velocity = constraint_drift(simulate(Scenario(), np.linspace(0.0, 0.1, 11)))
    >>> bool(position.max() < 1e-9 and velocity.max() < 1e-9)
    True
    """
    instance("trajectory", trajectory, Trajectory)
    held, disk = trajectory.scenario.constraints, trajectory.scenario.disk
    names = multiplier_names(held)
    state = state_of(disk, trajectory.coordinates.T, trajectory.rates.T)
    speeds = [
        speed
        for name, speed in zip(names, velocity_residuals(held, disk, state), strict=True)
        if name not in PRESCRIBED
    ]
    position = np.max(np.abs(position_residuals(held, disk, state)), axis=0)
    return position, np.max(np.abs(speeds), axis=0)


def contact_forces(trajectory: Trajectory) -> Array:
    """Force of the table on the disk at every sample in N, in R-frame axes, shape (n, 3).

    Its parts are those along the edge (e_x) and across it (e_y), and the normal force. Where a
    constraint holds the slip at zero, the part in that direction is the constraint's force, and
    friction elsewhere.

    Parameters
    ----------
    trajectory : Trajectory
        On an ideal contact, or a penalty contact without thickness.

    Raises
    ------
    ValueError
        If the disk has a rounded rim, whose contact point is another.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, contact_forces, simulate
    >>> along, across, normal = contact_forces(simulate(Scenario(), np.linspace(0, 0.1, 11))).T
    >>> bool(np.all(np.hypot(along, across) < Scenario().friction.coefficient * normal))
    True
    """
    scenario = instance("trajectory", trajectory, Trajectory).scenario
    result = np.zeros((trajectory.times.size, 3))
    result[:, 2] = trajectory.normal_force
    result[:, :2] = _friction(trajectory)[1]
    for column, name in enumerate(("tangential_force", "lateral_force")):
        if name in multiplier_names(scenario.constraints):
            result[:, column] += trajectory.multiplier(name)
    return result


def _friction(trajectory: Trajectory) -> tuple[Array, Array]:
    """Slip that is not held, and friction in the same directions, along and across the edge."""
    scenario = trajectory.scenario
    if scenario.contact is not None and scenario.contact.is_rounded:
        raise ValueError("trajectory must be that of a disk with a sharp rim, got a rounded one")
    held, disk = scenario.constraints, scenario.disk
    state = state_of(disk, trajectory.coordinates.T, trajectory.rates.T)
    slips, is_free = velocity_residuals(SLIPS, disk, state), [way not in held for way in SLIPS]
    slip = np.transpose(slips) * is_free
    force = contact_functions(scenario)["force"]
    parts = np.column_stack((slip, trajectory.normal_force)).tolist()
    return slip, np.array([force(*each) for each in parts]) * is_free


def power(trajectory: Trajectory) -> Array:
    """Power of friction and of prescribed rates at every sample in W, shape (n,).

    All other constraints do no work. Friction takes energy; a torque that keeps a rate constant
    may bring some.

    Raises
    ------
    ValueError
        If the disk has a rounded rim, whose contact point is another.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, power, simulate
    >>> bool(power(simulate(Scenario(), np.linspace(0.0, 0.1, 11))).max() <= 0.0)
    True
    """
    scenario = instance("trajectory", trajectory, Trajectory).scenario
    slip, force = _friction(trajectory)
    result: Array = np.sum(force * slip, axis=1)
    for name, coordinate in prescribed(scenario.constraints).items():
        result += trajectory.multiplier(name) * trajectory.rate(coordinate)
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

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, energy_residual, simulate
    >>> run = simulate(Scenario(), np.linspace(0.0, 0.1, 101))
    >>> bool(np.abs(energy_residual(run)).max() < 1e-6)  # of some 0.4 J
    True
    """
    if instance("trajectory", trajectory, Trajectory).scenario.contact is not None:
        raise ValueError(
            "trajectory must hold all that stores and takes energy, but a penalty contact does "
            "beside it; SpatialMotion.energy_residual holds all"
        )
    kinetic, potential = energies(trajectory.scenario, trajectory.coordinates, trajectory.rates)
    total = kinetic + potential
    work = cumulative_simpson(power(trajectory), x=trajectory.times, initial=0.0)
    return total - total[0] - work
