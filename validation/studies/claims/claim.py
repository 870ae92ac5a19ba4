"""A statement of the paper beside what was measured."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from analysis.data.checks import choice
from validation.kit.tables import Table

Verdict = Literal["yes", "partly", "no"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A statement, how it is judged, what was measured and the verdict.

    Parameters
    ----------
    place : str
        Section or figure of the paper.
    statement : str
    criterion : str
        What has to be measured for "yes", and for "partly" if that can be.
    measured : str
        Numbers with units.
    verdict : {"yes", "partly", "no"}

    Raises
    ------
    ValueError
        If the verdict is unknown.
    """

    place: str
    statement: str
    criterion: str
    measured: str
    verdict: Verdict

    def __post_init__(self) -> None:
        choice("verdict", self.verdict, VERDICTS)


def grade(*, yes: bool, partly: bool = False) -> Verdict:
    """Return "yes", else "partly", else "no"."""
    return "yes" if yes else "partly" if partly else "no"


def falls(values: Sequence[float]) -> bool:
    """Whether each value is smaller than the one before."""
    return all(after < before for before, after in itertools.pairwise(values))


def listed(values: Iterable[float], form: str = ".2f") -> str:
    """Numbers separated by commas."""
    return ", ".join(f"{value:{form}}" for value in values)


def table(claims: Sequence[Claim]) -> Table:
    """All claims with their verdicts."""
    return Table(
        name="claims",
        title="What the paper says, and what the runs show",
        columns=("place", "statement", "criterion", "measured", "verdict"),
        rows=[
            [claim.place, claim.statement, claim.criterion, claim.measured, claim.verdict]
            for claim in claims
        ],
        note="Each verdict is computed from the numbers beside it in every report.",
        folded=False,
    )
