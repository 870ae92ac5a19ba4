"""Data types that are checked by the declarations of their quantities."""

from abc import ABCMeta
from dataclasses import fields
from functools import cache
from typing import Any, ClassVar

from analysis.data.checks import choice, number, switch
from analysis.data.names import ArgumentError, check_names
from analysis.data.quantities import QUANTITIES, Quantity, short


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
    result = number(quantity.name, value)
    least, most = quantity.least, quantity.most
    if (least < result or (least == result and not quantity.is_above)) and (
        result < most or (result == most and not quantity.is_below)
    ):
        return result
    raise ArgumentError(quantity.name, f"must {_range(quantity, result)}, got {result:g}")


def _range(quantity: Quantity, value: float) -> str:
    """What a value must be that is out of range."""
    least, most = quantity.least, quantity.most
    ends = [short(least), short(most)]
    if quantity.is_above and quantity.is_below:
        return f"lie in the open interval ({', '.join(ends)}), {quantity.why}"
    if least == 0.0 and value <= 0.0:
        return "be positive" if quantity.is_above else "not be negative"
    if quantity.is_below:
        return f"be less than {ends[1]}"
    return f"lie from {ends[0]} to {ends[1]}"


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
