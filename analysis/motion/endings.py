"""Why a motion ends, and what a run can be told to end at."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from analysis.problem.checks import choice, number, several
from analysis.problem.elementary import sin
from analysis.problem.names import ArgumentError
from analysis.problem.start import State
from analysis.problem.user_modules import error_text, is_user_name, user_object

CONTACT_WOULD_PULL = "contact would pull"
TIME_LIMIT = "time limit"
FLAT = "flat"
INVERTED = "inverted"
LOST = "lost"
AT_REST = "at rest"

REACHED = 0.9
"""Part of its largest height above the geometric centre from which on the COG is up."""


Condition = Callable[[State], float]
"""From a state to a number; a run ends where that turns negative."""

StopWhen = str | Condition | Iterable[str | Condition]
"""Conditions of one's own, as functions or by the name `module:function`; or names of
`CONDITIONS`."""


def _above(state: State) -> float:
    return sin(state.coordinates[4]) * sin(state.coordinates[5])


def _not_up(state: State) -> float:
    return REACHED - _above(state)


CONDITIONS: dict[str, Condition] = {INVERTED: _not_up, LOST: _above}
"""By name: the first rise of the centre of gravity to `REACHED`, whether it stays there or not;
its first fall from above the geometric centre to below it."""

_SAYING = {
    CONTACT_WOULD_PULL: "beyond, the contact would have to pull",
    FLAT: "the disk lies flat, where its Euler angles end",
    INVERTED: f"the centre of gravity is up, at {REACHED:.0%} of its largest height",
    LOST: "the centre of gravity has come below the geometric centre again",
    AT_REST: "the disk is at rest",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """Why a motion ends before the last time asked for.

    Parameters
    ----------
    reason : str
        "contact would pull": an ideal contact would have to hold the disk down. "flat": the Euler
        angles end. "at rest": see `RestCriterion`. "time limit". "inverted", or the name of the
        condition that the run was told to end at.
    time : float
        Where the motion ends, in s.
    value : float
        Normal force there in N, processor time taken in s, kinetic energy at rest in J; 0 for
        any other condition.

    Raises
    ------
    ValueError
        If the reason is no text or a number is not finite.
    """

    reason: str
    time: float
    value: float

    def __post_init__(self) -> None:
        if not isinstance(self.reason, str) or not self.reason:
            raise ArgumentError("reason", f"must be text, got {self.reason!r}")
        for name in ("time", "value"):
            value = number(name, getattr(self, name))
            object.__setattr__(self, name, value)

    def __str__(self) -> str:
        if self.reason == TIME_LIMIT:
            return f"ended at t = {self.time:.6g} s: time limit, after {self.value:.3g} s"
        saying = _SAYING.get(self.reason, self.reason)
        return f"ended at t = {self.time:.9g} s: {saying}"


LEAST = 1e-300
"""What lies below all numbers that a condition says but zero,"""

ROUNDING = 1e-12
"""and what one of one's own says, in its unit, that may be zero but for rounding: a state may have
been taken back from a rotation."""


@dataclass(frozen=True, slots=True)
class Turning:
    """A condition to which zero is negative.

    A motion may start on one, such as that the tilt rate turns negative, on which it ends when it
    comes back.

    Parameters
    ----------
    condition : callable
    """

    condition: Condition

    def __call__(self, state: State) -> float:
        """What it says of a state; `ArgumentError` if that is no finite number.

        A state of symbols may be answered with one.
        """
        is_named = self.condition in CONDITIONS.values()
        try:
            said = self.condition(state)
        except Exception as error:
            error.add_note(f"{self.name} fails: {error_text(error)} for {state}")
            raise
        if isinstance(state.coordinates[0], float):
            try:
                said = number("it", said)
            except ValueError as error:
                raise self.refused(f"{error} for {state}") from error
        return said - (LEAST if is_named else ROUNDING)

    def refused(self, why: str) -> ArgumentError:
        """That it says no number, for some reason."""
        return ArgumentError("stop_when", f"must say a number of a State: {why}", self.name)

    @property
    def name(self) -> str:
        """What to call it in an error."""
        return f"stop_when {_name_of(self.condition)}"


def each_condition(stop_when: StopWhen) -> list[str | Condition]:
    """Conditions one by one, to be gone through as often as wanted; see `named_conditions`."""
    if isinstance(stop_when, str) or not isinstance(stop_when, Iterable):
        return [stop_when]
    return several("stop_when", stop_when, "conditions")


def named_conditions(stop_when: StopWhen, state: State | None = None) -> dict[str, Turning]:
    """Conditions by the reason they give.

    Parameters
    ----------
    stop_when : str, callable or iterable of them
    state : State, optional
        To try them on.

    Raises
    ------
    ValueError
        If a name is unknown, stands for two of them or is that of an ending there is anyway,
        something is neither a name nor callable, or says no number of the state.
    """
    found: dict[str, Turning] = {}
    for each in each_condition(stop_when):
        name, condition = _named(each)
        if found.setdefault(name, Turning(condition)).condition is not condition:
            fault = f"must hold functions of different names, got {name} twice"
            raise ArgumentError("stop_when", fault)
    if state is not None:
        try_conditions(found, state)
    return found


def try_conditions(conditions: Mapping[str, Turning], state: State) -> None:
    """Raise `ValueError` if one of some conditions fails, or says no number of a state."""
    for each in conditions.values():
        try:
            each(state)
        except ArgumentError:
            raise
        except (Exception, SystemExit) as error:
            raise each.refused(error_text(error)) from error


def check_condition_name(name: Any) -> str:
    """Return the name of a condition; `ValueError` if it can be none. Imports nothing."""
    return (
        name if is_user_name(name) else choice("stop_when", name, [*CONDITIONS, "module:function"])
    )


def _named(given: str | Condition) -> tuple[str, Condition]:
    """Name of a condition, which it gives as the reason, and the condition."""
    if isinstance(given, str) and check_condition_name(given) in CONDITIONS:
        return given, CONDITIONS[given]
    condition = user_object("stop_when", given) if isinstance(given, str) else given
    if not callable(condition):
        fault = f"must hold names or functions of a State, got {given!r}"
        raise ArgumentError("stop_when", fault)
    name = _name_of(condition)
    if name in (*_SAYING, TIME_LIMIT):
        fault = f"must hold functions of other names than the endings there are, got {name}"
        raise ArgumentError("stop_when", f"{fault}: rename it")
    return name, condition


def _name_of(condition: Condition) -> str:
    return getattr(condition, "__name__", type(condition).__name__)
