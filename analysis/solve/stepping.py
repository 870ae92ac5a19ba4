"""Initial value problems, solved step by step with SciPy, watched on the way.

`scipy.integrate.solve_ivp` throws away what it has reached when it is stopped from outside, so
its solvers are stepped here.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import asin, isfinite, isnan, nan, sin
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import integrate as solvers
from scipy.optimize import brentq

from analysis.motion.endings import CONTACT_WOULD_PULL, TIME_LIMIT, Ending
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.choices import Method
from analysis.problem.friction import LawError
from analysis.problem.scenario import Scenario
from analysis.solve.watch import Lookout, StateFunction, Step, Watch

STILL = 1e-9
"""What has no sign, of a slip in m/s or a force over the weight."""

STALLED = 300
"""Equal steps, shorter than the longest there are, after which LSODA is begun anew: where the
right-hand side has jumped, it may take it for stiff ever after, and go on by picoseconds."""

FIRST = 1e-6
"""Part of the longest step that the first one is where it cannot be guessed."""

PAST = 50
"""Rounding errors of the time by which a solver goes on past a jump of the right-hand side, where
the shortest step there is still changes the state by more than it may. SciPy's steps are 10 of
them long or more, and shrink to a fifth at once."""

TIGHTER = 0.1
"""Power of the tolerance of a step by which the first one is shorter than SciPy guesses it. Its
guess is as long at every tolerance: an error not seen there would cancel between two runs."""

SHORTENED = 16
"""Times that a step is taken a tenth as long before its error is believed."""

ITERATED = 1e-4
"""Part of the error in a step that Newton's iteration may leave where the Jacobian is one of
differences."""

_EXPLICIT = solvers.RK23, solvers.RK45, solvers.DOP853

_IMPLICIT = ("Radau", "BDF")
"""Methods that are given a Jacobian. LSODA makes its own, which for most is faster."""


class SolverError(ArithmeticError):
    """A solver has given up."""


@dataclass(frozen=True, slots=True, eq=False)
class InitialValueProblem:
    """An initial value problem of the disk.

    Parameters
    ----------
    right_hand_side : callable
        Time derivative of the state from time and state.
    start : ndarray, shape (n,)
    longest_step : float
        In s.
    endings : mapping
        From reasons to functions of a state; the motion ends where one turns negative. For `FLAT`
        that is the sine of the angle between disk and table less `LEAST_TILT`, and for
        `CONTACT_WOULD_PULL` the normal force in N of a contact that must not.
    angles : slice or sequence of int
        Columns of a state that hold beta and gamma in rad; errors are judged by them.
    kinks : callable
        From a state to numbers near 1 or less; forces have a kink or jump where one changes its
        sign: slips in m/s, or what presses on a contact.
    difference : float
        Part of a variable, or of 1 if that is smaller, by which it is moved to differentiate the
        right-hand side; friction may bend within less than usual.
    absolute : float or ndarray, shape (n,)
        Absolute over relative tolerance of a step.
    jacobian : callable, optional
        Makes the function from a state to the exact Jacobian of a right-hand side that does not
        depend on time, shape (n, n); without it, differences are taken.
    kinked_load : float
        Size in N of the load of friction, if that ends where the contact pulls; else 0.
    """

    right_hand_side: Callable[[float, Array], npt.ArrayLike]
    start: Array
    longest_step: float
    endings: Mapping[str, StateFunction] = field(default_factory=dict)
    angles: slice | Sequence[int] = ()
    kinks: Callable[[Array], Sequence[float]] = lambda _: ()
    difference: float = 1e-8
    absolute: float | Array = 1.0
    jacobian: Callable[[], Callable[[Array], Array]] | None = None
    kinked_load: float = 0.0


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
    pulling : tuple of pairs of floats
        Times in s between which the contact has pulled.
    steps : int
    seconds : float
        Processor time of the run in s; nan if it is not known.
    local_tolerance, estimate : float
        Of a run to a tolerance, and its estimated error in rad; nan if there is none.
    """

    times: Array
    states: Array
    evaluations: int
    ended: str | None
    pulling: tuple[tuple[float, float], ...]
    steps: int = 0
    seconds: float = nan
    local_tolerance: float = nan
    estimate: float = nan

    def ending(self, normal_force: float, watch: Watch | None) -> Ending | None:
        """Why it ended early, if it did.

        Parameters
        ----------
        normal_force : float
            At the end in N.
        watch : Watch, optional
            Of the call that it was for.
        """
        if self.ended is None:
            return None
        # Any other condition ends a run where it is zero.
        value = normal_force if self.ended == CONTACT_WOULD_PULL else 0.0
        if self.ended == TIME_LIMIT and watch is not None:
            value = watch.seconds
        return Ending(reason=self.ended, time=float(self.times[-1]), value=value)

    def trajectory(self, scenario: Scenario, watch: Watch | None, **about: Any) -> Trajectory:
        """Trajectory of a run whose states are coordinates, their rates and constraint forces.

        Parameters
        ----------
        scenario : Scenario
        watch : Watch, optional
            Of the call that it was for.
        **about
            What made it, as `Trajectory` takes it.
        """
        coordinates, rates, multipliers = np.split(self.states, (6, 12), axis=1)
        return Trajectory(
            times=self.times,
            coordinates=coordinates,
            rates=rates,
            multipliers=multipliers,
            scenario=scenario,
            error_estimate=None if isnan(self.estimate) else self.estimate,
            ending=self.ending(float(multipliers[-1, 0]), watch),
            pulling=self.pulling,
            solver_seconds=None if isnan(self.seconds) else self.seconds,
            **about,
        )


