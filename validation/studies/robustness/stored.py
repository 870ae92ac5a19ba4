"""The cases of a full study as data: in a file, and as they are shipped with the package."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from analysis import Level
from validation.kit.full_study import FULL_STUDY, StudyFile, rounded
from validation.kit.provenance import Provenance
from validation.studies.robustness.cases import Way
from validation.studies.robustness.run import Outcome

DIGITS = 3
"""Of stored numbers."""

_COLUMNS = tuple(field.name for field in fields(Outcome))

Key = tuple[str, str, Level | None, str]


def key(outcome: Outcome) -> Key:
    """What a case is found by: axis, label, model and way."""
    return outcome.axis, outcome.label, outcome.level, outcome.way.name


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """All cases.

    Parameters
    ----------
    provenance : Provenance
    outcomes : tuple of Outcome
        In the order of problems and ways.
    """

    provenance: Provenance
    outcomes: tuple[Outcome, ...]


def beside(outcomes: Sequence[Outcome], study: Study) -> list[tuple[Outcome, Outcome | None]]:
    """Each of some cases beside the same case of a study, None if it is not in there."""
    known = {key(outcome): outcome for outcome in study.outcomes}
    return [(outcome, known.get(key(outcome))) for outcome in outcomes]


def _pack(study: Study) -> dict[str, Any]:
    return {
        "provenance": study.provenance.to_dict(),
        "columns": _COLUMNS,
        "outcomes": [_pack_outcome(outcome) for outcome in study.outcomes],
    }


def _pack_outcome(outcome: Outcome) -> list[Any]:
    values = asdict(outcome)
    values["way"] = list(values["way"].values())
    return [rounded(values[name], DIGITS) for name in _COLUMNS]


def _unpack(stored: dict[str, Any]) -> Study:
    return Study(
        provenance=Provenance(**stored["provenance"]),
        outcomes=tuple(_unpack_outcome(stored["columns"], row) for row in stored["outcomes"]),
    )


def _unpack_outcome(columns: Sequence[str], row: Sequence[Any]) -> Outcome:
    values = dict(zip(columns, row, strict=True))
    names = [field.name for field in fields(Way)]
    values["way"] = Way(**dict(zip(names, values["way"], strict=True)))
    return Outcome(**values)


FILE = StudyFile(
    name="robustness",
    shipped=Path(__file__).parent / FULL_STUDY,
    pack=_pack,
    unpack=_unpack,
    breaks=("],[", "],\n["),
)

shipped = cache(FILE.read_shipped)
"""The full study that comes with the package, None if there is none."""
