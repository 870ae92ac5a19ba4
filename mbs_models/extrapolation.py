"""The way of the engine's own integrators to a tolerance: fixed steps halved and extrapolated."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from operator import truediv

import numpy as np

from analysis.motion.endings import FLAT, TIME_LIMIT
from analysis.problem.checks import Array, TimeLimitError, ToleranceError
from analysis.problem.start import FlatError
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import error_at_ending, needed
from mbs_models.effort import HALVINGS, LATE
from mbs_models.integrators import EXPONENTS, Integrator
from mbs_models.scene import CLASSES, Scene
from mbs_models.solving import EngineError
from mbs_models.whole_runs import Call, run_over

ANGLES, ANGLE_RATES = slice(4, 6), slice(10, 12)
"""Columns of beta and gamma and of their rates in samples."""

ROUNDING = 1e-13
"""Error in rad that no estimate goes below."""

CAUTION = 2.0
"""Estimated error over the difference that it is taken from."""

FINEST = CAUTION * ROUNDING
"""Smallest estimate in rad."""

BLIND = 3.0
"""Factor of an estimate whose step is as long as the time in which friction brakes slip; it falls
with the step, down to 1."""

PATIENCE = 6
"""Halvings of the step in a row after which a disk that lies all but flat is given up."""

HOPELESS = 100.0
"""Estimated error over the tolerance from which on fixed steps lead to nothing."""


class HopelessError(ToleranceError):
    """Fixed steps lead to nothing, and another way is left to try."""


NEVER: Array = np.empty((0, 2))
"""Times of pulling of a run whose contact does not."""


class Ladder:
    """Richardson's extrapolation, fed with runs of which each has half the step of the one before.

    Parameters
    ----------
    scene : Scene
    integrator : Integrator
        Both decide which powers of the step the error holds.
    flat : bool
        Whether the runs end where the disk lies flat.

    Attributes
    ----------
    best : ndarray, shape (n, k + 1)
        Best extrapolated samples so far, and their times in s, of which that of an ending is
        extrapolated, too.
    best_edges : ndarray, shape (m, 2)
        First and last times in s of pulling.
    estimate : float
        Estimated error of beta and gamma of the last addition in rad; see `error_at_ending`.
    best_estimate : float
        Smallest estimate so far.
    """

    def __init__(self, scene: Scene, integrator: Integrator, *, flat: bool = False) -> None:
        self._decay, self._flat = scene.scenario.slip_decay, flat
        self._exponents = CLASSES[scene.built_as].exponents or EXPONENTS[integrator.name]
        # By which halving the step is to shrink the errors of the columns.
        self._factors = [2.0**each for each in (*self._exponents, self._exponents[-1])]
        self._row: list[Array] = []
        self._edges: list[Array] = []
        self._differences: list[float] = []
        self._worse = 0
        self.best: Array = np.empty((0, 0))
        self.best_edges = NEVER
        self.estimate = np.inf
        self.best_estimate = np.inf

    @property
    def stalled(self) -> bool:
        """Whether the last three halvings brought nothing: rounding has taken over.

        Not while the estimate is large: then the steps are still too long to be extrapolated.
        """
        return self._worse >= 3 and self.best_estimate < 1e-5

    @property
    def reached(self) -> str:
        """The accuracy that has been reached, in words."""
        if self.best_estimate == np.inf:
            return "there were no two runs to compare"
        return f"the best estimated error is {self.best_estimate:.1e} rad"

    def add(self, values: Array, times: Array, step: float, edges: Array = NEVER) -> None:
        """Add a run with half the step of the run before.

        Each extrapolated value is compared with its like from the run before. The difference is
        the error of the coarser one, and no less than that of the finer one for any order of
        convergence from one on, so that an order lost somewhere (to the kink in the friction law,
        say) shows up as a slow run and not as a false estimate. Two values may also agree by
        chance, while steps are too long to be extrapolated: a difference counts for no less than
        the one before it, or beside it, lets expect. That happens most where friction is stiff: a
        step over which it brakes slip entirely does not see how, so that estimates count for more
        there.

        Parameters
        ----------
        values : ndarray, shape (n, k)
            Samples, no more than those of the run before, which is cut to them.
        times : ndarray, shape (n,)
            In s; but for the last of a run that has ended by itself, those of the run before.
        step : float
            In s.
        edges : ndarray, shape (m, 2)
            First and last times of pulling in s, extrapolated over runs that pull as often.
        """
        self._row = [coarse[: len(values)] for coarse in self._row]
        row = self._refined(np.column_stack((values, times)), self._row)
        pull_alike = bool(self._edges) and self._edges[0].shape == edges.shape
        self._edges = self._refined(edges, self._edges if pull_alike else [])
        differences = [
            max(apart(fine, coarse, flat=self._flat), ROUNDING)
            for coarse, fine in zip(self._row, row, strict=False)
        ]
        expected = list(map(truediv, self._differences, self._factors))
        # A column that has none yet is measured by the one beside it, and the first by nothing.
        beside = differences[-2] / self._factors[len(expected) - 1] if expected else np.inf
        expected += [beside] * (len(differences) - len(expected))
        caution = CAUTION * max(BLIND * min(self._decay * step, 1.0), 1.0)
        estimates = caution * np.maximum(differences, expected)
        self.estimate = float(np.min(estimates, initial=np.inf))
        if self.estimate < np.inf:
            column = int(np.argmin(estimates))
            self.best, self.best_edges = row[column], self._edges[: column + 1][-1]
        self._differences = differences
        self._row = row
        improved = self.estimate < 0.5 * self.best_estimate
        self._worse = 0 if improved or len(row) < 3 else self._worse + 1
        self.best_estimate = min(self.best_estimate, self.estimate)

    def _refined(self, finest: Array, coarser: Sequence[Array]) -> list[Array]:
        """A run, and what its like from the runs before make of it, power by power of the step."""
        row = [finest]
        for exponent, coarse in zip(self._exponents, coarser, strict=False):
            row.append(row[-1] + (row[-1] - coarse) / (2.0**exponent - 1.0))
        return row


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


def extrapolated(call: Call, integrator: Integrator, *, is_last_way: bool) -> tuple[Run, float]:
    """Halve the step and extrapolate until the estimated error is small enough.

    Parameters
    ----------
    call : Call
        With a tolerance.
    integrator : Integrator
    is_last_way : bool
        Whether to go on where fixed steps lead to nothing, since nothing else is left to try.

    Returns
    -------
    run : Run
        Its states are samples, and it has an estimate.
    longest : float
        Longest step in s of the last run.

    Raises
    ------
    EngineError, FlatError, ToleranceError, TimeLimitError
        See `mbs_models.simulate`.
    """
    scene, tolerance = call.motion.scene, call.tolerance
    assert tolerance is not None
    empty = partial(Ladder, scene, integrator)
    ladder, kind = empty(), None
    failure: EngineError | FlatError | None = None
    flat = 0
    for halvings in range(HALVINGS):
        if ladder.stalled:
            break
        is_late = halvings == LATE and not is_last_way
        if is_late and ladder.best_estimate > HOPELESS * tolerance:
            raise HopelessError
        try:
            first = integrator.first_step(scene.scenario)
            result, step = run_over(call, integrator, first, halvings)
        except (EngineError, FlatError) as error:
            # A step too long for the iteration is no failure of the tolerance: halve it.
            flat = flat + 1 if isinstance(error, FlatError) else 0
            if flat == PATIENCE:
                raise
            failure, ladder = error, empty()
            continue
        failure, is_late = None, result.ended == TIME_LIMIT
        if not is_late and kind != (result.ended, result.times.size):
            # Runs that end elsewhere are not to be compared.
            kind = (result.ended, result.times.size)
            ladder = empty(flat=result.ended == FLAT)
        ladder.add(result.states, result.times, step, np.array(result.pulling).reshape(-1, 2))
        if ladder.estimate <= needed(tolerance, result.ended == FLAT):
            pulling = tuple(map(tuple, ladder.best_edges.tolist()))
            result = replace(result, times=ladder.best[:, -1], states=ladder.best[:, :-1])
            return replace(result, pulling=pulling, estimate=ladder.estimate), step
        if is_late:
            raise TimeLimitError(
                f"time limit met at t = {result.times[-1]:.6g} s of a run with a step of "
                f"{step:.3g} s, before runs agreed to {tolerance:g} rad; {ladder.reached}"
            )
    raise failure or ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {integrator.name} on formulation "
        f"{scene.built_as!r}: {ladder.reached}"
    )
