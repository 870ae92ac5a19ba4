"""Results as plain data and back: numbers, arrays and dataclasses of this project for JSON.

What JSON does not know is an object with a single key that says what it is: {"tuple": [...]},
{"array": [...]}, {"complex": [re, im]} of numbers or arrays, {"dict": [[key, value], ...]},
{"module:Class": {field: value}}, {"several": ["module:Class", {field: [value, ...]}]} of a list of
one class, {"same": [count, value]} of equal values there, and {"number": "nan"}. Not a number is
null in an array.
"""

import sys
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from importlib import import_module
from math import isfinite
from typing import Any

import numpy as np
import numpy.typing as npt

from validation.kit.reach import PROJECT

DIGITS = 12
"""Significant digits of the numbers in arrays; single ones keep all of theirs."""


def pack(value: Any) -> Any:
    """Plain data of a result.

    Parameters
    ----------
    value
        Numbers, text, None, arrays of numbers, dataclasses of this project, and lists, tuples
        and mappings of these.

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
        case np.ndarray():
            packed = _pack_array(value)
        case list():
            packed = _pack_list(value)
        case tuple():
            packed = {"tuple": _pack_list(value)}
        case dict():
            packed = {"dict": [[pack(key), pack(each)] for key, each in value.items()]}
        case _:
            packed = {
                _name(value): {
                    each.name: pack(getattr(value, each.name)) for each in fields(value)
                }
            }
    return packed


def _pack_list(values: Sequence[Any]) -> Any:
    kinds = {type(each) for each in values}
    if len(values) < 2 or len(kinds) > 1 or not is_dataclass(values[0]):
        return [pack(each) for each in values]
    # The names of a class and its fields are longer than most values.
    names = [each.name for each in fields(values[0])]
    columns = {name: _pack_column([getattr(each, name) for each in values]) for name in names}
    return {"several": [_name(values[0]), columns]}


def _pack_column(values: Sequence[Any]) -> Any:
    if isinstance(values[0], str) and len(set(values)) == 1:
        return {"same": [len(values), values[0]]}
    return _pack_list(values)


def _name(value: Any) -> str:
    """What `_known` finds the class of a value by."""
    kind = type(value)
    name = f"{kind.__module__}:{kind.__qualname__}"
    if not is_dataclass(kind) or _known(name) is not kind:
        raise ValueError(f"value must be plain data or a dataclass of this project, got {value!r}")
    return name


def _pack_array(values: npt.NDArray[Any]) -> dict[str, Any]:
    if np.iscomplexobj(values):
        return {"complex": [_pack_array(values.real)["array"], _pack_array(values.imag)["array"]]}
    if values.dtype.kind == "f":
        rounded = np.array([float(f"{each:.{DIGITS}g}") for each in values.flat])
        values = np.where(np.isnan(rounded), None, rounded).reshape(values.shape)  # type: ignore[call-overload]
    elif values.dtype.kind not in "bi":
        raise ValueError(f"value must be an array of numbers, got one of {values.dtype}")
    return {"array": values.tolist()}


def unpack(stored: Any) -> Any:
    """Result from what `pack` has returned.

    Raises
    ------
    ValueError
        If it is something else, or names a class that is no dataclass of this project.
    """
    if isinstance(stored, list):
        return [unpack(each) for each in stored]
    if not isinstance(stored, dict):
        return stored
    if len(stored) != 1:
        raise ValueError(f"stored must have a single key, got {', '.join(stored)}")
    ((what, content),) = stored.items()
    match what:
        case "tuple":
            result: Any = tuple(unpack(content))
        case "number":
            result = float(content)
        case "several":
            name, columns = content
            kind, names = _known(name), tuple(columns)
            rows = zip(*map(_unpack_column, columns.values()), strict=True)
            result = [kind(**dict(zip(names, row, strict=True))) for row in rows]
        case "array":
            result = _array(content)
        case "complex":
            real, imaginary = content
            result = (
                complex(real, imaginary)
                if isinstance(real, float)
                else _array(real) + 1j * _array(imaginary)
            )
        case "dict":
            result = {unpack(key): unpack(each) for key, each in content}
        case _:
            result = _known(what)(**{name: unpack(each) for name, each in content.items()})
    return result


def _array(content: list[Any]) -> npt.NDArray[Any]:
    values = np.array(content)
    return values.astype(float) if values.dtype.kind == "O" else values


def _unpack_column(stored: Any) -> Any:
    if isinstance(stored, dict) and "same" in stored:
        count, value = stored["same"]
        return [value] * count
    return unpack(stored)


def _known(name: str) -> type:
    """The dataclass of this project with a name "module:Class".

    A file may name anything: what is not a dataclass that is defined there is refused.
    """
    module, _, qualified = name.partition(":")
    if module.partition(".")[0] in PROJECT and "." not in qualified:
        found = getattr(sys.modules.get(module) or import_module(module), qualified, None)
        if isinstance(found, type) and is_dataclass(found) and found.__module__ == module:
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
