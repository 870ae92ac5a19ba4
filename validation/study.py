"""Studies: cases that are measured, kept as one tidy table, and measured again by sample.

A study names its cases, how to measure one, and what there is to show of all; everything else is
the same for all. `load` and `write` are for the tables that come with the package, and `confirm`
compares a sample of one, measured on the spot, with what is stored.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import inf, isfinite, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import pandas as pd

from analysis.motion.files import write_whole
from validation.comparison.limits import holds
from validation.measurement.sources import behind

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Row = dict[str, Any]
"""Numbers, text, truth values and lists of numbers by column; a missing number is None or NaN."""

Found = dict[tuple[str, str], list[Row] | Exception]
"""Rows of each task, or what it crashed with, by name of the study and label."""

Limit = float | Callable[[Row], float]
"""Allowed difference, or what tells it from the stored row."""

RESULTS = Path(__file__).parent / "results"
"""Tables that come with the package."""

DIGITS = 10
"""Significant digits that are kept of a number."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """Cases, how to measure one, and what of it has to come out again.

    Parameters
    ----------
    name : str
        Of its files.
    cases : callable
        Returns the cases by label; each is the argument of one call of `measure`.
    measure : callable
        From a case to its rows, at least one, which it may yield, in an order of their own:
        measured again, a row is compared with that in its place. What fails by itself has None for
        what it lacks; anything raised is a crash. Importable by its name, for worker processes.
    sample : sequence of str
        Labels of the cases that are measured again. With some, the table comes with the package;
        without, all cases are measured for each report.
    confirm : mapping
        From columns to their allowed difference; None if they have to be equal, as those that tell
        the rows of a case apart.
    timed : bool
        Whether it measures run times, and so last, beside its like.
    limit : float, optional
        Time in s, by the clock on the wall, after which a case is ended, which is a crash.
    columns : mapping
        What columns mean, with their units.
    rests_on : str
        Digest of what its rows rest on besides code, versions and machine.
    """

    name: str
    cases: Callable[[], Mapping[str, Any]]
    measure: Callable[[Any], Iterable[Row]]
    sample: Sequence[str] = ()
    confirm: Mapping[str, Limit | None] = field(default_factory=dict)
    timed: bool = False
    limit: float | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    rests_on: str = ""

    @property
    def is_stored(self) -> bool:
        """Whether its table comes with the package."""
        return bool(self.sample)

    def tasks(self, *, whole: bool) -> list["Task"]:
        """All measurements, or those for a report: of a stored study its sample."""
        cases = self.cases()
        labels = cases if whole or not self.is_stored else self.sample
        return [Task(self, label, cases[label]) for label in labels]


class Task(NamedTuple):
    """The measurement of a case."""

    study: Study
    label: str
    case: Any

    @property
    def key(self) -> tuple[str, str]:
        """What its rows are found by."""
        return self.study.name, self.label


Where = Literal["fresh", "stored"]
"""Measured on the spot, or taken from a stored table."""


class Check(NamedTuple):
    """Something that has to hold, and where it comes from."""

    name: str
    value: object
    limit: object
    where: Where
    holds: bool


def at_most(name: str, value: float | None, limit: float, where: Where = "fresh") -> Check:
    """Check that a finite number does not exceed a finite limit."""
    return Check(name, value, limit, where, holds(value, limit))


def equal(name: str, value: object, wanted: object, where: Where = "fresh") -> Check:
    """Check that something is what it has to be; not a number is equal to nothing."""
    return Check(name, value, wanted, where, bool(value == wanted))


# --- What is shown ------------------------------------------------------------------------------

Rows = Mapping[str, pd.DataFrame]
"""Tables of studies by their names."""


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


def within(value: float, yes: float, partly: float = -1.0) -> Row:
    """A size, its limits for both words, and its `verdict`; not a number meets none."""
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
    figures, animations : mapping
        Calls that draw each, made where the text shows it: checks need no picture.
    checks : sequence of Check
        Beside those that confirm what is stored.
    """

    numbers: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    figures: Mapping[str, Callable[[], "Figure"]] = field(default_factory=dict)
    animations: Mapping[str, Callable[[], Any]] = field(default_factory=dict)
    checks: Sequence[Check] = ()

    def __or__(self, other: "Content") -> "Content":
        """What two parts of a section have to show together."""
        together: dict[str, Any] = {}
        for each in fields(self):
            one, two = getattr(self, each.name), getattr(other, each.name)
            together[each.name] = {**one, **two} if isinstance(one, Mapping) else [*one, *two]
        return Content(**together)


# --- Tables ------------------------------------------------------------------------------------


def rows_of(measure: Callable[[Any], Iterable[Row]], case: Any) -> list[Row]:
    """Rows of a case with numbers and lists in place of NumPy's, cut to `DIGITS`.

    Raises
    ------
    TypeError
        If they hold anything else.
    ValueError
        If nothing was measured.
    """
    text = json.dumps([*measure(case)], default=_of_numpy)
    rows: list[Row] = json.loads(
        text, parse_float=lambda number: float(f"{float(number):.{DIGITS}g}")
    )
    if not rows:
        raise ValueError("nothing was measured")
    return rows


