"""A section on the toy study."""

import pandas as pd

from tests.toy_study import STUDY
from validation.kit.figures import new_figure
from validation.page.content import Content, Rows, Verdict
from validation.study import at_most

TITLE = "Toy"
STUDIES = (STUDY,)


def present(rows: Rows) -> Content:
    """A table, a figure, a check and a verdict."""
    table = rows["toy"]
    figure, axes = new_figure()
    axes.plot(table["value"], table["power"])
    return Content(
        numbers={"largest": float(table["value"].max())},
        tables={
            "powers": table[["power", "value"]],
            "long": pd.DataFrame({"number": range(40), "holds": True}),
        },
        figures={"curve": figure},
        checks=[at_most("toy: largest", float(table["value"].max()), 4.0, "stored")],
        verdicts=[Verdict(statement="It grows.", answer="yes", numbers="4", criterion="above 1")],
    )
