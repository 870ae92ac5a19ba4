"""Whether a statement of the paper holds, in part or not."""

from typing import Any, Literal

Answer = Literal["yes", "partly", "no"]

Judged = dict[str, Any]
"""What was measured for a statement, by names that the text uses, and its `verdict`."""


def grade(*, yes: bool, partly: bool = False) -> Answer:
    """Return "yes", else "partly", else "no"."""
    return "yes" if yes else "partly" if partly else "no"


def within(value: float, yes: float, partly: float = -1.0) -> Judged:
    """Judge a size by the limits for both words; not a number meets none."""
    verdict = grade(yes=bool(value <= yes), partly=bool(value <= partly))
    return {"value": value, "yes": yes, "partly": partly, "verdict": verdict}
