"""The equations of `analysis.mechanics`, evaluated on symbols in place of numbers.

Nothing here is mechanics: the functions that single runs call are given symbols of heyoka, and
what they return is compiled. Numbers of a scenario become parameters, so that scenarios alike in
structure share what is compiled.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from itertools import count, islice
from types import SimpleNamespace
from typing import Any

from analysis.compiled.library import CannotCompileError, heyoka
from analysis.data.constraint_set import ConstraintSet
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.data.friction import FrictionLaw
from analysis.data.limits import LEAST_TILT
from analysis.data.members import Members
from analysis.data.quantities import Load
from analysis.data.scenario import Scenario
from analysis.mechanics import recorded, reduced
from analysis.mechanics.states import paper_of
from analysis.models.forms import Form

FAINT = 1e-8
"""Slip speed in m/s over which the kink of friction is rounded if slip has two directions.

It acts for nanoseconds, and moves nothing by more than 1e-14 of its size.
"""

SINGULAR = "singular"
"""Ending of a run where friction calls for a newton of normal force for each newton of it."""

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
    rubs, kinked, horizontal, products, allow_pulling : bool
        Whether there is friction, it has a kink at no slip, the table is level, the disk has
        products of inertia, and a run goes on where the contact pulls.
    conditions : tuple of pairs
        Reasons and functions of a state that end a run, too.
    """

    form: Form
    constraints: ConstraintSet
    law: type[FrictionLaw]
    load: Load
    options: tuple[tuple[str, Any], ...]
    rubs: bool
    kinked: bool
    horizontal: bool
    products: bool
    allow_pulling: bool
    conditions: tuple[tuple[str, Condition], ...]

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        form: Form,
        conditions: Mapping[str, Condition],
        *,
        allow_pulling: bool,
    ) -> "Structure":
        """Structure of the runs of a scenario, or of members that are alike in it."""
        law = scenario.friction
        if not law.is_simple:
            raise CannotCompileError(
                "method 'taylor' takes friction that is isotropic and in proportion to the load, "
                f"got {type(law).__name__}"
            )
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
            products=scenario.disk.has_products,
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
    law = scenario.friction
    values = (getattr(law, name) for name in _names(type(law)))
    return [
        *(1.0, 1.0, 0.0, 0.0),
        scenario.initial_state.rates[3],
        *recorded.numbers(scenario),
        *(value for value in values if isinstance(value, _NUMBERS)),
    ]


SIGN, ALIVE, REASON, WHEN, SPIN = range(5)
"""Numbers of parameters: sign of the slip; whether, why and when a run of a batch ended; spin."""


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


def _symbolic(structure: Structure) -> Any:
    """Stand-in for a scenario, with parameters for numbers."""
    symbols = (heyoka().par[number] for number in count(SPIN))
    spin = next(symbols)
    given = list(islice(symbols, len(recorded.NUMBERS)))
    # A law checks its numbers when it is made, and symbols are none.
    law = object.__new__(structure.law)
    options = dict(structure.options)
    for field in fields(structure.law):
        value = options[field.name] if field.name in options else next(symbols)
        object.__setattr__(law, field.name, value)
    return SimpleNamespace(numbers=given, disk=recorded.disk_of(given), friction=law, spin=spin)


def build(structure: Structure) -> System:
    """Symbols of the equations of a structure.

    Raises
    ------
    CannotCompileError
        If its friction law or a condition does what cannot be done with symbols.
    """
    makers = {"index-1": _index1, "reduced": _reduced}
    system, coordinates, rates, beta = makers[structure.form](structure)
    system.endings[FLAT] = heyoka().sin(beta) - LEAST_TILT
    state = SimpleNamespace(coordinates=coordinates, rates=rates)
    for reason, condition in structure.conditions:
        system.endings[reason] = _expressed(f"stop_when {reason!r}", condition, state)
    return system


