"""What a user writes in a module of their own, by the name `module:attribute`."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module
from typing import Any

from analysis.data.names import ArgumentError

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
        fault = "must be imported first; on the command line, --law does that"
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
