"""Does every start come to rest? Random ones, and Table 3 with spins below the critical one."""

from math import acos, pi

import numpy as np

from analysis import Dissipation, Scenario, Start
from validation.kit.limits import largest
from validation.page.content import Content, Rows
from validation.run import run_to_rest
from validation.study import Row, Study, at_most, equal

DISSIPATION = Dissipation(rolling_dry=1e-3, pivoting=5e-5)

SLOW_SPINS = (10.0, 20.0, 28.0)
"""Spins in rad/s below the critical one of 30.9 rad/s, with the centre of gravity low."""

NUMBER = 30
"""Of random starts."""

END = 120.0
"""Longest time in s."""

RESIDUAL = 1e-7
"""Largest unexplained energy in J."""


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


def cases() -> dict[str, Start]:
    """Slow starts of Table 3 and random ones, by name."""
    slow = {f"Table 3 at {spin:g} rad/s": Start(spin=spin) for spin in SLOW_SPINS}
    return slow | {f"random, seed {seed}": random_start(seed) for seed in range(NUMBER)}


def measure(start: Start) -> list[Row]:
    """What becomes of a start."""
    scenario = Scenario.rest(dissipation=DISSIPATION, start=start)
    motion = run_to_rest(scenario, END, source="in-house", spacing=5e-3, local_tolerance=1e-10)
    return [
        {
            "beta": start.beta,
            "spin": start.spin,
            "flat": motion.phases.flat,
            "rest": motion.phases.rest,
            "face": "first" if motion.tilt[-1] < pi / 2 else "second",
            "lifted": bool(np.any(motion.normal_force == 0.0)),
            "force": np.min(motion.normal_force),
            "residual": np.max(np.abs(motion.energy_residual)),
        }
    ]


STUDY = Study(
    name="rest-starts",
    cases=cases,
    measure=measure,
    sample=("random, seed 1", "random, seed 7"),
    confirm=dict.fromkeys(("flat", "rest"), 0.02)
    | dict.fromkeys(("face", "lifted"))
    | {"force": 1e-2, "residual": RESIDUAL},
    columns={
        "beta": "inclination at the start in rad",
        "spin": "rate of α at the start in rad/s",
        "flat": "when it began to lie flat in s",
        "rest": "when it began to lie still in s",
        "face": "which lies up at last",
        "lifted": "whether the disk left the table on its way",
        "force": "least contact force in N",
        "residual": "largest unexplained energy in J",
    },
)
STUDIES = (STUDY,)


def present(rows: Rows) -> Content:
    """How many starts come to rest, and when."""
    table = rows[STUDY.name]
    resting, name = int(table["rest"].notna().sum()), "rest, other starts"
    return Content(
        numbers={"started": table, "starts_resting": resting},
        tables={"starts": table},
        checks=[
            equal(f"{name}: missing", len({*table["case"]} ^ {*cases()}), 0, "stored"),
            equal(f"{name}: at rest", resting, len(cases()), "stored"),
            at_most(f"{name}: contact pulls by N", largest(-table["force"]), 0.0, "stored"),
            at_most(f"{name}: unexplained energy in J", largest(table["residual"]), RESIDUAL,
                    "stored"),
        ],
    )  # fmt: skip
