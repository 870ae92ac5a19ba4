"""The report: every study's jobs, run side by side, and the sections they fill.

A study offers `jobs`, the calls behind it, and `section`, which makes a section of the report from
their results by key; those with a long form are asked for their quick one. Jobs that take too long
are `shipped`: their results come with the package, and others confirm a sample of them. Those that
take longer still are `long`: a report shows what is shipped of them and never runs them itself.
"""

import os
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from validation.kit import shipped
from validation.kit.clock import Clock, model_1_seconds
from validation.kit.parts import Job, Store, identity, open_store
from validation.kit.progress import duration, say
from validation.kit.report import PAGE, Section, contents, foreign, run_parts, write
from validation.studies import crosscheck, inversion, modelled, paper_numbers, summary
from validation.studies.claims import section as claims
from validation.studies.nonlinear import confirm as nonlinear
from validation.studies.rest import section as rest
from validation.studies.robustness import section as robustness
from validation.studies.stability import section as stability
from validation.studies.work_precision import jobs as work_precision_jobs
from validation.studies.work_precision import section as work_precision


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """What a study offers to the report.

    Parameters
    ----------
    name : str
        That of its section.
    jobs : callable
        Returns the jobs.
    section : callable
        From the results of all jobs by key to the section.
    shipped : callable
        Returns the jobs whose results come with the package; see `validation.kit.shipped`.
    long : callable
        Returns the jobs that only `validation.studies.ship` runs, where the study is named.
    workers : int, optional
        Processes that these run in, by default one for each core.
    work : float
        Processor time that the jobs take, in in-house runs of Model 1. It is what the announced
        time is reckoned from, and nothing else.
    timed : bool
        Whether the jobs measure run times, and have to run beside their like.
    """

    name: str
    jobs: Callable[[], Sequence[Job]]
    section: Callable[[dict[Any, Any]], Section]
    shipped: Callable[[], Sequence[Job]] = list
    long: Callable[[], Sequence[Job]] = list
    workers: int | None = None
    work: float = 0.0
    timed: bool = False

    def expected_seconds(self, *, quick: bool) -> float:
        """Processor time in s of its quick jobs, or of those shipped; 0 if that is not known."""
        if quick:
            return self.work * model_1_seconds()
        shipment = shipped.of(self.name)
        return 0.0 if shipment is None else shipment.seconds

    def all_jobs(self) -> list[Job]:
        """All jobs, the shipped ones replaced by the reading of their results."""
        return [*self.jobs(), *shipped.taken(self.name, self.shipped())]


def _claims_jobs() -> list[Job]:
    # The statements are also judged by the runs of the paper's figures.
    return [*inversion.jobs(), *claims.jobs()]


STUDIES = (
    Study(name="modelled", jobs=list, section=modelled.section),
    Study(name="inversion", jobs=inversion.jobs, section=inversion.section, work=35.0),
    Study(
        name="claims",
        jobs=_claims_jobs,
        section=claims.section,
        shipped=claims.shipped,
        work=60.0,
    ),
    Study(
        name="crosscheck",
        jobs=crosscheck.jobs,
        section=crosscheck.section,
        shipped=crosscheck.shipped,
        work=70.0,
    ),
    Study(
        name="stability",
        jobs=stability.jobs,
        section=stability.section,
        shipped=stability.shipped,
        work=25.0,
    ),
    Study(
        name="nonlinear",
        jobs=nonlinear.jobs,
        section=nonlinear.section,
        shipped=nonlinear.shipped,
        work=80.0,
    ),
    Study(name="rest", jobs=rest.jobs, section=rest.section, shipped=rest.shipped, work=75.0),
    Study(
        name="work-precision",
        jobs=partial(work_precision_jobs.jobs, quick=True),
        section=partial(work_precision.section, quick=True),
        long=partial(work_precision_jobs.jobs, quick=False),
        workers=work_precision_jobs.WORKERS,
        work=95.0,
        timed=True,
    ),
    Study(
        name="robustness",
        jobs=partial(robustness.jobs, quick=True),
        section=partial(robustness.section, quick=True),
        long=partial(robustness.case_jobs, quick=False),
        work=85.0,
        timed=True,
    ),
    Study(name="numbers", jobs=list, section=paper_numbers.section),
)
"""In the order of their sections, behind the box that sums them up."""


def make(folder: Path, *, only: Collection[str] = ()) -> tuple[Path, list[Section]]:
    """Run everything and write the report; what an earlier call has left finished is kept.

    Parameters
    ----------
    folder : Path
        Where the page, figures and tables go; the finished parts lie in its `parts.FOLDER`.
    only : collection of str
        Names of the sections to make, by default all of them, which the box then sums up.

    Returns
    -------
    page : Path
    sections : list of Section
        All that it shows, the box in front.

    Raises
    ------
    OSError
        If the folder cannot be written, or another process works in it.
    """
    studies = [study for study in STUDIES if not only or study.name in only]
    with open_store(folder) as store:
        return _make(studies, store, folder, whole=not only)


def _make(
    studies: Sequence[Study], store: Store, folder: Path, *, whole: bool
) -> tuple[Path, list[Section]]:
    clock = Clock()
    kept, drawings = _compute(studies, store, folder)
    sections, kept_drawing = _draw(drawings, store)
    if whole:
        jobs = [job for study in STUDIES for job in study.all_jobs()]
        store.forget_all_but([*jobs, *drawings])
    box = summary.section(sections) if whole else partial_box(studies)
    made = clock.sentence(kept + kept_drawing)
    page = write([box, *sections], folder, made=made, whole=whole)
    if others := foreign(folder):
        named = ", ".join(others[:3]) + (", …" if len(others) > 3 else "")
        say(f"report: {len(others)} files in {folder} are not of this report: {named}")
    return page, [box, *sections]


