"""Random scenarios: whether a run of the engine breaks its promise, and which do not finish.

    python -m validation.studies.robustness.random_scenarios --number 60 --seed 1

Spin from 0 to 300 rad/s, half of them to 60, friction from 0.01 to 3, smoothing from 1e-5 to
10 m/s, any tilt, tolerances from 1e-3 to 1e-8 rad, all models, formulations and loads, 1 s long.
Each run is measured against in-house runs by two methods.
"""

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

import mbs_models
from analysis import MODELS, Scenario, SmoothCoulomb, Start
from mbs_models import Formulation, Scene
from validation.kit.limits import holds, largest
from validation.studies.robustness.cases import HardProblem
from validation.studies.robustness.reference import (
    NoReference,
    deviation,
    ending_error,
    reference_or_reason,
)
from validation.studies.robustness.run import STEPS
from validation.studies.robustness.work import StepCount


@dataclass(frozen=True, slots=True, kw_only=True)
class Draw:
    """A random motion for the engine.

    Parameters
    ----------
    problem : HardProblem
    formulation : str
    tolerance : float
        Asked for in rad.
    """

    problem: HardProblem
    formulation: Formulation
    tolerance: float

    def __str__(self) -> str:
        scenario = self.problem.scenario
        friction, state = scenario.friction, scenario.initial_state
        assert isinstance(friction, SmoothCoulomb)
        return (
            f"{scenario.name}, {self.formulation}, load {friction.load}, "
            f"μ {friction.coefficient:.2g}, ε {friction.smoothing:.1e}, "
            f"spin {state.rates[3]:.0f}, β {state.coordinates[4]:.2f}, "
            f"tolerance {self.tolerance:.0e}"
        )


def draws(number: int, seed: int) -> list[Draw]:
    """So many random motions, the same ones for a seed."""
    rng = np.random.default_rng(seed)
    return [_draw(rng) for _ in range(number)]


def _draw(rng: np.random.Generator) -> Draw:
    models = tuple(MODELS.values())
    base = Scenario(constraints=models[rng.integers(len(models))])
    available = mbs_models.formulations(base)
    formulation = available[rng.integers(len(available))]
    by_contact = rng.random() < 0.5 and formulation != "contact-tree"
    friction = SmoothCoulomb(
        coefficient=float(10.0 ** rng.uniform(-2.0, 0.5)),
        smoothing=float(10.0 ** rng.uniform(-5.0, 1.0)),
        load="contact" if by_contact else "weight",
    )
    start = Start(
        beta=float(rng.uniform(0.01, np.pi - 0.01)),
        gamma=float(rng.uniform(-np.pi, np.pi)),
        spin=float(rng.uniform(0.0, 300.0 if rng.random() < 0.5 else 60.0)),
    )
    scenario = replace(base, friction=friction, start=start)
    problem = HardProblem(axis="random", label="", scenario=scenario, end=1.0)
    tolerance = float(10.0 ** rng.uniform(-8.0, -3.0))
    return Draw(problem=problem, formulation=formulation, tolerance=tolerance)


def verdict(drawn: Draw) -> tuple[str, str]:
    """What became of a draw, in a word and in detail.

    The word is "kept" or "kept up to its ending", "BROKEN", or what stood in the way.
    """
    problem, tolerance = drawn.problem, drawn.tolerance
    count = StepCount(STEPS["engine"])
    try:
        run = mbs_models.simulate(
            Scene(problem.scenario, drawn.formulation),
            problem.times,
            tolerance=tolerance,
            progress=count,
        )
    except Exception as error:
        if count.is_used_up:
            return "not finished", f"{count.limit} steps, the last pass at {count.reached:.3g} s"
        if not isinstance(error, (ArithmeticError, ValueError)):
            raise
        return "refused" if isinstance(error, ValueError) else "failed", str(error)
    known = reference_or_reason(problem)
    if isinstance(known, NoReference):
        return "no reference", known.reason
    apart, late = deviation(run, known.first), ending_error(run, known.first)
    detail = f"error {apart:.1e} rad, estimate {run.error_estimate:.1e}, doubt {known.doubt:.1e}"
    if run.ending is not None or known.first.ending is not None:
        detail += f", ending off by {late:.1e} s"
    if not holds(largest((apart, late)), tolerance + known.doubt):
        return "BROKEN", detail
    return "kept" if run.ending is None else "kept up to its ending", detail


def asked_for(module: str, arguments: Sequence[str] | None) -> list[Draw]:
    """Draws that the command line of a module asks for."""
    parser = argparse.ArgumentParser(prog=f"python -m validation.studies.robustness.{module}")
    parser.add_argument("--number", type=int, default=60, help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default: %(default)s)")
    options = parser.parse_args(arguments)
    return draws(options.number, options.seed)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run random scenarios and print them; 1 if a promise is broken."""
    counts: Counter[str] = Counter()
    for index, drawn in enumerate(asked_for("random_scenarios", arguments)):
        word, detail = verdict(drawn)
        counts[word] += 1
        print(f"{index:3d} {word}: {drawn}: {detail}", flush=True)
    print(", ".join(f"{number} {word}" for word, number in counts.most_common()))
    return 1 if counts["BROKEN"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
