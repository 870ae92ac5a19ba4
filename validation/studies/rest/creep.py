"""The creep that sliding friction alone leaves, and its law.

A disk without loss would roll as Euler's disk does: its centre of gravity at rest, the contact
point running round it with the precession rate, Omega² = m g r / (A sin(beta)). With its centre
of gravity off its centre by e, it cannot do that without slip. Friction so weak that the centre of
gravity stays at rest leaves a slip of amplitude e Omega sin²(beta). Far below epsilon the law is
viscous and takes 1/2 (mu m g / epsilon) times its square, in proportion to beta³ at small beta.
With an energy of 3/2 m g r sin(beta),

    1 / beta² = 1 / beta_0² + k t,  where k = 2 mu m g e² / (3 epsilon A) for weak friction.

Friction that drags the centre of gravity along makes k smaller, but keeps the law.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sin, sqrt
from typing import Any

import numpy as np

from analysis import MODELS, Disk, Scenario, SmoothCoulomb, SpatialMotion, Start
from analysis.data.checks import Array
from validation.kit import figures
from validation.kit.figures import Picture
from validation.kit.limits import holds
from validation.kit.report import Job
from validation.kit.tables import Cell, Table
from validation.run import run_to_rest

START = 0.28
"""Inclination in rad at which the runs of the law start, about where the fall ends."""

TIMES = (30.0, 45.0, 60.0)
"""In s: what is left of the start has died away, end of the fit, end of its check."""

SMOOTHINGS = (0.1, 0.3, 3.0)
"""Of the friction in m/s."""

MEAN_TIME = 2.5
"""Time in s over which the energy is averaged."""

DEVIATION = 2e-4
"""Largest relative deviation of a run from the law fitted to the stretch before."""

FAR = 0.05
"""Inclination in rad to which the law is extrapolated."""

WINDOWS = ((24.0, 30.0), (45.0, 55.0), (70.0, 80.0))
"""Times in s of the run from Table 3 over which its loss is averaged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """What a creeping disk loses over a time.

    Parameters
    ----------
    begin, end : float
        In s.
    leaning, slip : float
        Mean leaning in rad and slip speed in m/s.
    energy, loss, viscous : float
        Mean energy in J, its mean loss in W, and that by a viscous friction law in W.
    """

    begin: float
    end: float
    leaning: float
    slip: float
    energy: float
    loss: float
    viscous: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Creep:
    """A creeping disk and the law fitted to it.

    Parameters
    ----------
    scenario : Scenario
    times, tilts : ndarray, shape (n,)
        Times in s, and inclinations in rad of Euler's disk of the same mean energy. The disk
        itself nods about them as it turns.
    offset, rate : float
        Of the fitted 1 / beta² = offset + rate * t.
    error : float
        Largest relative deviation of the inclination from the law behind the time of the fit.
    """

    scenario: Scenario
    times: Array
    tilts: Array
    offset: float
    rate: float
    error: float

    def time_between(self, first: float, last: float) -> float:
        """Time in s that the law takes from one inclination to another."""
        return (last**-2 - first**-2) / self.rate


def run_creep(smoothing: float) -> Creep:
    """Let the disk creep on friction of this smoothing, and fit the law."""
    return fit(creep(smoothing, TIMES[-1]))


def creep(smoothing: float, end: float) -> SpatialMotion:
    """Run the disk as Euler's would roll, on friction of this smoothing, up to a time in s."""
    scenario = Scenario.rest(friction=SmoothCoulomb(smoothing=smoothing, load="contact"))
    precession = sqrt(
        scenario.weight * scenario.disk.radius / (_across(scenario.disk) * sin(START))
    )
    # The rates keep the centre of gravity over its place, as the constraint of Model 2 would.
    start = Start(beta=START, gamma=0.0, spin=precession)
    held = start.state(MODELS[2], scenario.disk)
    start = replace(
        start,
        x=held.coordinates[0],
        y=held.coordinates[1],
        x_rate=held.rates[0],
        y_rate=held.rates[1],
    )
    return run_to_rest(
        replace(scenario, start=start),
        end,
        source="in-house",
        spacing=1e-2,
        local_tolerance=1e-9,
    )


def means(motion: SpatialMotion) -> tuple[Array, Array]:
    """`times` and `tilts` of a `Creep` from its motion."""
    block = round(MEAN_TIME / (motion.times[1] - motion.times[0]))
    count = motion.times.size // block * block
    times = motion.times[:count].reshape(-1, block).mean(axis=1)
    energy = motion.energies.sum(axis=1)[:count].reshape(-1, block).mean(axis=1)
    scenario = motion.scenario
    return times, np.arcsin(energy / (1.5 * scenario.weight * scenario.disk.radius))


def fit(motion: SpatialMotion) -> Creep:
    """Fit the law to the second part of a motion and check it with the third."""
    times, tilts = means(motion)
    settled, end, _ = TIMES
    fitted = (times >= settled) & (times < end)
    rate, offset = np.polyfit(times[fitted], tilts[fitted] ** -2, 1)
    checked = times >= end
    law = (offset + rate * times[checked]) ** -0.5
    return Creep(
        scenario=motion.scenario,
        times=times,
        tilts=tilts,
        offset=float(offset),
        rate=float(rate),
        error=float(np.max(np.abs(tilts[checked] / law - 1.0))),
    )


