"""Constraint drift and energy balance of a trajectory."""

import numpy as np
from scipy.integrate import cumulative_simpson

from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.dissipation import CAUSES
from analysis.data.trajectory import Trajectory
from analysis.models import constraints, equations
from analysis.models.index1 import friction_per_load

_UNTOLD = ("stiffness", *(cause for cause in CAUSES if cause != "sliding"))
"""Settings whose energy no trajectory holds."""


def energies(disk: Disk, coordinates: Array, rates: Array) -> tuple[Array, Array]:
    """Kinetic and potential energy in J, each shape (n,).

    Parameters
    ----------
    disk : Disk
    coordinates, rates : ndarray, shape (n, 6)
        Co-rotating coordinates and their rates. The potential energy counts from the table.
    """
    kinetic = [
        0.5 * u @ equations.mass_matrix(disk, z) @ u
        for z, u in zip(coordinates, rates, strict=True)
    ]
    height = coordinates[:, 2] + disk.eccentricity * np.sin(coordinates[:, 4]) * np.sin(
        coordinates[:, 5]
    )
    return np.array(kinetic), disk.weight * height


def constraint_drift(trajectory: Trajectory) -> tuple[Array, Array]:
    """Largest constraint residual at every sample.

    Returns
    -------
    position : ndarray, shape (n,)
        Largest position-level residual in m.
    velocity : ndarray, shape (n,)
        Largest velocity-level residual in m/s; the prescribed spin of Model 4 is left out.
    """
    level, disk = trajectory.level, trajectory.disk
    position = np.empty(trajectory.times.size)
    velocity = np.empty(trajectory.times.size)
    for row, (z, u) in enumerate(zip(trajectory.coordinates, trajectory.rates, strict=True)):
        position[row] = np.max(np.abs(constraints.positions(level, disk, z)))
        velocity[row] = np.max(np.abs((constraints.directions(level, disk, z) @ u)[:4]))
    return position, velocity


def power(trajectory: Trajectory) -> Array:
    """Power of friction and of the prescribed spin at every sample in W, shape (n,).

    All other constraints do no work. Friction takes energy; the torque that keeps the spin of
    Model 4 constant may bring some.
    """
    result = np.zeros(trajectory.times.size)
    for row, (z, u) in enumerate(zip(trajectory.coordinates, trajectory.rates, strict=True)):
        load = (
            trajectory.disk.weight
            if trajectory.friction.load == "weight"
            else max(0.0, trajectory.normal_force[row])
        )
        result[row] = load * (
            friction_per_load(trajectory.level, trajectory.disk, trajectory.friction, z, u) @ u
        )
    if trajectory.level == 4:
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
    missing = [name for name in _UNTOLD if trajectory.method.get(name)]
    if missing:
        raise ValueError(
            "trajectory must hold all that stores and takes energy, but holds nothing of its "
            f"{', '.join(missing)}; SpatialMotion.energy_residual does"
        )
    kinetic, potential = energies(trajectory.disk, trajectory.coordinates, trajectory.rates)
    total = kinetic + potential
    work = cumulative_simpson(power(trajectory), x=trajectory.times, initial=0.0)
    residual: Array = total - total[0] - work
    return residual