def multipliers(structure: Structure) -> tuple[list[Any], list[Any]]:
    """Variables of an index-1 system, and the constraint forces, at every single state."""
    variables = _variables()
    # The kink does no harm here, but 0 / 0 would.
    solution, _ = _solution(structure, variables, _size(1e-150))
    return variables, solution[12:-1]


def _index1(structure: Structure) -> tuple[System, Any, Any, Any]:
    variables = _variables()
    slips: list[Any] = []

    def size(slip_x: Any, slip_y: Any) -> Any:
        if structure.flips:
            slips.append(slip_y if "no-slip-along" in structure.constraints else slip_x)
            return heyoka().par[SIGN] * slips[0]
        return _size(FAINT)(slip_x, slip_y)

    solution, feedback = _solution(structure, variables, size)
    endings = {CONTACT_WOULD_PULL: solution[12]}
    if feedback is not None:
        endings[SINGULAR] = 1.0 - feedback
    kinked = structure.rubs and structure.kinked
    system = System(
        variables=variables,
        derivatives=solution[:12],
        kink=slips[0] if structure.flips else solution[-1] if kinked else None,
        flips=structure.flips,
        endings=endings,
    )
    coordinates, rates = paper_of(_symbolic(structure).disk, variables)
    return system, coordinates, rates, variables[4]


def _reduced(structure: Structure) -> tuple[System, Any, Any, Any]:
    library, scenario = heyoka(), _symbolic(structure)
    variables = library.make_vars("beta", "gamma", "beta_rate")
    slips: list[Any] = []

    def friction(slip: Any) -> Any:
        slips.append(slip)
        size = library.par[SIGN] * slip if structure.flips else _size(FAINT)(0.0, slip)
        return _per_speed(scenario, size) * slip

    *derivatives, force, _ = reduced.formula()(
        *scenario.numbers,
        scenario.spin,
        sin=library.sin,
        cos=library.cos,
        friction=friction if structure.rubs else lambda _: 0.0,
    )(*variables)
    system = System(
        variables=variables,
        derivatives=derivatives,
        kink=slips[0] if structure.flips else None,
        flips=structure.flips,
        endings={CONTACT_WOULD_PULL: force},
    )
    coordinates, rates = reduced.expanded(scenario.disk, scenario.spin, 0.0, variables)
    return system, coordinates, rates, variables[0]


def _variables() -> list[Any]:
    variables: list[Any] = heyoka().make_vars(*recorded.STATE)
    return variables


def _solution(
    structure: Structure, variables: list[Any], speed: Callable[[Any, Any], Any]
) -> tuple[list[Any], Any]:
    """What `recorded.formula` tells, and the part of the normal force that friction calls for."""
    library, scenario = heyoka(), _symbolic(structure)
    feedback: list[Any] = []

    def contact_load(alone: Any, added: Any) -> Any:
        feedback.append(added)
        return alone / (1.0 - added)

    code = recorded.formula(
        structure.constraints,
        structure.load if structure.rubs else None,
        horizontal=structure.horizontal,
        products=structure.products,
        slowing=True,
    )
    try:
        found = code(
            *scenario.numbers,
            sin=library.sin,
            cos=library.cos,
            speed=speed,
            per_speed=scenario.friction.per_speed,
            force=None,
            contact_load=contact_load,
        )(*variables)
    except (TypeError, ValueError, AttributeError) as error:
        raise _unexpressed(f"friction law {structure.law.__name__}", error) from error
    symbol = library.expression
    # Some may be floats, such as the acceleration of a constant spin.
    symbols = [symbol(entry) if isinstance(entry, float) else entry for entry in found]
    return symbols, feedback[0] if feedback else None


def _size(faint: float) -> Callable[[Any, Any], Any]:
    return lambda slip_x, slip_y: heyoka().sqrt(slip_x * slip_x + slip_y * slip_y + faint**2)


def _per_speed(scenario: Any, speed: Any) -> Any:
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
