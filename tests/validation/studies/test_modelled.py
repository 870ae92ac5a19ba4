"""What is modelled: the tables are those of what is run."""

import pytest

import mbs_models
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
    assert values["moment of inertia about G, z"] == pytest.approx(468.0816, rel=1e-6)
    assert values["centre, Models 2 to 4: −e cos γ"] == pytest.approx(-0.2496, rel=1e-3)


def test_only_the_contact_tree_leaves_no_constraint_and_builds_model_1_alone() -> None:
    table = modelled.formulation_table().set_index("way")
    engine = table[table["side"] == "engine"]
    assert engine.index[engine["with constraints"] == "–"].tolist() == ["contact-tree"]
    assert engine.loc["contact-tree", "models"] == "1"


def test_a_way_that_is_not_told_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    assert all(check.holds for check in CONTENT.checks)
    monkeypatch.setattr(modelled, "FORMULATIONS", (*mbs_models.FORMULATIONS, "another"))
    assert not all(check.holds for check in modelled.present({}).checks)
