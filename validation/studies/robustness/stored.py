"""The cases of a full study as they are shipped with the package."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from analysis import Level
from validation.kit import shipped as kit
from validation.kit.provenance import Provenance
from validation.studies.robustness.axes import problems
from validation.studies.robustness.cases import HardProblem
from validation.studies.robustness.run import Outcome

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


def in_order(outcomes: Iterable[Outcome], wanted: Iterable[HardProblem]) -> list[Outcome]:
    """Outcomes in the order of their problems; those of other problems at the end."""
    order = {
        (each.scenario.model, each.axis, each.label): place for place, each in enumerate(wanted)
    }
    last = len(order)
    return sorted(outcomes, key=lambda each: order.get((each.level, each.axis, each.label), last))


@cache
def shipped() -> Study | None:
    """The full study that comes with the package, None if there is none."""
    found = kit.of("robustness")
    if found is None:
        return None
    flat = (outcome for batch in found.results() for outcome in batch)
    outcomes = in_order(flat, problems(quick=False))
    return Study(provenance=found.provenance, outcomes=tuple(outcomes))
