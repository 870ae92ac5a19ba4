"""What scenes pay for what they do not need."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.problem.checks import Array
from validation.page.section import Section
from validation.studies import lean

PART = "friction of coefficient zero"


Timed = tuple[float, Array]


def evenly(*calls: Callable[[], Timed], pairs: int) -> list[list[Timed]]:
    """Runs in turns on a machine on which the first always takes a fifth longer."""
    return [
        [(seconds, call()[1])] * pairs for call, seconds in zip(calls, (1.2, 1.0), strict=True)
    ]


@pytest.mark.parametrize("name", lean.cases())
def test_no_part_that_a_scene_does_not_need_changes_its_motion(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lean, "in_turns", evenly)
    monkeypatch.setattr(lean, "DURATION", 0.01)
    (row,) = lean.price(lean.cases()[name])
    assert row["change"] < 1e-12 < lean.SAME


def test_price_is_that_of_the_part_and_a_change_of_the_motion_is_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lean, "in_turns", evenly)
    monkeypatch.setattr(lean, "DURATION", 0.05)
    (row,) = lean.price(lean.cases()[f"{PART}: contact-tree, Model 1, without friction"])
    assert [row[name] for name in ("from", "price in %", "to")] == pytest.approx([20.0] * 3)
    (row,) = lean.price((PART, lean.scene(1, "contact-tree")))
    assert row["change"] > 1e3 * lean.SAME
    for least, most, said in (
        (19.0, 21.0, "1 have a price."),
        (-1.0, 21.0, "0 have a price, and for 1 none is"),
        (-3.0, -1.0, "0 have a price, and 1 seem to save up to 20.0 % of"),
    ):
        table = pd.DataFrame([{"case": "a", **row, "change": 1e-12, "from": least, "to": most}])
        content = lean.present({"lean": table})
        text = Section("lean", content, Path(lean.__file__).with_suffix(".md")).filled(vars(lean))
        assert f"of 1 parts in these scenes, {said}" in text[1]
    for change, holds in ((1e-12, True), (1e-3, False), (np.nan, False)):
        table = pd.DataFrame([{"case": "a", **row, "change": change}])
        assert [check.holds for check in lean.present({"lean": table}).checks] == [holds]
