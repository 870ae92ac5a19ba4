"""The orders in the smoothing of the closed form of the eigenvalues, Eqs. (118) to (123)."""

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

QUANTITIES = {
    "a = λ₃ (118)": -1,
    "b (118)": 1,
    "c (118)": 0,
    "a less (119), (122)": 1,
    "b less (121)": None,
    "c less (120)": None,
    "λ₁ less (123)": None,
}
"""What is followed, and the order the paper gives for it, if it does."""


def values(smoothing: float, spin: float) -> Array:
    """Sizes of `QUANTITIES` at one smoothing in m/s and spin in rad/s, shape (7,)."""
    scenario = Scenario(constraints=MODELS[4], friction=SmoothCoulomb(smoothing=smoothing))
    matrix = reduced_matrices(scenario, [spin])[0]
    third, lower, upper = np.sort_complex(np.linalg.eigvals(matrix))
    a, b, c = third.real, -(lower + upper).real, (lower * upper).real
    form = closed_form(scenario, [spin])
    first = max(form.eigenvalues[0][:2], key=lambda value: value.imag)
    return np.abs((a, b, c, a - form.a, b - form.b[0], c - form.c[0], upper - first))


def measure(spin: float) -> list[Row]:
    """Exponent of the smoothing in each quantity, fitted by least squares."""
    sizes = np.array([values(smoothing, spin) for smoothing in SMOOTHINGS])
    fitted = np.polyfit(np.log(SMOOTHINGS), np.log(sizes), 1)[0]
    return [
        {"quantity": name, "order": order, "fitted": exponent, "spin": spin}
        for (name, order), exponent in zip(QUANTITIES.items(), fitted, strict=True)
    ]


ORDERS = Study(
    name="closed-form-orders",
    cases=lambda: {"40 rad/s": 40.0},
    measure=measure,
    keys=("quantity",),
)


def judge(table: pd.DataFrame) -> Judged:
    """Section 6: a = O(1/ε), b = O(ε), c = O(1), λ₃ = A_33 + O(ε)."""
    told = table.dropna(subset=["order"])
    wrong = int((~((told["fitted"] - told["order"]).abs() <= CLOSE)).sum())
    return within(wrong, 0, len(told) - 1) | {
        "orders": told["order"].tolist(),
        "fitted": told["fitted"].tolist(),
        "spin": told["spin"].iloc[0],
    }
