"""Options of the command line: of the scenario, of a run, of what becomes of the result."""

import argparse
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from inspect import cleandoc
from typing import Any, NamedTuple, NoReturn

from analysis.data.names import nearest
from analysis.data.quantities import QUANTITIES, SECTIONS, Quantity, of_table, short
from validation.parser.paths import PICTURES, existing, writable
from validation.parser.runs import OPTIONS

_NEGATIVE = re.compile(r"-(\d|\.\d|pi)")


class Option(NamedTuple):
    """An option or argument: what `argparse` takes."""

    name: str
    how: dict[str, Any]


Options = Iterable[Option]


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A command.

    Parameters
    ----------
    options : callable
        Makes its options; the name, what it does in a line, and more about it, are those of this
        function and its docstring.
    module : str
        Of `validation.commands`, with the function that does it.
    tables : sequence of str
        Of the scenario whose quantities are options.
    outputs : sequence of str
        Of "json", "csv" and "plot".
    more : str
        What its help ends with.
    """

    options: Callable[[], Options]
    module: str
    tables: Sequence[str] = ()
    outputs: Sequence[str] = ()
    more: str = ""

    @property
    def name(self) -> str:
        """As it is called."""
        return self.options.__name__.strip("_").replace("_", "-")

    @property
    def about(self) -> str:
        """What it does."""
        return cleandoc(self.options.__doc__ or "")

    def parser(self) -> "Parser":
        """Parser of the command."""
        parser = Parser(
            prog=f"tippedisk {self.name}",
            description="\n\n".join(part for part in (self.about, self.more) if part),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        parser.set_defaults(command=self.name, module=self.module)
        names = ""
        for each in (*self.options(), *(OUTPUTS[name] for name in self.outputs)):
            action = parser.add_argument(each.name, **each.how)
            if not action.option_strings:
                names += f" {action.metavar}{' ...' if action.nargs else ''}"
        parser.usage = f"tippedisk {self.name} [OPTION ...]{names}"
        for table in self.tables:
            group = parser.add_argument_group(table or "problem", SECTIONS[table].about)
            for quantity in of_table(table).values():
                group.add_argument(quantity.flag, **_how(quantity))
        return parser


class Parser(argparse.ArgumentParser):
    """Parser whose errors are one line, and tell what a wrong name may stand for."""

    def __init__(self, **how: Any) -> None:
        super().__init__(allow_abbrev=False, **how)
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


def option(name: str, about: str, default: Any = None, *, usual: str = "", **how: Any) -> Option:
    """Option that says its default; its type is that of the default, or a number.

    Parameters
    ----------
    name : str
        With its dashes; without, an argument.
    about : str
    default
        None for what need not be given; a switch is True or False.
    usual : str
        The default in words.
    **how
        Further keywords of `argparse`.
    """
    usual = usual or ("" if default is None or default is False else short(default))
    told = f"{about} ({usual})" if usual else about
    how |= {"help": told.replace("%", "%%"), "default": default}
    if isinstance(default, bool):
        return Option(name, how | {"action": argparse.BooleanOptionalAction})
    if "type" not in how and "choices" not in how:
        how["type"] = float if default is None else type(default)
    if name.startswith("-") and "metavar" not in how and "choices" not in how:
        how["metavar"] = {float: "NUMBER", int: "N"}.get(how["type"], "NAME")
    return Option(name, how)


def of_run(*names: str, **changes: dict[str, Any]) -> list[Option]:
    """Options of a run.

    Parameters
    ----------
    *names
        Of fields of `RunOptions`.
    **changes
        By name, what a command has otherwise: `default`, `about`, `usual`, `choices`.
    """
    found = []
    for name in names:
        field, change = OPTIONS[name], changes.get(name, {})
        about, usual, how = (field.metadata[each] for each in ("about", "usual", "how"))
        told = {"about": about, "default": field.default, "usual": usual} | how | change
        found.append(option(f"--{name.replace('_', '-')}", **told))
    return found


def file(name: str, about: str, kind: Callable[[str], Any], **how: Any) -> Option:
    """Option that takes a path."""
    return option(name, about, type=kind, **({"metavar": "FILE"} | how))


OUTPUTS = {
    "json": option("--json", "print everything as JSON in place of the table", default=False),
    "csv": file("--csv", "write the table with all digits, .csv or -", writable(".csv")),
    "plot": file(
        "--plot", "draw it, .png, .svg, .pdf or -", writable(*PICTURES), metavar="PICTURE"
    ),
}
"""What becomes of a result; without the first two it is printed."""

SCENARIO = file("--scenario", "scenario, .toml, or a stored run to repeat, .npz", existing())

OWN = tuple(
    option(name, f"{about}: imports it", type=str, metavar="MODULE:CLASS")
    for name, about in (
        ("--law", "friction law of one's own that the motion was run with"),
        ("--body", "body of one's own that moved"),
    )
)
"""What a stored motion needs to be read that was run with classes of one's own."""


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
        if argument in (name, f"{name}s"):
            return flag
        # A law takes its parameters along, and a table stands for what is given of it.
        if (argument and argument == table) or (
            name == "law" and f"friction.{argument}" in QUANTITIES
        ):
            near = near or flag
    return near
