"""An engine system put together item by item, each with its reason."""

from functools import cached_property
from typing import Any, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items

Kind = Literal["node", "object", "marker", "load"]
KINDS: tuple[Kind, ...] = get_args(Kind)


class Assembly:
    """A system of the engine.

    Attributes
    ----------
    system : exudyn.MainSystem
    reasons : dict
        From kind and number of every item in the system to why it is there.
    """

    def __init__(self) -> None:
        self._container = exu.SystemContainer()
        self.system: Any = self._container.AddSystem()
        self.reasons: dict[tuple[Kind, int], str] = {}

    def add(self, item: Any, why: str) -> int:
        """Add an item to the system under the reason for it; returns its number."""
        name = type(item).__name__
        kind = next(kind for kind in KINDS if name.lower().startswith(kind))
        number = int(getattr(self.system, f"Add{kind.capitalize()}")(item))
        self.reasons[kind, number] = why
        return number

    @cached_property
    def table(self) -> int:
        """Number of the ground object, added when it is first asked for."""
        return self.add(
            items.ObjectGround(), "the table, which all that acts on the disk refers to"
        )
