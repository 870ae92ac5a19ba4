"""The cases of a full study as data: in a file, and as they are shipped with the package."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from analysis import Level
from analysis.data.files import whole_file
from validation.kit.provenance import Provenance
from validation.studies.robustness.cases import Way
from validation.studies.robustness.run import Outcome

FULL_STUDY = "full_study.json"
"""Name of the file with a full study, in the folder of its results and in the package."""

SHIPPED = Path(__file__).parent / FULL_STUDY
"""Results of the last full study."""

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


def write_study(study: Study, path: Path) -> None:
    """Write a study in a compact form, numbers to `DIGITS` digits.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    stored = {
        "provenance": study.provenance.to_dict(),
        "columns": _COLUMNS,
        "outcomes": [_pack(outcome) for outcome in study.outcomes],
    }
    text = json.dumps(stored, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    # A line for each case keeps the differences of two versions readable.
    text = text.replace("],[", "],\n[") + "\n"
    with whole_file(path) as stream:
        stream.write(text.encode())


def read_study(path: Path) -> Study:
    """Study from a file of `write_study`.

    Raises
    ------
    ValueError
        If the file is none.
    OSError
        If it cannot be read.
    """
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        return Study(
            provenance=Provenance(**stored["provenance"]),
            outcomes=tuple(_unpack(stored["columns"], row) for row in stored["outcomes"]),
        )
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is not a study of robustness: {error}") from error


@cache
def shipped() -> Study | None:
    """The study in the package, None if there is none."""
    return read_study(SHIPPED) if SHIPPED.is_file() else None


def beside(outcomes: Sequence[Outcome], study: Study) -> list[tuple[Outcome, Outcome | None]]:
    """Each of some cases beside the same case of a study, None if it is not in there."""
    known = {key(outcome): outcome for outcome in study.outcomes}
    return [(outcome, known.get(key(outcome))) for outcome in outcomes]


def _pack(outcome: Outcome) -> list[Any]:
    values = asdict(outcome)
    values["way"] = list(values["way"].values())
    return [_rounded(values[name]) for name in _COLUMNS]


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        # JSON knows no infinity; what is that far off is as good as that.
        return min(float(f"{value:.{DIGITS}g}"), 1e300)
    return value


def _unpack(columns: Sequence[str], row: Sequence[Any]) -> Outcome:
    values = dict(zip(columns, row, strict=True))
    names = [field.name for field in fields(Way)]
    values["way"] = Way(**dict(zip(names, values["way"], strict=True)))
    return Outcome(**values)