def partial_box(studies: Sequence[Study]) -> Section:
    """What stands in front of some sections alone."""
    return Section(
        name="summary",
        title="A part of the report",
        paragraphs=[
            (
                f"{len(studies)} of {len(STUDIES)} sections: "
                f"{', '.join(study.name for study in studies)}. `tippedisk report` makes all and "
                "sums them up in front; it takes what these have computed as it is."
            )
        ],
    )


def _compute(studies: Sequence[Study], store: Store, folder: Path) -> tuple[float, list[Job]]:
    """See to it that the parts of all jobs lie in the store.

    Returns
    -------
    seconds : float
        Processor time in s of those that did before.
    drawings : list of Job
        For each study the call that makes its section, told apart by the parts it is made of and
        by what is shipped for it.
    """
    ordered = sorted(studies, key=lambda study: not study.timed)
    found = {study.name: study.all_jobs() for study in studies}
    owner = {job.key: study for study in reversed(ordered) for job in found[study.name]}
    jobs = {job.key: job for study in ordered for job in found[study.name]}
    kept = {key: part.seconds for key, job in jobs.items() if (part := store.find(job))}
    left = [job for key, job in jobs.items() if key not in kept]
    pace = _Pace(left, owner)
    _announce(folder, store, len(kept), len(jobs), pace)
    run_parts(left, title="report", store=store, tell=pace.tell)
    return sum(kept.values()), [
        Job(
            ("section", study.name, shipped.digest(study.name)),
            study.section,
            (_identities(found[study.name]),),
        )
        for study in studies
    ]


def _identities(jobs: Iterable[Job]) -> tuple[tuple[Any, str], ...]:
    return tuple((job.key, identity(job)) for job in jobs)


def _draw(drawings: Sequence[Job], store: Store) -> tuple[list[Section], float]:
    """Sections from the store, those that are not there made in worker processes and kept.

    The second result is the processor time in s of those that were there.
    """
    kept = {job.key: part for job in drawings if (part := store.find(job)) is not None}
    left = {job.key: job for job in drawings if job.key not in kept}
    if left:
        say(f"report: drawing {', '.join(name for _, name, _ in left)}")
    calls = [
        Job(key, make_section, (store.folder, job.function, *job.arguments))
        for key, job in left.items()
    ]
    made = run_parts(calls, title="draw")
    for key, part in made.items():
        store.keep(left[key], part)
    sections = [{**kept, **made}[job.key].result for job in drawings]
    return sections, sum(part.seconds for part in kept.values())


def make_section(
    folder: Path,
    function: Callable[[dict[Any, Any]], Section],
    parts: Iterable[tuple[Any, str]],
) -> Section:
    """Section from parts in a store.

    Parameters
    ----------
    folder : Path
        That of the store.
    function : callable
        From results by key to the section.
    parts : iterable of (key, identity)

    Raises
    ------
    KeyError
        If a part is not there.
    """
    store = Store(folder)
    return function({key: store.read(name).result for key, name in parts})


def _announce(folder: Path, store: Store, kept: int, number: int, pace: "_Pace") -> None:
    if (folder / PAGE).exists() and PAGE not in contents(folder):
        say(f"report: {folder} holds a report of an older version, whose page is replaced")
    elif kept and not (folder / PAGE).exists():
        say(f"report: going on with the unfinished report in {folder}")
    if store.unreadable:
        say(f"report: {store.unreadable} kept parts cannot be read and are made anew")
    say(f"report: {number} parts, {kept} of them kept from before; {pace.forecast()}")


_DRAWING = 17.0
"""Processor time that drawing a section takes, in the mean, in in-house runs of Model 1."""


class _Pace:
    """How far the jobs are, and how long they will take.

    Parameters
    ----------
    jobs : sequence of Job
        Those to be run.
    owner : mapping
        Study of each key.
    """

    def __init__(self, jobs: Sequence[Job], owner: Mapping[Any, Study]) -> None:
        self._begin = time.perf_counter()
        self._owner = owner
        all_of = Counter(study.name for study in owner.values())
        self._work = {job.key: owner[job.key].work / all_of[owner[job.key].name] for job in jobs}
        self._left = Counter(owner[job.key].name for job in jobs)
        self._total = sum(self._work.values()) + _DRAWING * len(self._left)
        self._done = 0.0

    def forecast(self) -> str:
        """What is ahead, before anything is run."""
        if not self._work:
            return "nothing is to be computed"
        cores = os.cpu_count() or 1
        seconds = self._total * model_1_seconds() / cores
        return f"the others take some {duration(seconds)} on {cores} idle cores"

    def tell(self, job: Job) -> None:
        """Note a finished job; say so where it is the last one of a section."""
        name = self._owner[job.key].name
        self._done += self._work[job.key]
        self._left[name] -= 1
        if not self._left[name]:
            passed = time.perf_counter() - self._begin
            ahead = passed * (self._total / self._done - 1.0) if self._done else 0.0
            say(f"report: {name} computed after {duration(passed)}, some {duration(ahead)} to go")
