"""Corners of the stability chart: where two stability boundaries of the full system meet.

Along a Hopf curve another eigenvalue or pair reaches the imaginary axis there, or the curve ends.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.stability.hopf_curves import ExtendedSystem, HopfCurve
from analysis.stability.linearisation import ComplexArray, falling, spin_scale

Kind = Literal["double hopf", "zero hopf", "double zero"]


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
    found = [each for curve in curves for each in _along(scenario, curve)]
    return tuple(sorted(found, key=lambda corner: corner.gradient))


def _along(scenario: Scenario, curve: HopfCurve) -> Iterator[Corner]:
    """Corners of a curve; of two curves that cross, those of the lower frequency."""
    for end, spin, gradient in zip(
        curve.ends, curve.spins[[0, -1]].tolist(), curve.gradients[[0, -1]].tolist(), strict=True
    ):
        if end == "double zero":
            yield Corner(kind="double zero", spin=spin, gradient=gradient, frequencies=(0.0,))
    scale = spin_scale(scenario)
    points = np.column_stack(
        (curve.spins / scale, np.log(curve.gradients), curve.frequencies / scale)
    )
    system = ExtendedSystem(scenario, curve.motion, points[0])
    unstable = [int(np.sum(_others(system, point).real > 0.0)) for point in points]
    for index in np.flatnonzero(np.diff(unstable)).tolist():
        # The last one that is unstable on either side is the one that crosses.
        place = max(unstable[index : index + 2]) - 1
        point = _meeting(system, points[index], points[index + 1], place)
        frequency = abs(float(_others(system, point)[place].imag))
        spin, own = (point[[0, 2]] * scale).tolist()
        gradient = float(np.exp(point[1]))
        if frequency == 0.0:
            yield Corner(kind="zero hopf", spin=spin, gradient=gradient, frequencies=(own,))
        elif frequency > own:
            yield Corner(
                kind="double hopf", spin=spin, gradient=gradient, frequencies=(own, frequency)
            )


def _others(system: ExtendedSystem, point: Array) -> ComplexArray:
    """Eigenvalues by falling real part at a Hopf point, without its own pair."""
    values = np.linalg.eigvals(system.matrices(point)[0]).astype(complex)
    pair = 1j * point[2] * system.scale * np.array((1.0, -1.0))
    nearest = [int(np.argmin(np.abs(values - each))) for each in pair]
    return falling(np.delete(values, nearest))


def _meeting(system: ExtendedSystem, low: Array, high: Array, place: int) -> Array:
    """Point between two neighbouring ones of a curve at which a real part is zero."""
    system.renew(low)

    def between(part: float) -> Array:
        found = system.curve.correct(low + part * (high - low), high - low)
        if found is None:
            raise ArithmeticError(
                f"no meeting of two boundaries near {system.scale * low[0]:g} rad/s"
            )
        return found[0]

    part = brentq(
        lambda part: float(_others(system, between(part))[place].real), 0.0, 1.0, xtol=1e-14
    )
    return between(float(part))
