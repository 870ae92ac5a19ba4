"""What is modelled: values for the text, and the formulations with the models that they build."""

from analysis import LEVELS, MODELS, Scenario
from analysis.problem.disk import STEEL_RING
from analysis.simulation.forms import FORMS
from mbs_models import FORMULATIONS, Scene, formulations
from validation.page.content import Content, Rows
from validation.study import Row, Study, equal

TITLE = "What is modelled"
STUDIES: tuple[Study, ...] = ()

INHOUSE = {"index-1": LEVELS, "reduced": LEVELS[-1:]}
"""Models of the in-house formulations."""


def present(rows: Rows) -> Content:
    """Values of the default scenario, started for Model 2; nothing is measured."""
    del rows
    built, held = ways(), Scenario(constraints=MODELS[2])
    number = sum(bool(built[way]["models"]) for way in FORMULATIONS)
    name = "modelled: formulations that build a model"
    return Content(
        numbers={
            "ways": built,
            "ring": STEEL_RING,
            "scenario": held,
            "x": held.initial_state.coordinates[0],
        },
        checks=[equal(name, number, len(FORMULATIONS))],
    )


def ways() -> dict[str, Row]:
    """Models that each formulation builds, and those with constraints left to the engine."""
    scenarios = {level: Scenario(constraints=MODELS[level]) for level in LEVELS}
    found: dict[str, Row] = {}
    for way in FORMULATIONS:
        built = [level for level in LEVELS if way in formulations(scenarios[level])]
        tied = [level for level in built if Scene(scenarios[level], way).has_constraints]
        found[way] = {"side": "engine", "models": built, "tied": tied}
    for form in FORMS:
        found[form] = {"side": "in-house", "models": INHOUSE.get(form, ()), "tied": ()}
    return found
