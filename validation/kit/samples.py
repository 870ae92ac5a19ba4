"""How shipped results are confirmed on the spot, as a table."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from validation.kit import shipped
from validation.kit.limits import holds
from validation.kit.parts import Job
from validation.kit.tables import Table

COMMAND = "python -m validation.studies.ship"
"""What makes the shipped results anew."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A shipped result, and what confirms it.

    Parameters
    ----------
    what : str
        The result.
    how : str
        What has been computed on the spot; empty for a result that is only shipped.
    quantity : str
        What is compared.
    difference, limit : float, optional
        Largest difference, and what it may be at most.
    """

    what: str
    how: str = ""
    quantity: str = ""
    difference: float | None = None
    limit: float | None = None

    @property
    def agrees(self) -> bool | None:
        """Whether it is confirmed; None for a result without a limit, as one only shipped."""
        return None if self.limit is None else holds(self.difference, self.limit)


def fresh_key(key: Any) -> Any:
    """Key of the job that computes the result of a shipped one again."""
    return ("fresh", key)


def fresh(job: Job) -> Job:
    """The job that computes the result of a shipped one again."""
    return replace(job, key=fresh_key(job.key))


def table(section: str, jobs: Sequence[Job], samples: Sequence[Sample]) -> Table:
    """What is shipped for a section, and what of it is confirmed on the spot.

    Parameters
    ----------
    section : str
        Name of the section.
    jobs : sequence of Job
        Those whose results are shipped.
    samples : sequence of Sample
    """
    return Table.of(
        samples,
        {
            "shipped result": lambda each: each.what,
            "confirmed here by": lambda each: each.how or "no, only shipped",
            "compared": lambda each: each.quantity or None,
            "largest difference": lambda each: each.difference,
            "at most": lambda each: each.limit,
            "agrees": lambda each: each.agrees,
        },
        name=f"{section}-confirmed",
        title="What comes with the package, and what is confirmed on the spot",
        note=_origin(section, jobs),
        folded=False,
    )


def _origin(section: str, jobs: Sequence[Job]) -> str:
    found = shipped.of(section)
    here = [job for job in jobs if not shipped.holds(section, job)]
    if found is None or len(here) == len(jobs):
        return "Nothing is shipped: all of it was computed for this page."
    others = f"{len(here)} others were computed for this page. " if here else ""
    return (
        f"{len(jobs) - len(here)} results are shipped, which took {found.seconds:.0f} s of "
        f"processor time, from {found.provenance.text()}. {others}{age(section, jobs)}"
    )


def age(section: str, jobs: Sequence[Job]) -> str:
    """In what the code has changed since the results of a section were shipped, if any are."""
    found = shipped.of(section)
    if found is None:
        return ""
    changed = found.changed(jobs)
    since = {
        None: "cannot be compared on another version of Python",
        True: "has not changed since",
        False: f"has changed since in {_some(changed or [])}",
    }[None if changed is None else not changed]
    return f"The code that they come from {since}. Made anew by: {COMMAND} DIR {section}."


def _some(names: list[str]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more modules" if names[3:] else "")
