"""What the paper says about the motion from Table 3 (Figures 7 to 9, Sections 4 and 5)."""

from collections.abc import Sequence
from math import inf

import numpy as np
import pandas as pd

from analysis import LEVELS, MODELS, Level, Scenario, Trajectory, energies
from analysis.data.checks import Array
from analysis.mechanics import paper
from validation.run import run as run_scenario
from validation.studies.claims.claim import Claim, falls, grade, listed
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
    if index == 0:
        return float(run.times[0])
    part = (value - values[index - 1]) / (values[index] - values[index - 1])
    return float(run.times[index - 1] + part * (run.times[index] - run.times[index - 1]))


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
    e = run.scenario.disk.eccentricity
    x, y, _, alpha, beta, gamma = run.coordinates.T
    xd, yd, _, alpha_d, beta_d, gamma_d = run.rates.T
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    across, along = x + e * cg, y + e * cb * sg
    across_d = xd - e * sg * gamma_d - along * alpha_d
    along_d = yd - e * sb * sg * beta_d + e * cb * cg * gamma_d + across * alpha_d
    c, s = np.cos(alpha), np.sin(alpha)
    position = np.column_stack((c * across - s * along, s * across + c * along))
    velocity = np.column_stack((c * across_d - s * along_d, s * across_d + c * along_d))
    return position, velocity


def speeds(run: Trajectory) -> tuple[float, float]:
    """Root mean square of the COG's horizontal speed and of the slip in m/s, until inverted."""
    slip = [
        paper.tangential_directions(run.scenario.disk, z).T @ u
        for z, u in zip(run.coordinates, run.rates, strict=True)
    ]
    rising = run.times <= (run.inversion_time or run.times[-1])
    one, other = (
        float(np.sqrt(np.mean(np.sum(each[rising] ** 2, axis=1))))
        for each in (cog_path(run)[1], np.array(slip))
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
    columns={
        "settled": "from when γ stays near π/2, in s",
        "constant_until": "until when the spin stays what it is at 2 s, in s",
        "end": "of the inversion or of the run in s",
        "spin_at_4": "in rad/s at 4 s",
        "lowest_spin": "in rad/s until the inversion is lost",
        "away_early": "way of the COG from its start in m, within 2 s",
        "away": "the same until the end",
        "cog_speed": "root mean square until the inversion in m/s",
        "slip_speed": "the same of the slip",
    },
)


# --- Claims -------------------------------------------------------------------------------------


def figure_7(contact: Trajectory, weight: Trajectory) -> list[Claim]:
    """Claims about Figure 7, from runs of Model 1 under either load at the same times."""
    force = contact.normal_force / contact.scenario.weight
    late = contact.times >= 0.5
    after = float(np.max(np.abs(contact.coordinate("gamma") - UPRIGHT)[late]))
    reached = first_time(contact, "gamma", UPRIGHT)
    short = [UPRIGHT - value_at(run, run.coordinate("gamma"), 0.5) for run in (contact, weight)]
    inverted = contact.inversion_time
    shown = "not" if inverted is None else f"after {inverted:.3f} s"
    tilt, spread = largest_tilt(contact), float(np.max(np.abs(force - 1.0)))
    beta, gamma = np.max(np.abs(weight.coordinates - contact.coordinates), axis=0)[4:]
    place = "Sect. 4.1, Fig. 7"
    return [
        Claim(
            place,
            "γ converges within 0.5 s to π/2",
            f"within {NEAR:g} rad from 0.5 s on; partly: reaches π/2 by then",
            f"with the load λ_N {short[0]:.2f} rad short at 0.5 s (m g: {short[1]:.2f}), first at "
            f"π/2 after {reached:.3f} s, overshoot {overshoot(contact):.2f} rad (m g: "
            f"{overshoot(weight):.2f}); the disk is inverted {shown}",
            grade(yes=after <= NEAR, partly=reached <= 0.5),
        ),
        Claim(
            place,
            "β only changes slightly",
            "at most 0.1 rad from π/2; partly: 0.5 rad",
            f"at most {tilt:.2f} rad from π/2",
            grade(yes=tilt <= 0.1, partly=tilt <= 0.5),
        ),
        Claim(
            "Sect. 4.1",
            "the normal force is nearly constant",
            "within 10 % of m g; partly: 30 %",
            f"between {force.min():.3f} and {force.max():.3f} m g",
            grade(yes=spread <= 0.1, partly=spread <= 0.3),
        ),
        Claim(
            place,
            "with the loads m g and λ_N, β and γ differ by some 1e-2 rad",
            "at most 1e-2 rad; partly: at most 5e-2 rad",
            f"largest Δβ {beta:.1e}, largest Δγ {gamma:.1e} rad",
            grade(yes=max(beta, gamma) <= 1e-2, partly=max(beta, gamma) <= 5e-2),
        ),
    ]


