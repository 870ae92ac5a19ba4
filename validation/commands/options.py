"""From options of the command line, which several subcommands share, to what they mean."""

import argparse
from pathlib import Path
from tempfile import TemporaryFile

from analysis.data.checks import number, positive, within
from analysis.data.limits import LONGEST_MOTION, SHORTEST_STEP, Effort
from validation.kit.progress import say

PATIENCE = 60.0
"""Processor time in s from which on a run is announced before it starts."""


def announce(command: str, effort: Effort, time_limit: float | None = None) -> None:
    """Say on standard error what a run will take, if that is long and nothing ends it, or in vain.

    Parameters
    ----------
    command : str
        Name of the subcommand.
    effort : Effort
    time_limit : float, optional
        Processor time in s that the run may take.

    Raises
    ------
    ValueError
        If the run would take more steps than are made.
    """
    effort.check()
    endless = effort.seconds > PATIENCE and time_limit is None
    if endless or effort.doubt:
        hint = "; --time-limit ends it early" if endless else ""
        say(f"tippedisk {command}: {effort}{hint}")


def output_folder(name: str, value: str) -> Path:
    """Folder to write to, made if it does not exist.

    Parameters
    ----------
    name : str
        Name of the option.
    value : str
        What was given.

    Raises
    ------
    ValueError
        If it cannot be made or written to.
    """
    path = Path(value)
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise ValueError(
            f"{name} must be a folder that can be written to, got {value!r} ({error.strerror})"
        ) from error
    return path


def written_number(name: str, text: str) -> float:
    """Finite number from the text of an option.

    Raises
    ------
    ValueError
        If it is none.
    """
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"{name} must be a finite number, got {text!r}") from None
    return number(name, value)


def chosen_end(options: argparse.Namespace, least: float = SHORTEST_STEP) -> float:
    """Time in s from --end.

    Parameters
    ----------
    options : argparse.Namespace
    least : float
        In s, such as the spacing of the samples.

    Raises
    ------
    ValueError
        If it is not positive, below `least` or beyond `LONGEST_MOTION`.
    """
    return within("--end", positive("--end", options.end), least, LONGEST_MOTION)
