"""From Table 3 to rest: phases, energy budget and final stage, engine against in-house."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np

from analysis import CAUSES, Phases, SpatialMotion
from analysis.data.trajectory import SOURCES
from validation.kit import samples
from validation.kit.animation import player as animation
from validation.kit.limits import holds, largest
from validation.kit.report import Job, Section
from validation.kit.tables import Cell, Table
from validation.studies.rest import confirm, runs
from validation.studies.rest import contact as rest_contact
from validation.studies.rest import creep as rest_creep
from validation.studies.rest import figures as rest_figures
from validation.studies.rest import final_stage as rest_final
from validation.studies.rest import rolling as rest_rolling
from validation.studies.rest.runs import (
    CASES,
    ENGINE_END,
    SHOWN,
    SLIDING,
    SPACING,
    STEP,
    STEPS,
    Course,
)

VARIANTS = {
    "engine": "in the engine",
    "stiffness doubled": "stiffness doubled",
    "rim half as thick": "rim half as thick",
    "spin 0.001 rad/s faster": "spin 0.001 rad/s faster",
}
"""What is changed against the in-house run, and how it is called in a figure."""

AGREEMENT = 1e-3
"""Largest difference in rad of the tilt between engine and in-house."""

LARGEST_RISE = 1e-9
"""Of the energy from one sample to the next in J."""

LARGEST_SHIFT = {"rim half as thick": 0.2}
"""In s, of the phases by a variant; 0.02 s for those not named."""


def shipped() -> list[Job]:
    """Runs whose results come with the package."""
    return [*runs.jobs(), *rest_contact.jobs(), *rest_creep.jobs()]


def jobs() -> list[Job]:
    """Runs on the spot: those that confirm the shipped ones, and short ones."""
    return [*confirm.jobs(), *rest_rolling.jobs(), *rest_final.jobs()]


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report."""
    shown: SpatialMotion = results["rest fresh", "in-house"]
    engine: Course = results["rest", SHOWN, "engine"]
    base: Course = results["rest", SHOWN, "in-house"]
    variants = {name: results["rest", SHOWN, variant] for variant, name in VARIANTS.items()}
    return Section(
        name="rest",
        title="To rest",
        paragraphs=_paragraphs(results),
        pictures=[
            *rest_figures.draw(shown, engine),
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
                caption=f"In-house run on the spot, with {SHOWN} besides sliding friction.",
            )
        ],
        tables=[
            samples.table("rest", shipped(), confirm.samples(results)),
            phase_table(results),
            variant_table(results),
            budget(results),
            rest_creep.loss_table(results["rest", SLIDING, "in-house"].losses),
            rest_creep.law_table(results),
            rest_contact.table(results),
            rest_rolling.textbook(results),
            rest_final.table(results),
        ],
    )


def _paragraphs(results: Mapping[Any, Any]) -> list[str]:
    base: Course = results["rest", SHOWN, "in-house"]
    change = base.apart(results["rest", SHOWN, "spin 0.001 rad/s faster"])
    before = base.times[: change.size] < (base.phases.inversion_lost or np.inf)
    late: rest_creep.Loss = results["rest", SLIDING, "in-house"].losses[-1]
    law: rest_creep.Creep = results["rest creep", rest_creep.SMOOTHINGS[0]]
    return [
        (
            "The runs below take minutes and come with the package. Run on the spot, whole, is "
            f"the in-house way to rest with {SHOWN}, which the pictures and the animation show, "
            "and half of the engine's with a longer step; the first table says what else is "
            "repeated, and what is only shipped. The textbook's disks and the final stage are run "
            "here."
        ),
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
            f"what it takes falls to {late.loss:.1e} W between {late.begin:g} and {late.end:g} s "
            f"while {late.energy:.3f} J are left. That is no stationary state: 1/β² goes on "
            f"growing by {law.rate:.4f} per second, so that β halves in "
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
        pair: list[Course] = [results["rest", case, source] for source in SOURCES]
        lacking = _lacks(*pair) or _lacks(*reversed(pair))
        difference = np.inf if lacking else largest(pair[0].apart(pair[1]).tolist())
        for course, shown in zip(pair, (None, difference), strict=True):
            agrees = None if shown is None else holds(shown, AGREEMENT)
            times = _times(course.phases)
            rows.append((case, course.source, *times, course.face, shown, agrees))
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
            f"at most {AGREEMENT:g}",
        ),
        rows=rows,
        note=f"Times in s, to {SPACING:g} s. The difference is that of engine and in-house run, "
        f"every {runs.EVERY * SPACING:g} s over at most {ENGINE_END:g} s, infinite if one has a "
        "phase that the other has passed without. The engine's steps: "
        f"{', '.join(f'{step:g} s, {case}' for case, step in STEPS.items())}.",
    )


