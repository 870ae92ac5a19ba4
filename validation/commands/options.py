"""From options of the command line, which several commands share, to what they mean."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from analysis.problem.checks import Array, positive, within
from analysis.problem.limits import LONGEST_MOTION, MOST_SPINS, SHORTEST_STEP, Effort
from analysis.problem.names import ArgumentError
from validation.kit.progress import say
from validation.sweeps.axes import axis_from

PATIENCE = 60.0
"""Processor time in s from which on a run is announced before it starts."""


def announce(command: str, effort: Effort, time_limit: float | None = None) -> None:
    """Say on standard error what a run will take, if that is long and nothing ends it, or in vain.

    Parameters
    ----------
    command : str
        Name of the command.
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
    ArgumentError
        If it cannot be made or written to.
    """
    path = Path(value)
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        fault = f"must be a folder that can be written to, got {value!r} ({error.strerror})"
        raise ArgumentError(name, fault) from error
    return path


def parse_spins(texts: Sequence[str]) -> Array:
    """Spins in rad/s from values, lists and ranges in any order: each once, shape (n,).

    Parameters
    ----------
    texts : sequence of str
        Each a value, values with commas between, or `first:last:number`; without a number the
        ends alone.

    Raises
    ------
    ArgumentError
        If a text is none of these, or a range is empty or longer than `MOST_SPINS`.
    """
    spins: list[Any] = []
    for text in ",".join(texts).split(","):
        try:
            axis = axis_from("start.spin", text)
            within("number", axis.size or 2, 2 if ":" in text else 1, MOST_SPINS)
        except ValueError as error:
            fault = (
                "must be a value or first:last:number, of different ends and at least 2 and at "
                f"most {MOST_SPINS} spins, got {text!r}"
            )
            raise ArgumentError("spin", fault) from error
        spins += axis.grid or (axis.first, axis.last)
    return np.unique(np.array(spins, dtype=float))


def checked_end(end: float, least: float = SHORTEST_STEP) -> float:
    """Time in s from --end.

    Parameters
    ----------
    end : float
    least : float
        In s, such as the spacing of the samples.

    Raises
    ------
    ArgumentError
        If it is not positive, below `least` or beyond `LONGEST_MOTION`.
    """
    return within("end", positive("end", end), least, LONGEST_MOTION)
