"""What is modelled: the text is filled in with what is run."""

from validation.report import draw
from validation.studies import modelled
from validation.study import RESULTS


def test_parameters_are_those_of_the_default_scenario() -> None:
    text = draw(("modelled", {}, RESULTS))[0]["text"]
    for row in ("coefficient | μ | 0.3", "mass | m | 0.435425", "C | 468.082", "x̄ | -0.249584"):
        assert f"{row} |" in text


def test_only_the_contact_tree_leaves_no_constraint_and_builds_model_1_alone() -> None:
    built = {way: told for way, told in modelled.ways().items() if told["side"] == "engine"}
    assert built.pop("contact-tree") == {"side": "engine", "models": [1], "tied": []}
    assert all(told["tied"] for told in built.values())
