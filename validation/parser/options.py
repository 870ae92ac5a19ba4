"""Options of the command line, made from signatures and docstrings."""

import argparse
import re
from collections.abc import Callable, Iterable, Mapping
from inspect import Parameter, cleandoc, signature
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, NamedTuple, NoReturn, get_args, get_origin

from analysis.problem.names import nearest
from analysis.problem.quantities import QUANTITIES, SECTIONS, Quantity, of_table, short
from validation.commands.output import Result
from validation.parser.paths import existing, file

_NEGATIVE = re.compile(r"-(\d|\.\d|pi)")

_METAVARS: dict[Any, str] = {float: "NUMBER", int: "N", str: "NAME"}


class Parser(argparse.ArgumentParser):
    """Parser whose errors are one line, and tell what a wrong name may stand for."""

    def __init__(self, **how: Any) -> None:
        formatter = argparse.RawDescriptionHelpFormatter
        super().__init__(allow_abbrev=False, formatter_class=formatter, **how)
        # What looks like a negative value, such as -pi/2 or -1e-3, is none of the options.
        self._negative_number_matcher = _NEGATIVE

    @property
    def actions(self) -> list[argparse.Action]:
        """Options and arguments of the command."""
        return self._actions

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Options of a call, all of which must be known."""
        options, left = super().parse_known_args(args, namespace)
        if left:
            hints = (nearest(word.partition("=")[0], self._option_string_actions) for word in left)
            self.error(f"unrecognized arguments: {' '.join(left)}{''.join(hints)}")
        return options, left

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += nearest(value, action.choices or ())
            raise

    def error(self, message: str) -> NoReturn:
        """Exit with code 2 and one line."""
        self.exit(2, f"{self.prog}: error: {message}\n")

    def add(self, parameter: Parameter, told: dict[str, str]) -> None:
        """Add the option for a parameter of a function, or the argument for a positional one.

        Parameters
        ----------
        parameter : Parameter
            Of a plain type, or one with keywords of `argparse` behind it, or a group.
        told : dict
            What the parameters mean.
        """
        how = _keywords(parameter.annotation)
        if isinstance(how, OfScenario | Group):
            how.add_to(self, told)
            return
        name, default = parameter.name, parameter.default
        if any(each.dest == name for each in self.actions):
            # A command takes an output itself.
            return
        about = [told.get(name, "")]
        if "metavar" in how and "choices" in how:
            about.append(", ".join(how["choices"]))
        text = ": ".join(filter(None, about))
        if default not in (None, "", Parameter.empty) and default is not False:
            text += f" ({default[0] if isinstance(default, tuple) else short(default)})"
        how = how | {"help": text.replace("%", "%%")}
        if default is not Parameter.empty:
            # Text is looked at as if it were given.
            how["default"] = str(default) if isinstance(default, Path) else default
        if parameter.kind is Parameter.KEYWORD_ONLY:
            flag = f"--{name.replace('_', '-')}"
            self.add_argument(flag, required=default is Parameter.empty, **how)
        else:
            self.add_argument(name, **how)


def described(function: Callable[..., Any]) -> tuple[str, dict[str, str]]:
    """What a docstring says, and what it says of each parameter, in a line."""
    about, *sections = re.split(r"\n\n(?=\w+\n---)", cleandoc(function.__doc__ or ""))
    entry = re.compile(r"^(\w+).*\n((?: {4}.*\n?)+)", re.MULTILINE)
    entries = entry.findall("\n".join(sections))
    return about, {name: _as_in_help(" ".join(text.split())) for name, text in entries}


def _as_in_help(sentence: str) -> str:
    """A sentence without capital and full stop, unless it begins with an abbreviation."""
    first = sentence[:1] if sentence[1:2].isupper() else sentence[:1].lower()
    return first + sentence[1:].removesuffix(".")


def _keywords(kind: Any) -> Any:
    """Keywords of `argparse` for a type, or the group that stands behind it."""
    how: Any = {}
    if get_origin(kind) is Annotated:
        kind, how = get_args(kind)
    if not isinstance(how, dict):
        return how
    if NoneType in get_args(kind):
        kind = get_args(kind)[0]
    if get_origin(kind) is Literal:
        return {"choices": get_args(kind)} | how
    if kind is bool:
        return {"action": argparse.BooleanOptionalAction} | how
    return how if "choices" in how else {"type": kind, "metavar": _METAVARS.get(kind)} | how


class OfScenario(NamedTuple):
    """Group of options that tell a scenario.

    Parameters
    ----------
    tables : tuple of str
        Of the scenario whose quantities are options.
    flag : str
        Of its file.
    """

    tables: tuple[str, ...]
    flag: str = "--scenario"

    def add_to(self, parser: Parser, _: dict[str, str]) -> None:
        """Add the options for the file and for the quantities, a group for each table."""
        how: dict[str, Any] = {} if self.flag.startswith("-") else {"nargs": "?"}
        about = "scenario, .toml, or a stored run to repeat, .npz"
        parser.add_argument(self.flag, **file(existing(), help=about), **how)
        for table in self.tables:
            group = parser.add_argument_group(table or "problem", SECTIONS[table].about)
            for quantity in of_table(table).values():
                group.add_argument(quantity.flag, **_how(quantity))

    def value(self, given: Mapping[str, Any]) -> Any:
        """What is told of the scenario."""
        from validation.commands.scenarios import Problem  # noqa: PLC0415 - it takes NumPy along

        named = {key: given[key] for key in QUANTITIES if given.get(key) is not None}
        return Problem(file=given["scenario"], named=named)


class Group:
    """Group of options that are parameters of a function, or fields of a data class.

    Parameters
    ----------
    whole : callable
    *names : str
        Of the parameters; by default all.
    **defaults
        Where they differ from those of the parameters.
    """

    def __init__(self, whole: Callable[..., Any], *names: str, **defaults: Any) -> None:
        known = signature(whole).parameters
        self._told = described(whole)[1]
        self._parameters = [
            known[name].replace(default=defaults.get(name, known[name].default))
            for name in names or known
        ]

    def add_to(self, parser: Parser, told: dict[str, str]) -> None:
        """Add the options; what a command says of one itself comes first."""
        for parameter in self._parameters:
            parser.add(parameter, self._told | told)

    def value(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """What is given, by name."""
        named = {each.name: given[each.name] for each in self._parameters}
        return {name: value for name, value in named.items() if value is not None}


_OUTPUTS = Group(Result.deliver, "json", "csv", "plot")


class Command:
    """A command.

    Parameters
    ----------
    module : str
        Of `validation.commands`, with the function that does it.
    function : callable
        With its name, its parameters and its docstring; it does nothing.
    """

    def __init__(self, module: str, function: Callable[..., Any]) -> None:
        self.module, self.name = module, function.__name__
        self.about, self._told = described(function)
        told = signature(function)
        self._kinds = {name: _keywords(each.annotation) for name, each in told.parameters.items()}
        self._parameters = tuple(told.parameters.values())
        found = _OUTPUTS if told.return_annotation is Result else _keywords(told.return_annotation)
        self._outputs = found if isinstance(found, Group) else None

    def parser(self) -> Parser:
        """Parser of the command."""
        parser = Parser(prog=f"tippedisk {self.name}", description=self.about)
        for parameter in self._parameters:
            parser.add(parameter, self._told)
        if self._outputs:
            self._outputs.add_to(parser, {})
        names = "".join(
            f" {each.metavar}{' ...' if each.nargs else ''}"
            for each in parser.actions
            if not each.option_strings
        )
        parser.usage = f"tippedisk {self.name} [OPTION ...]{names}"
        return parser

    def call(self, function: Callable[..., Any], given: Mapping[str, Any]) -> int:
        """Exit code of the command, whose result goes where the options say."""
        found = function(
            **{
                name: given[name] if isinstance(kind, dict) else kind.value(given)
                for name, kind in self._kinds.items()
            }
        )
        return int(found.deliver(**self._outputs.value(given)) if self._outputs else found)


def _how(quantity: Quantity) -> dict[str, Any]:
    """Option of a quantity; its value stays text until it is read."""
    unit = f", in {quantity.unit}" if quantity.unit else ""
    usual = f" ({quantity.shown_default})" if quantity.shown_default else ""
    about = f"{quantity.meaning}{unit}{usual}".replace("%", "%%")
    how: dict[str, Any] = {"dest": quantity.key, "help": about}
    if quantity.is_switch:
        return how | {"action": argparse.BooleanOptionalAction}
    if quantity.choices and quantity.key not in ("constraints", "friction.law", "disk.body"):
        return how | {"choices": list(map(str, quantity.choices))}
    return how | {"metavar": quantity.metavar}


def flag_of(argument: str, options: Iterable[tuple[str, Any]]) -> str:
    """The given option that an argument comes from, if there is one.

    Parameters
    ----------
    argument : str
        As an `ArgumentError` names it.
    options : iterable of (str, value)
        Keys of quantities, or names, and what is given for them.
    """
    near = ""
    for key, value in options:
        table, _, name = key.rpartition(".")
        if value is None or value is False:
            continue
        flag = QUANTITIES[key].flag if key in QUANTITIES else f"--{name.replace('_', '-')}"
        if argument in (key, name, f"{name}s"):
            return flag
        # A law takes its parameters along, and a table stands for what is given of it; the contact
        # is refused for the constraints that it cannot take.
        if (
            (argument and argument == table)
            or (name == "law" and f"friction.{argument}" in QUANTITIES)
            or (argument == "contact" and key in ("model", "constraints"))
        ):
            near = near or flag
    return near
