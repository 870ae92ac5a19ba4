"""From Table 3 to rest: phases, energy budget and final stage, engine against in-house."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np

from analysis import (
    CAUSES,
    STEEL_DISK,
    Dissipation,
    PenaltyContact,
    Phases,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
)
from analysis.data.trajectory import SOURCES
from validation.kit.animation import player as animation
from validation.kit.report import Job, Section
from validation.kit.tables import Cell, Table
from validation.run import run, run_to_rest
from validation.studies.rest import contact as rest_contact
from validation.studies.rest import creep as rest_creep
from validation.studies.rest import figures as rest_figures
from validation.studies.rest import final_stage as rest_final
from validation.studies.rest import rolling as rest_rolling

SLIDING = "sliding friction only"
SHOWN = "dry rolling, pivoting"
CASES = {
    SLIDING: Dissipation(),
    SHOWN: Dissipation(rolling_dry=1e-3, pivoting=5e-5),
    "viscous rolling, pivoting": Dissipation(rolling_viscous=1e-3, pivoting=5e-5),
}

VARIANTS = {
    "engine": "in the engine",
    "stiffness doubled": "stiffness doubled",
    "rim half as thick": "rim half as thick",
    "spin 0.001 rad/s faster": "spin 0.001 rad/s faster",
}
"""What is changed against the in-house run, and how it is called in a figure."""

SPACING = 5e-3
STEP = 5e-5
"""Of the engine in s: the damper's small energy is right to two digits then."""

STEPS = dict.fromkeys(CASES, STEP) | {"viscous rolling, pivoting": 1e-4}
"""By case; where the damper takes more, so is a longer step."""

END = 80.0
"""Longest time in s; all but the sliding disk rest before."""

AGREEMENT = 1e-3
"""Largest difference in rad of the tilt between engine and in-house."""

LARGEST_SHIFT = {"rim half as thick": 0.2}
"""In s, of the phases by a variant; 0.02 s for those not named."""

ENGINE_END = 26.5
"""The same for the engine, whose sliding disk has been rolling for some while by then."""


def run_engine(case: str) -> SpatialMotion:
    """Run a case in the engine."""
    scenario = Scenario.rest(dissipation=CASES[case])
    return run_to_rest(scenario, ENGINE_END, step=STEPS[case], spacing=SPACING)


def run_in_house(
    case: str, stiffness: float = 1e6, half_thickness: float = 2e-4, spin: float = 40.0
) -> SpatialMotion:
    """Run a case with the in-house equations."""
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    scenario = Scenario.rest(contact=contact, dissipation=CASES[case], start=Start(spin=spin))
    return run_to_rest(scenario, END, source="in-house", spacing=SPACING, local_tolerance=1e-10)


def run_model_1() -> tuple[float | None, float | None]:
    """Times in s at which Model 1, with its ideal contact, inverts and loses the inversion."""
    times = np.arange(0.0, 19.5, SPACING)
    scenario = Scenario(friction=SmoothCoulomb(load="contact"))
    found = run(scenario, times, source="in-house", local_tolerance=1e-9)
    inversion = found.inversion
    return inversion.time, inversion.lost