def _of_numpy(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"rows must hold numbers, text and lists of numbers, got {value!r}")


def whole_table(study: Study, found: Found) -> pd.DataFrame:
    """Table of all measurements of a study; `ArithmeticError` if a case crashed."""
    crashed, table = [], []
    for task in study.tasks(whole=True):
        if isinstance(rows := found[task.key], Exception):
            crashed.append(f"{task.label}: {rows}")
        else:
            table += [{"case": task.label, **row} for row in rows]
    if crashed:
        part = f"{len(crashed)} of {len(study.cases())} cases crashed"
        raise ArithmeticError(f"{study.name}: {part}: " + "; ".join(crashed))
    return pd.DataFrame(table)


def write(study: Study, table: pd.DataFrame, provenance: Mapping[str, Any], folder: Path) -> None:
    """Keep a table and what made it, as NAME.csv and NAME.json, whole or not at all."""
    kinds = {name: _kind(table[name]) for name in table}
    about = {
        "provenance": provenance,
        "code": behind(study.measure.__module__),
        "columns": dict(study.columns),
        "kinds": kinds,
    }
    shown = table.assign(
        **{name: table[name].map(json.dumps) for name, kind in kinds.items() if kind == "list"}
    )
    write_whole(folder / f"{study.name}.csv", shown.to_csv(index=False, lineterminator="\n"))
    write_whole(
        folder / f"{study.name}.json", f"{json.dumps(about, indent=1, ensure_ascii=False)}\n"
    )


def _kind(values: pd.Series) -> str:
    """What a column of a file holds: "list", "text", or what NumPy calls it."""
    if values.map(lambda each: isinstance(each, list)).any():
        return "list"
    return "text" if values.map(lambda each: isinstance(each, str)).any() else str(values.dtype)


def load(study: Study, folder: Path = RESULTS) -> pd.DataFrame:
    """Table of a stored study.

    Raises
    ------
    OSError
        If there is none.
    ValueError
        If its files do not hold one.
    """
    kinds = about(study, folder)["kinds"]
    texts, lists = ([name for name in kinds if kinds[name] == each] for each in ("text", "list"))
    return pd.read_csv(
        folder / f"{study.name}.csv",
        dtype=dict.fromkeys(texts, "str"),
        converters=dict.fromkeys(lists, json.loads),
        keep_default_na=False,
        na_values={name: ["", "nan"] for name in kinds.keys() - {*texts, *lists}},
    )


def about(study: Study, folder: Path = RESULTS) -> Row:
    """Provenance, columns and identity of a stored table."""
    return json.loads((folder / f"{study.name}.json").read_text("utf-8"))


# --- Confirming --------------------------------------------------------------------------------


def confirm(study: Study, found: Found, stored: pd.DataFrame) -> list[Check]:
    """Compare the sample of a study, as measured on the spot, with what is stored of all cases.

    Parameters
    ----------
    study : Study
    found : dict
        What `measured` returns for its sample.
    stored : DataFrame
    """
    other = len(study.cases().keys() ^ set(stored["case"]))
    checks = [at_most(f"{study.name}: cases missing or too many", other, 0, "stored")]
    for task in study.tasks(whole=False):
        name, rows = f"{study.name}: {task.label}", found.get(task.key)
        if not isinstance(rows, list):
            checks.append(Check(f"{name}: runs", str(rows), "no crash", "fresh", False))
        else:
            known = stored[stored["case"] == task.label].to_dict("records")
            checks += _compared(study, name, rows, known)
    return checks


def _compared(
    study: Study, name: str, fresh: Sequence[Row], stored: Sequence[Row]
) -> Iterator[Check]:
    """Checks of the rows of one case; a number that is none holds nothing."""
    yield equal(f"{name}: rows", len(fresh), len(stored))
    both = list(zip(fresh, stored, strict=False))
    for column, limit in study.confirm.items():
        found = [_apart(row.get(column), known.get(column), known, limit) for row, known in both]
        worst = max(found, key=lambda each: each[0] - each[1], default=(0.0, 0.0))
        yield at_most(f"{name}: {column}", *worst)


def _apart(one: Any, other: Any, stored: Row, limit: Limit | None) -> tuple[float, float]:
    """Difference of a value from the stored one and what it may be.

    What does not apply is None on the spot and missing in the table. Not a number is infinitely
    far from anything.
    """
    is_missing = other is None or (isinstance(other, float) and isnan(other))
    if one is None or is_missing or limit is None:
        same = is_missing if one is None else one == other
        return (0.0 if same else inf), 0.0
    allowed = float(limit(stored)) if callable(limit) else float(limit)
    here, there = np.asarray(one, float), np.asarray(other, float)
    if here.shape != there.shape:
        return inf, allowed
    apart = float(np.max(np.abs(here - there), initial=0.0))
    return (apart, allowed) if isfinite(apart) and isfinite(allowed) else (inf, 0.0)


def relative(column: str, part: float, least: float = 0.0) -> Callable[[Row], float]:
    """Allowed difference as part of the stored value, and what is allowed in any case."""
    return lambda stored: part * float(np.max(np.abs(stored[column]))) + least