def integrate(
    problem: InitialValueProblem,
    times: Array,
    method: Method,
    local_tolerance: float,
    step_fraction: float = 1.0,
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
        Relative tolerance of a step.
    step_fraction : float
        Of the longest step that may be taken, and of the first one.
    allow_pulling : bool
        Whether to go on where the normal force turns negative.
    watch : Watch

    Raises
    ------
    SolverError
        If the solver gives up.
    ToleranceError
        If the call is out of steps.
    ValueError
        If the contact would have to pull at the start, or at once, and must not.
    """
    begin, first = time.thread_time(), float(times[0])
    # Late on the clock, SciPy's least step is longer than a motion may need.
    span = times - first
    longest, kinks = step_fraction * problem.longest_step, _kinks(problem, allow_pulling)
    problem = replace(problem, longest_step=longest, kinks=kinks)
    pulls_at_start(problem, allow_pulling=allow_pulling)
    lookout = Lookout(problem.endings, problem.start, allow_pulling)
    started: list[Any] = []
    first_part = step_fraction * local_tolerance**TIGHTER
    solver = _made_by(problem, method, local_tolerance, first_part, started)
    ended: str | None = None
    states, row, begun = [problem.start], 1, watch.steps
    for step in _steps(solver, problem, span[-1], first):
        watch.steps += 1
        if not watch.steps_left:
            if problem.angles:
                beta, _ = step.last[..., problem.angles]
                watch.flattest = first + step.end, asin(sin(beta))
            raise watch.given_up(method)
        ended = lookout.ending(step)
        count = int(np.searchsorted(span, step.end, side="right"))
        states += step.states(span[row:count])
        row = count
        if ended is None and watch.is_over(first + step.end, times[-1]) and row < times.size:
            ended = TIME_LIMIT
        if ended is not None:
            break
    if ended == CONTACT_WOULD_PULL and step.end <= 0.0:
        raise ValueError("start needs a contact that pulls at once; allow_pulling lets it")
    reached = times[:row]
    if ended is not None and first + step.end > reached[-1]:
        reached = np.append(reached, first + step.end)
        states.append(step.last)
    pulling = lookout.pulling(reached[-1] - first)
    return Run(
        reached,
        np.array(states),
        sum(_evaluations(problem, each) for each in started),
        ended,
        tuple((first + since, first + until) for since, until in pulling),
        watch.steps - begun,
        time.thread_time() - begin,
    )


def _made_by(
    problem: InitialValueProblem,
    method: Method,
    local_tolerance: float,
    first_part: float,
    made: list[Any],
) -> Callable[..., Any]:
    """From a time, a state, a last time and perhaps a `first_step` to a solver of SciPy.

    It begins with this part of the step that SciPy guesses; `made` gets each of them.
    """
    make = partial(
        getattr(solvers, method),
        problem.right_hand_side,
        rtol=local_tolerance,
        atol=problem.absolute * local_tolerance,
        max_step=problem.longest_step,
        **({"jac": _jacobian(problem)} if method in _IMPLICIT else {}),
    )

    def solver(*span: Any, **first: Any) -> Any:
        try:
            made.append(make(*span, **first))
        except ArithmeticError:
            # To guess a first step, SciPy takes one that may lead to where there is no solution.
            little = min(FIRST * problem.longest_step, span[2] - span[0])
            made.append(make(*span, first_step=little))
        if method != "LSODA" and not first:
            made[-1].h_abs *= first_part
            if method == "BDF":
                # Its differences are scaled with the step.
                made[-1].D[1] *= first_part
        if method in _IMPLICIT and problem.jacobian is None:
            # Rounding in a right-hand side of others is in the way of all that SciPy would have.
            made[-1].newton_tol = max(made[-1].newton_tol, ITERATED)
        return made[-1]

    return solver


def _steps(
    started: Callable[..., Any], problem: InitialValueProblem, end: float, clock: float
) -> Iterator[Step]:
    """Steps of a run, none of which goes across a kink of the forces.

    A step that does is taken again up to there: its error would be larger than it shows. LSODA
    is begun anew where it has stalled, and any solver past a jump that no step resolves.

    Parameters
    ----------
    started : callable
        See `_made_by`.
    problem : InitialValueProblem
    end : float
        In s from the start.
    clock : float
        Time of the start in s.

    Raises
    ------
    SolverError
        If the solver fails, or stalls with steps too short to move its time, and soon again.
    """
    kinks, solver = problem.kinks, started(0.0, problem.start, end)
    before = kinks(problem.start)
    stride, equal, length, jumped = 0.0, 0, end, -end
    while solver.status == "running":
        state = solver.y.copy()
        try:
            if equal == STALLED and isinstance(solver, solvers.LSODA):
                if stride <= PAST * np.spacing(solver.t):
                    raise _stopped(solver, clock, "its steps have come down to rounding")
                solver, equal = started(solver.t, state, end), 0
            step = _step(solver, clock)
        except SolverError:
            past = solver.t + PAST * np.spacing(solver.t)
            rates = np.asarray(solver.fun(solver.t, state))
            soon = solver.t - jumped < FIRST * problem.longest_step
            if soon or past >= end or not np.isfinite(rates.sum()):
                raise
            jumped, equal = solver.t, 0
            solver = started(past, state + (past - jumped) * rates, end)
            continue
        after = kinks(step.last)
        turn = _turn(kinks, before, step, after)
        if step.begin < turn < step.end:
            # By a step that goes across, it is not told exactly: one up to there may do so, too.
            length = max(step.end - step.begin, length if solver.t_bound < end else 0.0)
            solver = started(step.begin, state, turn, first_step=turn - step.begin)
            continue
        yield step
        before = after
        # As long as the one before, to a hundredth, and not held by the longest step; or as short
        # as steps can be.
        same = abs(solver.step_size - stride) <= 0.01 * stride < 0.009 * problem.longest_step
        same |= solver.step_size <= PAST * np.spacing(solver.t)
        stride, equal = solver.step_size, equal + 1 if same else 0
        if solver.status == "finished" and step.end < end:
            first = min(length, end - step.end)
            solver = started(step.end, solver.y, end, first_step=first)


def _kinks(
    problem: InitialValueProblem, allow_pulling: bool
) -> Callable[[Array], Sequence[float]]:
    """Kinks of a problem, and where its contact begins to pull or ceases, if that is one."""
    if not (allow_pulling and problem.kinked_load):
        return problem.kinks
    kinks, force = problem.kinks, problem.endings[CONTACT_WOULD_PULL]
    return lambda state: [*kinks(state), force(state) / problem.kinked_load]


def _turn(
    kinks: Callable[[Array], Sequence[float]],
    before: Sequence[float],
    step: Step,
    after: Sequence[float],
) -> float:
    """Time at which the first kink lies within a step, or its end."""

    def at(time: float, number: int) -> float:
        return kinks(step.path(time))[number]

    turn = step.end
    for number, (first, last) in enumerate(zip(before, after, strict=True)):
        if first * last < 0.0 and min(abs(first), abs(last)) > STILL:
            turn = min(turn, float(brentq(at, step.begin, step.end, args=(number,))))
    return turn


def _step(solver: Any, clock: float) -> Step:
    # Without a finite derivative, SciPy would look for a first step for ever.
    lost = isnan(getattr(solver, "h_abs", 0.0))
    message = None if lost else _taken(solver)
    if lost or solver.status == "failed" or not isfinite(solver.y.sum()):
        raise _stopped(solver, clock, message or "the state is no longer finite")
    return Step(solver)


def _taken(solver: Any) -> str | None:
    """Message of a step that a solver takes.

    A stage of an explicit one may lie beyond where there is a solution, although the motion does
    not go there: the step is then taken shorter and shorter.
    """
    for _ in range(SHORTENED * isinstance(solver, _EXPLICIT)):
        try:
            return solver.step()
        except LawError:
            raise
        except ArithmeticError:
            solver.h_abs *= 0.1
    return solver.step()


def _stopped(solver: Any, clock: float, why: str) -> SolverError:
    return SolverError(f"{type(solver).__name__} stopped after t = {clock + solver.t:g} s: {why}")


def _evaluations(problem: InitialValueProblem, solver: Any) -> int:
    """Evaluations of the right-hand side, those for differences among them."""
    by_differences = problem.jacobian is None and type(solver).__name__ in _IMPLICIT
    return int(solver.nfev + by_differences * solver.njev * (1 + solver.n))


def _jacobian(problem: InitialValueProblem) -> Callable[[float, Array], Array]:
    """Jacobian of the right-hand side from time and state, by forward differences at need.

    SciPy's own widens its steps for ever along coordinates that the right-hand side does not
    depend on, such as alpha, until they overflow.
    """
    if problem.jacobian is not None:
        exact = problem.jacobian()
        return lambda _, state: exact(state)

    def by_differences(moment: float, state: Array) -> Array:
        base = np.asarray(problem.right_hand_side(moment, state))
        moved = state + np.diag(problem.difference * np.maximum(1.0, np.abs(state)))
        rates = np.array([problem.right_hand_side(moment, each) for each in moved])
        return (rates - base).T / (np.diag(moved) - state)

    return by_differences


def pulls_at_start(problem: InitialValueProblem, *, allow_pulling: bool) -> bool:
    """Whether the contact pulls at the start; `ValueError` if it does and must not."""
    if CONTACT_WOULD_PULL not in problem.endings:
        return False
    force = problem.endings[CONTACT_WOULD_PULL](problem.start)
    if force < 0.0 and not allow_pulling:
        raise ValueError(
            f"start needs a contact that pulls, with a normal force of {force:.3g} N; "
            "allow_pulling lets it"
        )
    return force < 0.0
