"""What the paper says about the motion from Table 3 (Figures 7 to 9, Sections 4 and 5)."""

import itertools
from collections.abc import Sequence
from math import inf, nan

import numpy as np
import pandas as pd

from analysis import LEVELS, MODELS, Level, Scenario, Trajectory, energies
from analysis.problem.checks import Array
from validation.run import run as run_scenario
from validation.studies import inversion
from validation.study import Check, Row, Study, equal, grade, within

UPRIGHT = np.pi / 2

NEAR = 0.1
"""Distance in rad from the inverted position that counts as converged."""

CONSTANT = 1.0
"""Change of the spin in rad/s within which it counts as almost constant."""

LATER = 2.0
"""Time in s from which on the spin is said to be almost constant."""

LONG = 20.0
"""End in s of the runs that show for how long it is."""

STRAIGHT = 1.0
"""Time in s within which alpha is said to grow almost linearly, during the inversion."""


# --- Measures of a motion -----------------------------------------------------------------------


def measures(run: Trajectory) -> Row:
    """What the statements go by, in SI units."""
    times, gamma, spin = run.times, run.coordinate("gamma"), run.spin
    half, later, fourth = (
        int(np.argmin(np.abs(times - time))) for time in (inversion.PRINTED_TIME, LATER, 4.0)
    )
    reached = int(np.argmax(gamma >= UPRIGHT))
    around = slice(reached - 1, reached + 1)
    near = np.abs(gamma - UPRIGHT) <= NEAR
    beta_rate = run.rate("beta")[half:]
    kinetic, potential = energies(run.scenario, run.coordinates, run.rates)
    force = run.normal_force / run.scenario.weight
    rising = times <= (run.inversion_time or times[-1])
    positions, _, velocities, turning = run.poses
    slip = velocities + np.cross(turning, run.contact_points - positions)
    away = np.linalg.norm((run.cog_positions - run.cog_positions[0])[:, :2], axis=1)
    cog_speed, slip_speed = (
        np.sqrt(np.mean(np.sum(each[rising, :2] ** 2, axis=1)))
        for each in (run.cog_velocities, slip)
    )
    end = run.inversion.lost or times[-1]
    early = times <= STRAIGHT
    alpha = run.coordinate("alpha")[early]
    line = np.polyval(np.polyfit(times[early], alpha, 1), times[early])
    return {
        "inverted": run.inversion_time,
        "short": UPRIGHT - gamma[half],
        "reached": float(np.interp(UPRIGHT, gamma[around], times[around])) if reached else nan,
        "settled": first(times, np.logical_and.accumulate(near[::-1])[::-1]),
        "beyond": np.max(gamma) - UPRIGHT,
        "tilt": np.max(np.abs(run.coordinate("beta") - UPRIGHT)),
        "bent": np.max(np.abs(alpha - line)),
        "turned": alpha[-1] - alpha[0],
        "turns": int(np.sum(beta_rate[1:] * beta_rate[:-1] < 0.0)),
        "least_force": np.min(force),
        "most_force": np.max(force),
        "spin": spin[later],
        "constant_until": first(times, (times > LATER) & (np.abs(spin - spin[later]) > CONSTANT)),
        "spin_at_4": spin[fourth],
        "lowest_spin": np.min(spin[times <= end]),
        "end": end,
        "risen": potential[later] - potential[0],
        "lost": kinetic[0] - kinetic[later],
        "away_early": np.max(away[: later + 1]),
        "away": np.max(away),
        "cog_speed": cog_speed,
        "slip_speed": slip_speed,
    }


def first(times: Array, holds: Array) -> float:
    """First time in s at which something holds; inf if it never does."""
    return float(times[np.argmax(holds)]) if np.any(holds) else inf