def drift(longs: pd.DataFrame) -> list[Claim]:
    """Claims of Section 4.2 on the horizontal motion, from the long run of Model 1."""
    run, disk = longs.iloc[0], Scenario().disk
    early, speed, slip = run["away_early"], run["cog_speed"], run["slip_speed"]
    times_e, ratio = early / disk.eccentricity, speed / slip
    return [
        Claim(
            "Sect. 4.2",
            "the centre of gravity hardly moves horizontally",
            f"in Model 1 at most by the eccentricity within {LATER:g} s; partly: by twice that",
            f"{1e3 * early:.1f} mm, {times_e:.1f} times the eccentricity or "
            f"{early / disk.radius:.2f} of the radius; {1e3 * run['away']:.0f} mm until "
            f"{LONG:g} s",
            grade(yes=times_e <= 1, partly=times_e <= 2),
        ),
        Claim(
            "Sect. 4.2",
            "the part of the slip that comes from horizontal motion is negligible",
            "in Model 1, until the inversion, the root mean square of the COG's speed is at most "
            "10 % of that of the slip; partly: 50 %",
            f"{100 * ratio:.0f} %: {speed:.3f} of {slip:.3f} m/s",
            grade(yes=ratio <= 0.1, partly=ratio <= 0.5),
        ),
    ]


def constraints(levels: Sequence[Trajectory], longs: pd.DataFrame) -> list[Claim]:
    """Claims on what each constraint changes, from runs over 4 s and the long ones."""
    counts = [turning_points(run) for run in levels]
    beyond, tilts = ([measure(run) for run in levels] for measure in (overshoot, largest_tilt))
    settled = longs["settled"].tolist()
    reached = [first_time(run, "gamma", UPRIGHT) for run in levels]
    shown = [f"{time:.2f} s" if np.isfinite(time) else "never" for time in settled]
    return [
        Claim(
            "Sect. 4.2",
            "a high-frequency oscillation of Model 1 has disappeared in Model 2",
            f"at most half as many turning points of β from 0.5 s to {levels[0].times[-1]:g} s",
            f"{counts[0]} in Model 1, {counts[1]} in Model 2",
            grade(yes=counts[1] <= counts[0] / 2),
        ),
        Claim(
            "Sect. 4.2, as a sequence",
            "each further constraint leaves fewer oscillations",
            "the number of turning points of β falls from model to model",
            f"Models 1 to 4: {', '.join(map(str, counts))}",
            grade(yes=falls(counts)),
        ),
        Claim(
            "Sect. 5",
            "the additional constraints lead to less overshooting",
            "the overshoot of γ falls from model to model; partly: Models 2 to 4 all overshoot "
            "less than Model 1",
            f"Models 1 to 4: {listed(beyond)} rad",
            grade(yes=falls(beyond), partly=max(beyond[1:]) < beyond[0]),
        ),
        Claim(
            "Sect. 5, 7",
            "the additional constraints lead to faster convergence",
            f"the time from which γ stays within {NEAR:g} rad of π/2 until {LONG:g} s falls from "
            "model to model; partly: Models 2 to 4 are all faster than Model 1",
            f"Models 1 to 4: {', '.join(shown)}; γ is first at π/2 after {listed(reached)} s",
            grade(yes=falls(settled), partly=max(settled[1:]) < settled[0]),
        ),
        Claim(
            "Sect. 5",
            "β remains close to π/2 in all models",
            "at most 0.1 rad from π/2; partly: 0.5 rad",
            f"Models 1 to 4: at most {listed(tilts)} rad",
            grade(yes=max(tilts) <= 0.1, partly=max(tilts) <= 0.5),
        ),
    ]


def spinning(levels: Sequence[Trajectory], longs: pd.DataFrame) -> list[Claim]:
    """Claims about Figure 9; the arguments are those of `constraints`."""
    spins = [value_at(run, run.rate("alpha"), LATER) for run in levels[:3]]
    near = [abs(spin - 35.0) <= 1.0 for spin in spins]
    until, free = longs["constant_until"].to_numpy(float)[:3], longs.iloc[0]
    shares = [potential_share(run) for run in levels[:3]]
    return [
        Claim(
            "Sect. 5, Fig. 9",
            "the spin drops from 40 to about 35 rad/s (Models 1 to 3)",
            f"within 1 rad/s of 35 after {LATER:g} s in all three; partly: in some",
            f"after {LATER:g} s {listed(spins)} rad/s",
            grade(yes=all(near), partly=any(near)),
        ),
        Claim(
            "Fig. 9",
            f"for t > {LATER:g} s the spin of Models 1 to 3 is almost constant",
            f"within {CONSTANT:g} rad/s of its value at {LATER:g} s until {LONG:g} s in all "
            "three; partly: in some",
            f"Models 1 to 3 until {listed(np.minimum(until, LONG), '.1f')} s; Model 1 falls to "
            f"{free['spin_at_4']:.1f} rad/s at 4 s and to {free['lowest_spin']:.1f} rad/s at "
            f"{free['end']:.1f} s",
            grade(yes=min(until) == inf, partly=max(until) == inf),
        ),
        Claim(
            "Sect. 5, 7",
            "the spin drops because the potential energy rises",
            f"the rise is at least 90 % of the kinetic energy lost within {LATER:g} s; partly: at "
            "least a quarter",
            f"Models 1 to 3: {listed([100 * share for share in shares], '.0f')} %; friction takes "
            "the rest",
            grade(yes=min(shares) >= 0.9, partly=min(shares) >= 0.25),
        ),
    ]
