"""What the analyses of spinning ask of a scenario."""

from math import sqrt

from analysis.data.quantities import Level
from analysis.data.scenario import Scenario


def spin_scale(scenario: Scenario) -> float:
    """Natural unit of spins and frequencies: sqrt(g / r) in rad/s."""
    return sqrt(scenario.table.gravity / scenario.disk.radius)


def require_spinning(scenario: Scenario, analysis: str, level: Level | None = None) -> None:
    """Raise `ValueError` unless a scenario has the stationary motions that an analysis knows.

    Parameters
    ----------
    scenario : Scenario
    analysis : str
        What to call it, such as "the full system".
    level : {1, 2, 3, 4}, optional
        The one model that it describes; any constraints by default.

    Raises
    ------
    ValueError
        If the table leans, the contact is compliant, or the model is another one.
    """
    scenario.require_horizontal_table(analysis)
    if scenario.contact is not None:
        raise ValueError(f"{analysis} needs the ideal contact, got a {scenario.contact!r}")
    if level is not None and scenario.model != level:
        raise ValueError(
            f"{analysis} is that of Model {level}, got {scenario.name}; "
            "the system 'numeric' takes any constraints"
        )
