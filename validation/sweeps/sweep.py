"""A sweep as plain data, and a look ahead at what it takes."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from analysis import CONSTRAINTS, Scenario, multiplier_names
from analysis.motion.endings import each_condition, named_conditions
from analysis.motion.trajectory import versions
from analysis.problem.names import ArgumentError
from analysis.problem.user_modules import is_user_name
from analysis.problem.variations import changed, check_fields
from analysis.simulation.compiled.library import require_heyoka
from validation.measurement.sources import behind, digest, own_files
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan

_LOOKED_AT = 50


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """What is run: a scenario, what varies in it, and how each case is run.

    Parameters
    ----------
    scenario : Scenario
        With whatever does not vary.
    design : Design
    plan : Plan

    Raises
    ------
    ValueError
        If the scenario does not have a field that varies, or a force that is to be kept.
    """

    scenario: Scenario
    design: Design
    plan: Plan

    def __post_init__(self) -> None:
        firsts = self.design.values_of(0)
        check_fields(self.scenario, firsts)
        if not {"model", "constraints"} & firsts.keys():
            missing = {*multiplier_names(CONSTRAINTS)} & {*self.plan.keep}
            missing -= {*multiplier_names(self.scenario.constraints)}
            if missing:
                raise ArgumentError(
                    "keep", f"must name what {self.scenario.name} has, got {min(missing)}"
                )

    def scenario_of(self, index: int) -> Scenario:
        """Scenario of a case; `ValueError` if its values do not fit."""
        return changed(self.scenario, self.design.values_of(index))

    def has_witness(self, index: int) -> bool:
        """Whether the other side runs this case as well."""
        count = self.plan.witnesses
        return count > 0 and index in _spread(self.design.size, count)

    def values(self) -> dict[str, Any]:
        """Plain data, by which two sweeps are the same."""
        # However long a run may take, it is the same.
        return {
            "scenario": self.scenario.values(),
            "design": asdict(self.design),
            "plan": asdict(self.plan) | {"time_limit": None},
        }

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> "Sweep":
        """Sweep from what `values` has returned, or JSON of it."""
        design, plan = values["design"], dict(values["plan"])
        axes = tuple(Axis(**axis) for axis in design["axes"])
        del plan["time_limit"]
        return cls(
            scenario=Scenario.from_values(values["scenario"]),
            design=Design(**{**design, "axes": axes}),
            plan=Plan(**plan),
        )

    def code(self) -> dict[str, str]:
        """What the results depend on besides: versions, and digests of all sources."""
        # A law, a body and a condition may be of one's own.
        named: list[Any] = each_condition(self.plan.stop_when or ())
        named += (each for axis in self.design.axes for each in axis.values)
        own = {each.partition(":")[0] for each in named if is_user_name(each)}
        own |= {type(each).__module__ for each in (self.scenario.friction, self.scenario.disk)}
        sources = {"sources": behind("validation.sweeps.case"), "own": digest(own_files(own))}
        return versions("exudyn", "numpy", "scipy") | sources


@lru_cache
def _spread(size: int, count: int) -> frozenset[int]:
    """So many of the cases, evenly spread, in no step with a grid."""
    # Multiples of the golden ratio leave no large gap in any stretch.
    ranked = np.argsort(np.arange(size) * 0.6180339887498949 % 1.0)
    return frozenset(ranked[:count].tolist())


def look_ahead(sweep: Sweep) -> tuple[float, str]:
    """Look at some cases of a sweep, evenly spread, without running them.

    Returns
    -------
    float
        Processor time of a case in s, roughly, with the part that the other side has in it.
    str
        How many of those cases are refused, and why the first of them is; empty if none is.

    Raises
    ------
    ValueError
        If all of them would be refused, there is no such condition to end a run, or what the
        method needs is not installed.
    """
    if sweep.plan.stop_when is not None:
        named_conditions(sweep.plan.stop_when, sweep.scenario.initial_state)
    if sweep.plan.runs_in_batches:
        require_heyoka()
    size, errors, seconds = sweep.design.size, [], []
    numbers = sorted({round(part * (size - 1)) for part in np.linspace(0.0, 1.0, _LOOKED_AT)})
    for number in numbers:
        try:
            scenario = sweep.scenario_of(number)
            effort = sweep.plan.effort(scenario)
            effort.check()
        except ValueError as error:
            errors.append(error)
            continue
        seconds.append(effort.seconds)
        # A case that the other side cannot run takes it no time.
        with suppress(ValueError):
            if part := min(1.0, sweep.plan.witnesses / size):
                seconds[-1] += part * sweep.plan.witness.effort(scenario).seconds
    if not seconds:
        raise errors[0]
    count = f"{len(errors)} of {len(numbers)} cases looked at are refused"
    return sum(seconds) / len(numbers), f"{count}, such as: {errors[0]}" if errors else ""
