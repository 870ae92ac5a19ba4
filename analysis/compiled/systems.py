"""The equations of `analysis.models`, evaluated on symbols in place of numbers.

Nothing here is mechanics: the functions that single runs call are given symbols of heyoka, and
what they return is compiled. Numbers of a scenario become parameters, so that scenarios alike in
structure share what is compiled.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from itertools import count
from types import SimpleNamespace
from typing import Any, cast

from analysis.compiled.library import CannotCompileError, heyoka
from analysis.data.checks import Array
from analysis.data.constraint_set import ConstraintSet
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.data.friction import FrictionLaw, Load
from analysis.data.members import Members
from analysis.data.scenario import Scenario
from analysis.models import index1, reduced
from analysis.models.integration import NEARLY_FLAT

FAINT = 1e-8
"""Slip speed in m/s over which the kink of friction is rounded if slip has two directions.

It acts for nanoseconds, and moves nothing by more than 1e-14 of its size.
"""

SINGULAR = "singular"
"""Ending of a run where friction calls for a newton of normal force for each newton of it."""

_DISK = ("mass", "radius", "eccentricity", "inertia_x", "inertia_y", "inertia_z")


_NUMBERS = (float, Members)


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """What decides which equations are compiled; all else are parameters of theirs.

    Parameters
    ----------
    form : str
        "index-1" or "reduced".
    constraints : tuple of str
    law : type
        Class of the friction law.
    load : str
    options : tuple of pairs
        Fields of the law that are no floats.
    rubs, kinked, horizontal, allow_pulling : bool
        Whether there is friction, it has a kink at no slip, the table is level, and a run goes
        on where the contact pulls.
    conditions : tuple of pairs
        Reasons and functions of a state that end a run, too.
    """

    form: str
    constraints: ConstraintSet
    law: type[FrictionLaw]
    load: Load
    options: tuple[tuple[str, Any], ...]
    rubs: bool
    kinked: bool
    horizontal: bool
    allow_pulling: bool
    conditions: tuple[tuple[str, Condition], ...]

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        form: str,
        conditions: Mapping[str, Condition],
        *,
        allow_pulling: bool,
    ) -> "Structure":
        """Structure of the runs of a scenario, or of members that are alike in it."""
        law = scenario.friction
        values = ((name, getattr(law, name)) for name in _names(type(law)))
        return cls(
            form=form,
            constraints=scenario.constraints,
            law=type(law),
            load=law.load,
            options=tuple(pair for pair in values if not isinstance(pair[1], _NUMBERS)),
            rubs=bool(scenario.rubs),
            kinked=bool(_has_kink(law)),
            horizontal=bool(scenario.table.is_horizontal),
            allow_pulling=allow_pulling,
            conditions=tuple(conditions.items()),
        )

    @property
    def flips(self) -> bool:
        """Whether the friction has a kink where a slip in one direction changes its sign."""
        one = "no-slip-along" in self.constraints or "no-slip-across" in self.constraints
        return self.rubs and self.kinked and one


@cache
def _names(law: type[FrictionLaw]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(law))


def _has_kink(law: FrictionLaw) -> bool:
    """Whether the force for each m/s of slip rises or falls from no slip on."""
    little = 1e-6 * law.finest_speed
    return abs(law.per_speed(little) - law.gradient) > 1e-9 * law.gradient


def parameters(scenario: Scenario) -> list[float]:
    """Numbers of a scenario, in the order of the parameters of its compiled equations.

    The first ones are set during a run, `SIGN`, `ALIVE`, `REASON`, `WHEN`.
    """
    law, table = scenario.friction, scenario.table
    values = (getattr(law, name) for name in _names(type(law)))
    return [
        *(1.0, 1.0, 0.0, 0.0),
        scenario.initial_state.rates[3],
        *(getattr(scenario.disk, name) for name in _DISK),
        table.pressing,
        *table.vector[:2],
        *(value for value in values if isinstance(value, _NUMBERS)),
    ]


def disk_numbers(numbers: Array) -> dict[str, Array]:
    """Numbers of the disk by name among those of `parameters`, shape (..., p); each (...)."""
    return {name: numbers[..., 5 + place] for place, name in enumerate(_DISK)}


SIGN, ALIVE, REASON, WHEN, SPIN = range(5)
"""Numbers of parameters: sign of the slip, whether, why and when a run of a batch ended, and the
spinning speed at the start."""


@dataclass(frozen=True, slots=True, kw_only=True)
class System:
    """Symbols of the equations of one structure.

    Parameters
    ----------
    variables, derivatives : list of symbols
        State and its time derivative.
    kink : symbol, optional
        What is zero where the friction has a kink: the slip in the one direction there is, or
        half the rate of its squared speed, which rises through zero where the slip is least.
    flips : bool
        Whether it is the slip in one direction.
    endings : mapping
        From reasons to symbols; a run ends where one turns negative.
    """

    variables: list[Any]
    derivatives: list[Any]
    kink: Any
    flips: bool
    endings: dict[str, Any]


@dataclass(frozen=True, slots=True)
class _Symbolic:
    """Stand-in for a scenario, with parameters for numbers."""

    constraints: ConstraintSet
    disk: Any
    table: Any
    friction: Any
    rubs: bool
    sign: Any
    spin: Any

    @property
    def weight(self) -> Any:
        return self.disk.mass * self.table.pressing


def _symbolic(structure: Structure) -> _Symbolic:
    numbers = (heyoka().par[number] for number in count(4))
    spin = next(numbers)
    disk = SimpleNamespace(**{name: next(numbers) for name in _DISK})
    pressing, along, across = (next(numbers) for _ in range(3))
    table = SimpleNamespace(
        pressing=pressing, vector=(along, across, -pressing), is_horizontal=structure.horizontal
    )
    # A law checks its numbers when it is made, and symbols are none.
    law = object.__new__(structure.law)
    options = dict(structure.options)
    for field in fields(structure.law):
        value = options[field.name] if field.name in options else next(numbers)
        object.__setattr__(law, field.name, value)
    return _Symbolic(
        structure.constraints, disk, table, law, structure.rubs, heyoka().par[SIGN], spin
    )


def build(structure: Structure) -> System:
    """Symbols of the equations of a structure.

    Raises
    ------
    CannotCompileError
        If its friction law or a condition does what cannot be done with symbols.
    """
    scenario = _symbolic(structure)
    makers = {"index-1": _index1, "reduced": _reduced}
    system, coordinates, rates, beta = makers[structure.form](scenario, structure)
    system.endings[FLAT] = heyoka().sin(beta) - NEARLY_FLAT
    state = SimpleNamespace(coordinates=coordinates, rates=rates)
    for reason, condition in structure.conditions:
        system.endings[reason] = _expressed(f"stop_when {reason!r}", condition, state)
    return system


def multipliers(structure: Structure) -> tuple[list[Any], list[Any]]:
    """Variables z and u, and the constraint forces at them, at every single state."""
    coordinates, rates = _variables()
    scenario = _symbolic(structure)
    # The kink does no harm here, but 0 / 0 would.
    solution, _ = _solution(scenario, coordinates, rates, _size(1e-150))
    return [*coordinates, *rates], list(solution[6:])


def _index1(scenario: _Symbolic, structure: Structure) -> tuple[System, Any, Any, Any]:
    z, u = _variables()
    slips: list[Any] = []

    def size(slip_x: Any, slip_y: Any) -> Any:
        if structure.flips:
            slips.append(slip_y if "no-slip-along" in structure.constraints else slip_x)
            return scenario.sign * slips[0]
        slips.extend((slip_x, slip_y))
        return _size(FAINT)(slip_x, slip_y)

    solution, feedback = _solution(scenario, z, u, size)
    endings = {CONTACT_WOULD_PULL: solution[6]}
    if feedback is not None:
        endings[SINGULAR] = 1.0 - feedback
    variables, derivatives = [*z, *u], [*u, *solution[:6]]
    kink = None
    if structure.flips:
        kink = slips[0]
    elif structure.rubs and structure.kinked:
        kink = sum(slip * _rate(slip, variables, derivatives) for slip in slips)
    system = System(
        variables=variables,
        derivatives=derivatives,
        kink=kink,
        flips=structure.flips,
        endings=endings,
    )
    return system, tuple(z), tuple(u), z[4]


def _rate(symbol: Any, variables: list[Any], derivatives: list[Any]) -> Any:
    """Time derivative of a symbol along a motion."""
    parts = zip(variables, derivatives, strict=True)
    return sum(heyoka().diff(symbol, variable) * rate for variable, rate in parts)


def _reduced(scenario: _Symbolic, structure: Structure) -> tuple[System, Any, Any, Any]:
    library, stand_in = heyoka(), cast("Scenario", scenario)
    beta, gamma, rate = library.make_vars("beta", "gamma", "beta_rate")
    trig = library.sin(beta), library.cos(beta), library.sin(gamma), library.cos(gamma)
    slips: list[Any] = []

    def friction(slip: Any) -> Any:
        slips.append(slip)
        size = scenario.sign * slip if structure.flips else _size(FAINT)(0.0, slip)
        return _per_speed(scenario, size) * slip

    spin: Any = scenario.spin
    second = reduced.acceleration_from(
        stand_in, spin, trig, rate, friction if structure.rubs else lambda _: 0.0
    )
    force = reduced.normal_force_from(stand_in, spin, trig, rate, second)
    system = System(
        variables=[beta, gamma, rate],
        derivatives=[rate, -spin * trig[1], second],
        kink=slips[0] if structure.flips else None,
        flips=structure.flips,
        endings={CONTACT_WOULD_PULL: force},
    )
    coordinates, rates = reduced.expanded(scenario.disk, spin, 0.0, (beta, gamma, rate))
    return system, coordinates, rates, beta


def _variables() -> tuple[list[Any], list[Any]]:
    names = ("x", "y", "z", "alpha", "beta", "gamma")
    library = heyoka()
    rates = library.make_vars(*(f"{name}_rate" for name in names))
    return library.make_vars(*names), rates


def _solution(
    scenario: _Symbolic, z: list[Any], u: list[Any], speed: Callable[[Any, Any], Any]
) -> tuple[list[Any], Any]:
    """Accelerations and multipliers, and the part of the normal force that friction calls for."""

    def is_zero(entry: Any) -> bool:
        return bool(entry == (0.0 if isinstance(entry, float) else heyoka().expression(0.0)))

    try:
        columns = index1.solution(cast("Scenario", scenario), z, u, speed, is_zero)
    except (TypeError, ValueError, AttributeError) as error:
        raise _unexpressed(f"friction law {type(scenario.friction).__name__}", error) from error
    if len(columns) == 1:
        return _symbols(columns[0]), None
    frictionless, feedback = columns[0][6], columns[1][6]
    return _symbols(index1.loaded(columns, frictionless / (1.0 - feedback))), feedback


def _symbols(entries: list[Any]) -> list[Any]:
    """Entries of which some may be floats, such as the acceleration of a constant spin."""
    symbol = heyoka().expression
    return [symbol(entry) if isinstance(entry, float) else entry for entry in entries]


def _size(faint: float) -> Callable[[Any, Any], Any]:
    return lambda slip_x, slip_y: heyoka().sqrt(slip_x * slip_x + slip_y * slip_y + faint**2)


def _per_speed(scenario: _Symbolic, speed: Any) -> Any:
    law = scenario.friction
    return _expressed(f"friction law {type(law).__name__}", law.per_speed, speed)


def _expressed(what: str, function: Callable[[Any], Any], argument: Any) -> Any:
    try:
        return function(argument)
    except (TypeError, ValueError, AttributeError) as error:
        raise _unexpressed(what, error) from error


def _unexpressed(what: str, error: Exception) -> CannotCompileError:
    return CannotCompileError(
        f"method 'taylor' cannot express {what} ({error}); it must do with arithmetic and the "
        "functions of analysis.data.elementary"
    )
