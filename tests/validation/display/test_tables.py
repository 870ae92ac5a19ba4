"""Tables for a terminal."""

import pytest

from validation.display.tables import Table

WIDE = Table(
    title="What is compared, and to which number of digits it has come out",
    columns=("name", "largest difference", *(f"Re λ {number}" for number in range(8)), "reason"),
    rows=[
        (name, 1e-9, *(123.5 + number for number in range(8)), "not defined for a flat disk " * 3)
        for name in ("elsewhere/eigenvalues.npz", "accelerations")
    ],
    note="Columns follow the branches, which keep their colours in the picture.",
)


@pytest.mark.parametrize("width", [60, 80, 120, 400])
def test_table_is_no_narrower_than_its_terminal_and_keeps_every_word(width: int) -> None:
    shown, (name, _, *others) = WIDE.to_text(width), WIDE.rows[0]
    assert max(map(len, shown.splitlines())) == min(width, 195)
    words = " ".join(map(str, (WIDE.title, *WIDE.columns, WIDE.note, name, *others)))
    assert {*words.split()} <= {*shown.split()}
    assert shown.count("disk") == 6
    # The headings have as many lines as they need.
    heads, _, below = shown.partition("---")
    assert "difference" in heads
    assert "elsewhere" in below
    # What fits has a line for each row.
    assert (shown.count("\n") == len(WIDE.rows) + 4) == (width == 400)
