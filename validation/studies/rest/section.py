"""The way to rest: losses, phases, creep, contact, closed forms and other starts."""

from dataclasses import fields
from typing import Any

from validation.page.content import Content, Rows
from validation.studies.rest import closed_forms, contact, creep, starts, ways

TITLE = "To rest"

_PARTS = (ways, creep, contact, closed_forms, starts)
STUDIES = tuple(study for part in _PARTS for study in part.STUDIES)


def present(rows: Rows) -> Content:
    """What all parts show."""
    contents = [part.present(rows) for part in _PARTS]
    together: dict[str, Any] = {}
    for field in fields(Content):
        values = [getattr(content, field.name) for content in contents]
        together[field.name] = (
            {name: each for value in values for name, each in value.items()}
            if isinstance(values[0], dict)
            else [each for value in values for each in value]
        )
    return Content(**together)
