"""The whole study as data: in memory, in a file, and as it is shipped with the package."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from math import isfinite, nan
from pathlib import Path
from typing import Any, get_args

from analysis.data.files import whole_file
from validation.kit.provenance import Provenance
from validation.studies.work_precision.prices import Price
from validation.studies.work_precision.problems import PROBLEMS, Agreement, Errors, ProblemName
from validation.studies.work_precision.runs import Curve, Kind, Run

FULL_STUDY = "full_study.json"
"""Name of the file with a full study, in the folder of its results and in the package."""

SHIPPED = Path(__file__).parent / FULL_STUDY
"""Results of the last full study."""

DIGITS = 4
"""Of stored numbers: more than any of them can claim."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """Everything that was measured.

    Parameters
    ----------
    provenance : Provenance
    quick : bool
        Whether it is the quick selection.
    curves : tuple of Curve
        In the order of problems and methods.
    agreements : mapping
        Of the references of the problems.
    prices : tuple of Price
    """

    provenance: Provenance
    quick: bool
    curves: tuple[Curve, ...]
    agreements: Mapping[ProblemName, Agreement]
    prices: tuple[Price, ...]

    @property
    def runs(self) -> list[Run]:
        """Runs of all curves."""
        return [run for curve in self.curves for run in curve.runs]

    def of(self, problem: ProblemName, *formulations: str) -> list[Curve]:
        """Curves of a problem, of some formulations or all."""
        return [
            curve
            for curve in self.curves
            if curve.problem == problem and (not formulations or curve.formulation in formulations)
        ]


def write_study(study: Study, path: Path) -> None:
    """Write a study in a compact form, numbers to `DIGITS` digits.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    stored = {
        "provenance": study.provenance.to_dict(),
        "quick": study.quick,
        "agreements": {name: found.others for name, found in study.agreements.items()},
        "prices": [_rounded(price.to_dict()) for price in study.prices],
        "columns": list(_COLUMNS),
        "curves": [_pack(curve) for curve in study.curves],
    }
    text = json.dumps(stored, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    # A line for each curve keeps the differences of two versions readable.
    text = text.replace('{"problem"', '\n{"problem"') + "\n"
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
            quick=stored["quick"],
            curves=tuple(_unpack(curve, stored["columns"]) for curve in stored["curves"]),
            agreements={
                name: Agreement(problem=name, others=stored["agreements"][name])
                for name in PROBLEMS
                if name in stored["agreements"]
            },
            prices=tuple(Price.from_dict(price) for price in stored["prices"]),
        )
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} does not hold a work-precision study: {error!r}") from error


@cache
def shipped() -> Study | None:
    """The full study that comes with the package, if there is one."""
    return read_study(SHIPPED) if SHIPPED.exists() else None


_ERRORS = tuple(each.name for each in fields(Errors))
_COUNTS = ("steps", "rejected_steps", "right_hand_sides", "newton_iterations", "jacobians")
_COLUMNS = (
    "kind",
    "setting",
    "seconds",
    "median_seconds",
    "repeats",
    *_ERRORS,
    *_COUNTS,
    "failure",
)


def _pack(curve: Curve) -> dict[str, Any]:
    return {
        "problem": curve.problem,
        "formulation": curve.formulation,
        "scheme": curve.scheme,
        "end": curve.end,
        "runs": [_pack_run(run) for run in curve.runs],
    }


def _pack_run(run: Run) -> list[Any]:
    errors = [None] * len(_ERRORS) if run.errors is None else run.errors.row()
    return [
        get_args(Kind).index(run.kind),
        # Halved steps are exact; rounded ones would not be found again.
        run.setting,
        *_rounded(
            [
                run.seconds if isfinite(run.seconds) else None,
                run.median_seconds if isfinite(run.median_seconds) else None,
                run.repeats,
                *errors,
            ]
        ),
        *(run.counts.get(name) for name in _COUNTS),
        run.failure,
    ]


def _unpack(stored: dict[str, Any], columns: list[str]) -> Curve:
    where = {name: stored[name] for name in ("problem", "formulation", "scheme")}
    runs = tuple(
        _unpack_run(where, dict(zip(columns, row, strict=True))) for row in stored["runs"]
    )
    return Curve(**where, runs=runs, end=stored["end"])


def _unpack_run(where: dict[str, Any], row: dict[str, Any]) -> Run:
    failed = row["error"] is None
    return Run(
        **where,
        kind=get_args(Kind)[row["kind"]],
        setting=row["setting"],
        seconds=nan if failed else row["seconds"],
        median_seconds=nan if failed else row["median_seconds"],
        repeats=row["repeats"],
        counts={name: row[name] for name in _COUNTS if row[name] is not None},
        errors=None if failed else Errors(**{name: row[name] for name in _ERRORS}),
        failure=row["failure"],
    )


def _rounded(value: Any) -> Any:
    """The same with all numbers in it rounded."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(each) for each in value]
    return value
