"""The whole study as data: in memory, and as it is shipped with the package."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

from validation.kit import shipped as kit
from validation.kit.provenance import Provenance
from validation.studies.work_precision.jobs import PREFIX
from validation.studies.work_precision.prices import Price
from validation.studies.work_precision.problems import Agreement, ProblemName
from validation.studies.work_precision.runs import Curve, Run, Times


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

    def excess(self, asked: Run) -> float | None:
        """Work of a run to a tolerance over that of the cheapest run that would do.

        That is of the same method, extrapolated or not, and chosen with the reference at hand.
        None if there is none, or the position of the asked one is worse than the tolerance.
        """
        others = [
            run.work
            for curve in self.of(asked.problem, asked.formulation)
            if curve.scheme == asked.scheme
            for run in curve.runs
            if run.kind != "tolerance" and run.error <= asked.setting
        ]
        return asked.work / min(others) if others and asked.error <= asked.setting else None


def gathered(
    results: Iterable[Curve | Times | Agreement | Price], *, provenance: Provenance, quick: bool
) -> Study:
    """Study from the results of its jobs, in their order; rounds of a curve are joined."""
    curves: dict[tuple[str, ...], Curve] = {}
    agreements: dict[ProblemName, Agreement] = {}
    prices: list[Price] = []
    for each in results:
        match each:
            case Curve():
                curves[each.name] = each
            case Times():
                curves[each.curve] = curves[each.curve].joined(each)
            case Agreement():
                agreements[each.problem] = each
            case Price():
                prices.append(each)
    return Study(
        provenance=provenance,
        quick=quick,
        curves=tuple(curves.values()),
        agreements=agreements,
        prices=tuple(prices),
    )


@cache
def shipped() -> Study | None:
    """The full study that comes with the package, None if there is none."""
    found = kit.of(PREFIX)
    if found is None:
        return None
    return gathered(found.results(), provenance=found.provenance, quick=False)
