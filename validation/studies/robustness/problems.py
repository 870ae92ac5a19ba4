"""The hard cases: along each axis, motions become extreme in one respect, or end by themselves."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from math import pi, radians, sqrt
from typing import Any, Literal

import numpy as np

from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    Disk,
    EllipticDisk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Table,
)
from analysis.problem.checks import Array
from analysis.problem.disk import STEEL_RING
from validation.display.tables import power

TOLERANCE = 1e-6
"""Accuracy asked for in rad where a problem says nothing else."""

Condition = str | Callable[[State], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A motion to be computed.

    Parameters
    ----------
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

    scenario: Scenario
    end: float = 0.5
    samples: int = 101
    cover: Literal["all", "first", "fastest", "chosen"] = "first"
    tolerance: float = TOLERANCE
    stop_when: tuple[Condition, ...] | None = None

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return np.linspace(0.0, self.end, self.samples)


@cache
def problems() -> Mapping[str, Problem]:
    """Those of `AXES` in all models, other sets of constraints, and those that end.

    Their names tell what is extreme and, behind the last colon, how, and which model it is.
    """
    found = {
        f"{axis}: {label}, {base.name}": _placed(base, place)
        for base in (Scenario(constraints=each) for each in MODELS.values())
        for axis, places in AXES.items()
        for label, place in places.items()
        if base.model in place.get("models", LEVELS)
    }
    for scenario in (Scenario(constraints=each) for each in POSSIBLE_SETS):
        if scenario.model is None:
            found[f"constraint set: {scenario.name}"] = Problem(scenario=scenario)
    return found | {f"{ENDED}: {_label(each)}": each for each in ended()}


def _placed(base: Scenario, place: Mapping[str, Any]) -> Problem:
    """A problem at a place of an axis."""
    names = ("end", "samples", "cover", "tolerance")
    asked = {name: place[name] for name in names if name in place}
    changes = {name: place[name] for name in place.keys() - {*asked, "models"}}
    return Problem(scenario=replace(base, **changes), **asked)


# --- Extreme in one respect ---------------------------------------------------------------------


def body(moments: Sequence[float], eccentricity: float) -> Mapping[str, Any]:
    """The steel disk with other moments about the COG, and the COG elsewhere.

    Parameters
    ----------
    moments : sequence of 3 floats
        About the COG in kg m², so that a rigid body exists for every eccentricity.
    eccentricity : float
        In m.
    """
    shift = STEEL_DISK.mass * eccentricity**2
    about_centre = np.add(moments, (0.0, shift, shift)).tolist()
    inertia = dict(zip(("inertia_x", "inertia_y", "inertia_z"), about_centre, strict=True))
    return {"disk": replace(STEEL_DISK, eccentricity=eccentricity, **inertia), "end": 0.25}


def _scaled(radius: float) -> Mapping[str, Any]:
    """Table 3 for a steel disk of another size, at the same Froude number.

    Lengths are scaled by s, times by the root of s, speeds and smoothing likewise, so that the
    angles of the motion are those of the original.
    """
    scale = radius / _RADIUS
    lengths = {name: STEEL_RING[name] * scale for name in STEEL_RING.keys() - {"density"}}
    return {
        "disk": Disk.ring(**lengths | {"radius": radius}),
        "friction": SmoothCoulomb(smoothing=0.1 * sqrt(scale)),
        "start": Start(spin=40.0 / sqrt(scale)),
        "end": 0.5 * sqrt(scale),
    }


def _elliptic(part: float) -> EllipticDisk:
    """A lamina of the steel disk's mass, with this part of its radius as the other semi-axis."""
    along, across = (STEEL_DISK.mass * (each * _RADIUS) ** 2 / 4.0 for each in (part, 1.0))
    shift = STEEL_DISK.mass * _ECCENTRICITY**2
    return EllipticDisk(
        radius=_RADIUS,
        other_radius=part * _RADIUS,
        mass=STEEL_DISK.mass,
        eccentricity=_ECCENTRICITY,
        inertia_x=along,
        inertia_y=across + shift,
        inertia_z=along + across + shift,
    )


_RADIUS, _ECCENTRICITY = STEEL_DISK.radius, STEEL_DISK.eccentricity
_FIRST: Any = {}
_ALL: Any = {"cover": "all"}
_FASTEST: Any = {"cover": "fastest"}
_damped = partial(PenaltyContact.damped, disk=STEEL_DISK)
_ON_SPRINGS = {"friction": SmoothCoulomb(load="contact"), "models": (1,)}

