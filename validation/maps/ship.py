"""The maps that come with the package: which, how fine, and the jobs that make them."""

from pathlib import Path
from tempfile import TemporaryDirectory

from analysis import Scenario
from validation.kit.parts import Job
from validation.maps.problems import PROBLEMS
from validation.maps.run import Panel, panels, run_pairs, run_panel
from validation.maps.uncertainty import Uncertainty, shifted_sweeps
from validation.sweeps.pools import open_pool
from validation.sweeps.sweep import Sweep

CELLS = 8
LEVELS = {"spin-friction": 2, "spin-eccentricity": 2, "tilting": 2, "basins": 2, "rest": 1}
"""Maps of the report and how often their cells are halved; one to rest takes longest."""

WITNESSES = 2
"""On the coarse grid of each panel; see `panels`."""

PAIRS = 40


def jobs() -> list[Job]:
    """A job for each panel of the maps, and the last one for how fine the map to rest is."""
    return [
        *(
            Job(("map", name, index), run_map, (name, index))
            for name in LEVELS
            for index in range(len(sweeps(name)))
        ),
        Job(("map", "fineness"), run_fineness),
    ]


def sweeps(name: str) -> list[Sweep]:
    """Sweeps of the panels of a map."""
    problem = PROBLEMS[name]
    return panels(
        problem,
        Scenario(),
        cells=CELLS,
        levels=LEVELS[name],
        end=problem.end,
        witnesses=WITNESSES,
    )


def run_map(name: str, index: int) -> tuple[str, Panel]:
    """Name of a map, and one of its panels."""
    with TemporaryDirectory() as folder, open_pool("processes", workers=1) as pool:
        store = Path(folder) / "panel.db"
        levels = LEVELS[name]
        return name, run_panel(
            PROBLEMS[name], sweeps(name)[index], store, levels=levels, pool=pool
        )


def run_fineness() -> tuple[int, Uncertainty]:
    """Number of starts of the map to rest beside which others are run, and how it ends there.

    Raises
    ------
    ArithmeticError
        If there are too few pairs for an exponent.
    """
    rest = PROBLEMS["rest"]
    pairs = shifted_sweeps(rest, Scenario(), number=PAIRS, end=rest.end)
    with TemporaryDirectory() as folder, open_pool("processes", workers=1) as pool:
        found = run_pairs(rest, pairs, Path(folder), pool=pool)
    if found is None:
        raise ArithmeticError("fewer than two distances have pairs that differ")
    return PAIRS, found
