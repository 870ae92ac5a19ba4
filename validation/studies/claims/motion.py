"""What the paper says about the motion from Table 3 (Figures 7 to 9, Sections 4 and 5)."""

import itertools
from collections.abc import Sequence
from math import inf

import numpy as np
import pandas as pd

from analysis import LEVELS, MODELS, Level, Scenario, Trajectory, energies
from analysis.data import frames
from analysis.data.checks import Array
from validation.run import run as run_scenario
from validation.studies import inversion
from validation.studies.claims.grades import Judged, grade, within
from validation.study import Row, Study

UPRIGHT = np.pi / 2

NEAR = 0.1
"""Distance in rad from the inverted position that counts as converged."""

CONSTANT = 1.0
"""Change of the spin in rad/s within which it counts as almost constant."""

LATER = 2.0
"""Time in s from which on the spin is said to be almost constant."""

LONG = 20.0
"""End in s of the runs that show for how long it is."""


# --- Measures of a motion -----------------------------------------------------------------------


def first_time(run: Trajectory, name: str, value: float) -> float:
    """Time in s at which a coordinate first reaches a value from below; nan if never."""
    values = run.coordinate(name)
    index = int(np.argmax(values >= value))
    if values[index] < value:
        return float("nan")
    before = slice(max(index - 1, 0), index + 1)
    return float(np.interp(value, values[before], run.times[before]))


def overshoot(run: Trajectory) -> float:
    """How far gamma goes beyond pi / 2 in rad."""
    return float(np.max(run.coordinate("gamma")) - UPRIGHT)


def largest_tilt(run: Trajectory) -> float:
    """How far beta goes from pi / 2 in rad."""
    return float(np.max(np.abs(run.coordinate("beta") - UPRIGHT)))


def settling_time(run: Trajectory) -> float:
    """Time in s from which gamma stays within `NEAR` of pi / 2 to the end; inf if it does not."""
    away = np.flatnonzero(np.abs(run.coordinate("gamma") - UPRIGHT) > NEAR)
    if not away.size:
        return float(run.times[0])
    return inf if away[-1] == run.times.size - 1 else float(run.times[away[-1] + 1])


def turning_points(run: Trajectory, since: float = 0.5) -> int:
    """Number of turning points of beta after `since` seconds."""
    rate = run.rate("beta")[run.times >= since]
    return int(np.sum(rate[1:] * rate[:-1] < 0.0))


def leaves(run: Trajectory) -> float:
    """Time in s at which the spin first differs by `CONSTANT` from that at `LATER`; else inf."""
    spin = run.rate("alpha")
    away = (run.times > LATER) & (np.abs(spin - value_at(run, spin, LATER)) > CONSTANT)
    return float(run.times[np.argmax(away)]) if np.any(away) else inf


def value_at(run: Trajectory, values: Array, time: float) -> float:
    """Value at the sample nearest to a time in s."""
    return float(values[np.argmin(np.abs(run.times - time))])


def potential_share(run: Trajectory) -> float:
    """Gain of potential energy over the loss of kinetic energy from the start to `LATER`."""
    kinetic, potential = energies(run.scenario, run.coordinates, run.rates)
    gained = value_at(run, potential, LATER) - potential[0]
    return float(gained / (kinetic[0] - value_at(run, kinetic, LATER)))


def cog_path(run: Trajectory) -> tuple[Array, Array]:
    """Horizontal position and velocity of the COG in the inertial frame, each shape (n, 2)."""
    positions, rotations = frames.poses(run.coordinates)
    velocities, turning = frames.twists(run.coordinates, run.rates)
    arm = run.scenario.disk.eccentricity * rotations[:, :, 0]
    return (positions + arm)[:, :2], (velocities + np.cross(turning, arm))[:, :2]


def speeds(run: Trajectory) -> tuple[float, float]:
    """Root mean square of the COG's horizontal speed and of the slip in m/s, until inverted."""
    positions, _ = frames.poses(run.coordinates)
    velocities, turning = frames.twists(run.coordinates, run.rates)
    arm = run.contact_points - positions
    slip = (velocities + np.cross(turning, arm))[:, :2]
    rising = run.times <= (run.inversion_time or run.times[-1])
    one, other = (
        float(np.sqrt(np.mean(np.sum(each[rising] ** 2, axis=1))))
        for each in (cog_path(run)[1], slip)
    )
    return one, other


# --- Long runs ----------------------------------------------------------------------------------


def long_run(level: Level) -> list[Row]:
    """In-house run from Table 3 over `LONG`, sampled every 10 ms."""
    times = np.linspace(0.0, LONG, round(100 * LONG) + 1)
    scenario = Scenario(constraints=MODELS[level])
    return [_measures(run_scenario(scenario, times, source="in-house", local_tolerance=1e-7))]