AXES: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "smoothing ε in m/s": {
        label: {"friction": SmoothCoulomb(smoothing=float(label)), **more}
        for label, more in
        {"1": _ALL, "1e-2": _ALL, "1e-3": {}, "1e-4": {}, "1e-5": {}, "1e-8": {},
         "1e-6": {"models": (1,)}}.items()
    },
    "contact stiffness in N/m": {
        label: {"contact": _damped(float(label)), **_ON_SPRINGS, **_ALL}
        for label in ("1e4", "1e6", "1e9")
    },
    "start above the table": {
        f"{mm} mm, {name}": {
            "contact": contact, "start": Start(height=1e-3 * mm), "end": 0.1, **_ON_SPRINGS
        }
        for name, contact in
        (("undamped", PenaltyContact(stiffness=1e5)), ("damped", _damped(1e5)))
        for mm in (1, 5)
    },
    "just touching at the start": {
        f"{damping:g} N s/m": {
            "contact": PenaltyContact(stiffness=1e5, damping=damping),
            "start": Start(height=0.0, beta=2.1, gamma=-1.9, spin=-39.0), "end": 0.1,
            "tolerance": 1e-8, "models": (1,),
        }
        for damping in (30.0, 100.0)
    },
    "spin in rad/s": {
        label: {"start": Start(spin=float(label)), **more}
        for label, more in
        {"0": {}, "100": _ALL, "300": {}, "1000": {"end": 0.05}, "-40": {}}.items()
    },
    # The fast ones end where the contact would pull.
    "contact load: spin, μ": {
        f"{spin} rad/s, {coefficient:g}": {
            "friction": SmoothCoulomb(coefficient=coefficient, load="contact"),
            "start": Start(spin=spin), **more
        }
        for spin, coefficient, more in (
            (100, 0.3, _FIRST), (200, 0.3, _ALL), (300, 0.3, _FIRST), (40, 2, _FIRST),
            (40, 3, _ALL), (300, 3, _ALL),
        )
    },
    "tilt β in rad": {
        label: {"start": Start(beta=beta), "end": end, **more}
        for label, beta, end, more in (
            ("1e-4", 1e-4, 4e-4, {}),
            ("0.01", 0.01, 4e-3, {}),
            ("π − 0.01", pi - 0.01, 4e-3, {}),
            ("1e-4, beyond the fall", 1e-4, 0.1, {"samples": 11, "models": (1,)}),
        )
    },
    "eccentricity in m": {
        label: body(STEEL_DISK.inertia_about_cog, value)
        for label, value in (("0", 0.0), ("1e-9", 1e-9), ("0.99 r", 0.99 * _RADIUS))
    },
    # Flat bodies, in which one moment is the sum of the others, and rods, in which one is none.
    # A rod of no moment at all is no rigid body: one in a thousand is left.
    "inertia about the COG": {
        label: body([part * STEEL_DISK.mass * _RADIUS**2 for part in parts], eccentricity)
        for label, parts, eccentricity in (
            ("lamina", (0.25, 0.25, 0.5), 0.0),
            ("lamina, COG at 0.9 r", (0.25, 0.25, 0.5), 0.9 * _RADIUS),
            ("flat across x", (0.5, 0.25, 0.25), _ECCENTRICITY),
            ("flat across y", (0.25, 0.5, 0.25), _ECCENTRICITY),
            ("rod along x", (3e-4, 0.3, 0.3), _ECCENTRICITY),
            ("rod along y", (0.3, 3e-4, 0.3), _ECCENTRICITY),
            ("rod along z", (0.3, 0.3, 3e-4), _ECCENTRICITY),
        )
    },
    "radius of the disk in m": {"0.001": {**_scaled(1e-3), **_ALL}, "10": _scaled(10.0)},
    "ellipse: other semi-axis over r": {
        f"{part:g}": {
            "disk": _elliptic(part), "start": Start(spin=20.0, beta=1.2, gamma=0.3), "end": 0.3,
            "tolerance": 1e-8, "models": (1,), **_ALL,
        }
        for part in (0.1, 0.5)
    },
    "friction μ": {
        f"{each:g}": {"friction": SmoothCoulomb(coefficient=each)} for each in (0.0, 10.0)
    },
    "start": {
        "at rest": {"start": Start(gamma=-pi / 2 + 0.1, spin=0.0)},
        "at rest, COG above": {"start": Start(gamma=pi / 2, spin=0.0)},
        "noninverted spinning": {"start": Start(gamma=-pi / 2, spin=40.0)},
        "inverted, below critical spin": {"start": Start(gamma=pi / 2, spin=20.0)},
    },
    # Few samples; and through inversion and fall, in Model 1 for tens of seconds.
    "sampling, duration": {
        "2 samples, 0.5 s": {"samples": 2},
        "3 samples, 2 s": {"samples": 3, "end": 2.0},
        "2 samples, rolling fast": {
            "start": Start(beta=1.0, gamma=0.0, spin=50.0), "samples": 2, "end": 0.3
        },
        "5 s": {"end": 5.0, "samples": 501},
        "10 s": {"end": 10.0, "samples": 1001, **_FASTEST},
        "20 s": {"end": 20.0, "samples": 2001, "models": (1,), **_FASTEST},
        # With this friction inverted spinning is stable.
        "50 s, to inverted spinning": {
            "friction": SmoothCoulomb(smoothing=0.2), "start": Start(gamma=pi / 2 - 0.1),
            "end": 50.0, "samples": 5001, "models": (1,), **_FASTEST
        },
    },
    "inclination of the table": {
        f"{each}°": {"table": Table(inclination=radians(each), downhill=1.0)} for each in (2, 30)
    },
}  # fmt: skip
"""What is tried in each of the paper's models, or in some (`models`), by what is extreme about it:
fields of the scenario and of the problem."""


