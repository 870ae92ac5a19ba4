"""A statement of the paper beside what was measured."""

import itertools
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, get_args

Answer = Literal["yes", "partly", "no"]
ANSWERS: tuple[Answer, ...] = get_args(Answer)


class Claim(NamedTuple):
    """A statement, how it is judged, what was measured and whether it holds.

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
    """

    place: str
    statement: str
    criterion: str
    measured: str
    verdict: Answer


def grade(*, yes: bool, partly: bool = False) -> Answer:
    """Return "yes", else "partly", else "no"."""
    return "yes" if yes else "partly" if partly else "no"


def falls(values: Sequence[float]) -> bool:
    """Whether each value is smaller than the one before."""
    return all(after < before for before, after in itertools.pairwise(values))


def listed(values: Iterable[float], form: str = ".2f") -> str:
    """Numbers separated by commas."""
    return ", ".join(f"{value:{form}}" for value in values)
