"""What is asked of runs, their samples, and the motion that these make."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from analysis.motion.endings import CONTACT_WOULD_PULL, TIME_LIMIT, Condition, Ending
from analysis.motion.trajectory import Trajectory, versions
from analysis.problem.checks import Array, TimeLimitError
from analysis.problem.start import State
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import error_at_ending
from analysis.solve.watch import Watch
from mbs_models.integrators import Integrator
from mbs_models.scene import Scene

COORDINATES = slice(0, 6)
RATES = slice(6, 12)

ALPHA, BETA, GAMMA = 3, 4, 5
TURNING = [ALPHA, GAMMA]
NORMAL_FORCE = 12

ANGLES, ANGLE_RATES = slice(4, 6), slice(10, 12)
"""Those of beta and gamma."""


def apart(first: Array, second: Array, *, flat: bool = False) -> float:
    """Largest difference of beta and gamma in rad, which is what tolerances speak of.

    Parameters
    ----------
    first, second : ndarray, shape (n, 12 + k)
        Samples with their times as the last column; those of the last may differ.
    flat : bool
        Whether the disk lies flat at the last sample: gamma means nothing there.
    """
    gaps, rates = first[:, ANGLES] - second[:, ANGLES], second[:, ANGLE_RATES].copy()
    if flat:
        gaps[-1, 1] = rates[-1, 1] = 0.0
    return float(np.max(error_at_ending(gaps, first[:, -1] - second[:, -1], rates)))


def leaning(rows: Array) -> Array:
    """Angle in rad between disk and table in samples.

    It is negative where beta lies outside (0, pi), by whole turns if a run has failed.
    """
    tilts = rows[..., BETA]
    result: Array = np.minimum(tilts, pi - tilts)
    return result


def state_of(row: Array) -> State:
    """State of a sample."""
    values = row.tolist()
    return State(coordinates=tuple(values[COORDINATES]), rates=tuple(values[RATES]))


@dataclass(slots=True, kw_only=True, eq=False)
class Call:
    """What a call of `mbs_models.simulate` asks of every run that it takes.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    longest : float
        Longest step in s.
    tolerance : float or None
        Largest error in rad, if the runs are to have one.
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.
    allow_pulling : bool
        Whether to go on where the contact pulls.
    watch : Watch
    counts : Counter
        To which the work of the runs is added.
    seconds : float
        Processor time that the solver took for the last run.
    """

    scene: Scene
    times: Array
    longest: float
    tolerance: float | None
    conditions: Mapping[str, Condition]
    allow_pulling: bool
    watch: Watch
    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0

    def trajectory(
        self, run: Run, integrator: Integrator, step: float, estimate: float | None = None
    ) -> Trajectory:
        """The motion that a run has sampled.

        Parameters
        ----------
        run : Run
            Its states are samples: coordinates, their rates and the constraint forces.
        integrator : Integrator
        step : float
            Longest step in s, or the limit of step control.
        estimate : float, optional
            Estimated error in rad.

        Raises
        ------
        TimeLimitError
            If there is nothing but the start.
        """
        if len(run.states) < 2:
            raise TimeLimitError("time limit met before the first sample after the start")
        coordinates, rates, multipliers = np.split(run.states, (6, 12), axis=1)
        ending = None
        if run.ended is not None:
            says = {TIME_LIMIT: self.watch.seconds, CONTACT_WOULD_PULL: float(multipliers[-1, 0])}
            value = says.get(run.ended, 0.0)
            ending = Ending(reason=run.ended, time=float(run.times[-1]), value=value)
        return Trajectory(
            times=run.times,
            coordinates=coordinates,
            rates=rates,
            multipliers=multipliers,
            scenario=self.scene.scenario,
            source="engine",
            method={
                "formulation": self.scene.built_as,
                **integrator.settings(),
                "step": step,
                "tolerance": self.tolerance,
            },
            error_estimate=estimate,
            counts=dict(self.counts),
            versions=versions("numpy", "exudyn"),
            ending=ending,
            pulling=run.pulling,
            solver_seconds=self.seconds,
        )
