"""The hard cases: along each axis, motions become extreme in one respect."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import pi, radians, sqrt
from typing import Any, Literal

import numpy as np

from analysis import (
    MODELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    Disk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.data.checks import Array

TOLERANCE = 1e-6
"""Accuracy asked for in rad where a problem says nothing else."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A motion to be computed.

    Parameters
    ----------
    axis : str
        What is extreme about it.
    label : str
        How extreme.
    scenario : Scenario
    end : float
        In s.
    samples : int
    cover : {"all", "first", "fastest"}
        Whether all integrators of each formulation are tried, the first of each, or that of the
        first formulation alone, for motions that are too long for the others.
    tolerance : float
        Accuracy asked for in rad, and of the time of an ending in s.
    stop_when : tuple of str, optional
        What ends the motion besides a contact that would have to pull. If it is given, even an
        empty one, the reference finds the ending by itself.
    """

    axis: str
    label: str
    scenario: Scenario
    end: float = 0.5
    samples: int = 101
    cover: Literal["all", "first", "fastest"] = "first"
    tolerance: float = TOLERANCE
    stop_when: tuple[str, ...] | None = None

    @property
    def name(self) -> str:
        """Axis, label and model."""
        model = self.scenario.model
        return f"{self.axis}: {self.label}" + (f", Model {model}" if model else "")

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return np.linspace(0.0, self.end, self.samples)


Variation = tuple[str, dict[str, Any], dict[str, Any]]
"""Label, what is changed of a scenario, and what is asked for, as fields of `Problem`."""


def problems() -> list[Problem]:
    """Those of `AXES` and sets of constraints that are none of the paper's models."""
    found = [
        Problem(axis=axis, label=label, scenario=replace(base, **changes), **asked)
        for base in (Scenario(constraints=each) for each in MODELS.values())
        for axis, variations in AXES.items()
        for label, changes, asked in variations(base)
    ]
    others = (Scenario(constraints=each) for each in POSSIBLE_SETS)
    return found + [
        Problem(axis="constraint set", label=scenario.name, scenario=scenario)
        for scenario in others
        if scenario.model is None
    ]


def _smoothing(base: Scenario) -> Iterator[Variation]:
    for digits in (0, 2, 3, 4, 5, 6, 8) if base.model == 1 else (0, 2, 3, 4, 5, 8):
        friction = SmoothCoulomb(smoothing=10.0**-digits)
        cover = "all" if digits < 3 else "first"
        yield f"1e-{digits}" if digits else "1", {"friction": friction}, {"cover": cover}


def _stiffness(base: Scenario) -> Iterator[Variation]:
    friction = SmoothCoulomb(load="contact")
    for digits in (4, 6, 9) if base.model == 1 else ():
        contact = PenaltyContact.damped(10.0**digits, base.disk)
        yield f"1e{digits}", {"friction": friction, "contact": contact}, {"cover": "all"}


def _drops(base: Scenario) -> Iterator[Variation]:
    damping = {
        "undamped": PenaltyContact(stiffness=1e5),
        "damped": PenaltyContact.damped(1e5, base.disk),
    }
    for name, contact in damping.items() if base.model == 1 else ():
        for height in (1, 5):
            changes = {
                "friction": SmoothCoulomb(load="contact"),
                "contact": contact,
                "start": Start(height=1e-3 * height),
            }
            yield f"{height} mm, {name}", changes, {"end": 0.1}


def _spin(_: Scenario) -> Iterator[Variation]:
    for spin in (0.0, 100.0, 300.0, 1000.0, -40.0):
        asked = {
            "end": 0.05 if spin == 1000.0 else 0.5,
            "cover": "all" if spin == 100.0 else "first",
        }
        yield f"{spin:g}", {"start": Start(spin=spin)}, asked


def _contact_load(_: Scenario) -> Iterator[Variation]:
    """Friction by the contact force; the fast ones end where the contact would pull."""
    for spin, coefficient in ((100, 0.3), (200, 0.3), (300, 0.3), (40, 2), (40, 3), (300, 3)):
        friction = SmoothCoulomb(coefficient=coefficient, load="contact")
        cover = "all" if spin == 200 or coefficient == 3 else "first"
        changes = {"friction": friction, "start": Start(spin=spin)}
        yield f"{spin} rad/s, {coefficient:g}", changes, {"cover": cover}


def _tilt(base: Scenario) -> Iterator[Variation]:
    for label, beta, end in (
        ("1e-4", 1e-4, 4e-4),
        ("0.01", 0.01, 4e-3),
        ("π − 0.01", pi - 0.01, 4e-3),
    ):
        yield label, {"start": Start(beta=beta)}, {"end": end}
    if base.model == 1:
        yield "1e-4, beyond the fall", {"start": Start(beta=1e-4)}, {"end": 0.1, "samples": 11}


