"""Initial value problems, solved step by step with SciPy, watched on the way.

`scipy.integrate.solve_ivp` throws away what it has reached when it is stopped from outside, so
its solvers are stepped here.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import asin
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy.integrate import BDF, DOP853, LSODA, RK23, RK45, Radau
from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, TIME_LIMIT
from analysis.data.limits import LEAST_TILT
from analysis.data.watch import Watch

Method = Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor"]
METHODS: tuple[Method, ...] = get_args(Method)

_SOLVERS: dict[str, Any] = {
    "DOP853": DOP853,
    "RK45": RK45,
    "RK23": RK23,
    "Radau": Radau,
    "BDF": BDF,
    "LSODA": LSODA,
}


NEARLY_FLAT = LEAST_TILT
"""Sine of the angle between disk and table at which a motion in Euler angles ends."""


@dataclass(frozen=True, slots=True, eq=False)
class InitialValueProblem:
    """An initial value problem of the disk.

    Parameters
    ----------
    right_hand_side : callable
        Time derivative of the state from time and state.
    start : ndarray, shape (n,)
    leaning : callable
        From a state to the sine of the angle between disk and table.
    normal_force : callable
        From a state to the normal contact force in N.
    longest_step : float
        In s.
    conditions : mapping
        From reasons to functions of a state; the motion ends where one turns negative.
    """

    right_hand_side: Callable[[float, Array], npt.ArrayLike]
    start: Array
    leaning: Callable[[Array], float]
    normal_force: Callable[[Array], float]
    longest_step: float
    conditions: Mapping[str, Callable[[Array], float]] = field(default_factory=dict)

    def with_steps_up_to(self, part: float) -> "InitialValueProblem":
        """The same problem with this part of its longest step."""
        return self if part == 1.0 else replace(self, longest_step=part * self.longest_step)


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one integration has reached.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Those asked for, up to where the run ended, and the time of that ending.
    states : ndarray, shape (n, m)
    evaluations : int
        Of the right-hand side.
    ended : str or None
        Why it ended before the last time asked for.
    value : float
        What the condition that ended it says there.
    pulling : tuple of pairs of floats
        Times in s between which the contact has pulled.
    """

    times: Array
    states: Array
    evaluations: int
    ended: str | None
    pulling: tuple[tuple[float, float], ...]
    value: float = 0.0


def integrate(
    problem: InitialValueProblem,
    times: Array,
    method: Method,
    local_tolerance: float,
    *,
    allow_pulling: bool,
    watch: Watch,
) -> Run:
    """Integrate a problem and sample it at `times`.

    Parameters
    ----------
    problem : InitialValueProblem
    times : ndarray, shape (n,)
        Increasing; the start is at the first.
    method : str
        One of `METHODS`.
    local_tolerance : float
        Relative and absolute tolerance of a step.
    allow_pulling : bool
        Whether to go on where the normal force turns negative.
    watch : Watch

    Raises
    ------
    ArithmeticError
        If the solver gives up.
    ToleranceError
        If the call is out of steps.
    ValueError
        If the contact would have to pull at the start and must not.
    """
    lookout = _Lookout(problem, float(times[0]), allow_pulling)
    solver = _SOLVERS[method](
        problem.right_hand_side,
        times[0],
        problem.start,
        times[-1],
        rtol=local_tolerance,
        atol=local_tolerance,
        max_step=problem.longest_step,
        **_jacobian(problem, method),
    )
    ended: str | None = None
    states, row = [problem.start], 1
    while row < times.size and ended is None:
        message = solver.step()
        watch.steps += 1
        if not watch.steps_left:
            watch.flattest = (solver.t, asin(min(1.0, problem.leaning(solver.y))))
            raise watch.given_up(method)
        if solver.status == "failed":
            raise ArithmeticError(f"{method} stopped after t = {solver.t:g} s: {message}")
        within = times[row : np.searchsorted(times, solver.t, side="right")]
        for moment, state in _states(solver, within):
            if lookout.ends(moment, state, solver):
                ended = lookout.reason
                break
            if row < times.size and moment == times[row]:
                states.append(state)
                row += 1
        else:
            if watch.is_over(solver.t, times[-1]) and row < times.size:
                ended = TIME_LIMIT
    reached = times[:row]
    if ended is not None:
        last, state = lookout.end or (solver.t, solver.y)
        if last > reached[-1]:
            reached = np.append(reached, last)
            states.append(state)
    return Run(
        reached,
        np.array(states),
        _evaluations(solver),
        ended,
        lookout.pulling(reached[-1]),
        lookout.value,
    )


