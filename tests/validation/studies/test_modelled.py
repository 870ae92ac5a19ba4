"""What is modelled: the tables are those of what is run."""

import pytest

from validation.studies import modelled

CONTENT = modelled.present({})


def test_parameters_are_those_of_the_default_scenario() -> None:
    values = {
        row["parameter"]: row["value"]
        for name in ("disk", "motion")
        for row in CONTENT.tables[name].to_dict("records")  # type: ignore[union-attr]
    }
    assert values["coefficient"] == 0.3
    assert values["mass"] == pytest.approx(0.4354247, rel=1e-6)
    assert values["inertia z"] == pytest.approx(468.0816, rel=1e-6)
    assert values["x"] == pytest.approx(-0.2496, rel=1e-3)


def test_only_the_contact_tree_leaves_no_constraint_and_builds_model_1_alone() -> None:
    built = {way: told for way, told in modelled.ways().items() if told["side"] == "engine"}
    assert built.pop("contact-tree") == {"side": "engine", "models": [1], "tied": []}
    assert all(told["tied"] for told in built.values())
