"""The command line as a whole: which command a call is for, and its options."""

from argparse import Action, Namespace, RawDescriptionHelpFormatter
from collections.abc import Sequence
from typing import Any

from validation.parser.commands import COMMANDS
from validation.parser.options import Command, Parser

_ABOUT = """\
The tippedisk: a rigid disk whose centre of gravity lies off its centre. Spun fast about an
in-plane axis on a table, it turns itself upside down through friction.

Models 1 to 4 each add a constraint: 1 the disk stays on the table, 2 its centre of gravity
stays above one point, 3 it does not slip along its edge, 4 its spin is constant; other sets of
constraints go as well. Each runs in the multibody engine Exudyn (--source engine) and in
independent in-house equations (--source in-house).

commands:
"""

_EXAMPLES = """\

examples:
  tippedisk report                                   everything, as two pages in ./report
  tippedisk simulate --model 1 --out engine.npz      the engine, from the paper's start
  tippedisk simulate --model 1 --source in-house --out equations.npz
  tippedisk show engine.npz equations.npz --plot compare.png
  tippedisk scenario > my.toml                       the whole problem as a file, to be changed
  tippedisk simulate --scenario my.toml --out mine.npz
  tippedisk check --scenario my.toml                 do engine and equations agree on it?
  tippedisk simulate --inclination 2deg --law tanh --gamma -pi/2+0.3 --out slope.npz
  tippedisk sweep spin=25:45:41 mu=0.1,0.3 --out inversion.db
  tippedisk map spin-friction                        who inverts, refined where it changes
  tippedisk eigenvalues --system full --spin 0:50:501 --plot figure-6.png
  tippedisk critical --system full                   where eigenvalues cross, where it is stable
  tippedisk rest --rolling 1e-3 --pivoting 5e-5 --plot rest.png
  tippedisk animate engine.npz                       a page that plays the motion
  tippedisk play                                     a page on which the disk is spun by hand

Each command has its own --help. Every switch has a --no-SWITCH, and `-` is standard output.

exit codes:
   0  done
   1  a check fails, or a run
   2  refused: one line says what is allowed
   3  done, all files are written, but standard output could not be written to
  70  a fault of this program, or of a module of your own

`python -m validation` is the same command.
"""


def parsed(words: Sequence[str]) -> Namespace:
    """Options of a call; `SystemExit` if it is a wrong one or asks for help."""
    by_name = {command.name: command for command in COMMANDS}
    for word in words:
        name, _, value = word.partition("=")
        if name.startswith("--") and value == "--":
            # Taken for the end of the options, it would leave a list without a value.
            _top().error(f"argument {name}: expected a value behind =, got '--'")
    if words and words[0] in by_name:
        return by_name[words[0]].parser().parse_args(words[1:])
    _top().parse_args(list(words[:1]))
    raise AssertionError("a call without a command is refused, or help")


def _top() -> Parser:
    """Parser of what stands before a command, or in its place."""
    top = Parser(
        prog="tippedisk",
        usage="tippedisk [-h] [--version] COMMAND ...",
        description=_ABOUT + "".join(map(_line, COMMANDS)) + _EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action=_Version, nargs=0, help="print the version")
    top.add_argument("command", choices=[each.name for each in COMMANDS], metavar="COMMAND")
    return top


class _Version(Action):
    """Print the version, which takes as long to find out as all else."""

    def __call__(self, parser: Any, *_: Any) -> None:
        from importlib.metadata import version  # noqa: PLC0415

        print(f"tippedisk {version('tippedisk')}")  # noqa: T201
        parser.exit()


def _line(command: Command) -> str:
    first = command.about.partition("\n")[0].rstrip(".")
    return f"  {command.name:16s}{first[0].lower()}{first[1:]}\n"
