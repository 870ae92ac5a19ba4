"""States of the equations of motion, and the paper's coordinates.

A state in Euler angles holds the position of the centre of gravity S in axes of the frame R (3),
alpha, beta and gamma, the velocity of S in axes of R (3) and the rates of the angles, or what else
its chart tells the turning by (3). All functions take numbers of any kind, arrays of many states
among them.
"""

from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.elementary import cos, sin
from analysis.mechanics.attitude import EulerAngles
from analysis.mechanics.vectors import Numbers, Vector


def state_of(
    disk: Any, coordinates: Numbers, rates: Numbers, chart: type[EulerAngles] = EulerAngles
) -> tuple[Any, ...]:
    """State of the paper's coordinates and their rates, 6 numbers each.

    Parameters
    ----------
    disk : Disk
    coordinates, rates : sequence of 6 numbers
        In m, rad, m/s and rad/s; those of the constraints do not matter.
    chart : EulerAngles or EulerTurning
    """
    (a, b, c), (u, v, w) = _offset(disk, coordinates, rates)
    x, y, z, spin = coordinates[0] + a, coordinates[1] + b, coordinates[2] + c, rates[3]
    velocity = rates[0] + u - spin * y, rates[1] + v + spin * x, rates[2] + w
    turning = chart.turning_of(coordinates[3:], rates[3:])
    return x, y, z, *coordinates[3:], *velocity, *turning


def paper_of(
    disk: Any, state: Numbers, chart: type[EulerAngles] = EulerAngles
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The paper's coordinates and their rates, 6 numbers each, of a state."""
    turning = chart.rates(state[3:6], state[9:12])
    (a, b, c), (u, v, w) = _offset(disk, state[:6], (*state[6:9], *turning))
    x, y, z, spin = state[0], state[1], state[2], turning[0]
    rates = state[6] + spin * y - u, state[7] - spin * x - v, state[8] - w
    return (x - a, y - b, z - c, *state[3:6]), (*rates, *turning)


def paper_arrays(
    disk: Any, states: Array, chart: type[EulerAngles] = EulerAngles
) -> tuple[Array, Array]:
    """The paper's coordinates and their rates, each shape (..., 6), of states, (..., 12)."""
    coordinates, rates = paper_of(disk, np.moveaxis(states, -1, 0), chart)
    return np.stack(coordinates, axis=-1), np.stack(rates, axis=-1)


def _offset(disk: Any, coordinates: Numbers, rates: Numbers) -> tuple[Vector, Vector]:
    """S seen from G in axes of R, and its velocity there, from the angles and their rates."""
    e, (_, beta, gamma), (_, tilting, rolling) = disk.eccentricity, coordinates[3:], rates[3:]
    sb, cb, sg, cg = sin(beta), cos(beta), e * sin(gamma), e * cos(gamma)
    offset = cg, cb * sg, sb * sg
    moving = (
        -(sg * rolling),
        cb * cg * rolling - sb * sg * tilting,
        sb * cg * rolling + cb * sg * tilting,
    )
    return offset, moving