def body(moments: tuple[float, float, float], eccentricity: float) -> Disk:
    """The steel disk with other moments about the COG, and the COG elsewhere.

    Parameters
    ----------
    moments : tuple of 3 floats
        About the COG in kg m², so that a rigid body exists for every eccentricity.
    eccentricity : float
        In m.
    """
    shift = STEEL_DISK.mass * eccentricity**2
    a, b, c = moments
    return replace(
        STEEL_DISK,
        eccentricity=eccentricity,
        inertia_x=a,
        inertia_y=b + shift,
        inertia_z=c + shift,
    )


def _eccentricity(base: Scenario) -> Iterator[Variation]:
    for label, value in (("0", 0.0), ("1e-9", 1e-9), ("0.99 r", 0.99 * base.disk.radius)):
        yield label, {"disk": body(base.disk.inertia_about_cog, value)}, {"end": 0.25}


def _inertia(base: Scenario) -> Iterator[Variation]:
    """Flat bodies, in which one moment is the sum of the others, and rods, in which one is none.

    A rod of no moment at all is no rigid body: one in a thousand is left.
    """
    e, r = base.disk.eccentricity, base.disk.radius
    for label, parts, eccentricity in (
        ("lamina", (0.25, 0.25, 0.5), 0.0),
        ("lamina, COG at 0.9 r", (0.25, 0.25, 0.5), 0.9 * r),
        ("flat across x", (0.5, 0.25, 0.25), e),
        ("flat across y", (0.25, 0.5, 0.25), e),
        ("rod along x", (3e-4, 0.3, 0.3), e),
        ("rod along y", (0.3, 3e-4, 0.3), e),
        ("rod along z", (0.3, 0.3, 3e-4), e),
    ):
        a, b, c = (part * base.disk.mass * r**2 for part in parts)
        yield label, {"disk": body((a, b, c), eccentricity)}, {"end": 0.25}


def _radius(_: Scenario) -> Iterator[Variation]:
    """Table 3 for a steel disk of another size, at the same Froude number.

    Lengths are scaled by s, times by the root of s, speeds and smoothing likewise, so that the
    angles of the motion are those of the original.
    """
    for radius in (1e-3, 10.0):
        scale = radius / STEEL_DISK.radius
        changes = {
            "disk": Disk.ring(
                radius=radius,
                hole_radius=0.015 * scale,
                hole_distance=0.02 * scale,
                thickness=0.01 * scale,
                density=7700.0,
            ),
            "friction": SmoothCoulomb(smoothing=0.1 * sqrt(scale)),
            "start": Start(spin=40.0 / sqrt(scale)),
        }
        cover = "all" if scale < 1.0 else "first"
        yield f"{radius:g}", changes, {"end": 0.5 * sqrt(scale), "cover": cover}


def _friction(_: Scenario) -> Iterator[Variation]:
    for coefficient in (0.0, 10.0):
        yield f"{coefficient:g}", {"friction": SmoothCoulomb(coefficient=coefficient)}, {}


def _start(_: Scenario) -> Iterator[Variation]:
    for label, gamma, spin in (
        ("at rest", -pi / 2 + 0.1, 0.0),
        ("at rest, COG above", pi / 2, 0.0),
        ("noninverted spinning", -pi / 2, 40.0),
        ("inverted, below critical spin", pi / 2, 20.0),
    ):
        yield label, {"start": Start(gamma=gamma, spin=spin)}, {}


def _sampling(base: Scenario) -> Iterator[Variation]:
    """Few samples; and through inversion and fall, in Model 1 for tens of seconds."""
    yield "2 samples, 0.5 s", {}, {"samples": 2}
    yield "3 samples, 2 s", {}, {"samples": 3, "end": 2.0}
    rolling = Start(beta=1.0, gamma=0.0, spin=50.0)
    yield "2 samples, rolling fast", {"start": rolling}, {"samples": 2, "end": 0.3}
    first = base.model == 1
    for end in (5.0, 10.0, 20.0) if first else (5.0, 10.0):
        cover = "first" if end == 5.0 else "fastest"
        yield f"{end:g} s", {}, {"end": end, "samples": round(100 * end) + 1, "cover": cover}
    if first:
        # With this friction inverted spinning is stable.
        changes = {"friction": SmoothCoulomb(smoothing=0.2), "start": Start(gamma=pi / 2 - 0.1)}
        asked = {"end": 50.0, "samples": 5001, "cover": "fastest"}
        yield "50 s, to inverted spinning", changes, asked


def _inclination(_: Scenario) -> Iterator[Variation]:
    for degrees in (2, 30):
        table = Table(inclination=radians(degrees), downhill=1.0)
        yield f"{degrees}°", {"table": table}, {}


AXES: dict[str, Callable[[Scenario], Iterator[Variation]]] = {
    "smoothing ε in m/s": _smoothing,
    "contact stiffness in N/m": _stiffness,
    "start above the table": _drops,
    "spin in rad/s": _spin,
    "contact load: spin, μ": _contact_load,
    "tilt β in rad": _tilt,
    "eccentricity in m": _eccentricity,
    "inertia about the COG": _inertia,
    "radius of the disk in m": _radius,
    "friction μ": _friction,
    "start": _start,
    "sampling, duration": _sampling,
    "inclination of the table": _inclination,
}
"""Variations of each of the paper's models, by what is extreme about them."""
