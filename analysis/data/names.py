"""Names that are nearly right: what a user may have meant by one that nobody knows."""

import re
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import wraps
from inspect import signature
from typing import Any, TypeVar

K = TypeVar("K")
V = TypeVar("V")
F = TypeVar("F", bound=Callable[..., Any])
C = TypeVar("C", bound=type)

_MOST = 3
"""Names that are offered at once."""

SHORT = {"mu": "coefficient", "eps": "smoothing"}
"""Names of the paper's, by which the command line knows these parameters of friction."""


def nearest(name: Any, known: Iterable[Any]) -> str:
    """What to add to a message that refuses a name: the known ones that it may stand for.

    Examples
    --------
    >>> nearest("spn", ["spin", "beta"])
    '; did you mean spin?'
    >>> nearest("speed", ["spin", "beta"])
    ''
    """
    names = {str(each).lstrip("-"): str(each) for each in known}
    word = str(name).lstrip("-")
    parts = [each for each in names if word in re.split(r"[-_]", each)]
    close = [*get_close_matches(word, names, 2, 0.7), *parts]
    if SHORT.get(word) in names:
        close = [SHORT[word]]
    listed = " or ".join(names[each] for each in list(dict.fromkeys(close))[:_MOST])
    return f"; did you mean {listed}?" if listed else ""


def suggesting(function: F) -> F:
    """Let a function say which of its keywords an unknown one may stand for."""

    @wraps(function)
    def checked(*args: Any, **given: Any) -> Any:
        try:
            return function(*args, **given)
        except TypeError:
            known = [
                name for name in signature(function).parameters if name not in {"self", "cls"}
            ]
            for name in given:
                if name not in known:
                    what = function.__qualname__.removesuffix(".__init__")
                    raise TypeError(
                        f"{what} takes {', '.join(known)}, and no {name}{nearest(name, known)}"
                    ) from None
            raise

    return checked  # type: ignore[return-value]


def suggesting_fields(kind: C) -> C:
    """Let a class say which of its fields an unknown keyword may stand for."""
    kind.__init__ = suggesting(kind.__init__)  # type: ignore[misc]
    return kind


class Named(dict[K, V]):
    """A dictionary that says what it holds where a key is missing.

    Parameters
    ----------
    name : str
        What to call it.
    entries : mapping
    """

    def __init__(self, name: str, entries: dict[K, V]) -> None:
        super().__init__(entries)
        self._name = name

    def __missing__(self, key: object) -> V:
        held = ", ".join(map(repr, self))
        raise KeyError(f"{self._name} holds {held}, and no {key!r}{nearest(key, self)}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._name, dict(self))
