"""What scenes pay for what they do not need."""

import numpy as np
import pandas as pd
import pytest

from validation.studies import lean

PART = "friction of coefficient zero"


def test_price_is_measured_and_a_change_of_the_motion_is_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lean, "PAIRS", 5)
    monkeypatch.setattr(lean, "DURATION", 0.05)
    (row,) = lean.price(lean.cases()[f"{PART}: contact-tree, Model 1, without friction"])
    assert row["from"] <= row["price in %"] <= row["to"]
    # A user function that is called at every step costs more than the machine's noise.
    assert row["price in %"] > 5.0
    assert row["change"] < lean.SAME
    (row,) = lean.price((PART, lean.scene(1, "contact-tree")))
    assert row["change"] > 1e3 * lean.SAME
    for change, holds in ((1e-12, True), (1e-3, False), (np.nan, False)):
        table = pd.DataFrame([{"case": "a", **row, "change": change}])
        assert [check.holds for check in lean.present({"lean": table}).checks] == [holds]