def weak_friction_rate(scenario: Scenario) -> float:
    """Rate k of the law in 1/s for friction so weak that the centre of gravity stays at rest."""
    viscosity = scenario.friction.gradient * scenario.weight
    disk = scenario.disk
    return 2.0 / 3.0 * viscosity * disk.eccentricity**2 / _across(disk)


def _across(disk: Disk) -> float:
    """Mean moment of inertia across the axis about the centre of gravity in kg m²."""
    return sum(disk.inertia_about_cog[:2]) / 2.0


def jobs() -> list[Job]:
    """Runs behind the law."""
    return [Job(("rest creep", smoothing), run_creep, (smoothing,)) for smoothing in SMOOTHINGS]


def law_table(results: Mapping[Any, Any]) -> Table:
    """The law for each smoothing, and how long it takes."""
    rows: list[tuple[Cell, ...]] = []
    largest = 0.0
    for smoothing in SMOOTHINGS:
        found: Creep = results["rest creep", smoothing]
        share = found.rate / weak_friction_rate(found.scenario)
        rows.append(
            (
                1.0 / found.scenario.friction.gradient,
                found.rate,
                share,
                # Friction drags the centre of gravity along, the less the weaker it is.
                largest < share < 1.0,
                found.error,
                holds(found.error, DEVIATION),
                found.time_between(START, 0.5 * START) / 60.0,
                found.time_between(START, FAR) / 3600.0,
            )
        )
        largest = share
    return Table(
        name="rest-creep-law",
        title="The creep goes on: 1 / β² grows in proportion to time",
        columns=(
            "ε/μ in m/s",
            "growth in 1/s, fitted",
            "part of that for weak friction",
            "more than for stronger, below 1",
            "largest relative deviation in β",
            f"at most {DEVIATION:g}",
            f"from {START:g} to {0.5 * START:g} rad in min",
            f"to {FAR:g} rad in h",
        ),
        rows=rows,
        note=f"In-house runs, fitted from {TIMES[0]:g} to {TIMES[1]:g} s, deviation from "
        f"{TIMES[1]:g} to {TIMES[2]:g} s. Weak friction: 2 μ m g e² / (3 ε A), with the centre of "
        "gravity at rest; friction that drags it along slips less. The last two columns "
        "extrapolate the law. A centred disk would not creep at all.",
    )


def draw(results: Mapping[Any, Any]) -> Picture:
    """1 / beta² over time, with the fitted lines."""
    figure, axes = figures.new_figure()
    for index, smoothing in enumerate(SMOOTHINGS):
        found: Creep = results["rest creep", smoothing]
        look: dict[str, Any] = {"color": figures.COLOURS[index]}
        name = f"ε/μ = {1.0 / found.scenario.friction.gradient:.3g} m/s"
        axes.plot(
            found.times, found.tilts**-2, marker=figures.MARKERS[index], linestyle="",
            label=name, **look,
        )  # fmt: skip
        axes.plot(found.times, found.offset + found.rate * found.times, linestyle=":", **look)
    axes.axvspan(*TIMES[:2], color="#dddddd", zorder=0)
    axes.set(xlabel="time in s", ylabel="1/β² in 1/rad²")
    axes.legend()
    return figures.render(
        figure,
        name="rest-creep",
        title="With sliding friction alone the disk sinks ever more slowly",
        caption="Dotted: fitted over the grey range. Before it, what is left of the start dies "
        "away.",
    )


def losses(motion: SpatialMotion) -> tuple[Loss, ...]:
    """Losses over those of `WINDOWS` that a motion has passed."""
    return tuple(
        _loss(motion, begin, end) for begin, end in WINDOWS if motion.times[-1] > end - 1e-9
    )


def _loss(motion: SpatialMotion, begin: float, end: float) -> Loss:
    energy, times = motion.energies.sum(axis=1), motion.times
    first, last = np.searchsorted(times, (begin, end))
    part = slice(first, last + 1)
    slip, force = motion.slip_speeds[part], motion.normal_force[part]
    viscous = motion.scenario.friction.gradient * force * slip**2
    return Loss(
        begin=begin,
        end=end,
        leaning=float(np.mean(motion.leaning[part])),
        slip=float(np.mean(slip)),
        energy=float(np.mean(energy[part])),
        loss=float((energy[first] - energy[last]) / (times[last] - times[first])),
        viscous=float(np.mean(viscous)),
    )


def loss_table(found: Sequence[Loss]) -> Table:
    """How slowly the disk loses energy by sliding alone."""
    return Table.of(
        found,
        {
            "time in s": lambda each: f"{each.begin:g} to {each.end:g}",
            "mean lean in rad": lambda each: each.leaning,
            "mean slip speed in m/s": lambda each: each.slip,
            "energy in J": lambda each: each.energy,
            "loss in W": lambda each: each.loss,
            "loss by μ λ_N s² / ε in W": lambda each: each.viscous,
            "energy over loss in s": lambda each: each.energy / each.loss,
        },
        name="rest-creep",
        title="With sliding friction alone the disk creeps",
        note="In-house run from Table 3, which goes on creeping. The slip is far below ε, so that "
        "the friction law is viscous with μ/ε and its loss grows with the square of the slip.",
    )
