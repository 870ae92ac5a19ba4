"""Names that are nearly right: what a user may have meant by one that nobody knows."""

import re
from collections.abc import Collection, Iterable
from difflib import get_close_matches
from typing import Any, TypeVar

from analysis.problem.quantities import KEYS, QUANTITIES

K = TypeVar("K")
V = TypeVar("V")

_MOST = 3
"""Names that are offered at once."""

_LONGEST = 200
"""Characters of a value in a message, before it is cut."""


class ArgumentError(ValueError):
    """An argument that is refused: the message is its name with what is wrong.

    Parameters
    ----------
    argument : str
        Its name, by which a file finds the line and the command line the option.
    fault : str
        What is wrong: "must be positive, got 0".
    subject : str
        What to call it in the message; by default its name.
    """

    def __init__(self, argument: str, fault: str, subject: str = "") -> None:
        super().__init__(argument, fault, subject)
        self.argument = argument

    def __str__(self) -> str:
        argument, fault, subject = self.args
        # An array writes itself on several lines, a scenario on a long one.
        message, got, value = " ".join(f"{subject or argument} {fault}".split()).partition(
            ", got "
        )
        return f"{message}{got}{value if len(value) <= _LONGEST else f'{value[:_LONGEST]} …'}"


class OutputLostError(OSError):
    """What was made could not be written to standard output."""


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
    short = KEYS.get(word, "").rpartition(".")[2]
    if short in names:
        close = [short]
    listed = " or ".join(names[each] for each in list(dict.fromkeys(close))[:_MOST])
    return f"; did you mean {listed}?" if listed else ""


def check_names(what: str, given: Iterable[str], known: Collection[str]) -> None:
    """Raise `TypeError` that says what an unknown keyword of a call may stand for."""
    for name in given:
        if name not in known:
            hint = nearest(name, known) or _elsewhere(name)
            raise TypeError(f"{what} takes {', '.join(known)}, and no {name}{hint}")


def _elsewhere(name: str) -> str:
    """What to add to a message that refuses a name which other parts of a scenario know."""
    if name == "model":
        return "; write constraints=MODELS[...]"
    table, _, key = KEYS.get(name, "").rpartition(".")
    return f"; {key} belongs to the {table}" if table else ""


def full_name(name: str, argument: str = "axis") -> str:
    """Key of a quantity from that, or from its last part or its option alone.

    Parameters
    ----------
    name : str
    argument : str
        What to call it if there is no such quantity.

    Raises
    ------
    ArgumentError
        If there is none.
    """
    if not isinstance(name, str):
        raise ArgumentError(argument, f"must be named by text, got {name!r}")
    name = name.strip().replace("-", "_")
    table, _, key = name.rpartition(".")
    # A law or a body of one's own has parameters of its own.
    if name in QUANTITIES or (table in ("friction", "disk") and key):
        return name
    known = {each.option: key for key, each in QUANTITIES.items() if each.option} | KEYS
    if name in known:
        return known[name]
    raise ArgumentError(
        argument,
        "must be a field of a scenario, as `tippedisk scenario` lists them, such as start.spin, "
        "or with its table one of a law or a body of one's own, such as friction.power, "
        f"got {name!r}{nearest(key, KEYS)}",
    )


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
