"""The orders in the smoothing of the closed form of the eigenvalues, Eqs. (118) to (123)."""

import numpy as np

from analysis import MODELS, Scenario, SmoothCoulomb
from analysis.data.checks import Array
from analysis.stability.linear_reduced import closed_form, reduced_matrices
from validation.kit.tables import Table
from validation.studies.claims.claim import Claim, grade, listed

SPIN = 40.0
"""Spinning speed in rad/s."""

SMOOTHINGS = np.geomspace(1e-3, 1e-2, 7)
"""Smoothing speeds in m/s; below, rounding shows in the error of b."""

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


def values(smoothing: float) -> Array:
    """Sizes of `QUANTITIES` at one smoothing, shape (7,)."""
    scenario = Scenario(constraints=MODELS[4], friction=SmoothCoulomb(smoothing=smoothing))
    third, *pair = sorted(
        np.linalg.eigvals(reduced_matrices(scenario, [SPIN]))[0],
        key=lambda value: (value.real, value.imag),
    )
    a, b, c = third.real, -sum(pair).real, (pair[0] * pair[1]).real
    form = closed_form(scenario, [SPIN])
    first = max(form.eigenvalues[0][:2], key=lambda value: value.imag)
    upper = max(pair, key=lambda value: value.imag)
    sizes = (a, b, c, a - form.a, b - form.b[0], c - form.c[0], upper - first)
    return np.abs(sizes)


def slopes() -> dict[str, float]:
    """Exponent of the smoothing in each of `QUANTITIES`, fitted by least squares."""
    sizes = np.array([values(smoothing) for smoothing in SMOOTHINGS])
    fitted = np.polyfit(np.log(SMOOTHINGS), np.log(sizes), 1)[0]
    return dict(zip(QUANTITIES, fitted.tolist(), strict=True))


def claim(found: dict[str, float]) -> Claim:
    """Section 6: a = O(1/ε), b = O(ε), c = O(1), λ₃ = A_33 + O(ε)."""
    expected = {name: order for name, order in QUANTITIES.items() if order is not None}
    close = [abs(found[name] - order) <= 0.05 for name, order in expected.items()]
    return Claim(
        place="Sect. 6",
        statement="a = O(1/ε), b = O(ε), c = O(1), λ₃ = A₃₃ + O(ε)",
        criterion="the fitted exponents differ from -1, 1, 0, 1 by at most 0.05; partly: some",
        measured=f"exponents {listed((found[name] for name in expected), '.3f')} at "
        f"{SPIN:g} rad/s",
        verdict=grade(yes=all(close), partly=any(close)),
    )


def table(found: dict[str, float]) -> Table:
    """Fitted exponents."""
    return Table(
        name="closed-form-orders",
        title="Orders in ε of the closed form of the reduced system's eigenvalues",
        columns=("quantity", "order in the paper", "fitted exponent"),
        rows=[[name, order, found[name]] for name, order in QUANTITIES.items()],
        note=f"ε from {SMOOTHINGS[0]:g} to {SMOOTHINGS[-1]:g} m/s at {SPIN:g} rad/s, "
        "unrounded disk; the eigenvalues of Eq. (111) are computed numerically.",
    )
