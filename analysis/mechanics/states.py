"""States of the equations of motion, and the paper's coordinates.

A state in Euler angles holds the position of the centre of gravity S in axes of the frame R (3),
alpha, beta and gamma, the velocity of S in axes of R (3) and the rates of the angles (3). All
functions take numbers of any kind, arrays of many states among them.
"""

from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.mechanics.attitude import EulerAngles
from analysis.mechanics.vectors import Numbers, Vector


def state_of(disk: Any, coordinates: Numbers, rates: Numbers) -> tuple[Any, ...]:
    """State of the paper's coordinates and their rates, 6 numbers each.

    Parameters
    ----------
    disk : Disk
    coordinates, rates : sequence of 6 numbers
        In m, rad, m/s and rad/s; those of the constraints do not matter.
    """
    x, y, z, *angles = coordinates
    x_rate, y_rate, z_rate, *turning = rates
    (a, b, c), (u, v, w) = _offset(disk, angles, turning)
    spin = turning[0]
    velocity = x_rate - spin * y + u, y_rate + spin * x + v, z_rate + w
    return x + a, y + b, z + c, *angles, *velocity, *turning


def paper_of(disk: Any, state: Numbers) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The paper's coordinates and their rates, 6 numbers each, of a state."""
    position, angles, velocity, turning = state[:3], state[3:6], state[6:9], state[9:12]
    (a, b, c), (u, v, w) = _offset(disk, angles, turning)
    x, y, z, spin = position[0] - a, position[1] - b, position[2] - c, turning[0]
    rates = velocity[0] - u + spin * y, velocity[1] - v - spin * x, velocity[2] - w
    return (x, y, z, *angles), (*rates, *turning)


def paper_arrays(disk: Any, states: Array) -> tuple[Array, Array]:
    """The paper's coordinates and their rates, each shape (..., 6), of states, (..., 12)."""
    coordinates, rates = paper_of(disk, np.moveaxis(states, -1, 0))
    return np.stack(coordinates, axis=-1), np.stack(rates, axis=-1)


def _offset(disk: Any, angles: Numbers, turning: Numbers) -> tuple[Vector, Vector]:
    """S seen from G in axes of R, and its velocity relative to G."""
    frame, e = EulerAngles.frame(angles), disk.eccentricity
    angular = EulerAngles.angular_velocity(angles, turning)
    return frame.seen((e, 0.0, 0.0)), frame.seen((0.0, e * angular[2], -e * angular[1]))
