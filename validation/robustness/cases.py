"""The hard cases: motions at the ends of what the parameters allow, and ways to compute them."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import pi, sqrt
from typing import Literal

import mbs_models
from analysis import (
    LEVELS,
    STEEL_DISK,
    Disk,
    Form,
    Level,
    Method,
    PenaltyContact,
    SmoothCoulomb,
    consistent_start,
)
from analysis.state import State
from mbs_models import Formulation, IntegratorName, Scene

TOLERANCE = 1e-6
"""Accuracy asked for in rad."""

STIFFEST = 1e-8
"""End of the range of the smoothing in m/s."""

QUICK_LEVELS: tuple[Level, ...] = (1,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A motion to be computed.

    Parameters
    ----------
    axis : str
        What is extreme about it.
    label : str
        How extreme.
    level : {1, 2, 3, 4}
    disk : Disk
    friction : SmoothCoulomb
    contact : PenaltyContact, optional
        The ideal contact if there is none. The engine alone has the other.
    start : State
    end : float
        In s.
    samples : int
    """

    axis: str
    label: str
    level: Level
    start: State
    disk: Disk = STEEL_DISK
    friction: SmoothCoulomb = field(default_factory=SmoothCoulomb)
    contact: PenaltyContact | None = None
    end: float = 0.5
    samples: int = 101


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A way to compute a motion: formulation and integrator, or in-house form and method."""

    source: Literal["engine", "in-house"]
    formulation: Formulation | Form
    integrator: IntegratorName | Method

    @property
    def name(self) -> str:
        """Formulation and integrator."""
        return f"{self.formulation}, {self.integrator}"


def ways(problem: Problem, *, quick: bool) -> list[Way]:
    """Ways that apply to a problem; in the quick version with their first integrator alone.

    So it is inside the very stiff range, where runs take long to fail.
    """
    smoothing = problem.friction.smoothing
    most = 1 if quick or STIFFEST < smoothing < 1e-4 else None
    stiff = smoothing < 1e-3
    methods: tuple[Method, ...] = ("Radau",) if stiff else ("DOP853", "Radau")
    forms: tuple[Form, ...] = ("index-1", "reduced") if problem.level == 4 else ("index-1",)
    engine = [
        Way(source="engine", formulation=formulation, integrator=integrator)
        for formulation in mbs_models.formulations(problem.level)
        if problem.contact is None or formulation != "contact-tree"
        for integrator in mbs_models.integrators(
            formulation, constrained=scene(problem, formulation).has_constraints
        )[:most]
    ]
    if problem.contact is not None:
        return engine
    in_house = [
        Way(source="in-house", formulation=form, integrator=method)
        for form in forms
        for method in methods[:most]
    ]
    return engine + in_house


def problems(*, quick: bool) -> list[Problem]:
    """All problems, for Model 1 alone in the quick version, without the long ones."""
    found: list[Problem] = []
    for level in QUICK_LEVELS if quick else LEVELS:
        found += _smoothing(level, quick=quick)
        found += _stiffness(quick=quick) if level == 1 else ()
        found += _spin(level, quick=quick)
        found += _tilt(level, quick=quick)
        found += _body(level)
        found += _friction(level)
        found += _rest(level)
        found += _sampling(level, quick=quick)
    return found


def _smoothing(level: Level, *, quick: bool) -> Iterator[Problem]:
    # Below, runs take a minute until they give up.
    for digits in (0, 2, 3) if quick else range(9):
        yield Problem(
            axis="smoothing ε in m/s",
            label=f"1e-{digits}" if digits else "1",
            level=level,
            friction=SmoothCoulomb(smoothing=10.0**-digits),
            start=consistent_start(level, STEEL_DISK),
        )


def _stiffness(*, quick: bool) -> Iterator[Problem]:
    for digits in (4, 6) if quick else range(4, 10):
        contact = PenaltyContact.damped(10.0**digits, STEEL_DISK)
        yield Problem(
            axis="contact stiffness in N/m",
            label=f"1e{digits}",
            level=1,
            friction=SmoothCoulomb(load="contact"),
            contact=contact,
            start=contact.lowered(STEEL_DISK, consistent_start(1, STEEL_DISK)),
        )


def _spin(level: Level, *, quick: bool) -> Iterator[Problem]:
    for spin in (0.0, 1.0, 100.0, 1000.0, -40.0):
        fast_end = 0.02 if quick else 0.05
        yield Problem(
            axis="spin in rad/s",
            label=f"{spin:g}",
            level=level,
            start=consistent_start(level, STEEL_DISK, spin=spin),
            end=fast_end if spin == 1000.0 else 0.5,
        )


def _tilt(level: Level, *, quick: bool) -> Iterator[Problem]:
    cases = [
        (1e-4, "1e-4", 4e-4, 101),
        (0.01, "0.01", 4e-3, 101),
        (pi - 0.01, "π − 0.01", 4e-3, 101),
        (pi - 1e-4, "π − 1e-4", 4e-4, 101),
    ]
    if not quick:
        cases.append((1e-4, "1e-4, beyond the fall", 0.1, 11))
    for beta, label, end, samples in cases:
        yield Problem(
            axis="tilt β in rad",
            label=label,
            level=level,
            start=consistent_start(level, STEEL_DISK, beta=beta, spin=40.0),
            end=end,
            samples=samples,
        )


def eccentric_disk(eccentricity: float) -> Disk:
    """The steel disk with its COG elsewhere.

    Mass and moments about the COG stay, so that a rigid body exists for every eccentricity; the
    moments about G follow.
    """
    disk = STEEL_DISK
    shift = disk.mass * eccentricity**2
    a, b, c = disk.inertia_about_cog
    return replace(
        disk, eccentricity=eccentricity, inertia_x=a, inertia_y=b + shift, inertia_z=c + shift
    )


def scaled(level: Level, radius: float) -> Problem:
    """Table 3 for a steel disk of another size, at the same Froude number.

    Lengths are scaled by s, times by the root of s, speeds and smoothing likewise, so that the
    angles of the motion are those of the original.
    """
    scale = radius / STEEL_DISK.radius
    disk = Disk.ring(
        radius=radius,
        hole_radius=0.015 * scale,
        hole_distance=0.02 * scale,
        thickness=0.01 * scale,
        density=7700.0,
    )
    return Problem(
        axis="radius of the disk in m",
        label=f"{radius:g}",
        level=level,
        disk=disk,
        friction=SmoothCoulomb(smoothing=0.1 * sqrt(scale)),
        start=consistent_start(level, disk, spin=40.0 / sqrt(scale)),
        end=0.5 * sqrt(scale),
    )


def _body(level: Level) -> Iterator[Problem]:
    radius = STEEL_DISK.radius
    for value, label in ((0.0, "0"), (1e-9, "1e-9"), (0.99 * radius, "0.99 r")):
        disk = eccentric_disk(value)
        yield Problem(
            axis="eccentricity in m",
            label=label,
            level=level,
            disk=disk,
            start=consistent_start(level, disk),
            end=0.25,
        )
    for size in (1e-3, 10.0):
        yield scaled(level, size)


def _friction(level: Level) -> Iterator[Problem]:
    for coefficient in (0.0, 10.0):
        yield Problem(
            axis="friction μ",
            label=f"{coefficient:g}",
            level=level,
            friction=SmoothCoulomb(coefficient=coefficient),
            start=consistent_start(level, STEEL_DISK),
        )


def _rest(level: Level) -> Iterator[Problem]:
    for label, gamma, spin in (
        ("at rest", -pi / 2 + 0.1, 0.0),
        ("at rest, COG above", pi / 2, 0.0),
        ("noninverted spinning", -pi / 2, 40.0),
        ("inverted, below critical spin", pi / 2, 20.0),
    ):
        yield Problem(
            axis="start",
            label=label,
            level=level,
            start=consistent_start(level, STEEL_DISK, gamma=gamma, spin=spin),
        )


def _sampling(level: Level, *, quick: bool) -> Iterator[Problem]:
    for samples, end in ((2, 0.5),) if quick else ((2, 0.5), (2, 2.0), (3, 2.0)):
        yield Problem(
            axis="sampling, duration",
            label=f"{samples} samples, {end:g} s",
            level=level,
            start=consistent_start(level, STEEL_DISK),
            end=end,
            samples=samples,
        )
    yield Problem(
        axis="sampling, duration",
        label="2 samples, rolling fast",
        level=level,
        start=consistent_start(level, STEEL_DISK, beta=1.0, gamma=0.0, spin=60.0),
        end=0.3,
        samples=2,
    )
    if not quick:
        yield Problem(
            axis="sampling, duration",
            label="100 s, to inverted spinning",
            level=level,
            # With this friction inverted spinning is stable in Model 1, too.
            friction=SmoothCoulomb(smoothing=0.2),
            start=consistent_start(level, STEEL_DISK, gamma=pi / 2 - 0.1, spin=40.0),
            end=100.0,
            samples=10001,
        )


def scene(problem: Problem, formulation: Formulation) -> Scene:
    """Scene of a problem in one of the engine's formulations."""
    return Scene(
        level=problem.level,
        formulation=formulation,
        disk=problem.disk,
        friction=problem.friction,
        contact=problem.contact,
        start=problem.start,
    )
