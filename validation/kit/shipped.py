"""Results of jobs that come with the package: stored by one command, taken by the report.

A file holds the results of a section's long jobs, with machine, versions, date and commit, and a
digest of the code that they come from. A job whose call is in the file is not run again; any
other one is, so that a new job needs nothing but time until it is shipped.
"""

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from validation.kit.parts import Job, Part
from validation.kit.plain import DIGITS, pack, rounded, unpack
from validation.kit.provenance import Provenance
from validation.kit.sources import behind

FOLDER = Path(__file__).parents[1] / "studies" / "shipped"
"""Where the files lie, one for each section."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shipment:
    """The shipped results of a section.

    Parameters
    ----------
    provenance : Provenance
    code : str
        Digests of the code behind the jobs.
    parts : dict
        From `call` of each job to its result as plain data and its processor time in s, None if
        that was not noted.
    """

    provenance: Provenance
    code: str
    parts: dict[str, tuple[Any, float | None]]

    @property
    def seconds(self) -> float:
        """Processor time in s that all results took, as far as it was noted."""
        return sum(seconds or 0.0 for _, seconds in self.parts.values())

    def results(self) -> list[Any]:
        """All results, in the order of the file.

        Raises
        ------
        ValueError, TypeError
            If the class of one has got other fields since.
        """
        return [unpack(result) for result, _ in self.parts.values()]

    def is_of_this_code(self, jobs: Iterable[Job]) -> bool:
        """Whether the code behind the jobs is what it was for the results."""
        return self.code == _code(jobs)

    def write(self, path: Path) -> None:
        """Write it, one result a line.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        head = {"provenance": self.provenance.to_dict(), "code": self.code}
        lines = [json.dumps(head, ensure_ascii=False)]
        lines += [
            json.dumps(
                [name, seconds, result],
                ensure_ascii=False,
                separators=(",", ":"),
                allow_nan=False,
            )
            for name, (result, seconds) in self.parts.items()
        ]
        with whole_file(path) as stream:
            stream.write("".join(f"{line}\n" for line in lines).encode())


def call(job: Job) -> str:
    """Key, function and arguments of a job as text, the same in every process."""
    name = f"{job.function.__module__}.{job.function.__qualname__}"
    # Another machine's mathematical library may differ in the last digit of an argument.
    known = rounded([pack(job.key), name, pack(job.arguments)], DIGITS)
    text = json.dumps(known, ensure_ascii=False)
    return f"{job.key!r} {hashlib.sha256(text.encode()).hexdigest()[:12]}"


def gather(jobs: Sequence[Job], parts: dict[Any, Part], provenance: Provenance) -> Shipment:
    """Shipment of the results of jobs.

    Parameters
    ----------
    jobs : sequence of Job
    parts : dict
        By the key of each job.
    provenance : Provenance
    """
    return Shipment(
        provenance=provenance,
        code=_code(jobs),
        parts={
            call(job): (pack(parts[job.key].result), round(parts[job.key].seconds, 2))
            for job in jobs
        },
    )


def _code(jobs: Iterable[Job]) -> str:
    """Digest of the code behind some jobs."""
    return " ".join(sorted({behind(job.function.__module__) for job in jobs}))


def path_of(section: str) -> Path:
    """File of a section, whether it is there or not."""
    return FOLDER / f"{section}.json"


def read(path: Path) -> Shipment:
    """Shipment from a file of `Shipment.write`.

    Raises
    ------
    ValueError
        If the file is none.
    OSError
        If it cannot be read.
    """
    try:
        head, *rows = (json.loads(line) for line in path.read_text("utf-8").splitlines())
        return Shipment(
            provenance=Provenance(**head["provenance"]),
            code=head["code"],
            parts={name: (result, seconds) for name, seconds, result in rows},
        )
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} does not hold shipped results: {error!r}") from error


@cache
def of(section: str) -> Shipment | None:
    """What is shipped for a section, None if nothing is."""
    path = path_of(section)
    return read(path) if path.is_file() else None


def taken(section: str, jobs: Sequence[Job]) -> list[Job]:
    """The same jobs, those whose results are shipped replaced by the reading of these."""
    told_apart = digest(section)
    return [
        Job(job.key, result_of, (section, call(job), told_apart)) if holds(section, job) else job
        for job in jobs
    ]


def digest(section: str) -> str:
    """Hash of what is shipped for a section; empty if nothing is."""
    path = path_of(section)
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def holds(section: str, job: Job) -> bool:
    """Whether the result of a job is shipped, and is one that the code still knows."""
    shipment = of(section)
    if shipment is None or (name := call(job)) not in shipment.parts:
        return False
    try:
        unpack(shipment.parts[name][0])
    except (ValueError, TypeError):
        # Its class has got other fields since.
        return False
    return True


def result_of(section: str, name: str, _digest: str) -> Any:
    """A shipped result by the `call` of its job; the digest of the file tells versions apart."""
    shipment = of(section)
    if shipment is None:
        raise KeyError(f"nothing is shipped for {section}")
    return unpack(shipment.parts[name][0])
