"""Passage through the critical speed: when and why an inverted disk falls as its spin decays.

The slow pair of inverted spinning gains its instability where the falling spin passes its Hopf
point, but the disk stays up until the deviation has grown: a delayed loss of stability. With the
growth rate sigma of the pair, the deviation goes as the exponential of the integral of
sigma(spin) over time. It shrinks on the way in as it grows on the way out, and the disk is lost
where both together have brought it to pi/2. Near the crossing sigma goes with the spin; a disk
whose spin falls at a rate r from the Hopf point on is lost at
(spin_crit - spin)² = (2 r / |dsigma/dspin|) ln((pi/2) / deviation at the crossing).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.integrate import cumulative_trapezoid

from analysis import (
    Dissipation,
    Progress,
    Scenario,
    SpatialMotion,
    Start,
    Trajectory,
)
from analysis.motion.interpolation import running_mean
from analysis.problem.checks import Array, positive, within
from analysis.problem.choices import Source
from analysis.problem.limits import LONGEST_MOTION
from analysis.problem.scenario import steady
from analysis.solve.effort import usual_method
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import spin_scale
from analysis.stability.spectra import matrices_over_spin
from validation.display.tables import Table
from validation.run import even_times, run, run_to_rest

LOST = np.pi / 2
"""Deviation of gamma in rad at which an upright disk has its centre of gravity sideways."""

SPACING, STEP = 2e-3, 2e-4
"""Of the samples, and of the engine on a compliant contact, in s, for the paper's disk; others
have as much in parts of sqrt(r / g)."""

LOCAL = 1e-11
"""Local tolerance of other runs: a deviation may shrink to 1e-7 before it grows, and beyond the
loss no tolerance of the whole motion can be kept."""

_DAMPED = -1.35
"""Real part over `spin_scale` below which an eigenvalue belongs to the slip, and not to an
oscillation."""

_FLAT = 0.01
"""Inclination in rad below which a lost disk is not followed."""

RANGE = (0.3, 10.0)
"""Spins over `spin_scale` in which the crossing is looked for."""

SMALL = 0.02
"""Deviation in rad from which slowed disks start."""

Passage = Mapping[str, Any]
"""How a motion passes the critical speed, by the names of `measure`."""


class SlowPair(NamedTuple):
    """The slow pair of inverted spinning about its Hopf point.

    Parameters
    ----------
    scenario : Scenario
        With no dissipation but rolling resistance.
    spin, frequency : float
        Of the Hopf point in rad/s, without sign.
    sense : float
        1 or -1, in which the disk spins.
    """

    scenario: Scenario
    spin: float
    frequency: float
    sense: float = 1.0

    @property
    def settling(self) -> float:
        """Half a slow period in s, left out after the inversion; then as long is measured."""
        return np.pi / self.frequency

    @classmethod
    def of(cls, scenario: Scenario) -> "SlowPair":
        """That of a scenario; what lets the spin decay is left out.

        Raises
        ------
        ValueError
            If the scenario has no such pair, or no linear system.
        """
        lasting = replace(steady(scenario), start=Start())
        # With products of inertia, the two senses are not each other's mirror images.
        sense = -1.0 if scenario.initial_state.rates[3] < 0.0 else 1.0
        least, most = (spin_scale(lasting) * end for end in RANGE)
        low, high = sorted((sense * least, sense * most))
        faster = "above" if sense > 0.0 else "below"
        hopf = critical_speeds(lasting, (low, high)).hopf
        found = [each for each in hopf if each.stable_side == faster]
        if not found:
            raise ValueError(
                f"scenario must have a Hopf point above which inverted spinning gains stability, "
                f"and {scenario.name} has none from {least:.4g} to {most:.4g} rad/s"
            )
        last = max(found, key=lambda each: abs(each.spin))
        return cls(scenario=lasting, spin=abs(last.spin), frequency=last.frequency, sense=sense)

    def rates_at(self, spins: Array) -> tuple[Array, Array | None]:
        """Growth rate of the slow pair in 1/s, and frequency of a fast one in rad/s, shape (n,).

        At spins in rad/s in the sense of the disk, interpolated between 200 of them; no frequency
        if there is no fast pair. The rate is no number above the Hopf point where the pair has
        become two real eigenvalues of which one grows: there, the disk goes to other stationary
        motions.
        """
        grid = np.linspace(np.min(spins) - 0.01, np.max(spins) + 0.01, 200)
        matrices = matrices_over_spin(self.scenario)(self.sense * grid)
        values = np.linalg.eigvals(matrices).astype(complex)
        swings = values.real >= _DAMPED * spin_scale(self.scenario)
        away = np.abs(values.imag - self.frequency)
        away = np.where(swings & (values.imag >= 0.0), away, np.inf)
        # A pair that has become two real eigenvalues grows as its faster one.
        slow = away <= np.min(away, axis=1, keepdims=True)
        rates = np.max(np.where(slow, values.real, -np.inf), axis=1)
        apart = np.max(np.where(slow, values.imag, -np.inf), axis=1) == 0.0
        rates[(grid > self.spin) & apart & (rates > 0.0)] = np.nan
        growth = np.interp(spins, grid, rates)
        fastest = np.max(np.where(swings, values.imag, 0.0), axis=1)
        fast = None
        if np.all(fastest >= 2.0 * self.frequency):
            fast = np.interp(spins, grid, fastest)
        return growth, fast


def measure(motion: Trajectory | SpatialMotion, pair: SlowPair) -> Passage:
    """Follow spin and slow deviation of a motion from its inversion on, by its slow pair.

    Returns
    -------
    dict
        What is told of it, as plain data by names:

        - source, and spin `hopf` and `frequency` of the Hopf point in rad/s;
        - `times` in s, `spins` and `deviations`, shape (n,): samples from the inversion to the
          loss, mean spin in rad/s in the sense of that at the inversion, and slow deviation of
          gamma in rad, freed of the fast oscillation; `linear`, shape (n,): deviation in rad by
          the growth rate alone, fitted soon after the inversion, and of a disk that is lost from
          its lowest spin on at the rate there; none where `SlowPair.rates_at` has no rate;
        - `crossing`, when the mean spin comes below that of the Hopf point, `lost`, when the
          centre of gravity comes below the geometric centre, and `predicted`, when `linear` has
          come to pi/2, beyond the loss at its last rate: in s, None where it does not happen;
        - `lowest_spin`, the lowest mean spin in rad/s, since in falling the disk spins up again,
          and `rate`, at which the spin falls from the crossing to it, in rad/s², or None.

    Raises
    ------
    ValueError
        If the disk is never inverted for a second, or the motion ends soon after.
    """
    inversion = motion.inversion
    (times, gamma, rates), kept = _inverted(motion, pair)
    spins = running_mean(times, rates, 2.0 * np.pi / pair.frequency)
    spins = np.sign(spins[kept][0]) * spins
    turns = np.round((np.median(gamma[kept]) - np.pi / 2) / (2.0 * np.pi))
    deviation = gamma - np.pi / 2 - 2.0 * np.pi * turns
    growth, fast = pair.rates_at(spins)
    if fast is not None:
        for _ in range(2):
            deviation = running_mean(times, deviation, 2.0 * np.pi / fast)
    amplitude = np.hypot(deviation, np.gradient(deviation, times) / pair.frequency)[kept]
    times, spins = times[kept], spins[kept]
    below = np.flatnonzero(spins < pair.spin)
    slowest = int(np.argmin(spins))
    lost_from = None if inversion.lost is None else slowest
    linear, predicted = _predicted(times, growth[kept], amplitude, lost_from, pair.settling)
    # One that begins below the Hopf point, but for rounding, does not come through it.
    begins_above = np.abs(rates[kept][0]) > pair.spin - 1e-9
    crossing = float(times[below[0]]) if below.size and begins_above else None
    rate = None
    if crossing is not None and times[slowest] > crossing:
        rate = float((pair.spin - spins[slowest]) / (times[slowest] - crossing))
    return {
        "source": motion.source,
        "hopf": pair.spin,
        "frequency": pair.frequency,
        "crossing": crossing,
        "lost": inversion.lost,
        "predicted": predicted,
        "lowest_spin": float(spins[slowest]),
        "rate": rate,
        "times": times,
        "spins": spins,
        "deviations": amplitude,
        "linear": linear,
    }


def _inverted(
    motion: Trajectory | SpatialMotion, pair: SlowPair
) -> tuple[tuple[Array, Array, Array], npt.NDArray[np.bool_]]:
    """Times, gamma and rates of alpha up to the loss, or the end, and which of them are told."""
    inversion = motion.inversion
    if inversion.time is None:
        raise ValueError(
            f"motion must be one that inverts the disk, and it is {inversion.outcome}"
        )
    # A little more than is told, for the means about the last samples.
    measured = 2.0 * pair.settling
    beyond = motion.times[-1] if inversion.lost is None else inversion.lost + measured
    end = beyond - measured
    if inversion.lost is None and end < inversion.time + measured:
        raise ValueError(
            f"motion must go on for {2.0 * measured:.3g} s after the inversion at t = "
            f"{inversion.time:.3g} s, or until that is lost"
        )
    if isinstance(motion, SpatialMotion):
        if inversion.lost is not None:
            # It may lie flat that soon afterwards, where Euler angles end.
            lying = motion.times[(motion.leaning < _FLAT) & (motion.times > inversion.lost)]
            beyond = float(np.nextafter(np.min(lying, initial=beyond), 0.0))
        motion = motion.to_trajectory(beyond)
    near = motion.times <= beyond
    times = motion.times[near]
    moving = times, motion.coordinate("gamma")[near], motion.rate("alpha")[near]
    return moving, (times >= inversion.time) & (times <= end)


def follow(
    scenario: Scenario, end: float, source: Source, *, progress: Progress | None = None
) -> Passage:
    """Run a scenario up to a time in s, on an ideal or a compliant contact, and measure it.

    `progress` is told how far the run is, as both sides tell it.

    Raises
    ------
    ValueError
        If the scenario has no slow pair, or the samples are too many or less than two, which is
        told before the run; and see `measure`.
    ArithmeticError
        If the run fails.
    """
    pair = SlowPair.of(scenario)
    engine, longer = source == "engine", spin_scale(Scenario()) / spin_scale(scenario)
    spacing = longer * SPACING
    within("end", positive("end", end), spacing, LONGEST_MOTION)
    how: dict[str, Any] = {"source": source, "progress": progress}
    if scenario.contact is None:
        times = even_times(scenario, end, round(end / spacing) + 1, "end")
        if engine:
            how["integrator"] = usual_method(scenario, times, local_tolerance=LOCAL)
        return measure(run(scenario, times, local_tolerance=LOCAL, **how), pair)
    how |= {"step": longer * STEP} if engine else {"local_tolerance": LOCAL}
    return measure(run_to_rest(scenario, end, spacing=spacing, **how), pair)


def _predicted(
    times: Array, rates: Array, amplitude: Array, lost_from: int | None, settling: float
) -> tuple[Array, float | None]:
    """Deviation by the linear growth, and when it comes to pi/2 after it has been smaller.

    A disk that is lost spins up as it falls, of which the prediction is to know nothing: from its
    lowest spin on, at this sample, the growth goes on at the rate there, beyond the loss as well.
    """
    if lost_from is not None:
        rates = np.append(rates[:lost_from], np.full(times.size - lost_from, rates[lost_from]))
    grown = cumulative_trapezoid(rates, times, initial=0.0)
    since = times - times[0]
    early = (since >= settling) & (since <= 2.0 * settling)
    # Of a disk that is exactly upright, nothing grows.
    with np.errstate(divide="ignore"):
        size = grown + np.mean(np.log(amplitude[early]) - grown[early])
    reached = np.flatnonzero((size > np.log(LOST)) & (since > 2.0 * settling))
    if reached.size:
        return np.exp(size), float(times[reached[0]])
    if lost_from is None or rates[-1] <= 0.0 or not np.isfinite(size[-1]):
        return np.exp(size), None
    return np.exp(size), float(times[-1] + (np.log(LOST) - size[-1]) / rates[-1])


# --- The law of the delay -----------------------------------------------------------------------


def slowed(lever: float) -> Passage:
    """Passage of a disk that starts inverted at the Hopf point and is slowed by pivoting friction.

    Parameters
    ----------
    lever : float
        Of the pivoting friction in m.
    """
    spin = SlowPair.of(Scenario.rest()).spin
    start = Start(beta=np.pi / 2, gamma=np.pi / 2 + SMALL, spin=spin)
    scenario = Scenario.rest(dissipation=Dissipation(pivoting=lever), start=start)
    # What the slowest takes, and less for the others: the slower the spin falls, the later.
    return follow(scenario, 20.0 * float(np.sqrt(1e-5 / lever)), "in-house")


class DelayLaw(NamedTuple):
    """How far below the Hopf point a disk is lost over the rate at which its spin falls.

    Parameters
    ----------
    exponent, error : float
        Power of the rate, fitted, and its standard error; the law says 1/2.
    growth : float
        Logarithm of the growth from the crossing to the loss by the law, from the fit of the
        square of the delay.
    """

    exponent: float
    error: float
    growth: float


def delay_law(rates: npt.ArrayLike, delays: npt.ArrayLike) -> DelayLaw:
    """Fit the delays of disks of the paper that start alike.

    Parameters
    ----------
    rates, delays : array_like, shape (n,)
        Rates of decay in rad/s² and Hopf point less lowest spin in rad/s.

    Raises
    ------
    ValueError
        If there are less than three, or one is none.
    """
    x, y = np.log(np.array(rates, float)), np.log(np.array(delays, float))
    if x.size < 3 or not np.all(np.isfinite([x, y])):
        raise ValueError("rates must be 3 or more, of disks that fall through the Hopf point")
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    pair = SlowPair.of(Scenario.rest())
    below, above = pair.rates_at(pair.spin + np.array((-0.5, 0.5)))[0]
    growths = np.exp(2.0 * y - x) * (below - above) / 2.0
    return DelayLaw(float(slope), float(np.sqrt(covariance[0, 0])), float(np.mean(growths)))


# --- Shown --------------------------------------------------------------------------------------


def passage_table(named: Sequence[tuple[str, Passage]]) -> Table:
    """When and at which spin the inversion is lost."""
    heads = {
        "source": "source",
        "Hopf point in rad/s": "hopf",
        "crossed at s": "crossing",
        "lost at s": "lost",
        "predicted at s": "predicted",
        "lowest spin in rad/s": "lowest_spin",
        "rate of decay in rad/s²": "rate",
    }
    return Table(
        title="Passage through the critical speed",
        columns=("motion", *heads),
        rows=[(name, *(each[head] for head in heads.values())) for name, each in named],
        note="Predicted is from the deviation in the second half of a slow period after the "
        "inversion and the eigenvalues at the mean spin, and of a disk that is lost from its "
        "lowest spin on by those there: that it then spins up again is the fall itself.",
    )
