"""What a user writes in a module of their own, by the name `module:attribute`."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields
from importlib import import_module
from typing import Any, TypeVar

from analysis.data.names import ArgumentError, nearest

T = TypeVar("T")

_FOREIGN = ContextVar("_FOREIGN", default=False)
"""Whether names come from a file, which may be anybody's."""


def is_own(name: Any) -> bool:
    """Whether a name is that of something in a module of the user's own."""
    return isinstance(name, str) and ":" in name


def own_object(what: str, name: str, argument: str = "") -> Any:
    """Import what a name stands for, which runs its module.

    Parameters
    ----------
    what : str
        What to call it in an error, such as "friction law".
    name : str
        `module:attribute`.
    argument : str
        That gives the name, where it is not called so.

    Raises
    ------
    ValueError
        If it cannot be, or within `foreign_names` if its module has not been imported before.
    """
    module, _, attribute = name.partition(":")
    if _FOREIGN.get() and module not in sys.modules:
        fault = f"must be imported first; on the command line, --{argument or what} does that"
        raise ArgumentError(argument or what, fault, f"{what} {name!r}")
    try:
        return getattr(import_module(module), attribute)
    except (Exception, SystemExit) as error:  # a module of one's own may fail in any way
        kind = type(error).__name__
        said = error if isinstance(error, ImportError | AttributeError) else f"{kind}: {error}"
        fault = f"cannot be loaded: {said}"
        raise ArgumentError(argument or what, fault, f"{what} {name!r}") from error


@contextmanager
def foreign_names() -> Iterator[None]:
    """Import nothing for the names in here: they come from a file that has results in it."""
    token = _FOREIGN.set(True)
    try:
        yield
    finally:
        _FOREIGN.reset(token)


def own_class(
    what: str, name: Any, known: Mapping[str, type[T]], base: Any, argument: str
) -> type[T]:
    """Class by its name: a known one, or one of the user's own.

    Parameters
    ----------
    what : str
        What to call it in an error, such as "friction law".
    name : str
        One of the known ones, or `module:class`.
    known : mapping
        Classes by name.
    base : type
        What a class of one's own must derive from.
    argument : str
        That gives the name.

    Raises
    ------
    ArgumentError
        If there is none, or it is another.
    """
    if isinstance(name, str) and name in known:
        return known[name]
    if not is_own(name):
        fault = f"must be one of {', '.join(known)} or module:class, got {name!r}"
        raise ArgumentError(argument, fault + nearest(name, known), what)
    kind = own_object(what, name, argument)
    if not isinstance(kind, type) or not issubclass(kind, base):
        fault = f"must be a class derived from {base.__name__}"
        raise ArgumentError(argument, fault, f"{what} {name!r}")
    return kind


def made(what: str, name: str, kind: type[T], values: Mapping[str, Any], argument: str) -> T:
    """Object of a class, which may be of one's own, from its fields.

    Parameters
    ----------
    what, name, argument : str
        As in `own_class`.
    kind : type
    values : mapping

    Raises
    ------
    ArgumentError
        If a field is missing, not one of its own, or out of range.
    """
    known: list[str] = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    for given in values:
        if given not in known:
            raise ArgumentError(
                given,
                f"is no parameter of the {what} {name}, which takes {', '.join(known)}"
                f"{nearest(given, known)}",
            )
    try:
        return kind(**values)
    except ValueError:
        raise
    except (Exception, SystemExit) as error:
        said = error if isinstance(error, TypeError) else f"{type(error).__name__}: {error}"
        raise ArgumentError(argument, f"cannot be made: {said}", f"{what} {name!r}") from error
