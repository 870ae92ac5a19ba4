"""What a user writes in a module of their own, by the name `module:attribute`."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import fields
from functools import partial
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from traceback import extract_tb
from types import CodeType
from typing import Any, TypeVar

from analysis.problem.names import ArgumentError, Named, nearest
from analysis.problem.quantities import QUANTITIES

T = TypeVar("T")

_FOREIGN = ContextVar("_FOREIGN", default=False)
"""Whether names come from a file, which may be anybody's."""


def is_user_name(name: Any) -> bool:
    """Whether a name is that of something in a module of the user's own."""
    return isinstance(name, str) and ":" in name


def user_object(what: str, name: str, argument: str = "") -> Any:
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
        way = f"`import {module}`; on the command line, --{argument or what} does that"
        fault = f"must be imported first: {way}"
        raise ArgumentError(argument or what, fault, f"{what} {name!r}")
    try:
        return attrgetter(attribute)(import_module(module))
    except (Exception, SystemExit) as error:  # a module of one's own may fail in any way
        fault = f"cannot be loaded: {error_text(error, ImportError, AttributeError)}"
        fault += place(error, module)
        raise ArgumentError(argument or what, fault, f"{what} {name!r}") from error


def place(error: BaseException, module: str) -> str:
    """Where in the file of a module an error was raised, in words; empty if it was not there."""
    # One that fails as it is imported is not there afterwards.
    path, name = getattr(sys.modules.get(module), "__file__", None), module.rpartition(".")[2]
    frames = [(each.filename, each.lineno) for each in extract_tb(error.__traceback__)]
    lines = [line for file, line in frames if (path or file) == file and Path(file).stem == name]
    return f", in line {lines[-1]} of {name}.py" if lines else ""


@contextmanager
def foreign_names() -> Iterator[None]:
    """Import nothing for the names in here: they come from a file that has results in it."""
    token = _FOREIGN.set(True)
    try:
        yield
    finally:
        _FOREIGN.reset(token)


class Kinds(Named[str, type[T]]):
    """Classes of one kind by their names; those of a user's own go by `module:class`.

    Parameters
    ----------
    name : str
        What to call them all.
    what : str
        What to call one in an error, such as "friction law".
    key : str
        Of the quantity that gives the name of the class, such as "friction.law".
    base : type
        What a class of one's own must derive from.
    kinds : sequence of type
        In the order of the quantity's choices; the first is meant where no name is given.
    """

    def __init__(
        self, name: str, what: str, key: str, base: Any, kinds: Sequence[type[T]]
    ) -> None:
        super().__init__(name, dict(zip(QUANTITIES[key].choices, kinds, strict=True)))
        self._what, self._key, self._base = what, QUANTITIES[key].name, base

    def find(self, name: Any) -> type[T]:
        """Class of this name, of itself, or of None; `ArgumentError` if there is none such."""
        if name is None:
            return next(iter(self.values()))
        if isinstance(name, str) and name in self:
            return self[name]
        if isinstance(name, type) and issubclass(name, self._base):
            return name
        if not is_user_name(name):
            fault = f"must be one of {', '.join(self)} or module:class, got {name!r}"
            raise ArgumentError(self._key, fault + nearest(name, self), self._what)
        kind = user_object(self._what, name, self._key)
        if not isinstance(kind, type) or not issubclass(kind, self._base):
            fault = f"must be a class derived from {self._base.__name__}"
            raise ArgumentError(self._key, fault, f"{self._what} {name!r}")
        return kind

    def name_of(self, kind: type[T]) -> str:
        """Name by which `find` finds a class."""
        names = {each: name for name, each in self.items()}
        return names.get(kind, f"{kind.__module__}:{kind.__qualname__}")

    def merged(self, one: Any, given: dict[str, Any]) -> dict[str, Any]:
        """Data of an object with some changed; another class takes over what all classes have."""
        kind: Any = self.find(given.get(self._key, type(one)))
        kept = fields(one if kind is type(one) else self._base)
        return {self._key: kind} | {each.name: getattr(one, each.name) for each in kept} | given

    def made(self, **given: Any) -> T:
        """Object of a class, which may be of one's own, from its name and its fields.

        A module that is named is imported, which runs it, but within `foreign_names`.

        Raises
        ------
        ArgumentError
            If the class is unknown, or a field missing, unknown or out of range.
        """
        kind = self.find(given.pop(self._key, None))
        try:
            return kind(**{name: _frozen(each) for name, each in given.items()})
        except ValueError:
            raise
        except (Exception, SystemExit) as error:
            fault = f"cannot be made: {error_text(error, TypeError)}"
            subject = f"{self._what} {self.name_of(kind)!r}"
            raise ArgumentError(self._key, fault, subject) from error

    @contextmanager
    def answering(self, one: T) -> Iterator[None]:
        """Tell whatever is wrong with what an object of one's own says as a fault of its class."""
        try:
            yield
        except (Exception, SystemExit) as error:
            if isinstance(error, ArgumentError) and error.argument == self._key:
                raise
            subject = f"{self._what} {self.name_of(type(one))!r}:"
            fault = error_text(error, ValueError) + place(error, type(one).__module__)
            raise ArgumentError(self._key, fault, subject) from error


def reads(function: Any, kind: type | None = None) -> tuple[Any, ...]:
    """What a function of one's own works with that is no argument, and may change.

    Those are globals, outer variables, attributes of its class or of the object that it belongs
    to, and what it takes from a module or an object by name. Code that is made of the function
    holds as long as these are the same. What other functions read that it calls is not looked at.

    Parameters
    ----------
    function : callable
        A partial one or an object that can be called, too; one that is not written in Python
        reads nothing.
    kind : type, optional
        Its class, of a method that is not bound.
    """
    if isinstance(function, partial):
        given = (*function.args, *function.keywords.items())
        return (*reads(function.func, kind), *map(_key, given))
    owner = getattr(function, "__self__", None)
    if not hasattr(function, "__code__"):
        owner, function = function, type(function).__call__
        if not hasattr(function, "__code__"):
            return ()
    codes, found = [function.__code__], []
    for code in codes:
        # A lambda or a generator in it has code of its own.
        codes += [each for each in code.co_consts if isinstance(each, CodeType)]
    names = sorted({name for code in codes for name in code.co_names})
    for cell in function.__closure__ or ():
        # One that is bound later is empty.
        with suppress(ValueError):
            found.append(cell.cell_contents)
    kind = type(owner) if owner is not None else kind
    holders = [function.__globals__, *(vars(each) for each in getattr(kind, "__mro__", ()))]
    found += [holder[name] for name in names for holder in holders if name in holder]
    parts = (vars(each) for each in (owner, *found) if hasattr(each, "__dict__"))
    found += [held[name] for held in [*parts] for name in names if name in held]
    return tuple(map(_key, found))


def _key(value: Any) -> Any:
    """What tells a value from another one, and can be hashed."""
    try:
        hash(value)
    except TypeError:
        # An array shows neither all of its digits nor all of its entries.
        return (value.shape, value.tobytes()) if hasattr(value, "tobytes") else repr(value)
    return value


def _frozen(value: Any) -> Any:
    """A value with tuples in place of lists, which is how files tell them."""
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def error_text(error: BaseException, *plain: type[Exception]) -> str:
    """What an error says, with its kind unless that is one of these."""
    return str(error) if isinstance(error, plain) else f"{type(error).__name__}: {error}"


def fault_of(error: BaseException) -> str:
    """What an error says, or who of one's own is blamed for it, if anybody is, by its notes."""
    return "; ".join(getattr(error, "__notes__", ())) or str(error)
