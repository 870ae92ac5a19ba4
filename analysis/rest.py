"""In-house simulation of the disk until it lies still, in any attitude."""

from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from scipy.integrate import solve_ivp

from analysis import frames
from analysis.checks import Array, choice, positive
from analysis.contact import PenaltyContact
from analysis.disk import STEEL_DISK, Disk
from analysis.dissipation import CAUSES, Dissipation, RestCriterion
from analysis.effort import rest_effort
from analysis.free_disk import FreeDisk, norm, to_inertial
from analysis.friction import SmoothCoulomb
from analysis.limits import check_storage
from analysis.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.state import State, consistent_start
from analysis.trajectory import versions

RestMethod = Literal["LSODA", "DOP853", "RK45"]
REST_METHODS: tuple[RestMethod, ...] = get_args(RestMethod)
"""SciPy's Radau and BDF overflow: their numerical Jacobian meets states nothing depends on."""

Progress = Callable[[float], None]

STRETCH = 1.0
"""Time in s after which the quaternion is normalised and rest is looked for."""

ACTUAL = SmoothCoulomb(load="contact")


def simulate_to_rest(
    end: float,
    *,
    disk: Disk = STEEL_DISK,
    friction: SmoothCoulomb = ACTUAL,
    contact: PenaltyContact | None = None,
    dissipation: Dissipation | None = None,
    start: State | None = None,
    spacing: float = 2e-3,
    criterion: RestCriterion | None = None,
    method: RestMethod = "LSODA",
    local_tolerance: float = 1e-10,
    progress: Progress | None = None,
) -> SpatialMotion:
    """Simulate the disk on a compliant table until it rests, or until `end`.

    Parameters
    ----------
    end : float
        Longest time in s.
    disk : Disk
    friction : SmoothCoulomb
        The paper's values on the actual contact force by default.
    contact : PenaltyContact, optional
        With a rounded rim; by default `PenaltyContact.rounded`.
    dissipation : Dissipation, optional
        None besides sliding friction and the contact's damper by default.
    start : State, optional
        By default Table 3, lowered until the contact carries the weight. A given start is taken
        as it is; `PenaltyContact.lowered` makes one that does not bounce.
    spacing : float
        Time between samples in s.
    criterion : RestCriterion, optional
    method : {"LSODA", "DOP853", "RK45"}
        SciPy method. LSODA is fastest; the explicit ones slow down on a flat disk.
    local_tolerance : float
        Relative tolerance of a single step; the absolute one is a hundredth of the number.
    progress : callable, optional
        Called now and then with the time in s that the motion has reached.

    Returns
    -------
    SpatialMotion

    Raises
    ------
    ValueError
        If an argument is out of range, or the run would take more than `MOST_STEPS` or samples
        than can be held.
    ArithmeticError
        If the integration fails on the way.
    """
    end, spacing = positive("end", end), positive("spacing", spacing)
    if spacing > end:
        raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
    choice("method", method, REST_METHODS)
    tolerance = positive("local_tolerance", local_tolerance)
    contact = contact if contact is not None else PenaltyContact.rounded(disk)
    if not contact.is_rounded:
        raise ValueError("half_thickness must be positive for the disk to lie flat, got 0")
    model = FreeDisk(
        disk=disk,
        friction=friction,
        contact=contact,
        dissipation=dissipation if dissipation is not None else Dissipation(),
    )
    if start is None:
        start = contact.lowered(disk, consistent_start(1, disk))
    check_storage("end", end / spacing, MOTION_COLUMNS)
    rest_effort(end, disk, contact).check()
    criterion = criterion if criterion is not None else RestCriterion()
    times: Array = np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing
    states, count, rest = _integrate(
        model, start_vector(disk, start), times, (method, tolerance), (criterion, progress)
    )
    return SpatialMotion(
        **_sampled(model, times[: len(states)], states),
        disk=disk,
        friction=friction,
        contact=model.contact,
        dissipation=model.dissipation,
        source="in-house",
        rest_time=rest,
        method={"method": method, "local_tolerance": tolerance},
        counts={"right_hand_sides": count},
        versions=versions("numpy", "scipy"),
    )