def _measures(run: Trajectory) -> Row:
    position, _ = cog_path(run)
    away = np.linalg.norm(position - position[0], axis=1)
    spin, end = run.rate("alpha"), run.inversion.lost or LONG
    cog_speed, slip_speed = speeds(run)
    return {
        "settled": settling_time(run),
        "constant_until": leaves(run),
        "end": end,
        "spin_at_4": value_at(run, spin, 4.0),
        "lowest_spin": float(np.min(spin[run.times <= end])),
        "away_early": float(np.max(away[run.times <= LATER])),
        "away": float(np.max(away)),
        "cog_speed": cog_speed,
        "slip_speed": slip_speed,
    }


LONG_RUNS = Study(
    name="long-runs",
    cases=lambda: {f"Model {level}": level for level in LEVELS},
    measure=long_run,
)


# --- Statements ---------------------------------------------------------------------------------


def judge(runs: inversion.Runs, short: inversion.Runs, longs: pd.DataFrame) -> dict[str, Judged]:
    """All statements on the motion from Table 3.

    Parameters
    ----------
    runs, short : mapping
        Those of the engine over 4 s and until `LATER`.
    longs : DataFrame
        Of `LONG_RUNS`.
    """
    levels = [runs[f"Model {level}", "engine"] for level in LEVELS]
    turns, beyond = list(map(turning_points, levels)), list(map(overshoot, levels))
    settled, first = longs["settled"].tolist(), longs.iloc[0]
    disk = Scenario().disk
    spins = [value_at(run, run.rate("alpha"), LATER) for run in levels[:3]]
    until = longs["constant_until"][:3]
    shares = list(map(potential_share, levels[:3]))
    return figure_7(short[inversion.CONTACT, "engine"], short["Model 1", "engine"]) | {
        "drift": within(first["away_early"] / disk.eccentricity, 1.0, 2.0)
        | {"of_radius": first["away_early"] / disk.radius, "run": first},
        "slip": within(first["cog_speed"] / first["slip_speed"], 0.1, 0.5) | {"run": first},
        "oscillation": within(turns[1] / turns[0], 0.5) | {"turns": turns},
        "fewer": {"turns": turns, "verdict": grade(yes=falls(turns))},
        "overshoot": {
            "beyond": beyond,
            "verdict": grade(yes=falls(beyond), partly=max(beyond[1:]) < beyond[0]),
        },
        "faster": {
            "settled": settled,
            "reached": [first_time(run, "gamma", UPRIGHT) for run in levels],
            "verdict": grade(yes=falls(settled), partly=max(settled[1:]) < settled[0]),
        },
        "tilts": within(max(map(largest_tilt, levels)), 0.1, 0.5)
        | {"tilts": list(map(largest_tilt, levels))},
        "spin": within(sum(abs(spin - inversion.PRINTED_SPIN) > CONSTANT for spin in spins), 0, 2)
        | {"spins": spins},
        "constant": within(sum(np.isfinite(until)), 0, 2)
        | {"until": np.minimum(until, LONG).tolist(), "run": first},
        "potential": within(1.0 - min(shares), 0.1, 0.75) | {"shares": shares},
    }


def figure_7(contact: Trajectory, weight: Trajectory) -> dict[str, Judged]:
    """Statements about Figure 7, from runs of Model 1 under either load at the same times."""
    gamma = contact.coordinate("gamma")
    after = float(np.max(np.abs(gamma - UPRIGHT)[contact.times >= inversion.PRINTED_TIME]))
    reached = first_time(contact, "gamma", UPRIGHT)
    force = contact.normal_force / contact.scenario.weight
    change = np.max(np.abs(weight.coordinates - contact.coordinates), axis=0)[4:]
    return {
        "converges": {
            "verdict": grade(yes=after <= NEAR, partly=reached <= inversion.PRINTED_TIME),
            "reached": reached,
            "short": [
                UPRIGHT - value_at(run, run.coordinate("gamma"), inversion.PRINTED_TIME)
                for run in (contact, weight)
            ],
            "overshoot": [overshoot(run) for run in (contact, weight)],
            "inverted": contact.inversion_time,
        },
        "tilt": within(largest_tilt(contact), 0.1, 0.5),
        "force": within(float(np.max(np.abs(force - 1.0))), 0.1, 0.3)
        | {"least": force.min(), "most": force.max()},
        "loads": within(float(np.max(change)), inversion.PRINTED_CHANGE, 5e-2)
        | {"change": change.tolist()},
    }


def falls(values: Sequence[float]) -> bool:
    """Whether each value is smaller than the one before."""
    return all(after < before for before, after in itertools.pairwise(values))
