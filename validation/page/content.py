"""What a study has to show: numbers, tables, figures and checks; and what is read first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Literal, NamedTuple

import pandas as pd
from matplotlib.figure import Figure

from validation.animation.player import Animation
from validation.study import Check

Rows = Mapping[str, pd.DataFrame]
"""Tables of studies by their names."""

Judged = dict[str, Any]
"""What was measured for a statement, by names that the text uses, and its `verdict`."""


class Verdict(NamedTuple):
    """A result that is read first, as the text of its section has it.

    Parameters
    ----------
    statement : str
    answer : str
        A word or two: "yes", "partly", "no", "not shown".
    numbers : str
        What was found, with units.
    criterion : str
        What decides on the answer.
    hoped : str
        The answer that is hoped for.
    """

    statement: str
    answer: str
    numbers: str
    criterion: str
    hoped: str = "yes"

    @property
    def good(self) -> bool:
        """Whether the answer is the one that is hoped for."""
        return self.answer == self.hoped


def grade(*, yes: bool, partly: bool = False) -> Literal["yes", "partly", "no"]:
    """Whether a statement holds, in part or not."""
    return "yes" if yes else "partly" if partly else "no"


def within(value: float, yes: float, partly: float = -1.0) -> Judged:
    """Judge a size by the limits for both words; not a number meets none."""
    verdict = grade(yes=bool(value <= yes), partly=bool(value <= partly))
    return {"value": value, "yes": yes, "partly": partly, "verdict": verdict}


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """What a study has to show.

    Parameters
    ----------
    numbers : mapping
        Names that its text uses.
    tables : mapping
        With headings as a reader wants them, units included. Each is shown by the text or given
        as a file.
    figures : mapping
    animations : mapping
    checks : sequence of Check
        Beside those that confirm what is stored.
    """

    numbers: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    figures: Mapping[str, Figure] = field(default_factory=dict)
    animations: Mapping[str, Animation] = field(default_factory=dict)
    checks: Sequence[Check] = ()

    def __or__(self, other: "Content") -> "Content":
        """What two parts of a section have to show together."""
        together: dict[str, Any] = {}
        for each in fields(self):
            one, two = getattr(self, each.name), getattr(other, each.name)
            together[each.name] = {**one, **two} if isinstance(one, Mapping) else [*one, *two]
        return Content(**together)
