"""The commands: every public function of the modules of `validation.commands`.

A signature says what a command takes, its docstring what the help prints. Both are read from the
source, since importing those modules loads NumPy and the engine, for which no help should wait.
"""

import argparse
import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from inspect import Parameter, cleandoc, signature
from itertools import takewhile
from pathlib import Path
from types import MappingProxyType, NoneType
from typing import Annotated, Any, Literal, NamedTuple, NoReturn, get_args, get_origin

from analysis.problem.names import nearest
from analysis.problem.quantities import KEYS, QUANTITIES, SECTIONS, Quantity, of_table, short
from validation import commands as package
from validation.parser.files import Result, existing, file

_MODULES = (
    *("studies", "simulate", "show", "scenario", "sweep", "maps", "stability", "nonlinear"),
    "completion",
)
"""In the order of the help."""

_LIGHT = ("pathlib", "typing", "validation.parser", "analysis.problem.choices")
"""Modules from which signatures have their names."""

_NEGATIVE = re.compile(r"-(\d|\.\d|pi|inf|nan|$)")
"""What begins like an option and is a value; `-` is standard output, or input."""

_UNTOLD = "What help says of commands and options is left out where Python runs with -OO."

_NUMBERS = {float: "a number", int: "a whole number"}

_METAVARS: dict[Any, str] = {float: "NUMBER", int: "N", str: "NAME"}

_SHOWN: dict[Any, str] = {None: " {}", "?": " [{}]", "+": " {} ...", "*": " {} ..."}
"""An argument in the usage, by how many words it takes."""


# --- Options -------------------------------------------------------------------------------------


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

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Options of a call, all of which must be known; those that are not are told first.

        Arguments may stand between them.
        """
        known, words = self._option_string_actions, takewhile("--".__ne__, args)
        flags = [word for word in words if word.startswith("-") and not _NEGATIVE.match(word)]
        for flag in flags:
            if flag.endswith("=--"):
                # Taken for the end of the options, it would leave a list without a value.
                self.error(f"argument {flag[:-3]}: expected a value behind =, got '--'")
        left = [each for each in flags if each.partition("=")[0] not in known]
        options, more = (namespace, []) if left else self.parse_known_intermixed_args(args)
        if left := left or more:
            # A word that is no option stands for none.
            wrong = (word.partition("=")[0] for word in left if word.startswith("-"))
            hints = (nearest(flag, known) for flag in wrong)
            self.error(f"unrecognized arguments: {' '.join(left)}{''.join(hints)}")
        return options

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += nearest(value, action.choices or ())
            raise

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        try:
            return super()._get_value(action, arg_string)
        except argparse.ArgumentError as error:
            if action.type in _NUMBERS:
                error.message = f"must be {_NUMBERS[action.type]}, got {arg_string!r}"
            raise

    def error(self, message: str) -> NoReturn:
        """Exit with code 2 and one line."""
        self.exit(2, f"{self.prog}: error: {message}\n")


def described(function: Callable[..., Any]) -> tuple[str, dict[str, str]]:
    """What a docstring says, and what it says of each parameter, in a line."""
    about, *sections = re.split(r"\n\n(?=\w+\n---)", cleandoc(function.__doc__ or _UNTOLD))
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
    model : int
        That is taken where neither a file nor options tell one.
    """

    tables: tuple[str, ...]
    flag: str = "--scenario"
    model: int = 1

    def add_to(self, parser: Parser, _: Mapping[str, str]) -> None:
        """Add the options for the file and for the quantities, a group for each table."""
        how: dict[str, Any] = {} if self.flag.startswith("-") else {"nargs": "?"}
        about = "scenario, .toml or -, or a stored run to repeat, .npz"
        parser.add_argument(self.flag, **file(existing, help=about), **how)
        for table in self.tables:
            group = parser.add_argument_group(table or "problem", SECTIONS[table].about)
            for quantity in of_table(table).values():
                usual = self.model if quantity.key == "model" else quantity.default
                group.add_argument(quantity.flag, **_how(quantity._replace(default=usual)))

    def value(self, given: Mapping[str, Any]) -> Any:
        """What is told of the scenario."""
        from validation.commands.options import Problem

        named = {key: given[key] for key in QUANTITIES if given.get(key) is not None}
        return Problem(file=given["scenario"], named=named, model=self.model)


