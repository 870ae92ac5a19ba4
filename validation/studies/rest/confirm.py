"""What the report runs on the spot to confirm the shipped ways to rest."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from validation.kit.limits import largest
from validation.kit.report import Job
from validation.kit.samples import Sample
from validation.studies.rest import contact, creep
from validation.studies.rest.runs import SHOWN, STEP, Course, move_in_house, run_engine

COARSER, COARSER_END = 6, 13.0
"""Longer step of the engine on the spot, in those of the shipped run, and time in s that it runs
for: until the disk has lost the inversion, fallen and begun to roll."""

BEGIN = 1.0
"""Time in s that the engine runs with the step of the shipped run."""

CREEP_END = 10.0
"""Time in s that the creep is run for."""

CONTACT = contact.CONTACTS[-1]
"""Stiffness in N/m and half thickness in m of the contact that is measured again."""


def creep_means(smoothing: float, end: float) -> tuple[Any, Any]:
    """Times and tilts of a `Creep` up to a time in s."""
    return creep.means(creep.creep(smoothing, end))


def jobs() -> list[Job]:
    """Runs on the spot."""
    return [
        Job(("rest fresh", "coarser"), run_engine, (SHOWN, COARSER * STEP, COARSER_END)),
        Job(("rest fresh", "in-house"), move_in_house, (SHOWN,)),
        Job(("rest fresh", "begin"), run_engine, (SHOWN, STEP, BEGIN)),
        Job(("rest fresh", "creep"), creep_means, (creep.SMOOTHINGS[0], CREEP_END)),
        Job(("rest fresh", "contact"), contact.measure, CONTACT),
    ]


def samples(results: Mapping[Any, Any]) -> list[Sample]:
    """What is shipped beside what has been run on the spot."""
    engine, inhouse = (results["rest", SHOWN, source] for source in ("engine", "in-house"))
    whole = Course.of(results["rest fresh", "in-house"])
    begin, coarser = (results["rest fresh", name] for name in ("begin", "coarser"))
    tilt = "β in rad"
    found = [
        (f"{SHOWN}, in-house", "the whole run, repeated", inhouse, whole, 1e-5),
        (f"{SHOWN}, engine", "the whole in-house run", engine, whole, 1e-4),
        (
            f"{SHOWN}, engine",
            f"its first {COARSER_END:g} s with {COARSER} times the step",
            engine,
            coarser,
            1e-3,
        ),
        (f"{SHOWN}, engine", f"its first {BEGIN:g} s, repeated", engine, begin, 1e-9),
    ]
    law = results["rest creep", creep.SMOOTHINGS[0]]
    tilts = results["rest fresh", "creep"][1]
    measured = results[("rest contact", *CONTACT)]
    errors, again = (
        np.array([each.law_error for each in runs])
        for runs in (measured, results["rest fresh", "contact"])
    )
    stiffness, thickness = CONTACT
    return [
        *(
            Sample(
                what=what,
                how=how,
                quantity=tilt,
                difference=largest(one.apart(other).tolist()),
                limit=limit,
            )
            for what, how, one, other, limit in found
        ),
        *(
            Sample(what=each, how="", quantity="")
            for each in ("sliding friction only and viscous rolling", "stiffness, rim and start")
        ),
        Sample(
            what=f"creep, ε/μ = {1.0 / law.scenario.friction.gradient:.3g} m/s",
            how=f"its first {CREEP_END:g} s, repeated",
            quantity="mean β in rad",
            difference=largest(np.abs(tilts - law.tilts[: tilts.size]).tolist()),
            limit=1e-6,
        ),
        Sample(what="the other two creeps", how="", quantity=""),
        Sample(
            what=f"contact of {stiffness:g} N/m and {1e3 * thickness:g} mm",
            how="repeated",
            quantity="deviation from the ideal contact, relative",
            difference=largest(np.abs(again / errors - 1.0).tolist()),
            limit=1e-3,
        ),
        Sample(what="the other contacts", how="", quantity=""),
    ]