# --- Ended by themselves, most of them sampled at their two ends alone --------------------------

ENDED = "ended by a condition, or a pull"

DIGITS = (3, 8, 5, 6, 7, 4)
"""Of the accuracy in rad that the random motions ask for in turn."""

RANDOM = 24
"""Number of random motions."""

FEW = 0.7
"""Part of the random motions that is sampled at its two ends alone."""

SEED = 5
"""Of the random starts."""


def passes_sideways(state: State) -> float:
    """Negative from where the centre of gravity comes to the side: gamma passes 0 upwards."""
    return float(-np.sin(state.coordinates[5]))


def falls_low(state: State) -> float:
    """Negative where the disk leans so far that its centre is below 0.85 of its radius."""
    return float(np.sin(state.coordinates[4]) - 0.85)


CONDITIONS: tuple[Condition | None, ...] = ("inverted", "lost", passes_sideways, falls_low, None)
"""Of the random motions in turn; None for a contact that would pull."""


def ended() -> Iterator[Problem]:
    """Known hard ones, then random ones of every model, condition, tolerance and sampling."""
    for spin, gamma, beta, digits in (
        (45.2112, -1.467538, 1.356142, 8),
        (45.2112, -1.467538, 1.356142, 6),
        (59.3464, -1.570456, 1.35434, 6),
        (37.25768, -1.761848, 1.823287, 8),
        (10.0, -1.5, 0.9, 6),
    ):
        start = Start(spin=spin, gamma=gamma, beta=beta)
        yield _ended(Scenario(constraints=MODELS[4], start=start), "inverted", digits)
    # The contact would pull for two milliseconds, far from the next sample.
    for spin, digits in ((139.0, 8), (140.0, 3)):
        yield _ended(Scenario(start=Start(spin=spin)), None, digits, end=1.0)
    rising = Scenario(constraints=MODELS[4], start=Start(beta=0.63878, beta_rate=5.14286))
    yield _ended(rising, None, 6, samples=31, end=0.3)
    rng = np.random.default_rng(SEED)
    for number in range(RANDOM):
        yield _drawn(rng, number)


def _drawn(rng: np.random.Generator, number: int) -> Problem:
    """A random start, so that the condition is met in most of them."""
    condition = CONDITIONS[number % 5]
    # What is lost or falls is up at first, and slow.
    slow = condition in ("lost", falls_low)
    low, high = (5.0, 25.0) if slow else (35.0, 60.0) if condition else (100.0, 300.0)
    beta = rng.uniform(1.1, pi - 1.1)
    gamma = (pi / 2 if slow else -pi / 2) + rng.uniform(-0.6, 0.6)
    friction = SmoothCoulomb(
        coefficient=rng.uniform(0.2, 0.5), load=LOADS[int(rng.integers(len(LOADS)))]
    )
    start = Start(beta=beta, gamma=gamma, spin=round(rng.uniform(low, high), 3))
    return _ended(
        Scenario(constraints=MODELS[LEVELS[number % 4]], start=start, friction=friction),
        condition,
        DIGITS[number % len(DIGITS)],
        samples=2 if rng.random() < FEW else 101,
        end=1.5 if condition else 0.25,
        cover="fastest" if number % 7 else "first",
    )


def _ended(scenario: Scenario, condition: Condition | None, digits: int, **asked: Any) -> Problem:
    asked = {"samples": 2, "end": 1.5, "cover": "fastest", **asked}
    conditions = (condition,) if condition else ()
    return Problem(scenario=scenario, tolerance=10.0**-digits, stop_when=conditions, **asked)


def _label(problem: Problem) -> str:
    """What ends a motion, its spin, what it is asked for, and its model."""
    (condition,) = problem.stop_when or ("pull",)
    name = condition if isinstance(condition, str) else condition.__name__.replace("_", " ")
    scenario, sampled = problem.scenario, " sampled" if problem.samples > 2 else ""
    spin = f"{scenario.initial_state.rates[3]:.4g} rad/s"
    return f"{name} {spin} {power(problem.tolerance)}{sampled}, {scenario.name}"
