"""The integrators that a scene can be run with, their options, and how long their steps may be.

Some are the engine's own. Others step the engine's accelerations (`mbs_models.accelerations`).
"""

from dataclasses import asdict, dataclass
from math import factorial, inf, sqrt
from typing import cast

import numpy as np

from analysis.problem.checks import choice, instance, optional, positive, switch, within
from analysis.problem.checks import local_tolerance as one_step
from analysis.problem.choices import (
    ACCELERATED,
    INTEGRATORS,
    IntegratorName,
    Method,
)
from analysis.problem.contact import FULL_GRIP
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.solve.effort import turning_time
from mbs_models.scene import CLASSES, Scene

EXPLICIT: tuple[IntegratorName, ...] = ("RK67", "RK44", "DOPRI5")
"""The engine's own integrators that take no constraints, the default one first,"""

IMPLICIT: tuple[IntegratorName, ...] = ("TrapezoidalIndex2", "GeneralizedAlpha")
"""and those that solve its equations by Newton's iteration in each step."""

EXPONENTS: dict[IntegratorName, tuple[int, ...]] = {
    "RK44": (4, 5, 6, 7, 8),
    "RK67": (6, 7, 8, 9),
    # It is symmetric.
    "TrapezoidalIndex2": (2, 4, 6, 8),
    "GeneralizedAlpha": (2, 3, 4, 5),
}
"""Exponents of the step in the error expansion of integrators that keep it; the first is their
order. All others choose their steps by themselves, and their runs are not extrapolated."""

_EXPONENTIAL = [1.0 / factorial(power) for power in range(7)]

STABILITY: dict[IntegratorName, list[float]] = {
    "RK44": _EXPONENTIAL[:5],
    "RK67": [*_EXPONENTIAL, -(1.0 + sqrt(5.0)) / 7200.0],
}
"""Stability functions of explicit integrators with fixed steps, by coefficients from degree 0 on:
one step of length 1 multiplies a state by this polynomial of the system's matrix."""

FINEST_LOCAL, FINEST_ABSOLUTE = 1e-13, 3e-14
"""Errors in a step below which step control stalls: by the noise of accelerations that differences
go into, and by the rounding of angles of some rad, in the engine's own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Newton:
    """How the nonlinear equations of an implicit step are solved.

    Parameters
    ----------
    modified : bool
        Keep the Jacobian for several iterations and steps instead of renewing it every time.
    relative : float
        Iterations end when the residual has fallen by this factor, positive.
    absolute : float, optional
        Or when it is below this part of the disk's weight, positive; by default, and never
        below, where rounding lies (`mbs_models.runs.force_rounding`).

    Raises
    ------
    ValueError
        If a tolerance is not positive.
    """

    modified: bool = True
    relative: float = 1e-13
    absolute: float | None = None

    def __post_init__(self) -> None:
        modified, relative = switch("modified", self.modified), positive("relative", self.relative)
        absolute = optional(positive, "absolute", self.absolute)
        checked = {"modified": modified, "relative": relative, "absolute": absolute}
        for name, value in checked.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, slots=True, kw_only=True)
class Integrator:
    """An integrator and its options.

    Parameters
    ----------
    name : {"RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha", "DOP853", \
"Radau", "LSODA"}
        The first five are the engine's own, by its names of them. Of these, the first three are
        explicit and need a scene without constraints; DOPRI5 controls its step, the others keep
        it. GeneralizedAlpha has a ripple in constraint forces where it begins, of first order in
        the step, and where uneven times change that: at steps of 1 ms on Model 3 from Table 3,
        1e-4 N on `euler-tree`, and 2e-2 N on `floating` and `floating-lie`. The last three are
        SciPy's, step the engine's accelerations and control their steps; Radau and LSODA are for
        stiff friction.
    newton : Newton, optional
        Of implicit integrators.
    spectral_radius : float, optional
        Numerical damping of GeneralizedAlpha from 0 (strongest) to 1 (none); 0.9 by default.
    local_tolerance : float, optional
        Absolute error that DOPRI5 allows in a step, in m, rad, m/s and rad/s, `FINEST_ABSOLUTE`
        or more; 1e-8 by default. Relative and absolute error of SciPy's, `FINEST_LOCAL` or more;
        None leaves it to the tolerance of a run.

    Raises
    ------
    ValueError
        If the name is unknown, a value is out of range, or an option belongs to another
        integrator.
    """

    name: IntegratorName
    newton: Newton | None = None
    spectral_radius: float | None = None
    local_tolerance: float | None = None

    def __post_init__(self) -> None:
        choice("integrator", self.name, INTEGRATORS)
        usual = None if self.steps_accelerations else 1e-8
        for option, applies, default in (
            ("newton", self.implicit, Newton()),
            ("spectral_radius", self.name == "GeneralizedAlpha", 0.9),
            ("local_tolerance", self.controls_step, usual),
        ):
            value = getattr(self, option)
            if value is None and applies:
                object.__setattr__(self, option, default)
            elif value is not None and not applies:
                fault = f"is no option of integrator {self.name!r}, got {value!r}"
                raise ArgumentError(option, fault)
        least = FINEST_LOCAL if self.steps_accelerations else FINEST_ABSOLUTE
        optional(instance, "newton", self.newton, Newton)
        optional(within, "spectral_radius", self.spectral_radius, 0.0, 1.0)
        optional(one_step, "local_tolerance", self.local_tolerance, least)

    @property
    def implicit(self) -> bool:
        """Whether it solves the engine's equations by Newton's iteration in each step."""
        return self.name in IMPLICIT

    @property
    def steps_accelerations(self) -> bool:
        """Whether it is one of SciPy's, which step the engine's accelerations."""
        return self.name in ACCELERATED

    @property
    def method(self) -> Method:
        """SciPy's name of one that steps accelerations."""
        return cast("Method", self.name)

    @property
    def controls_step(self) -> bool:
        """Whether it chooses its steps by itself."""
        return self.name not in EXPONENTS

    def first_step(self, scenario: Scenario) -> float:
        """First step in s of a run to a tolerance, some 5 or 10 ms for the paper's disk."""
        step = (0.15 if self.implicit else 0.3) * turning_time(scenario)
        return min(step, _gripping_time(scenario))

    def settings(self) -> dict[str, str | float | int | None]:
        """Name and options, as they go with a trajectory."""
        found: dict[str, str | float | int | None] = {"integrator": self.name}
        if self.newton is not None:
            found |= {f"newton_{option}": value for option, value in asdict(self.newton).items()}
        options = {name: getattr(self, name) for name in ("spectral_radius", "local_tolerance")}
        return found | {name: value for name, value in options.items() if value is not None}