class Group:
    """Group of options that are parameters of a function, or fields of a data class.

    Parameters
    ----------
    whole : callable
    *names : str
        Of the parameters; by default all.
    """

    def __init__(self, whole: Callable[..., Any], *names: str) -> None:
        known = signature(whole).parameters
        # A command may take an output itself; of what a class inherits, it may say more.
        _, self._meanings = described(Result.deliver)
        for each in reversed(getattr(whole, "__mro__", (whole,))):
            self._meanings |= described(each)[1]
        self._parts = [(known[name], _keywords(known[name].annotation)) for name in names or known]

    def add_to(self, parser: Parser, further: Mapping[str, str] = MappingProxyType({})) -> None:
        """Add the options; what a command says of one itself comes first."""
        meanings = {**self._meanings, **further}
        for parameter, how in self._parts:
            if isinstance(how, OfScenario | Group):
                how.add_to(parser, meanings)
            elif all(each.dest != parameter.name for each in parser.actions):
                _add(parser, parameter, how, meanings.get(parameter.name, ""))

    def value(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """What is given, by name."""
        found = {
            parameter.name: given[parameter.name] if isinstance(how, dict) else how.value(given)
            for parameter, how in self._parts
        }
        return {name: value for name, value in found.items() if value is not None}


def _add(parser: Parser, parameter: Parameter, how: dict[str, Any], meaning: str) -> None:
    """Add the option for a parameter of a function, or the argument for a positional one."""
    name, default = parameter.name, parameter.default
    about = [meaning]
    if "metavar" in how and "choices" in how:
        about.append(", ".join(how["choices"]))
    text = ": ".join(filter(None, about))
    if default not in (None, "", (), Parameter.empty) and default is not False:
        text += f" ({default[0] if isinstance(default, tuple) else short(default)})"
    how = how | {"help": text.replace("%", "%%")}
    if default is not Parameter.empty:
        # Text is looked at as if it were given.
        how["default"] = str(default) if isinstance(default, Path) else default
    if parameter.kind is Parameter.KEYWORD_ONLY:
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(flag, required=default is Parameter.empty, **how)
    else:
        parser.add_argument(name, **how)


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
        self.about, _ = described(function)
        self._options = Group(function)
        returned = signature(function).return_annotation
        found = _OUTPUTS if returned is Result else _keywords(returned)
        self._outputs = found if isinstance(found, Group) else None

    @property
    def title(self) -> str:
        """What it does, in a line."""
        return self.about.partition("\n")[0]

    def parser(self) -> Parser:
        """Parser of the command."""
        parser = Parser(prog=f"tippedisk {self.name}", description=self.about)
        self._options.add_to(parser)
        if self._outputs:
            self._outputs.add_to(parser)
        arguments = [each for each in parser.actions if not each.option_strings]
        names = "".join(_SHOWN[each.nargs].format(each.metavar) for each in arguments)
        parser.usage = f"tippedisk {self.name} [OPTION ...]{names}"
        return parser

    def call(self, function: Callable[..., Any], given: Mapping[str, Any]) -> int:
        """Exit code of the command, whose result goes where the options say."""
        found = function(**self._options.value(given))
        return int(found.deliver(**self._outputs.value(given))) if self._outputs else 0


def _how(quantity: Quantity) -> dict[str, Any]:
    """Option of a quantity; its value stays text until it is read."""
    unit = f", in {quantity.unit}" if quantity.unit else ""
    usual = f" ({quantity.shown_default})" if quantity.shown_default else ""
    # Others than these may be given, or several of them, so that nothing else lists them.
    is_open = quantity.key in ("constraints", "friction.law", "disk.body")
    names = f"; names: {quantity.allowed}" if is_open else ""
    about = f"{quantity.meaning}{names}{unit}{usual}".replace("%", "%%")
    how: dict[str, Any] = {"dest": quantity.key, "help": about}
    if quantity.is_switch:
        return how | {"action": argparse.BooleanOptionalAction}
    if quantity.choices and not is_open:
        return how | {"choices": list(map(str, quantity.choices))}
    return how | {"metavar": quantity.metavar}


# --- Commands ------------------------------------------------------------------------------------


@cache
def commands() -> tuple[Command, ...]:
    """All of them, in the order of the help."""
    return tuple(each for module in _MODULES for each in _declared(module))


def _declared(module: str) -> Iterator[Command]:
    """Commands of a module, of whose functions the names, parameters and docstrings are kept."""
    tree = ast.parse(Path(*package.__path__, f"{module}.py").read_text(encoding="utf-8"))
    functions = [each for each in tree.body if isinstance(each, ast.FunctionDef)]
    public = [each for each in functions if not each.name.startswith("_")]
    for each in public:
        each.body = each.body[:1]
    imports = [each for each in tree.body if isinstance(each, ast.ImportFrom)]
    light = [each for each in imports if (each.module or "").startswith(_LIGHT)]
    names: dict[str, Any] = {}
    exec(compile(ast.Module([*light, *public], []), module, "exec"), names)  # noqa: S102
    yield from (Command(module, names[each.name]) for each in public)


def parsed(words: Sequence[str]) -> tuple[Command, argparse.Namespace]:
    """Command and options of a call; `SystemExit` if it is a wrong one or asks for help."""
    known = {each.name: each for each in commands()}
    if words and (command := known.get(words[0])):
        return command, command.parser().parse_args(words[1:])
    _top(known).parse_args(list(words[:1]))
    raise AssertionError("a call without a command is refused, or help")


def _top(known: Mapping[str, Command]) -> Parser:
    """Parser of what stands before a command, or in its place."""
    about = cleandoc(package.__doc__ or _UNTOLD)
    lines = (f"  {name:16s}{_as_in_help(each.title)}" for name, each in known.items())
    top = Parser(
        prog="tippedisk",
        usage="tippedisk [-h] [--version] COMMAND ...",
        description=about.format(commands="\n".join(lines)),
    )
    top.add_argument("--version", action=_Version, nargs=0, help="print the version")
    top.add_argument("command", choices=list(known), metavar="COMMAND")
    return top


class _Version(argparse.Action):
    """Print the version, which takes as long to find out as all else."""

    def __call__(self, parser: Any, *_: Any) -> None:
        from importlib.metadata import version

        print(f"tippedisk {version('tippedisk')}")
        parser.exit()


def flag_of(argument: str, options: Iterable[tuple[str, Any]]) -> str:
    """The given option that an argument comes from, if there is one.

    Parameters
    ----------
    argument : str
        As an `ArgumentError` names it.
    options : iterable of (str, value)
        Keys of quantities, or names, and what is given for them.
    """
    near, part = "", KEYS.get(argument, argument).partition(".")[0]
    for key, value in options:
        table, _, name = key.rpartition(".")
        if value is None or value is False:
            continue
        flag = QUANTITIES[key].flag if key in QUANTITIES else f"--{name.replace('_', '-')}"
        if argument in (key, name, f"{name}s"):
            return flag
        # What is refused may follow from what is given of its table: a mass from a radius, a
        # parameter from the law. The contact is refused for the constraints that it cannot take,
        # and those of a command for the body.
        is_model = part in ("contact", "constraints") and key in ("model", "constraints")
        is_body = part == "constraints" and key == "disk.body"
        if (argument and part == table) or is_model or is_body:
            near = near or flag
    return near
