"""Runs on the spot against the same runs of the shipped study."""

from dataclasses import dataclass
from statistics import median

from validation.kit.limits import holds
from validation.kit.plain import rounded
from validation.kit.tables import Table
from validation.studies.work_precision.problems import PROBLEMS
from validation.studies.work_precision.runs import Run
from validation.studies.work_precision.stored import Study

WORK = 0.01
"""Relative difference in work up to which two runs count as the same."""

ERROR = 0.05
"""Relative difference of their errors, beside what the reference leaves open."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A run made on the spot, the same one of the shipped study, and what can be measured."""

    here: Run
    there: Run
    floor: float

    @property
    def same_work(self) -> bool:
        """Whether both took the same evaluations, to `WORK`."""
        return holds(abs(self.here.work - self.there.work), WORK * self.there.work)

    @property
    def same_error(self) -> bool:
        """Whether both have the same error, to `ERROR`, or failed both."""
        if self.here.errors is None or self.there.errors is None:
            return self.here.errors is self.there.errors
        apart = abs(self.here.error - self.there.error)
        return holds(apart, ERROR * self.there.error + self.floor)


def pairs(here: Study, there: Study) -> list[Pair]:
    """Runs that both studies hold."""
    known = {_key(run): run for run in there.runs}
    return [
        Pair(run, known[_key(run)], there.agreements[run.problem].floor)
        for run in here.runs
        if _key(run) in known
    ]


def _key(run: Run) -> tuple[str, ...]:
    return run.problem, run.formulation, run.scheme, run.kind, f"{run.setting:.6e}"


def speed(found: list[Pair]) -> float | None:
    """Median ratio of the processor times, here over there; None without finished runs."""
    ratios = [pair.here.seconds / pair.there.seconds for pair in found if pair.here.errors]
    ratios = [ratio for ratio in ratios if ratio == ratio]  # noqa: PLR0124
    return median(ratios) if ratios else None


def sentence(here: Study, there: Study) -> str:
    """What the runs on the spot say about the shipped ones."""
    found = pairs(here, there)
    same = sum(pair.same_work and pair.same_error for pair in found)
    confirmed = "yes" if found and same == len(found) else "partly"
    ratio = speed(found)
    text = (
        f"Confirmed on the spot: {confirmed}. Of {len(found)} runs of the quick selection, {same} "
        f"take the work of the shipped ones (to {100 * WORK:g} %) and have their error (to "
        f"{100 * ERROR:g} %, beside the references' doubt)"
    )
    if ratio is not None:
        text += f"; they take {ratio:.2g} times the processor time here (median)"
    return f"{text}."


def table(here: Study, there: Study) -> Table:
    """The same by method."""
    groups: dict[tuple[str, str], list[Pair]] = {}
    for pair in pairs(here, there):
        groups.setdefault((pair.here.problem, pair.here.method), []).append(pair)
    return Table(
        name="work-precision-confirmed",
        title="The quick run on this machine against the shipped study",
        columns=("problem", "method", "runs", "same work", "same error", "time, median ratio"),
        rows=[
            [
                next(each.title for each in PROBLEMS.values() if each.name == problem),
                method,
                len(group),
                sum(pair.same_work for pair in group),
                sum(pair.same_error for pair in group),
                rounded(speed(group), 3),
            ]
            for (problem, method), group in groups.items()
        ],
        note=f"Same work: to {100 * WORK:g} %. Same error: to {100 * ERROR:g} %, beside what the "
        "references leave open, or failed both.",
    )
