"""Tables of the study of numerical stability."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import get_args

from validation.kit.tables import Cell, Table
from validation.studies.robustness.cases import TOLERANCE
from validation.studies.robustness.causes import GOOD
from validation.studies.robustness.drift import Conserved, Drift
from validation.studies.robustness.run import Outcome, Verdict
from validation.studies.robustness.steps import ACCURACY, StepLimit

VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


def verdicts(outcomes: Sequence[Outcome], refusals: Table) -> Table:
    """Number of cases of each verdict, by what is extreme about them.

    Parameters
    ----------
    outcomes : sequence of Outcome
    refusals : Table
        Of `validation.studies.robustness.refusals`, for the last row.
    """
    shown = [
        verdict
        for verdict in VERDICTS
        if verdict in {"accurate", "ends: contact would pull", "inaccurate", "refused", "crashed"}
        or any(each.verdict == verdict for each in outcomes)
    ]
    rows: list[list[Cell]] = []
    for axis in dict.fromkeys(outcome.axis for outcome in outcomes):
        found = [outcome for outcome in outcomes if outcome.axis == axis]
        repeated = [each.repeatable for each in found if each.repeatable is not None]
        rows.append(
            [
                axis,
                len(found),
                *(sum(each.verdict == verdict for each in found) for verdict in shown),
                _largest([each.error for each in found]),
                _largest([each.drift for each in found]),
                _largest([each.energy for each in found]),
                all(repeated) if repeated else None,
                not any(each.broken for each in found),
            ]
        )
    refused = [row[1] is True for row in refusals.rows]
    counts = [sum(refused) if verdict == "refused" else 0 for verdict in shown]
    rows.append(["cannot work", len(refused), *counts, None, None, None, None, all(refused)])
    return Table(
        name="robustness",
        title=f"Hard cases at a tolerance of {TOLERANCE:g} rad, unless their label says another",
        columns=(
            "what is extreme",
            "cases",
            *shown,
            "largest error in rad",
            "drift / radius",
            "energy error, relative",
            "same bits when repeated",
            "none crashed, promises kept",
        ),
        rows=rows,
        note="Eccentric disks keep the steel disk's mass and its moments about the COG. Disks of "
        "another radius are scaled at the same Froude number. A disk tilted close to 0 or π is "
        "followed until it falls flat, and once beyond. The files robustness-all-cases.csv and "
        "robustness-failures.csv hold each case, and each that is not accurate with its reason.",
    )


def _largest(values: Sequence[float | None]) -> float | None:
    return max((value for value in values if value is not None), default=None)


_CASE: dict[str, Callable[[Outcome], Cell]] = {
    "model": lambda each: each.level,
    "what is extreme": lambda each: each.axis,
    "how": lambda each: each.label,
    "formulation, integrator": lambda each: each.way.name,
    "verdict": lambda each: each.verdict,
}


def all_cases(outcomes: Sequence[Outcome]) -> Table:
    """Everything, for a file."""
    return Table.of(
        outcomes,
        {
            **_CASE,
            "error in rad": lambda each: each.error,
            "asked for in rad": lambda each: each.tolerance,
            "error of the ending in s": lambda each: each.ending_error,
            "promised in rad": lambda each: each.estimate,
            "doubt of the reference in rad": lambda each: each.doubt,
            "drift / radius": lambda each: each.drift,
            "energy error, relative": lambda each: each.energy,
            "same bits when repeated": lambda each: each.repeatable,
            "steps": lambda each: each.steps,
            "seconds": lambda each: each.seconds,
            "reason": lambda each: each.reason,
        },
        name="robustness-all-cases",
        title="All hard cases",
        file_only=True,
    )


def failures(outcomes: Sequence[Outcome]) -> Table:
    """Every case that is not accurate, with its reason."""
    return Table.of(
        [outcome for outcome in outcomes if outcome.verdict not in GOOD],
        {**_CASE, "reason": lambda each: each.reason or _error(each)},
        name="robustness-failures",
        title="Cases that gave no accurate result",
        file_only=True,
    )


def confirmation(pairs: Sequence[tuple[Outcome, Outcome | None]]) -> Table:
    """Verdicts of this run beside those of the full study, by what is extreme.

    Parameters
    ----------
    pairs : sequence of (Outcome, Outcome or None)
        See `validation.studies.robustness.stored.beside`.
    """
    rows: list[list[Cell]] = []
    for axis in dict.fromkeys(here.axis for here, _ in pairs):
        found = [(here, there) for here, there in pairs if here.axis == axis]
        known = [(here, there) for here, there in found if there is not None]
        other = [
            f"{here.label}, {here.way.name}: {here.verdict}, there {there.verdict}"
            for here, there in known
            if here.verdict != there.verdict
        ]
        same = len(known) - len(other)
        kept = not any(here.broken for here, _ in found)
        if not known:
            counts = Counter(here.verdict for here, _ in found).most_common()
            made = ", ".join(f"{number} {verdict}" for verdict, number in counts)
            other = [f"not in the full study; here {made}"]
        rows.append([axis, len(found), len(known), same, "; ".join(other), kept])
    return Table(
        name="robustness-confirmation",
        title="This run beside the full study",
        columns=(
            "what is extreme",
            "cases of this run",
            "of them in the full study",
            "same verdict",
            "others",
            "none crashed here, promises kept",
        ),
        rows=rows,
    )


def _error(outcome: Outcome) -> str:
    promised = "nothing" if outcome.estimate is None else f"{outcome.estimate:.1e} rad"
    text = f"error {outcome.error:.1e} rad, promised {promised}, doubt {outcome.doubt:.1e} rad"
    return f"{text}; relative energy error {outcome.energy:.1e}"


def step_limits(limits: Sequence[StepLimit]) -> Table:
    """Measured and predicted step limits."""
    units = {"smoothing": "m/s", "stiffness": "N/m"}
    return Table.of(
        limits,
        {
            "over": lambda limit: f"{limit.axis} {limit.value:g} {units[limit.axis]}",
            "formulation": lambda limit: limit.formulation,
            "integrator": lambda limit: limit.integrator,
            "limit": lambda limit: limit.kind,
            "step in s": lambda limit: limit.step,
            "predicted in s": lambda limit: limit.predicted,
        },
        name="step-limits",
        title="Largest stable and largest accurate steps",
        note="Stable: a small disturbance of inverted spinning does not grow. Accurate: within "
        f"{ACCURACY:g} rad over 0.4 s from Table 3. No step: none of those tried works, or "
        "the spinning itself is as unstable as the step could make it.",
    )


def conserved(found: Sequence[Conserved]) -> Table:
    """What a frictionless Model 1 conserves."""
    return Table.of(
        found,
        {
            "formulation, integrator": lambda each: each.name,
            "energy / (weight · radius)": lambda each: each.energy,
            "horizontal momentum / (mass · rim speed)": lambda each: each.momentum,
            "vertical angular momentum about the COG, relative": lambda each: each.spin,
            "failure": lambda each: each.failure or None,
        },
        name="conserved",
        title="Model 1 without friction, 2 s from Table 3: largest changes of what is conserved",
        note="Engine at a step of 1 ms, in-house at a local tolerance of 1e-9. The table's force "
        "is vertical, so that it has no moment about the vertical through the COG.",
    )


def drift(found: Sequence[Drift]) -> Table:
    """Largest residuals of the long runs."""
    return Table(
        name="drift",
        title="Constraint drift and energy balance of long runs from Table 3",
        columns=(
            "constraints met on",
            "end in s",
            "largest position residual in m",
            "at the end in m",
            "largest velocity residual in m/s",
            "energy residual / (weight · radius)",
            "failure",
        ),
        rows=[
            [each.runner.label, None, None, None, None, None, each.failure]
            if each.failure
            else [
                each.runner.label,
                float(each.times[-1]),
                float(max(abs(each.position))),
                float(each.position[-1]),
                float(max(abs(each.velocity))),
                float(max(abs(each.energy))),
                None,
            ]
            for each in found
        ],
    )
