"""Data types that are checked by the declarations of their quantities."""

from abc import ABCMeta
from dataclasses import fields
from functools import cache
from inspect import Signature, signature
from typing import Any, ClassVar

from analysis.data.checks import choice, in_range, switch
from analysis.data.names import check_names
from analysis.data.quantities import QUANTITIES, Quantity


def checked(quantity: Quantity, value: Any) -> Any:
    """Return the clean value of a quantity.

    Raises
    ------
    ArgumentError
        If it is of the wrong kind or out of range.
    """
    if quantity.choices:
        if quantity.is_switch:
            return switch(quantity.name, value)
        return choice(quantity.name, value, quantity.choices)
    return in_range(
        quantity.name,
        value,
        quantity.least,
        quantity.most,
        is_above=quantity.is_above,
        is_below=quantity.is_below,
        why=quantity.why,
    )


class _Checking(ABCMeta):
    """Classes whose keywords are checked before an object is made of them."""

    def __call__(cls, *arguments: Any, **given: Any) -> Any:
        known = _known(cls)
        for name, value in given.items():
            if name not in known:
                check_names(cls.__name__, [name], known)
            quantity, follows = known[name]
            if quantity is not None and not (value is None and follows):
                given[name] = checked(quantity, value)
        return super().__call__(*arguments, **given)

    @property
    def __signature__(cls) -> Signature:
        """That of the dataclass, which `__call__` would hide from help and documentation."""
        made = signature(cls.__init__)  # type: ignore[misc] # it is the class's own
        return made.replace(parameters=list(made.parameters.values())[1:])


@cache
def _known(kind: Any) -> dict[str, tuple[Quantity | None, bool]]:
    """Fields of a class: their quantities, and whether they follow from the rest for None."""
    return {
        field.name: (QUANTITIES.get(f"{kind.TABLE}.{field.name}"), field.default is None)
        for field in fields(kind)
    }


class Described(metaclass=_Checking):
    """Base of dataclasses whose fields are quantities of a table of a scenario."""

    __slots__ = ()

    TABLE: ClassVar[str] = ""
    """Name of the table."""
