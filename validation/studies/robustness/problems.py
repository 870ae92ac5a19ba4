"""The hard cases: along each axis, motions become extreme in one respect."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi, radians, sqrt
from typing import Any, Literal, NamedTuple

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
    State,
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
    cover : {"all", "first", "fastest", "chosen"}
        Whether all integrators of each formulation are tried, the first of each, or that of the
        first formulation alone, for motions that are too long for the others; or what the
        library chooses.
    tolerance : float
        Accuracy asked for in rad, and of the time of an ending in s.
    stop_when : tuple of str or callable, optional
        What ends the motion besides a contact that would have to pull. If it is given, even an
        empty one, the reference finds the ending by itself.
    """

    axis: str
    label: str
    scenario: Scenario
    end: float = 0.5
    samples: int = 101
    cover: Literal["all", "first", "fastest", "chosen"] = "first"
    tolerance: float = TOLERANCE
    stop_when: tuple[str | Callable[[State], float], ...] | None = None

    @property
    def name(self) -> str:
        """Axis, label and model."""
        model = self.scenario.model
        return f"{self.axis}: {self.label}" + (f", Model {model}" if model else "")

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return np.linspace(0.0, self.end, self.samples)


class Hard(NamedTuple):
    """A place on an axis.

    Parameters
    ----------
    label : str
    changes : mapping
        Fields of the scenario.
    asked : mapping
        Fields of `Problem`.
    models : sequence of int
        That it is tried in.
    """

    label: str
    changes: Mapping[str, Any]
    asked: Mapping[str, Any] = {}
    models: Sequence[int] = tuple(MODELS)


def problems() -> list[Problem]:
    """Those of `AXES` and sets of constraints that are none of the paper's models."""
    found = [
        Problem(axis=axis, label=hard.label, scenario=replace(base, **hard.changes), **hard.asked)
        for base in (Scenario(constraints=each) for each in MODELS.values())
        for axis, places in AXES.items()
        for hard in places
        if base.model in hard.models
    ]
    others = (Scenario(constraints=each) for each in POSSIBLE_SETS)
    return found + [
        Problem(axis="constraint set", label=scenario.name, scenario=scenario)
        for scenario in others
        if scenario.model is None
    ]


