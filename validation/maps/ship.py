"""Run the maps of the report and put them into the package.

    python -m validation.maps.ship DIR

DIR gets a store for each panel, as `tippedisk map` writes them; the same command goes on where
an interrupted one stopped. It takes some twelve minutes of processor time.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from analysis import Scenario
from validation.kit.provenance import Provenance
from validation.maps.problems import PROBLEMS
from validation.maps.run import panels, run_pairs, run_panel
from validation.maps.stored import FILE, Study
from validation.maps.uncertainty import shifted_sweeps
from validation.sweeps.pools import Pool, open_pool

CELLS = 8
LEVELS = {"spin-friction": 2, "spin-eccentricity": 2, "tilting": 2, "basins": 2, "rest": 1}
"""Maps of the report and how often their cells are halved; one to rest takes longest."""

WITNESSES = 2
"""On the coarse grid of each panel; see `panels`."""

PAIRS = 40


def run(folder: Path, pool: Pool) -> Study:
    """Run what the stores of a folder do not hold of the maps.

    Raises
    ------
    ArithmeticError
        If there are too few pairs for an exponent.
    """
    done = {}
    for name, levels in LEVELS.items():
        problem = PROBLEMS[name]
        wanted = panels(
            problem, Scenario(), cells=CELLS, levels=levels, end=problem.end, witnesses=WITNESSES
        )
        done[name] = tuple(
            run_panel(problem, sweep, folder / f"{name}-{index}.db", levels=levels, pool=pool)
            for index, sweep in enumerate(wanted, 1)
        )
        sys.stdout.write(f"{name}: {sum(len(each.classes) for each in done[name])} runs\n")
        sys.stdout.flush()
    rest = PROBLEMS["rest"]
    pairs = shifted_sweeps(rest, Scenario(), number=PAIRS, end=rest.end)
    fineness = run_pairs(rest, pairs, folder, pool=pool)
    if fineness is None:
        raise ArithmeticError("fewer than two distances have pairs that differ")
    return Study(provenance=Provenance.here(), panels=done, pairs=PAIRS, fineness=fineness)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run and ship; its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m validation.maps.ship", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder for the stores")
    parser.add_argument("--workers", type=int, default=2, help="processes (%(default)s)")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    with open_pool("processes", workers=options.workers) as pool:
        study = run(options.folder, pool)
    FILE.write(study, FILE.shipped)
    sys.stdout.write(f"{FILE.shipped}, {study.provenance.text()}\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
