"""Ways to compute a motion, and a limit on their work that is the same on every machine."""

import warnings
from typing import Any, NamedTuple

import analysis
import mbs_models
from analysis import Method, Scenario, Trajectory
from analysis.problem.checks import Array
from analysis.problem.choices import Source
from mbs_models import Integrator, IntegratorName
from validation.run import run


class Way(NamedTuple):
    """A way to compute a motion: formulation, and integrator or in-house method.

    What is left out, the side chooses.
    """

    source: Source
    formulation: mbs_models.Formulation | analysis.Formulation | None = None
    integrator: Integrator | IntegratorName | Method | None = None

    @property
    def name(self) -> str:
        """Formulation and integrator."""
        given = (self.formulation, self.integrator or "as chosen")
        return ", ".join(str(each) for each in given if each is not None)

    def run(self, scenario: Scenario, times: Array, **how: Any) -> Trajectory:
        """Run a scenario this way; the further arguments are those of `validation.run.run`.

        SciPy's warnings are left out: LSODA warns where it gives up, which is an error as well.
        """
        how.setdefault("integrator" if self.source == "engine" else "method", self.integrator)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return run(scenario, times, source=self.source, formulation=self.formulation, **how)


class WorkLimitError(ArithmeticError):
    """A run has taken all the steps it may take."""


class StepLimit:
    """Counts the steps of a call, whatever passes it makes, and ends it after so many.

    To be handed over as `progress`; around the call, as a context, it sees to it that a call that
    was ended raises a `WorkLimitError`, in whatever error of its own that came out.

    Parameters
    ----------
    per_second : int
        Number of steps of a motion of up to a second; of longer ones per second.
    end : float
        Of the motion in s.

    Attributes
    ----------
    steps : int
        Steps so far.
    """

    def __init__(self, per_second: int, end: float = 1.0) -> None:
        self.most = round(per_second * max(1.0, end))
        self.steps = 0
        self._reached = 0.0
        self._has_ended = False

    def __call__(self, reached: float, _end: float) -> None:
        """Count a step of a pass that has come to `reached` in s."""
        if self.steps >= self.most:
            self._has_ended = True
            raise _UsedUpError
        self.steps += 1
        self._reached = reached

    def __enter__(self) -> "StepLimit":
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, Exception) and self._has_ended:
            raise WorkLimitError(
                f"{self.most} steps taken, the last pass at t = {self._reached:.3g} s"
            ) from error


class _UsedUpError(Exception):
    """No failure of the run, which may be looking for one."""
