"""The maps as data: in a file, and as they are shipped with the package."""

from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from validation.kit.full_study import FULL_STUDY, StudyFile, rounded
from validation.kit.provenance import Provenance
from validation.maps.problems import PROBLEMS
from validation.maps.run import Panel, Witness
from validation.maps.uncertainty import Uncertainty
from validation.sweeps.sweep import Sweep

DIGITS = 3
"""Of stored times and differences."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """All maps of the report.

    Parameters
    ----------
    provenance : Provenance
    panels : dict
        Panels of each map by the names of `PROBLEMS`.
    pairs : int
        Starts of `fineness`.
    fineness : Uncertainty
        Of the map to rest.
    """

    provenance: Provenance
    panels: dict[str, tuple[Panel, ...]]
    pairs: int
    fineness: Uncertainty


def _pack(study: Study) -> dict[str, Any]:
    fineness = asdict(study.fineness)
    return {
        "provenance": study.provenance.to_dict(),
        "panels": [
            {"map": name, **_pack_panel(panel)}
            for name, panels in study.panels.items()
            for panel in panels
        ],
        "pairs": study.pairs,
        "fineness": {
            name: rounded(value.tolist() if isinstance(value, np.ndarray) else value, DIGITS)
            for name, value in fineness.items()
        },
    }


def _pack_panel(panel: Panel) -> dict[str, Any]:
    names = sorted(set(panel.classes.values()))
    times = {number: rounded(time, DIGITS) for number, time in panel.times.items()}
    return {
        "sweep": panel.sweep.to_values(),
        "seconds": rounded(panel.seconds, DIGITS),
        "classes": names,
        "cases": [
            # A case of the class "inverted" also has its time.
            [number, names.index(name), *([times[number]] if number in times else [])]
            for number, name in sorted(panel.classes.items())
        ],
        "witnesses": [
            [number, each.alike, rounded(each.difference, DIGITS)]
            for number, each in panel.witnesses.items()
        ],
    }


def _unpack(stored: dict[str, Any]) -> Study:
    panels: dict[str, tuple[Panel, ...]] = {}
    for each in stored["panels"]:
        panels[each["map"]] = (*panels.get(each["map"], ()), _unpack_panel(each))
    fineness: dict[str, Any] = {
        name: np.array(value) if isinstance(value, list) else value
        for name, value in stored["fineness"].items()
    }
    return Study(
        provenance=Provenance(**stored["provenance"]),
        panels=panels,
        pairs=stored["pairs"],
        fineness=Uncertainty(**fineness),
    )


def _unpack_panel(stored: dict[str, Any]) -> Panel:
    names = stored["classes"]
    return Panel(
        problem=PROBLEMS[stored["map"]],
        sweep=Sweep.from_values(stored["sweep"]),
        classes={number: names[code] for number, code, *_ in stored["cases"]},
        times={number: time[0] for number, _, *time in stored["cases"] if time},
        witnesses={
            number: Witness(alike=alike, difference=difference)
            for number, alike, difference in stored["witnesses"]
        },
        seconds=stored["seconds"],
    )


FILE = StudyFile(
    name="maps",
    shipped=Path(__file__).parent / FULL_STUDY,
    pack=_pack,
    unpack=_unpack,
    breaks=('},{"map"', '},\n{"map"'),
)

shipped = cache(FILE.read_shipped)
"""The maps that come with the package, None if there are none."""
