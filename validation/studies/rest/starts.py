"""Does every start come to rest? Random ones, and Table 3 with spins below the critical one."""

from math import acos, pi

import numpy as np
import pandas as pd

from analysis import Start
from validation.comparison.limits import largest
from validation.studies.rest.runs import COLUMNS, ENGINE_END, SHOWN, Case, course
from validation.study import Content, Row, Study, at_most, equal

SLOW_SPINS = (10.0, 20.0, 28.0)
"""Spins in rad/s below the critical one of 30.9 rad/s, with the centre of gravity low."""

FASTEST = 50.0
"""Largest rate of a random start in rad/s."""

NUMBER = 30
"""Of random starts."""

KEPT = ("flat", "rest", "face", "force", "unexplained")
"""Columns of the course of a run."""

UNEXPLAINED = 1e-7
"""Largest unexplained energy in J."""


def random_start(seed: int) -> Start:
    """Any attitude, and rates of up to `FASTEST`."""
    rng = np.random.default_rng(seed)
    return Start(
        beta=acos(rng.uniform(-1.0, 1.0)),
        gamma=rng.uniform(-pi, pi),
        spin=rng.uniform(-FASTEST, FASTEST),
        beta_rate=rng.uniform(-5.0, 5.0),
        gamma_rate=rng.uniform(-FASTEST, FASTEST),
    )


def cases() -> dict[str, Case]:
    """Slow starts of Table 3 and random ones, by name."""
    starts = {f"Table 3 at {spin:g} rad/s": Start(spin=spin) for spin in SLOW_SPINS}
    starts |= {f"random, seed {seed}": random_start(seed) for seed in range(NUMBER)}
    return {name: Case(SHOWN, end=ENGINE_END, start=start) for name, start in starts.items()}


def measure(case: Case) -> list[Row]:
    """What becomes of a start."""
    row = course(case.run())
    begin = {"beta": case.start.beta, "spin": case.start.spin}
    return [begin | {name: row[name] for name in KEPT}]


STUDY = Study(
    name="rest-starts",
    cases=cases,
    measure=measure,
    sample=("random, seed 1", "random, seed 7"),
    confirm={"flat": 0.02, "rest": 0.02, "face": None, "force": 1e-2, "unexplained": UNEXPLAINED},
    columns={
        "beta": "inclination at the start in rad",
        "spin": "rate of α at the start in rad/s",
        **{name: COLUMNS[name] for name in KEPT},
    },
)


def present(table: pd.DataFrame) -> Content:
    """How many starts come to rest, and when."""
    resting, name = int(table["rest"].notna().sum()), "rest, other starts"
    lost = largest(table["unexplained"])
    return Content(
        numbers={"starts_resting": resting},
        tables={"starts": table},
        checks=[
            equal(f"{name}: at rest", resting, len(cases()), "stored"),
            at_most(f"{name}: contact pulls by N", largest(-table["force"]), 0.0, "stored"),
            at_most(f"{name}: unexplained energy in J", lost, UNEXPLAINED, "stored"),
        ],
    )
