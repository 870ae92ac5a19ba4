"""What docs/results.md says of the shipped study.

python -m validation.studies.work_precision.results
"""

import sys
from textwrap import wrap

from validation.studies.work_precision.lesson import summary
from validation.studies.work_precision.problems import PROBLEMS
from validation.studies.work_precision.runs import GOALS, fastest, shortfall, words
from validation.studies.work_precision.stored import Study, shipped

BEGIN = "<!-- fastest ways: printed by python -m validation.studies.work_precision.results -->"
END = "<!-- end of fastest ways -->"


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


if __name__ == "__main__":
    study = shipped()
    sys.stdout.write("nothing is shipped\n" if study is None else f"{results_block(study)}\n")
