"""Compiled runs of many scenarios at once, alike in structure or not."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.compiled.lots import Judged, Lot, run_to
from analysis.compiled.runs import CompiledScenario
from analysis.data.checks import Array, positive
from analysis.data.checks import local_tolerance as one_step
from analysis.data.endings import Condition
from analysis.data.limits import Effort
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Setting, Trajectory
from analysis.data.watch import Watch
from analysis.models.forms import Form, PosedForm, default_form, pose
from analysis.models.simulation import TIGHTEST_LOCAL_TOLERANCE, local_tolerances, trajectory
from analysis.solve.effort import simulation_effort
from analysis.solve.stepping import Run, endings, pulls_at_start

Outcome = Trajectory | Exception
"""Of one member: its motion, or the error that ended it."""

DEFAULT_TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True, eq=False)
class PosedMember:
    """One scenario, posed and compiled."""

    scenario: Scenario
    form: Form
    compiled: CompiledScenario
    posed: PosedForm

    @classmethod
    def of(
        cls, scenario: Scenario, form: Form | None, conditions: Mapping[str, Condition]
    ) -> "PosedMember":
        """Pose and compile a scenario; errors are those of `simulate`."""
        form = default_form(scenario) if form is None else form
        compiled = CompiledScenario(scenario, form, conditions, allow_pulling=False)
        return cls(
            scenario, form, compiled, pose(scenario, form, conditions, compiled.multipliers)
        )

    def alone(
        self, times: Array, local_tolerance: float, longest: float, most: float
    ) -> Run | Exception:
        """Its run of so many steps at most; where it fails, it must not take others with it."""
        problem = self.posed.problem.with_steps_up_to(longest)
        try:
            return self.compiled.integrate(problem, times, local_tolerance, Watch(most=most))
        except (ArithmeticError, ValueError) as error:
            return error

    def trajectory(self, judged: Judged, row: int, times: Array, tolerance: float) -> Trajectory:
        """Its motion, from what a lot has reached."""
        run = judged.reached.run(row, times, self.compiled.code.reasons)
        if run.ended is not None:
            run = replace(run, value=endings(self.posed.problem)[run.ended](run.states[-1]))
        estimate = float(judged.estimates[row])
        told: dict[str, Setting] = {
            "form": self.form,
            "method": "taylor",
            "tolerance": None if np.isnan(estimate) else tolerance,
            "local_tolerance": float(judged.local_tolerances[row]),
        }
        estimated = None if np.isnan(estimate) else estimate
        return trajectory(self.scenario, self.posed, run, told, estimated)


def simulate_batches(
    tasks: Iterable[tuple[Scenario, float | None]],
    times: Array,
    *,
    form: Form | None,
    local_tolerance: float | None,
    conditions: Mapping[str, Condition],
) -> list[Outcome]:
    """Outcomes of many scenarios, each as `simulate` with Taylor's method gives it.

    Parameters
    ----------
    tasks : iterable of pairs
        Scenarios and their tolerances.
    times, form, local_tolerance
        As in `simulate`.
    conditions : mapping
        From reasons to functions of a `State`.
    """
    outcomes: dict[int, Outcome] = {}
    groups: defaultdict[Any, list[tuple[int, PosedMember, float, float]]] = defaultdict(list)
    for number, (scenario, asked) in enumerate(tasks):
        try:
            member = PosedMember.of(scenario, form, conditions)
            pulls_at_start(member.posed.problem, allow_pulling=False)
            ladder, tolerance = ladder_to(asked, local_tolerance)
            most = checked_effort(scenario, times, tolerance, local_tolerance).most
        except (ArithmeticError, ValueError) as error:
            outcomes[number] = error
        else:
            groups[member.compiled.code, ladder].append((number, member, tolerance, most))
    for (code, ladder), group in groups.items():
        members = [member for _, member, *_ in group]
        problems = [member.posed.problem for member in members]

        def alone(row: int, *how: float, members: list[PosedMember] = members) -> Run | Exception:
            return members[row].alone(times, *how)

        lot = Lot(
            code,
            members[0].form,
            np.array([problem.start for problem in problems]),
            np.array([member.compiled.numbers for member in members]),
            np.array([problem.longest_step for problem in problems]),
            np.array([most for *_, most in group]),
            alone,
        )
        judged = run_to(lot, times, ladder, np.array([tolerance for *_, tolerance, _ in group]))
        for row, (number, member, tolerance, _) in enumerate(group):
            if row in judged.failures:
                outcomes[number] = judged.failures[row]
                continue
            try:
                outcomes[number] = member.trajectory(judged, row, times, tolerance)
            except (ArithmeticError, ValueError) as error:
                outcomes[number] = error
    return [outcomes[number] for number in range(len(outcomes))]


def ladder_to(
    tolerance: float | None, local_tolerance: float | None
) -> tuple[tuple[float, ...], float]:
    """Local tolerances to run with, in turn, and the tolerance; one alone gives no estimate."""
    if local_tolerance is not None:
        if tolerance is not None:
            raise ValueError("give either tolerance or local_tolerance, not both")
        return (one_step("local_tolerance", local_tolerance, TIGHTEST_LOCAL_TOLERANCE),), np.inf
    wanted = positive("tolerance", DEFAULT_TOLERANCE if tolerance is None else tolerance)
    return tuple(local_tolerances(wanted, "taylor")), wanted


def checked_effort(
    scenario: Scenario, times: Array, tolerance: float, local_tolerance: float | None
) -> Effort:
    """What a run should take; `ValueError` if that is too many steps."""
    accuracy = {"tolerance": tolerance} if local_tolerance is None else {}
    effort = simulation_effort(
        scenario, times, method="taylor", local_tolerance=local_tolerance, **accuracy
    )
    effort.check()
    return effort
