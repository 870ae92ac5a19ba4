"""Error against work and run time of every formulation and integrator.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is counted
in evaluations and measured in processor time; what it is worth is its largest deviation from a
reference that two different methods agree on.
"""

from validation.kit.parts import Job
from validation.studies.work_precision.measure import measure, measure_again
from validation.studies.work_precision.methods import label, methods
from validation.studies.work_precision.prices import cases, measure_price
from validation.studies.work_precision.problems import PROBLEMS, agreement

WORKERS = 2
"""Runs at the same time, each in one thread of a process of its own."""

PREFIX = "work-precision"
"""Name of the section, which the keys of all jobs start with."""

ROUNDS = 2
"""Times at which the full study measures every curve: a machine may be slow for minutes."""


def jobs(*, quick: bool) -> list[Job]:
    """Everything that is to be computed, under keys that start with "work-precision".

    Parameters
    ----------
    quick : bool
        A selection that takes some 40 s of processor time.
    """
    chosen = {name: methods(problem, quick) for name, problem in PROBLEMS.items()}
    first = [
        Job((PREFIX, "agreement", name), agreement, (name, quick))
        for name, found in chosen.items()
        if found
    ]
    rounds = [measure, *[measure_again] * (ROUNDS - 1)]
    curves = [
        Job((PREFIX, name, label(method), number), how, (name, method, quick))
        for number, how in enumerate(rounds[:1] if quick else rounds)
        for name, found in chosen.items()
        for method in found
    ]
    compared = [
        Job((PREFIX, "price", case.label), measure_price, (case, quick)) for case in cases(quick)
    ]
    return first + curves + compared
