"""What scenes pay for what they do not need."""

from functools import partial

import numpy as np
import pandas as pd
import pytest

from mbs_models.scene import build
from validation.studies import lean

IDLE = "friction of coefficient zero: contact-tree, Model 1, without friction"


def held(change: float) -> list[bool]:
    """Whether the checks hold of a part that changes the motion so much."""
    row = {"carried": 2.0, "left out": 1.0, "price": 100.0, "least": 90.0, "most": 110.0}
    table = pd.DataFrame([{"part": "markers", "scene": "tree", **row, "change": change}])
    return [check.holds for check in lean.present({"lean": table}).checks]


def test_price_is_measured_and_a_change_of_the_motion_is_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lean, "PAIRS", 5)
    monkeypatch.setattr(lean, "DURATION", 0.05)
    (row,) = lean.price(lean.pairs()[IDLE])
    assert row["carried"] > 0.0
    assert row["least"] <= row["price"] <= row["most"]
    # A user function that is called at every step costs more than the machine's noise.
    assert row["price"] > 5.0
    assert row["change"] < lean.SAME
    rough = partial(build, lean.scene(1, "contact-tree"))
    (row,) = lean.price(lean.pairs()[IDLE]._replace(carried=rough))
    assert row["change"] > 1e3 * lean.SAME


def test_part_that_changes_the_motion_fails() -> None:
    assert [held(change) for change in (1e-12, 1e-3, np.nan)] == [[True], [False], [False]]
