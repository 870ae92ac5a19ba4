"""Why cases give no result, or no accurate one."""

from collections import Counter
from collections.abc import Sequence

from validation.kit.limits import holds
from validation.kit.tables import Cell, Table
from validation.studies.robustness.run import Outcome, Verdict

GOOD: tuple[Verdict, ...] = (
    "accurate",
    "ends: contact would pull",
    "ends: condition met",
    "ends: lies flat",
)
"""Verdicts on what is as it should be."""

_BY_WORDS = (
    ("a contact that pulls", "starts where the contact would pull"),
    ("lies flat", "falls flat, where Euler angles end"),
    ("lies nearly flat", "falls flat, where Euler angles end"),
    (
        "each newton of normal force",
        "contact load: friction calls for more normal force than it gets",
    ),
    ("Newton's iteration did not converge", "Newton's iteration does not converge"),
    ("singular", "singular system matrix"),
    ("minimum step", "step control at its minimum step"),
    ("cannot be reached", "rounding reached before the tolerance"),
    ("cannot be followed", "turns lost between samples"),
)
"""Words of a message, and the cause they stand for; the first that fits counts."""


def cause(outcome: Outcome) -> str:
    """Why a case is not accurate; empty if it is."""
    if outcome.verdict in GOOD:
        return ""
    if outcome.verdict in {"diverged", "refused"}:
        named = (meaning for words, meaning in _BY_WORDS if words in outcome.reason)
        return next(named, outcome.reason)
    if outcome.verdict == "inaccurate" and outcome.error is not None:
        if holds(outcome.worst, outcome.allowed):
            return "angles accurate, energy or constraint not"
        return "wrong angles or ending"
    return {
        "inaccurate": "runs where the reference cannot start",
        "not finished in the limit": "too many steps",
        "reference in doubt": "no reference is good enough",
    }.get(outcome.verdict, outcome.verdict)


def table(outcomes: Sequence[Outcome]) -> Table:
    """Number of cases without an accurate result, by cause, and where they lie."""
    found: dict[tuple[str, str], Counter[str]] = {}
    for outcome in outcomes:
        if name := cause(outcome):
            found.setdefault((outcome.verdict, name), Counter())[outcome.axis] += 1
    rows: list[list[Cell]] = [
        [*key, axes.total(), ", ".join(f"{axis} ({count})" for axis, count in axes.most_common())]
        for key, axes in sorted(found.items(), key=lambda item: -item[1].total())
    ]
    return Table(
        name="robustness-causes",
        title="Cases without an accurate result, by cause",
        columns=("verdict", "cause", "cases", "what is extreme (cases)"),
        rows=rows,
        note="A start that needs a contact that pulls, and a disk that falls flat, are ends of "
        "the model and not of a method.",
    )
