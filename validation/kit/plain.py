"""Results as plain data and back: numbers, arrays and dataclasses of this project for JSON.

What JSON does not know is an object with a single key that says what it is: {"tuple": [...]},
{"array": [...]}, {"complex": [re, im]} of numbers or arrays, {"dict": [[key, value], ...]},
{"module:Class": {field: value}}, {"several": ["module:Class", {field: [value, ...]}]} of a list of
one class, {"same": [count, value]} of equal values there, and {"number": "nan"},
{"bytes": text in base 64}, {"empty": [shape, kind]} of an array. Not a number is null in an array.

A file may come from anybody: reading it makes numbers, text and dataclasses of this project, these
by their own constructors, imports nothing else that it names, and changes nothing.
"""

import sys
from base64 import b64decode, b64encode
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from importlib import import_module
from math import isfinite
from typing import Any

import numpy as np
import numpy.typing as npt

from analysis.data.own import foreign_names
from validation.kit.reach import PROJECT

DIGITS = 12
"""Significant digits of the numbers in arrays; single ones keep all of theirs."""

_KINDS = {"b": bool, "i": int, "f": float, "c": complex}
"""Arrays by their kind in NumPy."""


def pack(value: Any, *, exact: bool = False) -> Any:
    """Plain data of a result.

    Parameters
    ----------
    value
        Numbers, text, bytes, None, arrays of numbers, dataclasses of this project, and lists,
        tuples and mappings of these.
    exact : bool
        Whether the numbers of arrays, too, keep all digits.

    Raises
    ------
    ValueError
        If it holds anything else.

    Examples
    --------
    >>> import numpy as np
    >>> from validation.kit.plain import pack, unpack
    >>> pack((1.0, None))
    {'tuple': [1.0, None]}
    >>> unpack(pack({"times": np.array((0.0, 0.5))}))
    {'times': array([0. , 0.5])}
    """
    if isinstance(value, np.generic):
        # Numbers of NumPy are no plain ones.
        value = value.item()
    match value:
        case float() if not isfinite(value):
            packed: Any = {"number": str(value)}
        case None | str() | bool() | int() | float():
            return value
        case complex():
            packed = {"complex": [value.real, value.imag]}
        case bytes():
            packed = {"bytes": b64encode(value).decode()}
        case np.ndarray():
            packed = _pack_array(value, exact=exact)
        case list():
            packed = _pack_list(value, exact=exact)
        case tuple():
            packed = {"tuple": _pack_list(value, exact=exact)}
        case dict():
            packed = {
                "dict": [
                    [pack(key, exact=exact), pack(each, exact=exact)]
                    for key, each in value.items()
                ]
            }
        case _:
            name = _name(value)
            packed = {
                name: {
                    each: pack(getattr(value, each), exact=exact) for each in _parameters(value)
                }
            }
    return packed


def _parameters(value: Any) -> list[str]:
    """Names of what a dataclass is made from."""
    return [each.name for each in fields(value) if each.init]


def _pack_list(values: Sequence[Any], *, exact: bool) -> Any:
    kinds = {type(each) for each in values}
    if len(values) < 2 or len(kinds) > 1 or not is_dataclass(values[0]):
        return [pack(each, exact=exact) for each in values]
    # The names of a class and its fields are longer than most values.
    columns = {
        name: _pack_column([getattr(each, name) for each in values], exact=exact)
        for name in _parameters(values[0])
    }
    return {"several": [_name(values[0]), columns]}


def _pack_column(values: Sequence[Any], *, exact: bool) -> Any:
    if isinstance(values[0], str) and len(set(values)) == 1:
        return {"same": [len(values), values[0]]}
    return _pack_list(values, exact=exact)


def _name(value: Any) -> str:
    """What `_known` finds the class of a value by."""
    kind = type(value)
    name = f"{kind.__module__}:{kind.__qualname__}"
    if not is_dataclass(kind) or _known(name) is not kind:
        raise ValueError(f"value must be plain data or a dataclass of this project, got {value!r}")
    return name