def _lacks(course: Course, other: Course) -> bool:
    """Whether a course has none of a phase of the other and runs on a second longer than that."""
    pairs = zip(_times(course.phases), _times(other.phases), strict=True)
    end = float(course.times[-1])
    return any(here is None and there is not None and there + 1.0 < end for here, there in pairs)


def variant_table(results: Mapping[Any, Any]) -> Table:
    """How phase times move with stiffness, rim, step and start."""
    rows: list[tuple[Cell, ...]] = []
    base = _times(results["rest", SHOWN, "in-house"].phases)
    for variant in ("in-house", *VARIANTS):
        course: Course = results["rest", SHOWN, variant]
        times = _times(course.phases)
        shift = limit = agrees = None
        if variant != "in-house":
            shift, limit = _shift(times, base), LARGEST_SHIFT.get(variant, 0.02)
            agrees = holds(shift, limit)
        rows.append((variant, *times, course.face, shift, limit, agrees))
    return Table(
        name="rest-variants",
        title=f"What the phases depend on ({SHOWN})",
        columns=("variant", *_PHASE_COLUMNS, "face up", "largest shift", "at most", "holds"),
        rows=rows,
        note=f"Times in s, to {SPACING:g} s. The engine runs with steps of {STEP:g} s, "
        "the others in-house.",
    )


def _shift(times: Sequence[float | None], base: Sequence[float | None]) -> float:
    """Largest shift in s of a phase that either has; infinite if one alone has it."""
    pairs = [pair for pair in zip(times, base, strict=True) if pair != (None, None)]
    return largest(None if a is None or b is None else abs(a - b) for a, b in pairs)


_PHASE_COLUMNS = tuple(field.name.replace("_", " ") for field in fields(Phases))


def _times(phases: Phases) -> Sequence[float | None]:
    return [getattr(phases, field.name) for field in fields(Phases)]


def budget(results: Mapping[Any, Any]) -> Table:
    """Where each joule went, and whether energy and contact force keep to their signs."""
    rows: list[tuple[Cell, ...]] = []
    for case, source in product(CASES, SOURCES):
        course: Course = results["rest", case, source]
        expected = results["rest", case, "in-house"].taken
        signs = holds(course.rise, LARGEST_RISE) and course.force >= 0.0
        alike = bool(np.allclose(course.taken, expected, rtol=0.05, atol=1e-9))
        rows.append(
            (
                case,
                source,
                course.energy,
                *course.taken.tolist(),
                course.left,
                course.unexplained,
                course.rise,
                course.force,
                signs,
                # The in-house run is what the engine's is compared with.
                alike if source == "engine" else None,
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
            "keeps its signs",
            "takes what the in-house run does",
        ),
        rows=rows,
        note=f"Up to rest, or {ENGINE_END:g} s. Left is what a disk at rest has by its height, "
        "and what still moves. Every cause is integrated with the motion, so that the unexplained "
        "part is the integrator's error. Largest rise: between two samples. Signs: no sample has "
        f"more energy than the one before, by {LARGEST_RISE:g} J, and the contact never pulls. "
        "Takes: every cause what it takes in-house, to 5 %.",
    )
