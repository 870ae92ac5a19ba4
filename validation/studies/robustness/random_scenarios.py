"""Random scenarios: whether a run of the engine breaks its promise, and which do not finish.

    python -m validation.studies.robustness.random_scenarios --number 60 --seed 1

Spin from 0 to 300 rad/s, half of them to 60, friction from 0.01 to 3, smoothing from 1e-5 to
10 m/s, any tilt, tolerances from 1e-3 to 1e-8 rad, all models, formulations and loads, 1 s long.
Each run is judged as the hard cases are.
"""

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import mbs_models
from analysis import MODELS, Scenario, SmoothCoulomb, Start
from validation.kit.ways import Way
from validation.studies.robustness.outcomes import outcome, reference_or_error
from validation.studies.robustness.problems import Problem

NUMBERS = ("tolerance", "error", "ending_error", "estimate", "doubt")
"""Columns that are printed."""


def draws(number: int, seed: int) -> list[tuple[Problem, Way]]:
    """So many random motions for the engine, the same ones for a seed."""
    rng = np.random.default_rng(seed)
    return [_draw(rng) for _ in range(number)]


def _draw(rng: np.random.Generator) -> tuple[Problem, Way]:
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
    problem = Problem(
        axis="random",
        label=f"load {friction.load}, μ {friction.coefficient:.2g}, ε {friction.smoothing:.1e}, "
        f"spin {start.spin:.0f}, β {start.beta:.2f}",
        scenario=replace(base, friction=friction, start=start),
        end=1.0,
        tolerance=float(10.0 ** rng.uniform(-8.0, -3.0)),
    )
    return problem, Way(source="engine", formulation=formulation)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run random scenarios and print them; 1 if one crashes or breaks its promise."""
    parser = argparse.ArgumentParser(
        prog="python -m validation.studies.robustness.random_scenarios"
    )
    parser.add_argument("--number", type=int, default=60, help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default: %(default)s)")
    options = parser.parse_args(arguments)
    counts: Counter[str] = Counter()
    for index, (problem, way) in enumerate(draws(options.number, options.seed)):
        found = outcome(problem, way, reference_or_error(problem))
        word = "BROKEN" if found["broken"] else found["verdict"]
        counts[word] += 1
        numbers = [f"{name} {found[name]:.1e}" for name in NUMBERS if found[name] is not None]
        told = ", ".join([problem.name, way.name, *numbers, found["reason"]])
        print(f"{index:3d} {word}: {told}", flush=True)
    print(", ".join(f"{number} {word}" for word, number in counts.most_common()))
    return 1 if counts["BROKEN"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
