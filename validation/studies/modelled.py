"""What is modelled: values for the text, and the formulations with the models that they build."""

import analysis
import mbs_models
from analysis import LEVELS, MODELS, Scenario
from analysis.problem.disk import STEEL_RING  # noqa: F401 # the text names it
from validation.study import Content, Row, Rows, Study, equal

TITLE = "What is modelled"
STUDIES: tuple[Study, ...] = ()


def present(rows: Rows) -> Content:
    """Values of the default scenario, started for Model 2; nothing is measured."""
    del rows
    built = ways()
    number = sum(bool(built[way]["models"]) for way in mbs_models.FORMULATIONS)
    name = "modelled: formulations that build a model"
    return Content(
        numbers={"ways": built, "scenario": Scenario(constraints=MODELS[2])},
        checks=[equal(name, number, len(mbs_models.FORMULATIONS))],
    )


def ways() -> dict[str, Row]:
    """Models that each formulation builds, and those with constraints left to the engine."""
    scenarios = {level: Scenario(constraints=MODELS[level]) for level in LEVELS}
    found: dict[str, Row] = {}
    for way in mbs_models.FORMULATIONS:
        built = [each for each in LEVELS if way in mbs_models.formulations(scenarios[each])]
        tied = [each for each in built if mbs_models.Scene(scenarios[each], way).has_constraints]
        found[way] = {"side": "engine", "models": built, "tied": tied}
    for formulation in analysis.FORMULATIONS:
        built = [each for each in LEVELS if formulation in analysis.formulations(scenarios[each])]
        found[formulation] = {"side": "in-house", "models": built, "tied": ()}
    return found
