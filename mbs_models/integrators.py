"""The integrators that a scene can be run with, and their options.

Some are the engine's own. Others step the engine's accelerations (`mbs_models.accelerations`).
"""

from dataclasses import asdict, dataclass
from math import sqrt
from typing import Any, Literal, NamedTuple, cast, get_args

import exudyn as exu
import numpy as np

from analysis.problem.checks import choice, number, positive, switch
from analysis.problem.checks import local_tolerance as one_step
from analysis.problem.start import COORDINATES
from analysis.solve.stepping import Method
from mbs_models.model import Formulation, Model
from mbs_models.probe import Probe
from mbs_models.scene import CLASSES, Scene

IntegratorName = Literal[
    "RK44",
    "RK67",
    "DOPRI5",
    "TrapezoidalIndex2",
    "GeneralizedAlpha",
    "DOP853",
    "Radau",
    "LSODA",
]
INTEGRATORS: tuple[IntegratorName, ...] = get_args(IntegratorName)


MOST_ITERATIONS = 100
"""Iterations after which a step fails.

The engine's Jacobian leaves out how constraint forces turn with the disk, so that long steps
converge by a constant factor each, and need more than the engine's 25.
"""


class Rule(NamedTuple):
    """Traits of an integrator.

    Parameters
    ----------
    exponents : tuple of int
        Exponents of the step in its error expansion; the first is its order. Empty for those that
        step the engine's accelerations, whose runs are not extrapolated.
    stages : int
        Evaluations of the right-hand side in a step of an explicit one, 0 for an implicit one.
    controls_step : bool
        Whether it chooses its steps by itself.
    """

    exponents: tuple[int, ...]
    stages: int = 0
    controls_step: bool = False


RULES: dict[IntegratorName, Rule] = {
    "RK44": Rule((4, 5, 6, 7, 8), stages=4),
    "RK67": Rule((6, 7, 8, 9), stages=7),
    "DOPRI5": Rule((5, 6, 7, 8), stages=7, controls_step=True),
    # It is symmetric.
    "TrapezoidalIndex2": Rule((2, 4, 6, 8)),
    "GeneralizedAlpha": Rule((2, 3, 4, 5)),
    "DOP853": Rule((), controls_step=True),
    "Radau": Rule((), controls_step=True),
    "LSODA": Rule((), controls_step=True),
}

FINEST_LOCAL = 1e-13
"""Error in a step below which the noise of accelerations that differences go into stalls step
control."""

ACCELERATED: tuple[IntegratorName, ...] = ("DOP853", "Radau", "LSODA")
"""Those that step the engine's accelerations."""


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
        below, where rounding lies (`force_rounding`).

    Raises
    ------
    ValueError
        If a tolerance is not positive.
    """

    modified: bool = True
    relative: float = 1e-12
    absolute: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "modified", switch("modified", self.modified))
        object.__setattr__(self, "relative", positive("relative", self.relative))
        if self.absolute is not None:
            object.__setattr__(self, "absolute", positive("absolute", self.absolute))

    def apply(self, settings: Any, model: Model) -> None:
        """Write the options into the engine's settings of its time integration."""
        newton = settings.newton
        newton.useModifiedNewton = self.modified
        newton.maxIterations = MOST_ITERATIONS
        newton.relativeTolerance = self.relative
        wanted = (self.absolute or 0.0) * model.scenario.weight
        newton.absoluteTolerance = max(wanted, force_rounding(model))


@dataclass(frozen=True, slots=True, kw_only=True)
class Integrator:
    """An integrator and its options.

    Parameters
    ----------
    name : {"RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha", "DOP853", \
"Radau", "LSODA"}
        The first five are the engine's own, by its names of them. Of these, the first three are
        explicit and need a scene without constraints; DOPRI5 controls its step, the others keep
        it. The last three are SciPy's, step the engine's accelerations and control their steps;
        Radau and LSODA are for stiff friction.
    newton : Newton, optional
        Of implicit integrators.
    spectral_radius : float, optional
        Numerical damping of GeneralizedAlpha from 0 (strongest) to 1 (none); 0.9 by default.
    local_tolerance : float, optional
        Absolute error that DOPRI5 allows in a step, in m, rad, m/s and rad/s; 1e-8 by default.
        Relative and absolute error of SciPy's, `FINEST_LOCAL` or more; None leaves it to the
        tolerance of a run.

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
                fault = f"{option} is no option of integrator {self.name!r}, got {value!r}"
                raise ValueError(fault)
        if self.spectral_radius is not None:
            radius = number("spectral_radius", self.spectral_radius)
            if not 0.0 <= radius <= 1.0:
                raise ValueError(f"spectral_radius must lie in [0, 1], got {radius:g}")
        if self.local_tolerance is not None:
            least = FINEST_LOCAL if self.steps_accelerations else 0.0
            one_step("local_tolerance", self.local_tolerance, least)

    @property
    def implicit(self) -> bool:
        """Whether it solves the engine's equations by Newton's iteration in each step."""
        return not RULES[self.name].stages and not self.steps_accelerations

    @property
    def steps_accelerations(self) -> bool:
        """Whether it is one of SciPy's, which step the engine's accelerations."""
        return self.name in ACCELERATED

    @property
    def method(self) -> Method:
        """SciPy's name of one that steps accelerations."""
        assert self.steps_accelerations
        return cast("Method", self.name)

    @property
    def controls_step(self) -> bool:
        """Whether it chooses its steps by itself."""
        return RULES[self.name].controls_step

    @property
    def first_step(self) -> float:
        """Step in s with which a tolerance-controlled run starts for the paper's disk."""
        return 5e-3 if self.implicit else 1e-2

    def settings(self) -> dict[str, str | float | int | None]:
        """Name and options, as they go with a trajectory."""
        found: dict[str, str | float | int | None] = {"integrator": self.name}
        if self.newton is not None:
            found |= {f"newton_{option}": value for option, value in asdict(self.newton).items()}
        options = {name: getattr(self, name) for name in ("spectral_radius", "local_tolerance")}
        return found | {name: value for name, value in options.items() if value is not None}