def jobs() -> list[Job]:
    """Runs behind the section, the long ones first."""
    return [
        Job(("rest", SLIDING, "Model 1"), run_model_1),
        Job(("rest", SLIDING, "in-house"), run_in_house, (SLIDING,)),
        *(Job(("rest", case, "engine"), run_engine, (case,)) for case in CASES),
        Job(("rest", SHOWN, "stiffness doubled"), run_in_house, (SHOWN, 2e6)),
        Job(("rest", SHOWN, "rim half as thick"), run_in_house, (SHOWN, 1e6, 1e-4)),
        Job(("rest", SHOWN, "spin 0.001 rad/s faster"), run_in_house, (SHOWN, 1e6, 2e-4, 40.001)),
        *(
            Job(("rest", case, "in-house"), run_in_house, (case,))
            for case in CASES
            if case != SLIDING
        ),
        *rest_contact.jobs(),
        *rest_creep.jobs(),
        *rest_rolling.jobs(),
        *rest_final.jobs(),
    ]


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report."""
    shown: SpatialMotion = results["rest", SHOWN, "engine"]
    base: SpatialMotion = results["rest", SHOWN, "in-house"]
    variants = {name: results["rest", SHOWN, variant] for variant, name in VARIANTS.items()}
    return Section(
        name="rest",
        title="To rest",
        paragraphs=_paragraphs(results),
        pictures=[
            *rest_figures.draw(shown),
            rest_figures.draw_dependence(base, variants),
            rest_contact.draw(results),
            rest_creep.draw(results),
            rest_final.draw(results),
        ],
        animations=[
            animation.player(
                shown,
                name="rest-animation",
                title="The whole story",
                caption=f"Engine run with {SHOWN} besides sliding friction.",
            )
        ],
        tables=[
            phase_table(results),
            variant_table(results),
            budget(results),
            rest_creep.loss_table(results["rest", SLIDING, "in-house"]),
            rest_creep.law_table(results),
            rest_contact.table(results),
            rest_rolling.textbook(results),
            rest_final.table(results),
        ],
    )


def _paragraphs(results: Mapping[Any, Any]) -> list[str]:
    base = results["rest", SHOWN, "in-house"]
    faster = results["rest", SHOWN, "spin 0.001 rad/s faster"]
    count = min(base.times.size, faster.times.size)
    change = np.abs(base.tilt[:count] - faster.tilt[:count])
    before = base.times[:count] < (base.phases.inversion_lost or np.inf)
    begin, end = rest_creep.WINDOWS[-1]
    left, loss = rest_creep.creep_of(results["rest", SLIDING, "in-house"], begin, end)
    law: rest_creep.Creep = results["rest creep", rest_creep.SMOOTHINGS[0]]
    return [
        (
            "The disk is a thin spheroid on a stiff, damped, unilateral contact, so that its "
            "lowest point is defined in every attitude. Sliding friction acts on the actual "
            "contact force. Rolling resistance, pivoting friction and air drag are off unless a "
            "case names them."
        ),
        (
            "The paper concludes that on a slow timescale the disk comes to lie flat on the "
            "table. With the friction that it models this takes far longer than minutes: once "
            "the disk rolls, it slips so slowly that the smoothed friction law is viscous, and "
            f"what it takes falls to {loss:.1e} W between {begin:g} and {end:g} s while "
            f"{left:.3f} J are left. That is no stationary state: 1/β² goes on growing by "
            f"{law.rate:.4f} per second, so that β halves in "
            f"{law.time_between(rest_creep.START, rest_creep.START / 2) / 60:.0f} minutes and "
            f"comes to {rest_creep.FAR:g} rad after "
            f"{law.time_between(rest_creep.START, rest_creep.FAR) / 3600:.1f} hours. What "
            "sustains the slip is the eccentricity. Lying flat within seconds needs rolling "
            "resistance, and lying still needs pivoting friction."
        ),
        (
            "What can be predicted: a start that spins 0.001 rad/s faster changes β by at most "
            f"{float(np.max(change[before])):.1e} rad until the inversion is lost and by at most "
            f"{float(np.max(change)):.1e} rad until rest. A change of the start a thousand times "
            "smaller does a thousand times less, so that the motion is sensitive but not chaotic: "
            "phase times and the face up are as certain as start, rim and dissipation are known. "
            "What cannot: the exact place of rest and the phase of the last nutations, in which "
            "all that is uncertain has added up."
        ),
    ]


def phase_table(results: Mapping[Any, Any]) -> Table:
    """When each phase began, by case and source, and how far the two sources agree."""
    rows: list[tuple[Cell, ...]] = []
    for case in CASES:
        pair = [results["rest", case, source] for source in SOURCES]
        count = min(motion.times.size for motion in pair)
        difference = float(np.max(np.abs(pair[0].tilt[:count] - pair[1].tilt[:count])))
        for motion, shown in zip(pair, (None, difference), strict=True):
            times = _times(motion.phases)
            agrees = None if shown is None else shown < AGREEMENT
            rows.append((case, motion.source, *times, _face(motion), shown, agrees))
    ideal = results["rest", SLIDING, "Model 1"]
    blank = [None] * (len(rows[0]) - 4)
    rows.insert(2, (SLIDING, "Model 1, ideal contact", *ideal, *blank))
    return Table(
        name="rest-phases",
        title="Phases on the way to rest",
        columns=(
            "dissipation",
            "source",
            *_PHASE_COLUMNS,
            "face up",
            "largest difference in β in rad",
            f"below {AGREEMENT:g}",
        ),
        rows=rows,
        note=f"Times in s, to {SPACING:g} s. The difference is that of engine and in-house run, "
        f"over at most {ENGINE_END:g} s. The engine's steps: "
        f"{', '.join(f'{step:g} s, {case}' for case, step in STEPS.items())}.",
    )


def variant_table(results: Mapping[Any, Any]) -> Table:
    """How phase times move with stiffness, rim, step and start."""
    rows: list[tuple[Cell, ...]] = []
    base = _times(results["rest", SHOWN, "in-house"].phases)
    for variant in ("in-house", *VARIANTS):
        motion = results["rest", SHOWN, variant]
        times = _times(motion.phases)
        shift = [abs(a - b) for a, b in zip(times, base, strict=True) if None not in (a, b)]  # type: ignore[operator]
        limit = LARGEST_SHIFT.get(variant, 0.02)
        rows.append((variant, *times, _face(motion), max(shift), limit, max(shift) <= limit))
    return Table(
        name="rest-variants",
        title=f"What the phases depend on ({SHOWN})",
        columns=("variant", *_PHASE_COLUMNS, "face up", "largest shift", "at most", "holds"),
        rows=rows,
        note=f"Times in s, to {SPACING:g} s. The engine runs with steps of {STEP:g} s, "
        "the others in-house.",
    )


_PHASE_COLUMNS = tuple(field.name.replace("_", " ") for field in fields(Phases))


def _times(phases: Phases) -> Sequence[float | None]:
    return [getattr(phases, field.name) for field in fields(Phases)]


def _face(motion: SpatialMotion) -> str:
    return "first" if motion.tilt[-1] < np.pi / 2 else "second"


def budget(results: Mapping[Any, Any]) -> Table:
    """Where each joule went, and whether energy and contact force keep to their signs."""
    rows: list[tuple[Cell, ...]] = []
    for case, source in product(CASES, SOURCES):
        motion = results["rest", case, source]
        until = motion.times <= ENGINE_END
        energy = motion.energies.sum(axis=1)[until]
        taken = motion.dissipated[until][-1]
        rise, force = float(max(0.0, np.max(np.diff(energy)))), float(np.min(motion.normal_force))
        base = results["rest", case, "in-house"]
        expected = base.dissipated[base.times <= ENGINE_END][-1]
        alike = bool(np.allclose(taken, expected, rtol=0.05, atol=1e-9))
        rows.append(
            (
                case,
                source,
                float(energy[0]),
                *taken.tolist(),
                float(energy[-1]),
                float(np.max(np.abs(motion.energy_residual[until]))),
                rise,
                force,
                alike and rise < 1e-9 and force >= 0.0,
            )
        )
    names = [rest_figures.CAUSE_NAMES[cause] for cause in CAUSES]
    return Table(
        name="rest-budget",
        title="Where the energy went, in J",
        columns=(
            "dissipation",
            "source",
            "at first",
            *names,
            "left",
            "unexplained",
            "largest rise",
            "least contact force in N",
            "holds",
        ),
        rows=rows,
        note=f"Up to rest, or {ENGINE_END:g} s. Left is what a disk at rest has by its height, "
        "and what still moves. Every cause is integrated with the motion, so that the unexplained "
        "part is the integrator's error. Largest rise: between two samples. It holds if every "
        "cause takes what it takes in-house, to 5 %, no sample has more energy than the one "
        "before, by 1e-9 J, and the contact never pulls.",
    )