def _pack_array(values: npt.NDArray[Any], *, exact: bool) -> dict[str, Any]:
    if values.dtype.kind not in "bifc":
        raise ValueError(f"value must be an array of numbers, got one of {values.dtype}")
    if not values.size:
        # Lists of nothing have no shape.
        return {"empty": [list(values.shape), values.dtype.kind]}
    if values.dtype.kind == "c":
        parts = (_pack_array(part, exact=exact)["array"] for part in (values.real, values.imag))
        return {"complex": list(parts)}
    if values.dtype.kind == "f":
        if not exact:
            short = [float(f"{each:.{DIGITS}g}") for each in values.flat]
            values = np.array(short).reshape(values.shape)
        if np.isnan(values).any():
            values = np.where(np.isnan(values), None, values)  # type: ignore[call-overload]
    return {"array": values.tolist()}


def unpack(stored: Any) -> Any:
    """Result from what `pack` has returned.

    Raises
    ------
    ValueError
        If it is something else, or names a class that is no dataclass of this project.
    TypeError
        If what it holds does not fit there.
    """
    with foreign_names():
        return _unpack(stored)


def _unpack(stored: Any) -> Any:
    if isinstance(stored, list):
        return [_unpack(each) for each in stored]
    if not isinstance(stored, dict):
        return stored
    if len(stored) != 1:
        raise ValueError(f"stored must have a single key, got {', '.join(stored)}")
    ((what, content),) = stored.items()
    if what in _READ:
        return _READ[what](content)
    return _known(what)(**{name: _unpack(each) for name, each in content.items()})


def _complex(parts: Sequence[Any]) -> Any:
    real, imaginary = parts
    if isinstance(real, float):
        return complex(real, imaginary)
    # Infinite parts do not survive a product with 1j.
    result = _array(real) + 0j
    result.imag = _array(imaginary)
    return result


def _several(stored: Sequence[Any]) -> list[Any]:
    name, columns = stored
    kind, names = _known(name), tuple(columns)
    rows = zip(*map(_unpack_column, columns.values()), strict=True)
    return [kind(**dict(zip(names, row, strict=True))) for row in rows]


def _array(content: list[Any]) -> npt.NDArray[Any]:
    values = np.array(content)
    return values.astype(float) if values.dtype.kind == "O" else values


def _unpack_column(stored: Any) -> Any:
    if isinstance(stored, dict) and "same" in stored:
        count, value = stored["same"]
        return [value] * count
    return _unpack(stored)


_READ: dict[str, Callable[[Any], Any]] = {
    "array": _array,
    "bytes": b64decode,
    "complex": _complex,
    "dict": lambda pairs: {_unpack(key): _unpack(each) for key, each in pairs},
    "empty": lambda told: np.zeros(told[0], _KINDS[told[1]]),
    "number": float,
    "several": _several,
    "tuple": lambda items: tuple(_unpack(items)),
}
"""What is made of plain data by the key that says what it is."""


def _known(name: str) -> type:
    """The dataclass of this project with a name "module:Class".

    A file may name anything: what is not a dataclass that is defined there is refused.
    """
    module, _, qualified = name.partition(":")
    if module.partition(".")[0] in PROJECT and "." not in qualified:
        found = getattr(sys.modules.get(module) or import_module(module), qualified, None)
        if (
            isinstance(found, type)
            and found.__module__ == module
            and "__dataclass_fields__" in vars(found)
        ):
            return found
    raise ValueError(f"stored must name a dataclass of this project, got {name!r}")


def rounded(value: Any, digits: int) -> Any:
    """The same with all numbers in it rounded to so many digits."""
    if isinstance(value, float):
        # JSON knows no infinity; what is that far off is as good as that.
        return min(float(f"{value:.{digits}g}"), 1e300)
    if isinstance(value, dict):
        return {key: rounded(each, digits) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each, digits) for each in value]
    return value
