"""Corners of the stability chart: where two stability boundaries of the full system meet."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from math import log
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.stability.chart import static_gradient
from analysis.stability.hopf_curves import LEAST_FREQUENCY, HopfCurve
from analysis.stability.hopf_points import CONVERGED, ExtendedSystem
from analysis.stability.scope import spin_scale


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

    kind: Literal["double hopf", "zero hopf", "double zero"]
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
    scale = spin_scale(scenario)
    free = curve.frequencies > 2 * LEAST_FREQUENCY
    points = _points(scenario, curve)[free]
    static = static_gradient(scenario, curve.spins[free], curve.motion)
    above = curve.gradients[free] > static
    result = []
    for index in np.nonzero(np.diff(above) & np.isfinite(static[:-1] + static[1:]))[0].tolist():
        system = ExtendedSystem(scenario, curve.motion, points[index])
        x = _static_corner(system, points[index], points[index + 1])
        spin, gradient, frequency = x[0] * scale, np.exp(x[1]), x[2] * scale
        result.append(
            Corner(
                kind="zero hopf",
                spin=float(spin),
                gradient=float(gradient),
                frequencies=(float(frequency),),
            )
        )
    return result


def _static_corner(system: ExtendedSystem, start: Array, end: Array) -> Array:
    """Point between two Hopf points at which the static curve passes."""
    chord = end - start

    def point(part: float) -> Array:
        guess = start + part * chord
        found = system.correct(guess, chord, float(chord @ guess))
        if found is None:
            raise ArithmeticError(f"Hopf curve lost at spin {guess[0] * system.scale:g} rad/s")
        return found[0]

    def above(part: float) -> float:
        x = point(part)
        static = static_gradient(system.scenario, x[0] * system.scale, system.motion)[0]
        return float(x[1] - log(static))

    return point(float(brentq(above, 0.0, 1.0, xtol=1e-14)))


def _double_hopf(scenario: Scenario, one: HopfCurve, other: HopfCurve) -> list[Corner]:
    """Crossings of two Hopf curves: crossings of their chords, refined by Newton's method."""
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
        meeting = first[i] + s[i, j] * (first[i + 1] - first[i])
        partner = second[j] + t[i, j] * (second[j + 1] - second[j])
        x = np.append(meeting, partner[2])
        systems = (
            ExtendedSystem(scenario, one.motion, meeting),
            ExtendedSystem(scenario, other.motion, partner),
        )
        x = _meet(systems, x)
        result.append(
            Corner(
                kind="double hopf",
                spin=float(x[0] * scale),
                gradient=float(np.exp(x[1])),
                frequencies=(float(x[2] * scale), float(x[3] * scale)),
            )
        )
    return result


def _meet(systems: tuple[ExtendedSystem, ExtendedSystem], x: Array) -> Array:
    """Newton's method for a common point (Omega / s, ln delta) with two frequencies."""
    for _ in range(12):
        residuals, jacobian = np.empty(4), np.zeros((4, 4))
        for half, system in enumerate(systems):
            unknowns = [0, 1, 2 + half]
            rows = slice(2 * half, 2 * half + 2)
            residuals[rows], jacobian[rows, unknowns] = system.residual(x[unknowns])
        step = np.linalg.solve(jacobian, -residuals)
        x = x + step
        if np.max(np.abs(step)) < CONVERGED:
            return x
    raise ArithmeticError(
        f"no common point of two Hopf curves near {systems[0].scale * x[0]:g} rad/s"
    )
