"""What the report says of the linear stability of spinning upright."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from validation.comparison.limits import largest
from validation.studies.comparisons import EIGENVALUE_LIMIT
from validation.studies.stability import figures, measured, variants  # noqa: F401 # in the text
from validation.studies.stability.measured import CLOSED, ENGINE, HERE, HOPF, OWN
from validation.study import Check, Content, Rows, at_most, equal, grade

TITLE = "Linear stability"
STUDIES = (measured.EIGENVALUES, measured.NUMBERS, measured.VARIANTS, measured.REGION)

SPEED_LIMIT = 1e-6
"""Largest difference in rad/s of critical speeds that are found in several ways."""


def present(rows: Rows) -> Content:
    """Numbers, tables, figures and checks."""
    values, numbers, tried, region = (rows[study.name].drop(columns="case") for study in STUDIES)
    found = numbers.set_index("quantity")
    of_models = values[values.constraints.str.startswith("Model")]
    # In the engine's first formulation of each.
    first = of_models.drop_duplicates(["constraints", "motion"])
    first = first.set_index(["constraints", "motion"])
    full, stable = first.loc["Model 1"], first.at[("Model 1", "inverted"), measured.STABLE]
    inside = region[region.place == measured.INSIDE].iloc[0]
    return Content(
        numbers={
            "critical": _critical(found),
            "hopf": found.loc[HOPF, HERE].tolist(),
            "stable": stable,
            "corners": region[region.kind == "corner"],
            "inside": inside,
            "answers": _answers(found, stable),
            "changes": len(tried) - 1,
            "models_apart": largest(of_models.difference),
            "sets_apart": largest(values.difference),
            "own": values.groupby("is constrained")[OWN],
        },
        tables={
            "region": region.loc[region.kind != "curve"].drop(
                columns=["kind", "spins", "gradients"]
            ),
            "variants": tried,
            "eigenvalues": values.drop(columns=["spins", "real", "imag"]),
        },
        figures={
            "figure-6": lambda: figures.figure_6(full.loc["inverted"], found),
            "figure-10": lambda: figures.figure_10(first.loc[("Model 4", "inverted")], found),
            "figure-11": lambda: figures.figure_11(full.loc["noninverted"]),
            "chart": lambda: figures.chart(region),
        },
        checks=list(_checks(values, found, tried, region)),
    )


def _critical(found: pd.DataFrame) -> list[float]:
    """Critical speed of the reduced system in rad/s: closed form, root finding, engine."""
    return [found.at[CLOSED, HERE], *found.loc[measured.COMPUTED, [HERE, ENGINE]]]


def _checks(
    values: pd.DataFrame, found: pd.DataFrame, tried: pd.DataFrame, region: pd.DataFrame
) -> Iterator[Check]:
    scenes = 2 * len(measured.scenes())
    yield equal("eigenvalues: scenes in both motions", len(values), scenes)
    apart = largest(values.difference)
    yield at_most("eigenvalues: engine against in-house", apart, EIGENVALUE_LIMIT)
    stock = largest(values.loc[~values["is constrained"], OWN])
    yield at_most("eigenvalues: the engine's own, unconstrained", stock, EIGENVALUE_LIMIT)
    kinds = values.groupby(["but for the spin", "motion"])
    other = int((kinds[["eigenvalues", measured.STABLE]].nunique() > 1).any(axis=1).sum())
    yield equal("eigenvalues: sets that holding the spin changes", other, 0)
    ways = {"critical speed": _critical(found)}
    ways |= {name: found.loc[name, [HERE, ENGINE]].tolist() for name in HOPF}
    for name, speeds in ways.items():
        yield at_most(f"{name}: ways apart", float(np.ptp(speeds)), SPEED_LIMIT)
    points = region[region.kind == "point"]
    yield equal("stable region: points", len(points), 5)
    for _, point in points.iterrows():
        inside = point.place == measured.INSIDE
        for side in ("in-house", ENGINE):
            rate = point[side]
            holds = bool(rate < 0.0 if inside else rate > 0.0)
            name, limit = f"growth {point.place}, {side}", "below 0" if inside else "above 0"
            yield Check(f"stable region: {name}", rate, limit, "fresh", holds)
    # Tried as the variants are, the equations as they are have to cross where they do.
    as_they_are = tried.set_index("variant").at["equations as they are", measured.SPEEDS]
    here = ", ".join(f"{speed:.3f}" for speed in found.loc[HOPF, HERE])
    yield equal("variants: the equations as they are", as_they_are, here)


def _answers(found: pd.DataFrame, stable: str) -> dict[str, str]:
    """Whether critical and Hopf speeds are those printed, and inverted spinning never stable.

    The paper says that of its own friction alone.
    """
    printed = found["printed"]
    critical = [measured.rounds_to(each, printed[CLOSED]) for each in _critical(found)]
    hopf = [measured.rounds_to(found.at[name, HERE], printed[name]) for name in HOPF]
    return {
        "critical": grade(yes=all(critical)),
        "hopf": grade(yes=all(hopf), partly=any(hopf)),
        "unstable": grade(yes=stable == "nowhere"),
    }
