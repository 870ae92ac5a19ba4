"""What the paper says about the motion from Table 3 (Figures 7 to 9, Sections 4 and 5)."""

from collections.abc import Mapping, Sequence

import numpy as np

from analysis import MODELS, Level, Load, Scenario, Trajectory, energies
from validation.run import run as run_scenario
from validation.studies.claims.claim import Claim, falls, grade, listed

UPRIGHT = np.pi / 2

NEAR = 0.1
"""Distance in rad from the inverted position that counts as converged."""

CONSTANT = 1.0
"""Change of the spin in rad/s within which it counts as almost constant."""

LONG = 20.0
"""End in s of the runs that show for how long the spin stays constant."""


def long_run(level: Level) -> Trajectory:
    """In-house run from Table 3 over `LONG`, sampled every 10 ms."""
    times = np.linspace(0.0, LONG, round(100 * LONG) + 1)
    scenario = Scenario(constraints=MODELS[level])
    return run_scenario(scenario, times, source="in-house", local_tolerance=1e-7)


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


def settling_time(run: Trajectory) -> float:
    """Time in s from which gamma stays within `NEAR` of pi / 2 to the end; inf if it does not."""
    away = np.flatnonzero(np.abs(run.coordinate("gamma") - UPRIGHT) > NEAR)
    if not away.size:
        return float(run.times[0])
    return float("inf") if away[-1] == run.times.size - 1 else float(run.times[away[-1] + 1])


def turning_points(run: Trajectory, since: float = 0.5) -> int:
    """Number of turning points of beta after `since` seconds."""
    rate = run.rate("beta")[run.times >= since]
    return int(np.sum(rate[1:] * rate[:-1] < 0.0))


def leaves(run: Trajectory, since: float = 2.0) -> float:
    """Time in s at which the spin first differs by `CONSTANT` from that at `since`; else inf."""
    spin = run.rate("alpha")
    away = (run.times > since) & (np.abs(spin - value_at(run, spin, since)) > CONSTANT)
    return float(run.times[np.argmax(away)]) if np.any(away) else float("inf")


def value_at(run: Trajectory, values: np.ndarray, time: float) -> float:
    """Value at the sample nearest to a time in s."""
    return float(values[np.argmin(np.abs(run.times - time))])


def potential_share(run: Trajectory, until: float = 2.0) -> float:
    """Gain of potential energy over the loss of kinetic energy from the start to `until`."""
    kinetic, potential = energies(run.scenario, run.coordinates, run.rates)
    gained = value_at(run, potential, until) - potential[0]
    return float(gained / (kinetic[0] - value_at(run, kinetic, until)))


def figure_7(loads: Mapping[Load, tuple[Trajectory, Trajectory]]) -> list[Claim]:
    """Claims about Figure 7, from the engine's runs of Model 1 over 2 s by load law."""
    contact, weight = loads["contact"][0], loads["weight"][0]
    force = contact.normal_force / contact.scenario.weight
    gamma = contact.coordinate("gamma")
    after = np.max(np.abs(gamma - UPRIGHT)[contact.times >= 0.5])
    reached = first_time(contact, "gamma", UPRIGHT)
    short = [UPRIGHT - value_at(run, run.coordinate("gamma"), 0.5) for run in (contact, weight)]
    inverted = contact.inversion_time
    shown = "not" if inverted is None else f"after {inverted:.3f} s"
    tilt = float(np.max(np.abs(contact.coordinate("beta") - UPRIGHT)))
    difference = np.max(np.abs(weight.coordinates - contact.coordinates), axis=0)[4:6]
    spread = float(np.max(np.abs(force - 1.0)))
    return [
        Claim(
            place="Sect. 4.1, Fig. 7",
            statement="γ converges within 0.5 s to π/2",
            criterion=f"within {NEAR:g} rad from 0.5 s on; partly: reaches π/2 by then",
            measured=f"with the load λ_N {short[0]:.2f} rad short at 0.5 s (m g: {short[1]:.2f}), "
            f"first at π/2 after {reached:.3f} s, overshoot {overshoot(contact):.2f} rad (m g: "
            f"{overshoot(weight):.2f}); the disk is inverted {shown}",
            verdict=grade(yes=bool(after <= NEAR), partly=reached <= 0.5),
        ),
        Claim(
            place="Sect. 4.1, Fig. 7",
            statement="β only changes slightly",
            criterion="at most 0.1 rad from π/2; partly: 0.5 rad",
            measured=f"at most {tilt:.2f} rad from π/2",
            verdict=grade(yes=tilt <= 0.1, partly=tilt <= 0.5),
        ),
        Claim(
            place="Sect. 4.1",
            statement="the normal force is nearly constant",
            criterion="within 10 % of m g; partly: 30 %",
            measured=f"between {force.min():.3f} and {force.max():.3f} m g",
            verdict=grade(yes=spread <= 0.1, partly=spread <= 0.3),
        ),
        Claim(
            place="Sect. 4.1, Fig. 7",
            statement="with the loads m g and λ_N, β and γ differ by some 1e-2 rad",
            criterion="at most 1e-2 rad; partly: at most 5e-2 rad",
            measured=f"largest Δβ {difference[0]:.1e}, largest Δγ {difference[1]:.1e} rad",
            verdict=grade(yes=np.max(difference) <= 1e-2, partly=np.max(difference) <= 5e-2),
        ),
    ]


