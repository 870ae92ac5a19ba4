"""The whole study as data: in memory, in a file, and as it is shipped with the package."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from math import isfinite, nan
from pathlib import Path
from typing import Any, get_args

from validation.kit.full_study import FULL_STUDY, StudyFile, rounded
from validation.kit.provenance import Provenance
from validation.studies.work_precision.prices import Price
from validation.studies.work_precision.problems import PROBLEMS, Agreement, Errors, ProblemName
from validation.studies.work_precision.runs import Curve, Kind, Run

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


def _pack(study: Study) -> dict[str, Any]:
    return {
        "provenance": study.provenance.to_dict(),
        "quick": study.quick,
        "agreements": {name: found.others for name, found in study.agreements.items()},
        "prices": [rounded(price.to_dict(), DIGITS) for price in study.prices],
        "columns": list(_COLUMNS),
        "curves": [_pack_curve(curve) for curve in study.curves],
    }


def _pack_curve(curve: Curve) -> dict[str, Any]:
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
        *rounded(
            [
                run.seconds if isfinite(run.seconds) else None,
                run.median_seconds if isfinite(run.median_seconds) else None,
                run.repeats,
                *errors,
            ],
            DIGITS,
        ),
        *(run.counts.get(name) for name in _COUNTS),
        run.failure,
    ]


def _unpack(stored: dict[str, Any]) -> Study:
    return Study(
        provenance=Provenance(**stored["provenance"]),
        quick=stored["quick"],
        curves=tuple(_unpack_curve(curve, stored["columns"]) for curve in stored["curves"]),
        agreements={
            name: Agreement(problem=name, others=stored["agreements"][name])
            for name in PROBLEMS
            if name in stored["agreements"]
        },
        prices=tuple(Price.from_dict(price) for price in stored["prices"]),
    )


def _unpack_curve(stored: dict[str, Any], columns: list[str]) -> Curve:
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


FILE = StudyFile(
    name="work-precision",
    shipped=Path(__file__).parent / FULL_STUDY,
    pack=_pack,
    unpack=_unpack,
    breaks=('{"problem"', '\n{"problem"'),
)

shipped = cache(FILE.read_shipped)
"""The full study that comes with the package, None if there is none."""
