"""Calls of the engine: silent, with their own errors, and what Python raises comes through."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

import exudyn as exu
import numpy as np

from analysis.solve.stepping import SolverError

_PASSED_ON = (exu.ExudynError, SystemError)
"""What an error within the engine becomes: one of its own, or the interpreter's complaint about an
interrupt that the engine saw between user functions and did not raise."""

ABSURD = 1e12
"""Size of a coordinate or rate of the engine that no motion has; a step that was too long does."""


_OF_MATH = (
    "math domain error",
    "math range error",
    *(f"expected a {kind}" for kind in ("finite input", "nonnegative input", "number in range")),
)
"""How messages of Python's functions about infinite numbers begin, from 3.14 on the last ones. A
step that was too long calls a user function there; the engine may be back at the start of the step
when that is seen here."""


_LOCK, _callers = Lock(), list[bool]()
"""For each call on the way, in any thread, whether the engine printed before the first of them."""


class Ended(Exception):  # noqa: N818 - nothing is wrong
    """What a user function raises to end a run; the engine reports it as an error of its own."""


class EngineError(ArithmeticError):
    """The engine ended a run early, or gave up on the way."""


class SingularError(ArithmeticError):
    """The equations of motion have no solution in a state."""


def quiet() -> Any:
    """Settings with which the engine prints nothing, writes nothing, and guesses nothing."""
    settings = exu.SimulationSettings()
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
    settings.solution.file.write = False
    return settings


@contextmanager
def solving(system: Any) -> Iterator[None]:
    """Keep the engine from printing, and pass on what its user functions raise.

    The engine turns that into an error of its own: an interrupt, or the failure of a friction
    law, would be taken for a step too long.

    Parameters
    ----------
    system : exudyn.MainSystem

    Raises
    ------
    BaseException
        As a user function has raised it.
    exudyn.ExudynError
        If the engine itself has failed, or a user function raised `Ended` or could not make sense
        of a state that is `ABSURD`.
    """
    with _LOCK:
        _callers.append(_callers[0] if _callers else exu.config.printToConsole)
        exu.config.printToConsole = False
    try:
        yield
    except _PASSED_ON as error:
        raised = _raised(error)
        if raised is None or isinstance(raised, Ended):
            raise
        if isinstance(raised, ValueError | ArithmeticError) and (
            str(raised.__cause__ or raised).startswith(_OF_MATH) or _is_absurd(system)
        ):
            raise exu.SolverError("a step was so long that the motion exploded") from error
        raise raised from None
    finally:
        with _LOCK:
            printed = _callers.pop()
            exu.config.printToConsole = printed and not _callers


@contextmanager
def stepping(system: Any) -> Iterator[None]:
    """The same for a run on the engine's accelerations.

    Raises
    ------
    EngineError
        If the engine or the solver has failed, or the equations are singular.
    """
    try:
        with solving(system):
            yield
    except (SolverError, SingularError, exu.ExudynError) as error:
        raise EngineError(f"run on the engine's accelerations: {cause_of(error)}") from error


def cause_of(error: Exception) -> str:
    """What an error of the engine says, without where it was raised."""
    raised = _raised(error)
    said = str(raised if isinstance(raised, Ended) else error)
    return said.split(" [Python file", maxsplit=1)[0].strip().splitlines()[0]


def _raised(error: BaseException) -> BaseException | None:
    """What a user function raised that made the engine fail, through all calls in between."""
    cause: BaseException | None = error
    while isinstance(cause, _PASSED_ON):
        cause = cause.__cause__
    return cause


def _is_absurd(system: Any) -> bool:
    data = system.systemData
    state = np.concatenate((data.GetODE2Coordinates(), data.GetODE2Coordinates_t()))
    return not bool(np.all(np.abs(state) < ABSURD))
