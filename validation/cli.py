"""The command line.

Importing this module and building the parser loads neither NumPy nor the engine, so that `--help`
and wrong calls answer at once; each subcommand imports what it needs when it runs.
"""

import os
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from importlib import import_module
from io import StringIO
from pathlib import Path
from traceback import format_exc
from typing import Any, TextIO

from analysis.problem.names import ArgumentError, OutputLostError
from analysis.problem.user_modules import fault_of
from validation.parser.commands import flag_of, parsed
from validation.parser.files import STANDARD_INPUT

_OUTPUT_LOST = 3
"""Exit code of a command that did its work and could not say so."""

_FAILED, _REFUSED, _FAULT, _INTERRUPTED = 1, 2, 70, 130
"""Exit codes: a run failed, the call was refused, this program is at fault, it was interrupted."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of the process.

    Returns
    -------
    int
        Exit code, as `--help` lists them.
    """
    if sys.stderr is None:
        # Closed before the start. Progress bars and warnings take for granted that there is one.
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115
    # What is printed is kept until the work is done: a full disk or a closed pipe then cannot be
    # taken for a failure of the work itself.
    output = StringIO()
    with redirect_stdout(output):
        code = _run(arguments)
    if not _deliver(output.getvalue()):
        code = code or _OUTPUT_LOST
    try:
        sys.stderr.flush()
    except (OSError, ValueError):
        _give_up(sys.stderr)
    return code


def _run(arguments: Sequence[str] | None) -> int:
    try:
        command, options = parsed(sys.argv[1:] if arguments is None else arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    name, given = f"tippedisk {command.name}", vars(options)
    path = sys.path.copy()
    try:
        # Laws, bodies and conditions of one's own may lie in the working directory.
        sys.path.append("")
        # Imported late: the commands bring NumPy, SciPy and the engine along.
        module = import_module(f"validation.commands.{command.module}")
        with _warnings_in_a_line(name), _text_beside(given):
            return command.call(getattr(module, command.name), given)
    except (ValueError, ArithmeticError, OSError, MemoryError, ImportError) as error:
        message = " ".join(fault_of(error).split()) or "not enough memory"
        flag = flag_of(getattr(error, "argument", ""), given.items())
        _complain(f"{name}: error: {flag and f'{flag}: '}{message}")
        if isinstance(error, OutputLostError):
            return _OUTPUT_LOST
        return _REFUSED if isinstance(error, ValueError | OSError | ImportError) else _FAILED
    except (Exception, SystemExit):  # noqa: BLE001 - whatever it is, it is no result
        # A law of one's own, or this program, is at fault: where, the traceback says.
        _complain(format_exc().rstrip())
        return _FAULT
    except KeyboardInterrupt as stop:
        _complain(": ".join([name, "interrupted", *map(str, stop.args)]))
        return _INTERRUPTED
    finally:
        sys.path[:] = path


@contextmanager
def _warnings_in_a_line(name: str) -> Iterator[None]:
    """Say of a number that looks as if it were meant in another unit, once, and go on."""
    from analysis.problem.values import UnitWarning

    shown = warnings.showwarning

    def show(message: Any, category: type[Warning], *place: Any) -> None:
        if category is UnitWarning:
            _complain(f"{name}: {message}")
        else:
            shown(message, category, *place)

    with warnings.catch_warnings():
        warnings.simplefilter("once", UnitWarning)
        warnings.showwarning = show  # type: ignore[assignment] # the places are passed on
        yield


@contextmanager
def _text_beside(given: Mapping[str, Any]) -> Iterator[None]:
    """What is printed goes to standard error where standard output is to take a file.

    Raises
    ------
    ArgumentError
        If it is to take more than one, or JSON, too.
    """
    from analysis.motion.files import is_standard_output

    paths = {name: each for name, each in given.items() if isinstance(each, Path)}
    # On a terminal, standard input is the same device.
    taking = [
        name for name, each in paths.items() if each != STANDARD_INPUT and is_standard_output(each)
    ]
    if taking and len(taking) + bool(given.get("json")) > 1:
        fault = "must lead elsewhere: standard output takes one file, or JSON"
        raise ArgumentError(taking[-1], fault)
    beside = StringIO()
    try:
        with redirect_stdout(beside if taking else sys.stdout):
            yield
    finally:
        if text := beside.getvalue().rstrip():
            _complain(text)


def _deliver(text: str) -> bool:
    """Write to standard output; whether that worked."""
    if not text:
        return True
    if sys.stdout is None:
        _complain("tippedisk: standard output is closed; what was to be printed is lost")
        return False
    try:
        # What an output cannot show, such as λ in ASCII, is replaced; all else is worth having.
        encoding = sys.stdout.encoding or "utf-8"
        sys.stdout.write(text.encode(encoding, "replace").decode(encoding))
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        _complain(f"tippedisk: standard output could not be written to: {error}")
        _give_up(sys.stdout)
        return False
    return True


def _give_up(stream: TextIO) -> None:
    """Let a stream that cannot be written to lead nowhere.

    Or the interpreter would try again at its end, fail, and exit with a code of its own.
    """
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _complain(message: str) -> None:
    with suppress(OSError, ValueError):
        print(message, file=sys.stderr, flush=True)