def start_vector(disk: Disk, start: State) -> Array:
    """State of `FreeDisk` for a start in the paper's coordinates, shape (19,)."""
    position, rotation = frames.poses(np.array([start.coordinates]))
    velocity, angular = frames.twists(np.array([start.coordinates]), np.array([start.rates]))
    A = rotation[0]
    offset = disk.eccentricity * A[:, 0]
    cog = position[0] + offset
    cog_velocity = velocity[0] + np.cross(angular[0], offset)
    return np.concatenate(
        (
            cog,
            frames.quaternions(rotation)[0],
            A.T @ cog_velocity,
            A.T @ angular[0],
            np.zeros(len(CAUSES)),
        )
    )


def _integrate(
    model: FreeDisk,
    first: Array,
    times: Array,
    solver: tuple[RestMethod, float],
    watch: tuple[RestCriterion, Progress | None],
) -> tuple[Array, int, float | None]:
    """States at the sampling times up to rest, right-hand sides used, and the time of rest."""
    method, tolerance = solver
    criterion, progress = watch
    spacing = times[1] - times[0]
    stretch = max(1, round(STRETCH / spacing))
    blocks, count = [first[None]], 0
    for begin in range(0, times.size - 1, stretch):
        span = times[begin : begin + stretch + 1]
        result = solve_ivp(
            model.derivative,
            (span[0], span[-1]),
            blocks[-1][-1],
            method=method,
            t_eval=span[1:],
            rtol=tolerance,
            atol=0.01 * tolerance,
        )
        if not result.success:
            raise ArithmeticError(f"{method} stopped at t = {span[0]:g} s: {result.message}")
        count += int(result.nfev)
        block = result.y.T
        block[:, 3:7] /= np.linalg.norm(block[:, 3:7], axis=1)[:, None]
        blocks.append(block)
        if progress is not None:
            progress(float(span[-1]))
        recent = np.concatenate(blocks[-2:])
        kinetic = np.array([model.energies(state)[0] for state in recent.tolist()])
        rest = criterion.first(kinetic, recent[:, 2], spacing)
        if rest is not None:
            whole = np.concatenate(blocks)
            still = len(whole) - len(recent) + rest
            last = still + criterion.samples(spacing)
            return whole[:last], count, float(times[still])
    return np.concatenate(blocks), count, None


def _sampled(model: FreeDisk, times: Array, states: Array) -> dict[str, Array]:
    """Arrays of a `SpatialMotion` from states of `FreeDisk`."""
    offset = [-model.disk.eccentricity, 0.0, 0.0]
    rows = []
    for state in states.tolist():
        quaternion, angular = state[3:7], state[10:13]
        touch = model.touch(state)
        # From S to G the velocity changes by w x (-e, 0, 0).
        centre_velocity = [
            state[7],
            state[8] + angular[2] * offset[0],
            state[9] - angular[1] * offset[0],
        ]
        rows.append(
            (
                *to_inertial(quaternion, offset),
                *to_inertial(quaternion, centre_velocity),
                *to_inertial(quaternion, angular),
                *to_inertial(quaternion, list(touch.point)),
                norm(touch.slip),
                norm(touch.contour),
                touch.force,
                *model.energies(state),
            )
        )
    values = np.array(rows)
    return {
        "times": times,
        "positions": states[:, :3] + values[:, :3],
        "quaternions": states[:, 3:7],
        "velocities": values[:, 3:6],
        "angular_velocities": values[:, 6:9],
        "contact_points": states[:, :3] + values[:, 9:12],
        "slip_speeds": values[:, 12],
        "contour_speeds": values[:, 13],
        "normal_force": values[:, 14],
        "energies": values[:, 15:18],
        "dissipated": states[:, 13:],
    }
