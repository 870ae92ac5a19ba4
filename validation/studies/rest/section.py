"""The way to rest: losses, phases, creep, closed forms and other starts."""

from functools import reduce

from validation.page.content import Content, Rows
from validation.studies.rest import closed_forms, creep, runs, starts, ways  # noqa: F401

TITLE = "To rest"

_PARTS = (ways, creep, closed_forms, starts)
STUDIES = tuple(study for part in _PARTS for study in part.STUDIES)


def present(rows: Rows) -> Content:
    """What all parts show."""
    contents: list[Content] = [part.present(rows) for part in _PARTS]
    return reduce(Content.__or__, contents)
