"""The commands: every public function of the modules of `validation.commands`.

A signature says what a command takes, its docstring what the help prints. Both are read from the
source, since importing those modules loads NumPy and the engine, for which no help should wait.
"""

import ast
from argparse import Action, Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from validation.parser.options import Command, Parser

_FOLDER = Path(__file__).parent.parent / "commands"

_MODULES = (
    *("studies", "simulate", "show", "scenario", "sweep", "maps", "stability", "nonlinear"),
    *("scene", "animate", "completion"),
)
"""In the order of the help."""

_LIGHT = ("pathlib", "typing", "validation.commands.output", "validation.parser")
"""Modules from which signatures have their names."""


def commands() -> list[Command]:
    """All of them, in the order of the help."""
    return [each for module in _MODULES for each in _declared(module, _text(module))]


def _text(module: str) -> str:
    return (_FOLDER / f"{module}.py").read_text(encoding="utf-8")


def _declared(module: str, text: str) -> Iterator[Command]:
    """Commands of a module, of whose functions the names, parameters and docstrings are kept."""
    tree = ast.parse(text)
    functions = [each for each in tree.body if isinstance(each, ast.FunctionDef)]
    public = [each for each in functions if not each.name.startswith("_")]
    for each in public:
        each.body = each.body[:1]
    imports = [each for each in tree.body if isinstance(each, ast.ImportFrom)]
    light = [each for each in imports if (each.module or "").startswith(_LIGHT)]
    names: dict[str, Any] = {}
    exec(compile(ast.Module([*light, *public], []), module, "exec"), names)  # noqa: S102
    yield from (Command(module, names[each.name]) for each in public)


def _find(name: str) -> Command | None:
    """The command of a name, for which the module that has it alone is parsed."""
    for module in _MODULES:
        if f"\ndef {name}(" in (text := _text(module)):
            return next((each for each in _declared(module, text) if each.name == name), None)
    return None


def parsed(words: Sequence[str]) -> tuple[Command, Namespace]:
    """Command and options of a call; `SystemExit` if it is a wrong one or asks for help."""
    for word in words:
        name, _, value = word.partition("=")
        if name.startswith("--") and value == "--":
            # Taken for the end of the options, it would leave a list without a value.
            _top().error(f"argument {name}: expected a value behind =, got '--'")
    if words and (command := _find(words[0])):
        return command, command.parser().parse_args(words[1:])
    _top().parse_args(list(words[:1]))
    raise AssertionError("a call without a command is refused, or help")


def _top() -> Parser:
    """Parser of what stands before a command, or in its place."""
    about, found = ast.get_docstring(ast.parse(_text("__init__"))), commands()
    top = Parser(
        prog="tippedisk",
        usage="tippedisk [-h] [--version] COMMAND ...",
        description=(about or "").format(commands="\n".join(map(_line, found))),
    )
    top.add_argument("--version", action=_Version, nargs=0, help="print the version")
    top.add_argument("command", choices=[each.name for each in found], metavar="COMMAND")
    return top


class _Version(Action):
    """Print the version, which takes as long to find out as all else."""

    def __call__(self, parser: Any, *_: Any) -> None:
        from importlib.metadata import version  # noqa: PLC0415

        print(f"tippedisk {version('tippedisk')}")  # noqa: T201
        parser.exit()


def _line(command: Command) -> str:
    first = command.about.partition("\n")[0].rstrip(".")
    return f"  {command.name:16s}{first[0].lower()}{first[1:]}"
