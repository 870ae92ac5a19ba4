"""The way to rest: losses, phases, creep, closed forms and other starts."""

from validation.page.content import Content, Rows
from validation.studies.rest import closed_forms, creep, runs, starts, ways  # noqa: F401

TITLE = "To rest"

_BESIDE = (creep, closed_forms, starts)
STUDIES = (*ways.STUDIES, *(each.STUDY for each in _BESIDE))


def present(rows: Rows) -> Content:
    """What all parts show."""
    content = ways.present(rows)
    for each in _BESIDE:
        content |= each.present(rows[each.STUDY.name])
    return content
