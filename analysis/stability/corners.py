"""Corners of the stability chart: where two stability boundaries of the full system meet."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
from scipy.optimize import root

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.stability.chart import static_gradient
from analysis.stability.hopf_curves import LEAST_FREQUENCY, ExtendedSystem, HopfCurve
from analysis.stability.linearisation import spin_scale

Kind = Literal["double hopf", "zero hopf", "double zero"]

Equations = Callable[[Array], tuple[Array, Array]]

_SMALL = 1e-9
"""Residual of a corner, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """A point at which two stability boundaries of the full system meet.

    Parameters
    ----------
    kind : {"double hopf", "zero hopf", "double zero"}
        Two Hopf curves cross; a Hopf curve crosses the static curve; a Hopf curve starts there.
    spin : float
        Spinning speed in rad/s.
    gradient : float
        Friction gradient mu / epsilon in s/m.
    frequencies : tuple of float
        Imaginary parts of the critical pairs in rad/s.
    """

    kind: Kind
    spin: float
    gradient: float
    frequencies: tuple[float, ...]


def corners(scenario: Scenario, curves: Iterable[HopfCurve]) -> tuple[Corner, ...]:
    """Where Hopf curves of one scenario meet each other or the static curve, by gradient.

    Parameters
    ----------
    scenario : Scenario
        That of the curves.
    curves : iterable of HopfCurve

    Raises
    ------
    ArithmeticError
        If a meeting point cannot be refined.
    """
    curves = tuple(curves)
    found = [
        Corner(kind="double zero", spin=spin, gradient=gradient, frequencies=(0.0,))
        for curve in curves
        for end, spin, gradient in zip(
            curve.ends,
            curve.spins[[0, -1]].tolist(),
            curve.gradients[[0, -1]].tolist(),
            strict=True,
        )
        if end == "double zero"
    ]
    for curve in curves:
        found += _static_corners(scenario, curve)
    for one, other in combinations(curves, 2):
        found += _double_hopf(scenario, one, other)
    return tuple(sorted(found, key=lambda corner: corner.gradient))


def _points(scenario: Scenario, curve: HopfCurve) -> Array:
    """Curve in the unknowns of the extended system, shape (n, 3)."""
    scale = spin_scale(scenario)
    return np.column_stack(
        (curve.spins / scale, np.log(curve.gradients), curve.frequencies / scale)
    )


def _static_corners(scenario: Scenario, curve: HopfCurve) -> list[Corner]:
    """Crossings of a Hopf curve with the static curve, its own end on it aside."""
    free = curve.frequencies > 2 * LEAST_FREQUENCY
    points, scale = _points(scenario, curve)[free], spin_scale(scenario)

    def above(spin: float | Array) -> Array:
        """Logarithm of the static gradient at spins over the scale."""
        return np.log(static_gradient(scenario, np.asarray(spin) * scale, curve.motion))

    over = points[:, 1] > above(points[:, 0])
    crossed = np.diff(over) & np.isfinite(np.diff(above(points[:, 0])))
    result = []
    for guess in points[:-1][crossed]:
        hopf = ExtendedSystem(scenario, curve.motion, guess).residual

        def equations(x: Array, hopf: Equations = hopf) -> Array:
            return np.append(hopf(x)[0], x[1] - above(x[0]))

        result.append(_corner("zero hopf", _refined(equations, guess, scale), scale))
    return result


def _double_hopf(scenario: Scenario, one: HopfCurve, other: HopfCurve) -> list[Corner]:
    """Crossings of two Hopf curves, begun where their chords cross."""
    scale = spin_scale(scenario)
    first, second = _points(scenario, one), _points(scenario, other)
    # p + s a = q + t b for every pair of chords
    a, b = np.diff(first, axis=0)[:, None, :], np.diff(second, axis=0)[None, :, :]
    gap = second[None, :-1] - first[:-1, None]
    area = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (gap[..., 0] * b[..., 1] - gap[..., 1] * b[..., 0]) / area
        t = (gap[..., 0] * a[..., 1] - gap[..., 1] * a[..., 0]) / area
    result = []
    for i, j in np.argwhere((s >= 0) & (s < 1) & (t >= 0) & (t < 1)).tolist():
        meeting = first[i] + s[i, j] * a[i, 0]
        partner = second[j] + t[i, j] * b[0, j]
        both = (
            ExtendedSystem(scenario, one.motion, meeting).residual,
            ExtendedSystem(scenario, other.motion, partner).residual,
        )

        def equations(x: Array, both: tuple[Equations, Equations] = both) -> Array:
            return np.append(both[0](x[:3])[0], both[1](x[[0, 1, 3]])[0])

        x = _refined(equations, np.append(meeting, partner[2]), scale)
        result.append(_corner("double hopf", x, scale))
    return result


def _refined(equations: Callable[[Array], Array], guess: Array, scale: float) -> Array:
    """Root of as many equations as unknowns (Omega / s, ln delta, frequencies / s)."""
    found = root(equations, guess, tol=1e-13)
    if not np.max(np.abs(found.fun)) < _SMALL:
        raise ArithmeticError(f"no meeting of two boundaries near {scale * guess[0]:g} rad/s")
    return np.array(found.x)


def _corner(kind: Kind, x: Array, scale: float) -> Corner:
    spin, *frequencies = (np.delete(x, 1) * scale).tolist()
    return Corner(
        kind=kind, spin=spin, gradient=float(np.exp(x[1])), frequencies=tuple(frequencies)
    )