def _evaluations(solver: Any) -> int:
    """Evaluations of the right-hand side, those for `_jacobian` among them."""
    jacobians = solver.njev if isinstance(solver, (BDF, Radau)) else 0
    return int(solver.nfev + jacobians * (1 + solver.n))


def _jacobian(problem: InitialValueProblem, method: Method) -> dict[str, Any]:
    """Jacobian of the right-hand side by forward differences, for the methods that take one.

    SciPy's own widens its steps for ever along coordinates that the right-hand side does not
    depend on, such as alpha, until they overflow.
    """
    if method not in {"Radau", "BDF"}:
        return {}

    def jacobian(moment: float, state: Array) -> Array:
        base = np.asarray(problem.right_hand_side(moment, state))
        columns = []
        for index, value in enumerate(state):
            moved = state.copy()
            moved[index] += 1e-8 * max(1.0, abs(value))
            step = moved[index] - value
            columns.append((np.asarray(problem.right_hand_side(moment, moved)) - base) / step)
        return np.column_stack(columns)

    return {"jac": jacobian}


def _states(solver: Any, within: Array) -> Iterator[tuple[float, Array]]:
    """Times and states within the last step, and those at its end."""
    before = within[within < solver.t]
    if before.size:
        yield from zip(before.tolist(), solver.dense_output()(before).T, strict=True)
    yield solver.t, solver.y


def pulls_at_start(problem: InitialValueProblem, *, allow_pulling: bool) -> bool:
    """Whether the contact pulls at the start; `ValueError` if it does and must not."""
    force = problem.normal_force(problem.start)
    if force < 0.0 and not allow_pulling:
        raise ValueError(
            f"start needs a contact that pulls, with a normal force of {force:.3g} N; "
            "allow_pulling lets it"
        )
    return force < 0.0


def endings(problem: InitialValueProblem) -> dict[str, Callable[[Array], float]]:
    """What ends a motion: functions of its state that turn negative there, by reason."""
    return {
        FLAT: lambda state: problem.leaning(state) - NEARLY_FLAT,
        CONTACT_WOULD_PULL: problem.normal_force,
        **problem.conditions,
    }


def intervals(edges: list[float], last: float) -> tuple[tuple[float, float], ...]:
    """Intervals between edges in turns, the last one open up to `last`."""
    closed = [*edges, last] if len(edges) % 2 else edges
    return tuple(zip(closed[::2], closed[1::2], strict=True))


class _Lookout:
    """Looks out for what ends a motion, and for a contact that pulls.

    Parameters
    ----------
    problem : InitialValueProblem
    begin : float
        Time of the start in s.
    allow_pulling : bool

    Attributes
    ----------
    reason : str
        Why the motion ends.
    end : tuple of time and state, or None
        Where it does.
    value : float
        What the condition says there.
    """

    def __init__(self, problem: InitialValueProblem, begin: float, allow_pulling: bool) -> None:
        pulls = pulls_at_start(problem, allow_pulling=allow_pulling)
        self._conditions = endings(problem)
        self._allow, self._time = allow_pulling, begin
        self._values = {name: says(problem.start) for name, says in self._conditions.items()}
        self._edges = [begin] if pulls else []
        self.reason, self.value = "", 0.0
        self.end: tuple[float, Array] | None = None

    def ends(self, moment: float, state: Array, solver: Any) -> bool:
        """Look at a state within the last step; returns whether the motion ends up to there."""
        if moment <= self._time:
            return False
        crossings: list[tuple[float, str]] = []
        for name, says in self._conditions.items():
            before, here = self._values[name], says(state)
            self._values[name] = here
            crosses = here < 0.0 <= before
            lets = self._allow and name == CONTACT_WOULD_PULL
            if crosses or (lets and before < 0.0 <= here):
                path = solver.dense_output()
                edge = _root(_along(path, says), self._time, moment)
                if lets:
                    self._edges.append(edge)
                else:
                    crossings.append((edge, name))
        self._time = moment
        if not crossings:
            return False
        edge, self.reason = min(crossings)
        self.end = (edge, solver.dense_output()(edge))
        self.value = self._conditions[self.reason](self.end[1])
        return True

    def pulling(self, last: float) -> tuple[tuple[float, float], ...]:
        """Times between which the contact has pulled, up to `last`."""
        return intervals(self._edges, last)


def _along(path: Any, function: Callable[[Array], float]) -> Callable[[float], float]:
    """Function of the state as one of time, over the last step of a solver."""
    return lambda time: function(path(time))


def _root(function: Callable[[float], float], first: float, last: float) -> float:
    """Where a function that is not negative at `first` and not positive at `last` is zero."""
    if function(first) * function(last) >= 0.0:
        return last
    return float(brentq(function, first, last, xtol=1e-14, rtol=1e-14))