def spinning(levels: Sequence[Trajectory], longs: Sequence[Trajectory]) -> list[Claim]:
    """Claims about Figure 9, from engine runs over 4 s and in-house runs over `LONG`."""
    spins = [value_at(run, run.rate("alpha"), 2.0) for run in levels[:3]]
    until = [leaves(run) for run in longs[:3]]
    free = longs[0]
    last = free.inversion.lost or LONG
    lowest = float(np.min(free.rate("alpha")[free.times <= last]))
    shares = [potential_share(run) for run in levels[:3]]
    return [
        Claim(
            place="Sect. 5, Fig. 9",
            statement="the spin drops from 40 to about 35 rad/s (Models 1 to 3)",
            criterion="within 1 rad/s of 35 after 2 s in all three; partly: in some",
            measured=f"after 2 s {listed(spins)} rad/s",
            verdict=grade(
                yes=all(abs(spin - 35.0) <= 1.0 for spin in spins),
                partly=any(abs(spin - 35.0) <= 1.0 for spin in spins),
            ),
        ),
        Claim(
            place="Fig. 9",
            statement="for t > 2 s the spin of Models 1 to 3 is almost constant",
            criterion=f"within {CONSTANT:g} rad/s of its value at 2 s until {LONG:g} s in all "
            "three; partly: in some",
            measured=f"Models 1 to 3 until {listed(np.minimum(until, LONG), '.1f')} s; Model 1 "
            f"falls to {value_at(free, free.rate('alpha'), 4.0):.1f} rad/s at 4 s and to "
            f"{lowest:.1f} rad/s at {last:.1f} s",
            verdict=grade(yes=min(until) == np.inf, partly=max(until) == np.inf),
        ),
        Claim(
            place="Sect. 5, 7",
            statement="the spin drops because the potential energy rises",
            criterion="the rise is at least 90 % of the kinetic energy lost within 2 s; partly: "
            "at least a quarter",
            measured=f"Models 1 to 3: {listed([100 * share for share in shares], '.0f')} %; "
            "friction takes the rest",
            verdict=grade(yes=min(shares) >= 0.9, partly=min(shares) >= 0.25),
        ),
    ]


def constraints(levels: Sequence[Trajectory], longs: Sequence[Trajectory]) -> list[Claim]:
    """Claims on what each constraint changes; the arguments are those of `spinning`."""
    counts = [turning_points(run) for run in levels]
    beyond = [overshoot(run) for run in levels]
    settled = [settling_time(run) for run in longs]
    reached = [first_time(run, "gamma", UPRIGHT) for run in levels]
    shown = [f"{time:.2f} s" if np.isfinite(time) else "never" for time in settled]
    tilts = [float(np.max(np.abs(run.coordinate("beta") - UPRIGHT))) for run in levels]
    end = levels[0].times[-1]
    return [
        Claim(
            place="Sect. 4.2",
            statement="a high-frequency oscillation of Model 1 has disappeared in Model 2",
            criterion=f"at most half as many turning points of β from 0.5 s to {end:g} s",
            measured=f"{counts[0]} in Model 1, {counts[1]} in Model 2",
            verdict=grade(yes=counts[1] <= counts[0] / 2),
        ),
        Claim(
            place="Sect. 4.2, as a sequence",
            statement="each further constraint leaves fewer oscillations",
            criterion="the number of turning points of β falls from model to model",
            measured=f"Models 1 to 4: {', '.join(map(str, counts))}",
            verdict=grade(yes=falls(counts)),
        ),
        Claim(
            place="Sect. 5",
            statement="the additional constraints lead to less overshooting",
            criterion="the overshoot of γ falls from model to model; partly: Models 2 to 4 all "
            "overshoot less than Model 1",
            measured=f"Models 1 to 4: {listed(beyond)} rad",
            verdict=grade(yes=falls(beyond), partly=max(beyond[1:]) < beyond[0]),
        ),
        Claim(
            place="Sect. 5, 7",
            statement="the additional constraints lead to faster convergence",
            criterion=f"the time from which γ stays within {NEAR:g} rad of π/2 until {LONG:g} s "
            "falls from model to model; partly: Models 2 to 4 are all faster than Model 1",
            measured=f"Models 1 to 4: {', '.join(shown)}; γ is first at π/2 after "
            f"{listed(reached)} s",
            verdict=grade(yes=falls(settled), partly=max(settled[1:]) < settled[0]),
        ),
        Claim(
            place="Sect. 5",
            statement="β remains close to π/2 in all models",
            criterion="at most 0.1 rad from π/2; partly: 0.5 rad",
            measured=f"Models 1 to 4: at most {listed(tilts)} rad",
            verdict=grade(yes=max(tilts) <= 0.1, partly=max(tilts) <= 0.5),
        ),
    ]
