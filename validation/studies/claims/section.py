"""The report's section on the paper's statements: its jobs and what becomes of them."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from analysis import LEVELS, LOADS, Level, Scenario, SmoothCoulomb, Trajectory
from validation.kit import samples
from validation.kit.report import Job, Section
from validation.kit.samples import Sample
from validation.run import run
from validation.studies.claims import (
    attraction,
    claim,
    contact_matrix,
    drift,
    motion,
    orders,
    pure_rolling,
    start_spins,
)
from validation.studies.claims.claim import Claim


def contact_run() -> Trajectory:
    """In-house run of Model 1 from Table 3 with the contact force as the load."""
    times = np.linspace(0.0, motion.LONG, round(100 * motion.LONG) + 1)
    scenario = Scenario(friction=SmoothCoulomb(load="contact"))
    return run(scenario, times, source="in-house", local_tolerance=1e-6)


REPEATED: Level = 4
"""Model whose least spin is found again on the spot."""


def shipped() -> list[Job]:
    """Searches whose results come with the package."""
    searches = [
        Job(("least spin", level), start_spins.find_least_spin, (level,)) for level in LEVELS
    ]
    return [*searches, *attraction.jobs()]


def jobs() -> list[Job]:
    """Runs behind the claims, beside those of Figures 7 to 9; the long ones first."""
    return [
        *(samples.fresh(job) for job in shipped() if job.key == ("least spin", REPEATED)),
        *(Job(("slip", mu), pure_rolling.slip, (mu,)) for mu in pure_rolling.COEFFICIENTS),
        *(Job(("long run", level), motion.long_run, (level,)) for level in LEVELS),
        *(Job(("pure rolling", spin), pure_rolling.roll, (spin,)) for spin in pure_rolling.SPINS),
        *(
            Job(("repeated", start), attraction.confirm, (start,))
            for start in attraction.repeated()
        ),
        Job("contact run", contact_run),
    ]


def claims(results: Mapping[Any, Any]) -> list[Claim]:
    """All claims, from the results of these jobs and of those of `studies.inversion`."""
    loads = {load: results["run", 1, load, 2.0] for load in LOADS}
    levels = [results["run", level, "weight", 4.0][0] for level in LEVELS]
    longs = [results["long run", level] for level in LEVELS]
    oscillation, *compared = motion.constraints(levels, longs)
    return [
        attraction.claim(attraction.collect(results)),
        contact_matrix.claim(results["contact run"], contact_matrix.bound()),
        *motion.figure_7(loads),
        *drift.claims(longs[0]),
        oscillation,
        pure_rolling.claim([results["pure rolling", spin] for spin in pure_rolling.SPINS]),
        *compared,
        *motion.spinning(levels, longs),
        orders.claim(orders.slopes()),
        start_spins.claim([results["least spin", level] for level in LEVELS]),
    ]


def _samples(results: Mapping[Any, Any]) -> list[Sample]:
    key = ("least spin", REPEATED)
    one, other = (results[each] for each in (key, samples.fresh_key(key)))
    same = (one.outcomes, one.engine, one.scan) == (other.outcomes, other.engine, other.scan)
    return [
        Sample(
            what=f"least spin of Model {REPEATED} from which Table 3 inverts, and outcomes",
            how="found again on both sides",
            quantity="spin in rad/s; the outcomes have to be the same",
            difference=abs(one.above - other.above) if same else np.inf,
            limit=1e-9,
        ),
        Sample(what="those of the other models"),
        Sample(
            what="random starts",
            how=f"{len(attraction.repeated())} of them repeated, see below",
        ),
    ]


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report."""
    random = attraction.collect(results)
    found = claims(results)
    counted = {name: sum(each.verdict == name for each in found) for name in claim.VERDICTS}
    told = ", ".join(f"{number} {name}" for name, number in counted.items() if number)
    starts = attraction.repeated()
    return Section(
        name="claims",
        title="What the paper says",
        paragraphs=[
            (
                "Every statement of the paper about the motion, with the criterion it is judged "
                "by and the number measured. The least spins and the random starts come with the "
                "package, confirmed by a sample; all else is run for this page. A statement holds "
                f"(yes), holds in part (partly) or does not hold (no): {told}."
            ),
        ],
        pictures=[
            pure_rolling.draw(results),
            attraction.draw(random),
        ],
        tables=[
            claim.table(found),
            samples.table("claims", shipped(), _samples(results)),
            start_spins.table([results["least spin", level] for level in LEVELS]),
            pure_rolling.table(results),
            orders.table(orders.slopes()),
            attraction.table(random),
            attraction.confirmation(
                {start: results["repeated", start] for start in starts}, random
            ),
        ],
    )
