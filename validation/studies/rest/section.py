"""The way to rest: losses, phases, creep, contact, closed forms and other starts."""

from validation.page.content import Content, Rows
from validation.studies.rest import closed_forms, contact, creep, starts, ways

TITLE = "To rest"

_PARTS = (ways, creep, contact, closed_forms, starts)
STUDIES = tuple(study for part in _PARTS for study in part.STUDIES)


def present(rows: Rows) -> Content:
    """What all parts show."""
    shown, *others = (part.present(rows) for part in _PARTS)
    for other in others:
        shown |= other
    return shown
