"""A section on the toy study."""

import pandas as pd

from tests.toy_study import STUDY
from validation.display.figures import new_figure
from validation.study import Content, Rows, at_most

TITLE = "Toy"
STUDIES = (STUDY,)


def present(rows: Rows) -> Content:
    """Tables, a figure and a check."""
    table = rows["toy"]
    figure, axes = new_figure()
    axes.plot(table["value"], table["power"])
    return Content(
        numbers={"largest": float(table["value"].max())},
        tables={
            "powers": table[["power", "value"]],
            "long": pd.DataFrame({"number": range(40), "holds": True}),
        },
        figures={"curve": lambda: figure},
        checks=[at_most("toy: largest", float(table["value"].max()), 4.0, "stored")],
    )