def integrators(
    formulation: Formulation, *, constrained: bool | None = None
) -> tuple[IntegratorName, ...]:
    """The engine's own integrators that can take a formulation; those in `ACCELERATED` take any.

    The first is the default where a step is given.

    Parameters
    ----------
    formulation : str
    constrained : bool, optional
        Whether algebraic equations are left (`Scene.has_constraints`); by default whether the
        formulation has any on the ideal contact.

    Examples
    --------
    >>> from mbs_models import integrators
    >>> integrators("contact-tree")[0]
    'RK67'
    """
    implicit: tuple[IntegratorName, ...] = ("TrapezoidalIndex2", "GeneralizedAlpha")
    explicit: tuple[IntegratorName, ...] = ("RK67", "RK44", "DOPRI5")
    if CLASSES[formulation].closes_contact:
        return explicit + implicit
    # What has no constraints otherwise has a stiff contact.
    return implicit if constrained is None or constrained else implicit + explicit


def find_integrator(scene: Scene, wanted: Integrator | IntegratorName | None) -> Integrator:
    """Integrator as wanted, by name with its default options, or the default one of a scene.

    Raises
    ------
    ValueError
        If it is unknown, or cannot take the constraints of the scene.
    """
    available = integrators(scene.built_as, constrained=scene.has_constraints)
    if wanted is None:
        wanted = available[0]
    chosen = wanted if isinstance(wanted, Integrator) else Integrator(name=wanted)
    if chosen.name not in available + ACCELERATED:
        raise ValueError(
            f"integrator {chosen.name!r} is explicit and cannot take the constraints of "
            f"formulation {scene.built_as!r}; use one of {', '.join(available + ACCELERATED)}"
        )
    return chosen


def force_rounding(model: Model) -> float:
    """Residual in N that rounding leaves, below which Newton's iteration cannot get.

    The last digits of the forces: the weight, and what turns a disk as fast as the start, or
    a fall from upright, makes it turn. A stiff contact turns the last digit of a height into
    a force, and steep friction that of a slip speed. The engine adds the residuals of the
    algebraic equations, whatever their unit: speeds, that of the spin, and the norm of the
    Euler parameters, which is one. On a light disk their last digits are larger than those
    of the forces.
    """
    scenario = model.scenario
    disk, friction, contact = scenario.disk, scenario.friction, scenario.contact
    gravity, rates = scenario.table.gravity, model.start.rates[3:]
    fastest = sqrt(sum(rate * rate for rate in rates) + gravity / disk.radius)
    rim_speed = disk.radius * fastest
    largest = [disk.mass * (gravity + rim_speed * fastest)]
    largest += model.own_equations
    if model.has_constraints(scenario):
        largest.append(rim_speed)
        largest += [abs(model.start.rates[COORDINATES.index(name)]) for name in model.held_rates]
    lost = friction.slope(scenario.weight) * rim_speed
    if contact is not None:
        lost += contact.stiffness * disk.radius
    return 4.0 * float(np.finfo(float).eps) * max(lost, *largest)


def complete_jacobian(model: Model) -> None:
    """Add to the engine's Jacobian how friction grows with the contact force.

    The engine differentiates user functions by coordinates and velocities alone. Without this
    column, friction with the contact force as its load converges by a constant factor for each
    iteration, however short the step.
    """
    contact, scenario = model.contact_equation, model.scenario
    if contact is None or scenario.friction.load != "contact" or not scenario.rubs:
        return
    data, probe = model.system.systemData, Probe(model)

    def column(*_unused: Any) -> Any:
        forces = probe.forces_per_newton(contact).tolist()
        size = len(forces) + len(data.GetAECoordinates())
        entries = [[row, len(forces) + contact, force] for row, force in enumerate(forces)]
        matrix = exu.MatrixContainer()
        # Written into a dense matrix, the engine fails.
        matrix.SetWithSparseMatrix(entries, size, size, useDenseMatrix=False)
        return matrix

    model.system.SetSystemJacobianUserFunction(column)