def _gripping_time(scenario: Scenario) -> float:
    """Time in s in which a contact that just touches at the start has its full grip by the weight.

    Steps that go across it agree on a motion beside the right one. It is infinite for others.
    """
    if scenario.contact is None or not scenario.friction_fades:
        return inf
    _, _, height, _, beta, gamma = scenario.initial_state.coordinates
    gap = height - scenario.disk.clearance(beta, gamma, scenario.half_thickness)[0]
    sunk, stiffness = scenario.resting_penetration, scenario.contact.stiffness
    if not -FULL_GRIP * sunk < gap < sunk:
        return inf
    # The damper's force grows with the time, and the spring's with its square.
    damping, mass = scenario.contact.damping, FULL_GRIP * scenario.disk.mass
    return 2.0 * mass / (damping + sqrt(damping**2 + 2.0 * stiffness * mass))


def integrators(scene: Scene | Scenario) -> tuple[IntegratorName, ...]:
    """The engine's own integrators that can take a scene; those in `ACCELERATED` take any.

    The first is the default where a step is given.

    Parameters
    ----------
    scene : Scene or Scenario

    Raises
    ------
    ValueError
        If it is neither.

    Examples
    --------
    >>> from mbs_models import Scene, integrators
    >>> integrators(Scene())[0]
    'RK67'
    """
    scene = Scene.of(scene)
    if CLASSES[scene.built_as].closes_contact:
        return EXPLICIT + IMPLICIT
    # What has no constraints otherwise has a stiff contact.
    return IMPLICIT if scene.has_constraints else IMPLICIT + EXPLICIT


def find_integrator(scene: Scene, wanted: Integrator | IntegratorName | None) -> Integrator:
    """Integrator as wanted, by name with its default options, or the default one of a scene.

    Raises
    ------
    ValueError
        If it is unknown, or cannot take the constraints of the scene.
    """
    available = integrators(scene)
    if wanted is None:
        wanted = available[0]
    chosen = wanted if isinstance(wanted, Integrator) else Integrator(name=wanted)
    if chosen.name not in available + ACCELERATED:
        raise ValueError(
            f"integrator {chosen.name!r} is explicit and cannot take the constraints of "
            f"formulation {scene.built_as!r}; use one of {', '.join(available + ACCELERATED)}"
        )
    return chosen


def largest_step(integrator: IntegratorName, eigenvalue: complex) -> float:
    """Largest step in s at which a decaying motion decays, `inf` for an eigenvalue of zero.

    Parameters
    ----------
    integrator : {"RK44", "RK67"}
    eigenvalue : complex
        In 1/s, with a real part that is not positive.
    """
    if eigenvalue == 0.0:
        return float("inf")
    direction = eigenvalue / abs(eigenvalue)
    radii = np.linspace(0.0, 10.0, 10001)[1:]
    factors = np.abs(np.polyval(STABILITY[integrator][::-1], radii * direction))
    # Rounding must not count as growth where a step hardly damps.
    unstable = factors > 1.0 + 1e-9
    radius = radii[np.argmax(unstable)] if np.any(unstable) else np.inf
    return float(radius / abs(eigenvalue))
