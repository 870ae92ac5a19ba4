"""The maps as they are shipped with the package."""

from dataclasses import dataclass, replace
from functools import cache

from validation.kit import shipped as kit
from validation.kit.provenance import Provenance
from validation.maps.problems import PROBLEMS
from validation.maps.run import Panel
from validation.maps.uncertainty import Uncertainty


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


@cache
def shipped() -> Study | None:
    """The maps that come with the package, None if there are none."""
    found = kit.of("maps")
    if found is None:
        return None
    panels: dict[str, tuple[Panel, ...]] = {}
    *made, (pairs, fineness) = found.results()
    for name, panel in made:
        # What a map is called may have changed since.
        here = replace(panel, problem=PROBLEMS[name])
        panels[name] = (*panels.get(name, ()), here)
    return Study(provenance=found.provenance, panels=panels, pairs=pairs, fineness=fineness)
