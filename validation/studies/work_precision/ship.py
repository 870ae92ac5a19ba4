"""Put the results of a full study into the package, and print what docs/results.md says of them.

    python -m validation.studies.work_precision.ship DIR

DIR is the folder of a finished `tippedisk work-precision --out DIR`.
"""

from collections.abc import Sequence
from textwrap import wrap

from validation.studies.work_precision import study as studies
from validation.studies.work_precision.lesson import summary
from validation.studies.work_precision.problems import PROBLEMS
from validation.studies.work_precision.runs import GOALS, fastest, shortfall, words
from validation.studies.work_precision.stored import FILE, Study

BEGIN = "<!-- fastest ways: printed by python -m validation.studies.work_precision.ship -->"
END = "<!-- end of fastest ways -->"


def check_complete(study: Study) -> None:
    """Refuse a study that is not the whole one.

    Raises
    ------
    ValueError
        If it is the quick selection, or lacks a curve, a reference or a price.
    """
    if study.quick:
        raise ValueError("the study must be a full one, got the quick selection")
    found: set[tuple[str, ...]] = {
        (curve.problem, f"{curve.formulation}, {curve.scheme}") for curve in study.curves
    }
    found |= {("agreement", name) for name in study.agreements}
    found |= {
        ("price", f"{price.what}, {price.formulation}, {price.problem}") for price in study.prices
    }
    wanted = {tuple(job.key[1:]) for job in studies.jobs(quick=False)}
    if found != wanted:
        missing = ", ".join(sorted(" ".join(key) for key in wanted - found)) or "nothing"
        raise ValueError(
            f"the study must hold what `tippedisk work-precision` computes now; missing: {missing}"
        )


def results_block(study: Study) -> str:
    """Table of the engine's fastest ways and the lesson for docs/results.md, with its markers."""
    head = " | ".join(f"to {words(goal)} rad" for goal in GOALS)
    lines = [BEGIN, f"| | {head} |", "| --- " * (1 + len(GOALS)) + "|"]
    for name, problem in PROBLEMS.items():
        cells = [_cell(study, name, goal) for goal in GOALS]
        lines.append(f"| {problem.title} | {' | '.join(cells)} |")
    for text in (summary(study), f"Measured {study.provenance.text()}."):
        lines += ["", *wrap(text, 99, break_on_hyphens=False)]
    lines.append(END)
    return "\n".join(lines)


def _cell(study: Study, name: str, goal: float) -> str:
    curves = [
        curve
        for curve in study.curves
        if curve.problem == name and curve.formulation not in {"index-1", "reduced"}
    ]
    run = fastest([run for curve in curves for run in curve.runs], goal)
    if run is None:
        return shortfall(curves)
    return f"{float(f'{1e3 * run.seconds:.2g}'):g} ms, {run.formulation}, {run.way}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Ship the study of a folder; its exit code."""
    return FILE.ship(arguments, check=check_complete, text=results_block)


if __name__ == "__main__":
    raise SystemExit(main())