def long_run(level: Level) -> list[Row]:
    """In-house run from Table 3 over `LONG`, sampled every 10 ms."""
    times = np.linspace(0.0, LONG, round(100 * LONG) + 1)
    scenario = Scenario(constraints=MODELS[level])
    return [measures(run_scenario(scenario, times, source="in-house", local_tolerance=1e-7))]


LONG_RUNS = Study(
    name="long-runs",
    cases=lambda: {f"Model {level}": level for level in LEVELS},
    measure=long_run,
)


# --- Statements ---------------------------------------------------------------------------------


def measured(runs: inversion.Runs) -> pd.DataFrame:
    """Measures of the engine's runs, first that with the contact force as the load."""
    return pd.DataFrame([measures(runs[case, "engine"]) for case in inversion.cases()])


def judge(runs: inversion.Runs, found: pd.DataFrame, longs: pd.DataFrame) -> dict[str, Row]:
    """All statements on the motion from Table 3, from the runs, their measures and `LONG_RUNS`.

    With the largest changes of beta and gamma in rad by the load of the friction law, and their
    largest differences in Models 2 to 4 from Model 1, shape (3, 2).
    """
    contact, levels, long = found.iloc[0], found.iloc[1:], longs.iloc[0]
    change = np.abs(inversion.changes_by_load(runs)[:, 4:]).max(axis=0)
    one, *others = (runs[name, "engine"].coordinates[:, 4:] for name in inversion.NAMES)
    between = np.array([np.abs(each - one).max(axis=0) for each in others])
    turns, beyond, settled, inverted = (
        levels[name].tolist() for name in ("turns", "beyond", "settled", "inverted")
    )
    like = [bool(np.all(each <= NEAR)) for each in between]
    same = np.isfinite(np.array(inverted, dtype=float)).tolist()
    in_time = [contact[name] <= inversion.PRINTED_TIME for name in ("settled", "reached")]
    off = (levels["spin"][:3] - inversion.PRINTED_SPIN).abs() > CONSTANT
    share = (levels["risen"] / levels["lost"])[:3].min()
    force = max(1.0 - contact["least_force"], contact["most_force"] - 1.0)
    return {
        "converges": {"verdict": grade(yes=in_time[0], partly=in_time[1])},
        "tilt": within(contact["tilt"], 0.1, 0.5),
        "force": within(force, 0.1, 0.3),
        "loads": within(np.max(change), inversion.PRINTED_CHANGE, 5e-2) | {"change": change},
        "drift": within(long["away_early"] / Scenario().disk.eccentricity, 1.0, 2.0),
        "slip": within(long["cog_speed"] / long["slip_speed"], 0.1, 0.5),
        "oscillation": within(turns[1] / turns[0], 0.5),
        "overshoot": {"verdict": grade(yes=falls(beyond), partly=max(beyond[1:]) < beyond[0])},
        "faster": {"verdict": grade(yes=falls(settled), partly=max(settled[1:]) < settled[0])},
        "tilts": within(levels["tilt"].max(), 0.1, 0.5),
        "spin": within(off.sum(), 0, 2),
        "constant": within((longs["constant_until"][:3] <= inversion.END).sum(), 0, 2),
        "similar": {"verdict": grade(yes=like[0], partly=all(same[:2]))},
        "preserved": {"between": between, "verdict": grade(yes=all(like), partly=all(same))},
        "linear": within(levels["bent"].iloc[0] / levels["turned"].iloc[0], 0.05, 0.2),
        "repelled": {"verdict": grade(yes=bool(long["end"] < LONG))},
        "potential": within(1.0 - share, 0.1, 0.75),
    }


def checks(longs: pd.DataFrame) -> list[Check]:
    """Whether every measure of the long runs is a number, that of a time not reached excepted."""
    missing = longs.drop(columns=["inverted", "reached"]).isna().sum().sum()
    return [equal("long runs: numbers that are missing", int(missing), 0)]


def falls(values: Sequence[float]) -> bool:
    """Whether each value is smaller than the one before."""
    return all(after < before for before, after in itertools.pairwise(values))
