"""Put the cases of a full study into the package, and print what docs/results.md says of them.

    python -m validation.studies.robustness.ship DIR

DIR is the folder of a finished `tippedisk robustness --out DIR`.
"""

from collections import Counter
from collections.abc import Sequence

from validation.studies.robustness.axes import problems
from validation.studies.robustness.cases import ways
from validation.studies.robustness.causes import GOOD, cause
from validation.studies.robustness.stored import FILE, Study, key


def check_complete(study: Study) -> None:
    """Refuse a study that is not the whole one.

    Raises
    ------
    ValueError
        If a case is missing, or there is one that the study does not have.
    """
    wanted = {
        (problem.axis, problem.label, problem.scenario.model, way.name)
        for problem in problems(quick=False)
        for way in ways(problem, quick=False)
    }
    other = wanted ^ {key(outcome) for outcome in study.outcomes}
    if other:
        raise ValueError(
            "the study must hold the cases that `tippedisk robustness` computes now, and differs "
            f"in {len(other)}, such as {min(other)}"
        )


def summary(study: Study) -> str:
    """Counts of the verdicts and of the causes in a few lines."""
    outcomes = study.outcomes
    verdicts = Counter(outcome.verdict for outcome in outcomes)
    causes = Counter(cause(each) for each in outcomes if each.verdict not in GOOD)
    broken = sum(each.broken for each in outcomes)
    return "\n".join(
        [
            f"{len(outcomes)} cases, {broken} crashed or broke a promise",
            *(f"{number:5d} {verdict}" for verdict, number in verdicts.most_common()),
            "what is not accurate, by cause:",
            *(f"{number:5d} {name}" for name, number in causes.most_common()),
            study.provenance.text(),
        ]
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Ship the study of a folder; its exit code."""
    return FILE.ship(arguments, check=check_complete, text=summary)


if __name__ == "__main__":
    raise SystemExit(main())
