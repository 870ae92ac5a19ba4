"""The orders in the smoothing of the closed form of the eigenvalues, Eqs. (118) to (122)."""

import numpy as np
import pandas as pd

from analysis import MODELS, Scenario, SmoothCoulomb
from analysis.data.checks import Array
from analysis.stability.printed import closed_form, reduced_matrices
from validation.studies.claims.grades import Judged, within
from validation.study import Row, Study

SMOOTHINGS = np.geomspace(1e-3, 1e-2, 7)
"""Smoothing speeds in m/s; below, rounding shows in the error of b."""

CLOSE = 0.05
"""By which a fitted exponent may differ from the paper's."""

SPIN = 40.0
"""In rad/s."""

ORDERS = {"a = λ₃ (118)": -1, "b (118)": 1, "c (118)": 0, "a less (119), (122)": 1}
"""What is followed, and the order that the paper gives for it."""


def values(smoothing: float) -> Array:
    """Sizes of what is in `ORDERS` at a smoothing in m/s, shape (4,)."""
    scenario = Scenario(constraints=MODELS[4], friction=SmoothCoulomb(smoothing=smoothing))
    found = np.linalg.eigvals(reduced_matrices(scenario, [SPIN])[0])
    third, lower, upper = np.sort_complex(found)
    a, b, c = third.real, -(lower + upper).real, (lower * upper).real
    return np.abs((a, b, c, a - closed_form(scenario, [SPIN]).a))


def measure(_: object) -> list[Row]:
    """Exponent of the smoothing in each quantity, fitted by least squares."""
    sizes = np.array([values(smoothing) for smoothing in SMOOTHINGS])
    fitted = np.polyfit(np.log(SMOOTHINGS), np.log(sizes), 1)[0]
    rows = zip(ORDERS.items(), fitted, strict=True)
    return [{"quantity": name, "order": order, "fitted": each} for (name, order), each in rows]


CLOSED_FORM = Study(
    name="closed-form-orders",
    cases=lambda: {"40 rad/s": None},
    measure=measure,
    keys=("quantity",),
)


def judge(table: pd.DataFrame) -> Judged:
    """Section 6: a = O(1/ε), b = O(ε), c = O(1), λ₃ = A_33 + O(ε)."""
    right = (table["fitted"] - table["order"]).abs() <= CLOSE
    verdict = within((~right).sum(), 0, len(table) - 1)
    return verdict | {"orders": table["order"], "fitted": table["fitted"]}
