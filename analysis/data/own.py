"""What a user writes in a module of their own, by the name `module:attribute`."""

from importlib import import_module
from typing import Any


def is_own(name: Any) -> bool:
    """Whether a name is that of something in a module of the user's own."""
    return isinstance(name, str) and ":" in name


def own_object(what: str, name: str) -> Any:
    """Import what a name stands for, which runs its module.

    Parameters
    ----------
    what : str
        What to call it in an error, such as "friction law".
    name : str
        `module:attribute`.

    Raises
    ------
    ValueError
        If it cannot be.
    """
    module, _, attribute = name.partition(":")
    try:
        return getattr(import_module(module), attribute)
    except (Exception, SystemExit) as error:  # a module of one's own may fail in any way
        kind = type(error).__name__
        said = error if isinstance(error, ImportError | AttributeError) else f"{kind}: {error}"
        raise ValueError(f"{what} {name!r} cannot be loaded: {said}") from error