def body(moments: Sequence[float], eccentricity: float) -> Disk:
    """The steel disk with other moments about the COG, and the COG elsewhere.

    Parameters
    ----------
    moments : sequence of 3 floats
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


def _lean(parts: Sequence[float], eccentricity: float) -> dict[str, Any]:
    """A body of which the moments about the COG are parts of m r²."""
    return {"disk": body([part * STEEL_DISK.mass * _RADIUS**2 for part in parts], eccentricity)}


def _scaled(radius: float, cover: str) -> Hard:
    """Table 3 for a steel disk of another size, at the same Froude number.

    Lengths are scaled by s, times by the root of s, speeds and smoothing likewise, so that the
    angles of the motion are those of the original.
    """
    scale = radius / _RADIUS
    lengths = {"hole_radius": 0.015, "hole_distance": 0.02, "thickness": 0.01}
    changes = {
        "disk": Disk.ring(
            radius=radius,
            **{name: length * scale for name, length in lengths.items()},
            density=7700.0,
        ),
        "friction": SmoothCoulomb(smoothing=0.1 * sqrt(scale)),
        "start": Start(spin=40.0 / sqrt(scale)),
    }
    return Hard(f"{radius:g}", changes, {"end": 0.5 * sqrt(scale), "cover": cover})


def _on_springs(contact: PenaltyContact, **changes: Any) -> dict[str, Any]:
    return {"friction": SmoothCoulomb(load="contact"), "contact": contact, **changes}


_RADIUS, _ECCENTRICITY = STEEL_DISK.radius, STEEL_DISK.eccentricity
_damped = partial(PenaltyContact.damped, disk=STEEL_DISK)
_ALL, _FASTEST = {"cover": "all"}, {"cover": "fastest"}

AXES: dict[str, Sequence[Hard]] = {
    "smoothing ε in m/s": [
        Hard(label, {"friction": SmoothCoulomb(smoothing=float(label))}, {"cover": cover}, models)
        for label, cover, models in (
            *((each, "all", (1, 2, 3, 4)) for each in ("1", "1e-2")),
            *((each, "first", (1, 2, 3, 4)) for each in ("1e-3", "1e-4", "1e-5", "1e-8")),
            ("1e-6", "first", (1,)),
        )
    ],
    "contact stiffness in N/m": [
        Hard(each, _on_springs(_damped(float(each))), _ALL, models=(1,))
        for each in ("1e4", "1e6", "1e9")
    ],
    "start above the table": [
        Hard(
            f"{height} mm, {name}",
            _on_springs(contact, start=Start(height=1e-3 * height)),
            {"end": 0.1},
            models=(1,),
        )
        for name, contact in (
            ("undamped", PenaltyContact(stiffness=1e5)),
            ("damped", _damped(1e5)),
        )
        for height in (1, 5)
    ],
    "spin in rad/s": [
        Hard("0", {"start": Start(spin=0.0)}),
        Hard("100", {"start": Start(spin=100.0)}, _ALL),
        Hard("300", {"start": Start(spin=300.0)}),
        Hard("1000", {"start": Start(spin=1000.0)}, {"end": 0.05}),
        Hard("-40", {"start": Start(spin=-40.0)}),
    ],
    # The fast ones end where the contact would pull.
    "contact load: spin, μ": [
        Hard(
            f"{spin} rad/s, {coefficient:g}",
            {
                "friction": SmoothCoulomb(coefficient=coefficient, load="contact"),
                "start": Start(spin=spin),
            },
            {"cover": cover},
        )
        for spin, coefficient, cover in (
            *((100, 0.3, "first"), (200, 0.3, "all"), (300, 0.3, "first")),
            *((40, 2, "first"), (40, 3, "all"), (300, 3, "all")),
        )
    ],
    "tilt β in rad": [
        Hard("1e-4", {"start": Start(beta=1e-4)}, {"end": 4e-4}),
        Hard("0.01", {"start": Start(beta=0.01)}, {"end": 4e-3}),
        Hard("π − 0.01", {"start": Start(beta=pi - 0.01)}, {"end": 4e-3}),
        Hard(
            "1e-4, beyond the fall",
            {"start": Start(beta=1e-4)},
            {"end": 0.1, "samples": 11},
            models=(1,),
        ),
    ],
    "eccentricity in m": [
        Hard(label, {"disk": body(STEEL_DISK.inertia_about_cog, value)}, {"end": 0.25})
        for label, value in (("0", 0.0), ("1e-9", 1e-9), ("0.99 r", 0.99 * _RADIUS))
    ],
    # Flat bodies, in which one moment is the sum of the others, and rods, in which one is none.
    # A rod of no moment at all is no rigid body: one in a thousand is left.
    "inertia about the COG": [
        Hard(label, _lean(parts, eccentricity), {"end": 0.25})
        for label, parts, eccentricity in (
            ("lamina", (0.25, 0.25, 0.5), 0.0),
            ("lamina, COG at 0.9 r", (0.25, 0.25, 0.5), 0.9 * _RADIUS),
            ("flat across x", (0.5, 0.25, 0.25), _ECCENTRICITY),
            ("flat across y", (0.25, 0.5, 0.25), _ECCENTRICITY),
            ("rod along x", (3e-4, 0.3, 0.3), _ECCENTRICITY),
            ("rod along y", (0.3, 3e-4, 0.3), _ECCENTRICITY),
            ("rod along z", (0.3, 0.3, 3e-4), _ECCENTRICITY),
        )
    ],
    "radius of the disk in m": [_scaled(1e-3, "all"), _scaled(10.0, "first")],
    "friction μ": [
        Hard(f"{each:g}", {"friction": SmoothCoulomb(coefficient=each)}) for each in (0.0, 10.0)
    ],
    "start": [
        Hard("at rest", {"start": Start(gamma=-pi / 2 + 0.1, spin=0.0)}),
        Hard("at rest, COG above", {"start": Start(gamma=pi / 2, spin=0.0)}),
        Hard("noninverted spinning", {"start": Start(gamma=-pi / 2, spin=40.0)}),
        Hard("inverted, below critical spin", {"start": Start(gamma=pi / 2, spin=20.0)}),
    ],
    # Few samples; and through inversion and fall, in Model 1 for tens of seconds.
    "sampling, duration": [
        Hard("2 samples, 0.5 s", {}, {"samples": 2}),
        Hard("3 samples, 2 s", {}, {"samples": 3, "end": 2.0}),
        Hard(
            "2 samples, rolling fast",
            {"start": Start(beta=1.0, gamma=0.0, spin=50.0)},
            {"samples": 2, "end": 0.3},
        ),
        Hard("5 s", {}, {"end": 5.0, "samples": 501}),
        Hard("10 s", {}, _FASTEST | {"end": 10.0, "samples": 1001}),
        Hard("20 s", {}, _FASTEST | {"end": 20.0, "samples": 2001}, models=(1,)),
        # With this friction inverted spinning is stable.
        Hard(
            "50 s, to inverted spinning",
            {"friction": SmoothCoulomb(smoothing=0.2), "start": Start(gamma=pi / 2 - 0.1)},
            _FASTEST | {"end": 50.0, "samples": 5001},
            models=(1,),
        ),
    ],
    "inclination of the table": [
        Hard(f"{each}°", {"table": Table(inclination=radians(each), downhill=1.0)})
        for each in (2, 30)
    ],
}
"""What is tried in each of the paper's models, by what is extreme about it."""
