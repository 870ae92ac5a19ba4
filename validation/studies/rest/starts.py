"""Does every start come to rest? `python -m validation.studies.rest.starts [number]` shows it.

Besides so many random starts, it runs Table 3 with spins below the critical one.
"""

import sys
from dataclasses import dataclass
from math import acos, pi

import numpy as np

from analysis import Dissipation, Scenario, Start
from validation.kit.report import Job, run_jobs
from validation.kit.tables import Table
from validation.run import run_to_rest

DISSIPATION = Dissipation(rolling_dry=1e-3, pivoting=5e-5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of a start.

    Parameters
    ----------
    start : str
        Which one.
    beta, spin : float
        Inclination in rad and rate of alpha in rad/s at the start.
    flat, rest : float, optional
        Times in s; None if it never was.
    face : str
        Which face lies up at last.
    lifted : bool
        Whether the disk left the table on its way.
    lowest_force : float
        In N.
    residual : float
        Largest unexplained energy in J.
    """

    start: str
    beta: float
    spin: float
    flat: float | None
    rest: float | None
    face: str
    lifted: bool
    lowest_force: float
    residual: float


def random_start(seed: int) -> Start:
    """Any attitude, and rates of up to 50 rad/s."""
    rng = np.random.default_rng(seed)
    return Start(
        beta=acos(rng.uniform(-1.0, 1.0)),
        gamma=rng.uniform(-pi, pi),
        spin=rng.uniform(-50.0, 50.0),
        beta_rate=rng.uniform(-5.0, 5.0),
        gamma_rate=rng.uniform(-50.0, 50.0),
    )


SLOW_SPINS = (10.0, 20.0, 28.0)
"""Spins in rad/s below the critical one of 30.9 rad/s, with the centre of gravity low."""


def starts(number: int) -> dict[str, Start]:
    """Slow starts of Table 3 and so many random ones, by name."""
    slow = {f"Table 3 at {spin:g} rad/s": Start(spin=spin) for spin in SLOW_SPINS}
    return slow | {f"random, seed {seed}": random_start(seed) for seed in range(number)}


def run(name: str, start: Start) -> Outcome:
    """Simulate a start for at most two minutes."""
    motion = run_to_rest(
        Scenario.rest(dissipation=DISSIPATION, start=start),
        120.0,
        source="in-house",
        spacing=5e-3,
        local_tolerance=1e-10,
    )
    phases = motion.phases
    lowest = float(np.min(motion.normal_force))
    return Outcome(
        start=name,
        beta=start.beta,
        spin=start.spin,
        flat=phases.flat,
        rest=phases.rest,
        face="first" if motion.tilt[-1] < pi / 2 else "second",
        lifted=bool(np.any(motion.normal_force == 0.0)),
        lowest_force=lowest,
        residual=float(np.max(np.abs(motion.energy_residual))),
    )


def table(outcomes: list[Outcome]) -> Table:
    """One row per start."""
    return Table(
        name="rest-starts",
        title="Other starts on their way to rest",
        columns=(
            "start", "β in rad", "spin in rad/s", "flat at s", "rest at s", "face up",
            "left the table", "lowest force in N", "unexplained energy in J", "at rest",
        ),
        rows=[
            (o.start, o.beta, o.spin, o.flat, o.rest, o.face, "yes" if o.lifted else "no",
             o.lowest_force, o.residual, o.rest is not None)
            for o in outcomes
        ],
    )  # fmt: skip


def main(number: int) -> int:
    """Run the starts on all cores and print what became of them; 1 if one did not rest."""
    chosen = starts(number)
    results = run_jobs([Job(name, run, (name, chosen[name])) for name in chosen], title="starts")
    outcomes = [results[name] for name in chosen]
    sys.stdout.write(table(outcomes).to_text() + "\n")
    return int(any(outcome.rest is None for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 30))
