"""How sharp the error estimate of the engine's runs to a tolerance can be.

    python -m validation.studies.robustness.estimates --number 100 --seed 1

Draws the random motions of `random_scenarios` and halves their steps as `mbs_models.simulate`
does, but on and on. After each halving, the estimate is held against the error, measured by
in-house runs of two methods. The table shows for tolerances from 1e-3 to 1e-8 rad what estimates
divided by some factor would save in steps, and what they would break, and what a run would take
that knew its error.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from analysis.data.watch import Watch
from mbs_models import EngineError, Scene
from mbs_models.effort import HALVINGS
from mbs_models.extrapolation import Ladder
from mbs_models.integrators import find_integrator
from mbs_models.own_runs import run_over
from mbs_models.sampled import BETA, GAMMA
from validation.kit.tables import Cell, Table
from validation.studies.robustness.random_scenarios import Draw, asked_for
from validation.studies.robustness.reference import NoReference, reference_or_reason
from validation.studies.robustness.work import StepCount

TOLERANCES = 10.0 ** -np.arange(3.0, 8.01, 0.1)
STEPS = 12_000
"""Steps of all runs of a motion."""

FACTORS = (1.0, 1.5, 2.0, 4.0, 16.0, 64.0)
KNOWN = 0.1
"""Largest doubt of a reference over the tolerance that is looked at."""


@dataclass(frozen=True, slots=True)
class Rung:
    """What is known after a halving.

    Parameters
    ----------
    steps : int
        Steps of all runs so far.
    estimate, error : float
        Of the best extrapolated angles in rad.
    """

    steps: int
    estimate: float
    error: float


@dataclass(frozen=True, slots=True)
class Halved:
    """A motion whose step was halved again and again.

    Parameters
    ----------
    rungs : sequence of Rung
    doubt : float
        Of what the errors are measured against, in rad.
    """

    rungs: Sequence[Rung]
    doubt: float

    def accepted(self, tolerance: float, factor: float | None) -> Rung | None:
        """First rung that meets a tolerance by its estimate over a factor, or by its error."""
        for rung in self.rungs:
            if (rung.error if factor is None else rung.estimate / factor) <= tolerance:
                return rung
        return None


def halved(drawn: Draw) -> Halved | None:
    """Halve the steps of a random motion; None if it does not come to its end."""
    problem = drawn.problem
    scene = Scene(problem.scenario, drawn.formulation)
    known = reference_or_reason(problem)
    if isinstance(known, NoReference) or known.first.ending is not None:
        return None
    truth = known.first.coordinates[:, BETA : GAMMA + 1]
    integrator = find_integrator(scene.built_as, None, constrained=scene.has_constraints)
    empty = partial(Ladder, scene.built_as, integrator.name, problem.scenario.slip_decay)
    ladder = empty()
    count = StepCount(STEPS)
    rungs = []
    for halvings in range(HALVINGS):
        try:
            run = run_over(
                scene,
                problem.times,
                integrator,
                integrator.first_step,
                halvings,
                watch=Watch(progress=count),
            )
        except (EngineError, ArithmeticError):
            ladder = empty()
            continue
        except Exception:
            if count.is_used_up:
                break
            raise
        if run.ended is not None:
            return None
        ladder.add(run.values, run.times, run.step)
        if np.isfinite(ladder.estimate):
            error = float(np.max(np.abs(ladder.best[:, BETA : GAMMA + 1] - truth)))
            rungs.append(Rung(count.steps, ladder.estimate, error))
    return Halved(rungs, known.doubt)


def table(motions: Sequence[Halved]) -> Table:
    """What estimates divided by a factor would save, and break."""
    rows: list[list[Cell]] = []
    for factor in (*FACTORS, None):
        broken, worst, taken, reached = set(), 0.0, [], 0
        for number, motion in enumerate(motions):
            for tolerance in TOLERANCES[motion.doubt <= KNOWN * TOLERANCES].tolist():
                today = motion.accepted(tolerance, 1.0)
                found = motion.accepted(tolerance, factor)
                if found is None:
                    continue
                if today is not None:
                    taken.append(found.steps / today.steps)
                reached += 1
                worst = max(worst, found.error / tolerance)
                if found.error > tolerance + motion.doubt:
                    broken.add(number)
        if taken:
            label = "error known" if factor is None else f"{factor:g}"
            rows.append([label, reached, len(broken), worst, float(np.mean(taken))])
    return Table(
        name="estimates",
        title="Estimates divided by a factor: what they break, and what they save",
        columns=(
            "estimate divided by",
            "motions and tolerances",
            "motions with a broken promise",
            "largest error over tolerance",
            "mean of steps over today's",
        ),
        rows=rows,
        note=f"{len(motions)} random motions of 1 s in the engine; 51 tolerances from 1e-3 to "
        "1e-8 rad, as far as the steps run lead there; steps are compared where today's estimate "
        "gets there, too. Last row: a ladder that ends as soon as its error, unknown to any run, "
        "is small enough.",
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Halve the steps of random motions, and print the table."""
    motions = []
    for drawn in asked_for("estimates", arguments):
        motion = halved(drawn)
        if motion is None or not motion.rungs:
            print(f"{drawn}: does not come to its end", flush=True)
            continue
        finest = motion.rungs[-1]
        print(f"{drawn}: {finest.error:.1e} rad, estimated {finest.estimate:.1e}", flush=True)
        motions.append(motion)
    print(table(motions).to_text())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
