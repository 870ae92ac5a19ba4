"""The formulations by name, and which of them can build a scenario."""

from analysis.data.scenario import Scenario
from mbs_models.floating import Floating, FloatingLie
from mbs_models.model import Formulation, Model
from mbs_models.trees import ContactTree, EulerTree

_BY_ACCURACY: tuple[type[Model], ...] = (ContactTree, EulerTree, Floating, FloatingLie)
_TO_REST: tuple[type[Model], ...] = (FloatingLie, Floating)

CLASSES: dict[Formulation, type[Model]] = {each.name: each for each in _BY_ACCURACY}


def formulations(scenario: Scenario) -> tuple[Formulation, ...]:
    """Formulations that can build a scenario, the most accurate one first.

    Parameters
    ----------
    scenario : Scenario

    Examples
    --------
    >>> from analysis import Scenario
    >>> from mbs_models import formulations
    >>> formulations(Scenario())
    ('contact-tree', 'euler-tree', 'floating', 'floating-lie')
    """
    contact = scenario.contact
    lies_flat = contact is not None and (contact.is_rounded or scenario.dissipation.is_on)
    ranked = _TO_REST if lies_flat else _BY_ACCURACY
    return tuple(each.name for each in ranked if not each.obstacle(scenario))
