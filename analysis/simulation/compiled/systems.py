"""The equations of `analysis.mechanics`, evaluated on symbols in place of numbers.

Nothing here is mechanics: the functions that single runs call are given symbols of heyoka, and
what they return is compiled. Numbers of a scenario become parameters, so that scenarios alike in
structure share what is compiled.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache, partial
from itertools import count, islice
from types import SimpleNamespace
from typing import Any, NamedTuple

from analysis.mechanics import newton_euler, recorded, reduced
from analysis.mechanics.attitude import EulerTurning, paper_of, state_of
from analysis.mechanics.constraints import SLIPS
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.problem.checks import number
from analysis.problem.choices import Formulation
from analysis.problem.constraints import multiplier_names
from analysis.problem.elementary import Members, sqrt
from analysis.problem.friction import FrictionLaw
from analysis.problem.limits import CONTACT_JAMS, JAMMING, LEAST_TILT
from analysis.problem.scenario import Scenario
from analysis.problem.user_modules import reads
from analysis.simulation.compiled.library import CannotCompileError, heyoka
from analysis.simulation.request import Request

FAINT = 1e-8
"""Slip speed over which the kink of friction is rounded if slip has two directions, as a part of
sqrt(g r), the pace of a disk.

It acts for nanoseconds, and moves nothing by more than 1e-14 of its size.
"""

BESIDE = 1e-12
"""Such a part beside the kink at which a step ends: a motion without slip is always at the kink.

It is far above rounding, and far below what rounds the kink.
"""

SLOWEST = 1e-3
"""Pace in m/s below which heyoka, which does not know how slow a motion is, does not see the kink
where it is rounded."""

MOST_FORCES = 4
"""Constraint forces up to which a disk with products of inertia is compiled within seconds."""

_NUMBERS = (float, Members)


class Structure(NamedTuple):
    """What decides which equations are compiled; all else are parameters of theirs.

    Parameters
    ----------
    formulation : str
        "index-1" or "reduced".
    equations : newton_euler.Structure
    options : tuple of pairs
        Fields of the friction law that are no floats.
    kinked : bool
        Whether friction has a kink at no slip.
    allow_pulling : bool
        Whether a run goes on where the contact pulls.
    conditions : tuple of pairs
        Reasons and functions of a state that end a run, too.
    read : tuple
        What law, options and conditions depend on besides.
    """

    formulation: Formulation
    equations: newton_euler.Structure
    options: tuple[tuple[str, Any], ...]
    kinked: bool
    allow_pulling: bool
    conditions: tuple[tuple[str, Condition], ...]
    read: tuple[Any, ...] = ()

    @classmethod
    def of(cls, scenario: Scenario, formulation: Formulation, request: Request) -> "Structure":
        """Structure of the runs of a scenario, or of members that are alike in it.

        Parameters
        ----------
        scenario : Scenario
        formulation : {"index-1", "reduced"}
        request : Request

        Raises
        ------
        CannotCompileError
            If heyoka is not installed or something cannot be expressed in its symbols.
        """
        heyoka()
        law = scenario.friction
        if fault := _obstacle(scenario, formulation, request):
            raise CannotCompileError(f"method 'taylor' {fault}")
        values = ((name, getattr(law, name)) for name in _names(type(law)))
        options = tuple(pair for pair in values if not isinstance(pair[1], _NUMBERS))
        # The force for each m/s of slip rises or falls from no slip on.
        little = 1e-6 * law.finest_speed
        kinked = bool(
            scenario.rubs and abs(law.per_speed(little) - law.gradient) > 1e-9 * law.gradient
        )
        equations = newton_euler.Structure.of(scenario, EulerTurning)
        ends = tuple(request.conditions.items())
        conditions = (each.condition for each in request.conditions.values())
        functions = (*conditions, *(value for _, value in options))
        read = reads(type(law).per_speed, type(law)), *map(reads, functions)
        return cls(formulation, equations, options, kinked, request.allow_pulling, ends, read)


def _obstacle(scenario: Scenario, formulation: Formulation, request: Request) -> str:
    """Why the equations of a scenario cannot be compiled; empty if they can."""
    law, disk = scenario.friction, scenario.disk
    if formulation == "free-body":
        return "knows the ideal contact alone, no formulation 'free-body'"
    if not disk.is_round_disk and disk.SURFACE is None:
        return f"takes bodies with a SURFACE, got a {type(disk).__name__}"
    if disk.has_products and len(multiplier_names(scenario.constraints)) > MOST_FORCES:
        why = f"more than {MOST_FORCES} constraint forces, got {scenario.name}"
        return f"takes minutes to compile a disk with products of inertia and {why}"
    if request.allow_pulling and scenario.rubs and law.load == "contact":
        return "takes no allow_pulling where friction has the load 'contact': that comes and goes"
    if not law.is_simple:
        kind = type(law).__name__
        return f"takes friction that is isotropic and in proportion to the load, got {kind}"
    pace = pace_of(scenario)
    slow = f"takes disks with sqrt(g r) of {SLOWEST:g} m/s or more, got {pace:.3g} m/s"
    return slow if pace < SLOWEST else ""


@cache
def _names(law: type[FrictionLaw]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(law))


def pace_of(scenario: Scenario) -> float:
    """Speed sqrt(g r) in m/s of the motions of a disk; of `Members`, one each."""
    pace: float = scenario.disk.radius * sqrt(scenario.fall)
    return pace


def start(scenario: Scenario, formulation: Formulation) -> tuple[float, ...]:
    """State at the start, of a scenario or of `Members`."""
    first = scenario.initial_state
    if formulation == "reduced":
        return *first.coordinates[4:6], first.rates[4]
    return state_of(scenario.disk, first.coordinates, first.rates, EulerTurning)


def parameters(scenario: Scenario, begin: float) -> list[float]:
    """Numbers of a scenario, in the order of the parameters of its compiled equations.

    The first ones are set during a run, `SIGN`, `ALIVE`, `REASON`, `WHEN`. It begins at this time
    in s.
    """
    law, first = scenario.friction, scenario.initial_state
    values = (getattr(law, name) for name in _names(type(law)))
    spin = first.rates[3]
    return [
        *(1.0, 1.0, 0.0, 0.0),
        *(spin, first.coordinates[3] - spin * begin, pace_of(scenario)),
        *recorded.numbers(scenario),
        *(value for value in values if isinstance(value, _NUMBERS)),
    ]


SIGN, ALIVE, REASON, WHEN, SPIN, TURNED, PACE = range(7)
"""Numbers of parameters: sign of the slip; whether, why and when a run of a batch ended; of the
reduced system, the spin and alpha at the time zero; and sqrt(g r) in m/s."""

CONSTANTS = slice(PACE + 1, PACE + 1 + len(recorded.NUMBERS))
"""Those behind them that are `recorded.NUMBERS`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class System:
    """Symbols of the equations of one structure.

    Parameters
    ----------
    variables, derivatives : list of symbols
        State and its time derivative; that of the index-1 system is one of `EulerTurning`, which
        takes the fewest operations.
    kinks : list of symbols
        Of one or two slips, at whose zeros a step has to end.
    endings : mapping
        From reasons to symbols; a run ends where one turns negative.
    readings : list of symbols
        Coordinates, rates, constraint forces, and the slips if friction acts, at a state.
    """

    variables: list[Any]
    derivatives: list[Any]
    kinks: list[Any]
    endings: dict[str, Any]
    readings: list[Any]


_Speed = Callable[[Any, Any], Any]
"""Size of a slip along and across the edge."""


def _symbolic(structure: Structure) -> Any:
    """Stand-in for a scenario, with parameters for numbers."""
    symbols = (heyoka().par[number] for number in count(SPIN))
    body = structure.equations.body
    surface = body.SURFACE or () if isinstance(body, type) else ()
    spin, turned, pace, *given = islice(symbols, 3 + len(recorded.NUMBERS) + len(surface))
    # A law checks its numbers when it is made, and symbols are none.
    law = object.__new__(structure.equations.law)
    options = dict(structure.options)
    for field in fields(structure.equations.law):
        value = options[field.name] if field.name in options else next(symbols)
        object.__setattr__(law, field.name, value)
    return SimpleNamespace(
        numbers=given,
        disk=recorded.disk_of(given, body),
        per_speed=partial(_expressed, f"friction law {type(law).__name__}", law.per_speed)
        if structure.equations.load
        else lambda _: 0.0,
        pace=pace,
        spin=spin,
        alpha=turned + spin * heyoka().time,
    )


def build(structure: Structure) -> System:
    """Symbols of the equations of a structure.

    Raises
    ------
    CannotCompileError
        If its friction law or a condition does what cannot be done with symbols.
    """
    library, scenario = heyoka(), _symbolic(structure)
    # Slip in a single direction changes its sign at the kink.
    single = any(slip in structure.equations.constraints for slip in SLIPS)
    speed = _signed if structure.kinked and single else _size(FAINT * scenario.pace)
    code = full = recorded.formula(structure.equations)
    constants, forces = scenario.numbers, len(multiplier_names(structure.equations.constraints))
    if structure.formulation == "reduced":
        variables = library.make_vars("beta", "gamma", "beta_rate")
        coordinates, rates = reduced.expanded(
            scenario.disk, scenario.spin, scenario.alpha, variables
        )
        state = state_of(scenario.disk, coordinates, rates, EulerTurning)
        code, constants, forces = reduced.formula(is_simple=True), [*constants, scenario.spin], 1
    else:
        variables = state = library.make_vars(*recorded.STATE)
        coordinates, rates = paper_of(scenario.disk, variables, EulerTurning)
    derivatives, told, jamming = _solution(code, constants, scenario.per_speed, variables, speed)
    slips = told[forces:] if structure.kinked else []
    endings = {CONTACT_WOULD_PULL: told[0], FLAT: library.sin(coordinates[4]) - LEAST_TILT}
    endings.update((CONTACT_JAMS, each) for each in jamming)
    paper_state = SimpleNamespace(coordinates=coordinates, rates=rates)
    for reason, condition in structure.conditions:
        symbol = _expressed(f"stop_when {reason!r}", condition, paper_state)
        # What stays as it is does not turn negative.
        if _changes(symbol):
            endings[reason] = symbol
    # The kink does no harm here, but 0 / 0 would.
    _, smooth, _ = _solution(full, scenario.numbers, scenario.per_speed, state, _size(1e-150))
    return System(
        variables=variables,
        derivatives=derivatives,
        kinks=[slip + BESIDE * scenario.pace for slip in slips],
        endings=endings,
        readings=_symbols([*coordinates, *rates, *smooth]),
    )


def _solution(
    code: Callable[..., Callable[..., tuple[Any, ...]]],
    constants: Sequence[Any],
    per_speed: Callable[[Any], Any],
    variables: Sequence[Any],
    speed: _Speed,
) -> tuple[list[Any], list[Any], list[Any]]:
    """What code of the equations tells of a state, as symbols.

    Returns
    -------
    derivatives, told : list
        What is told beside begins with the normal force, and ends with the slips that rub.
    jamming : list
        What turns negative where the contact jams, if it may.
    """
    jamming = list[Any]()

    def contact_load(alone: Any, added: Any) -> Any:
        jamming[:] = [JAMMING - added]
        return alone / (1.0 - added)

    function = code(*constants, speed=speed, per_speed=per_speed, contact_load=contact_load)
    found, size = _symbols(function(*variables)), len(variables)
    return found[:size], found[size:], jamming


def _symbols(entries: Sequence[Any]) -> list[Any]:
    """Symbols, of which some may be floats, such as a force that is held at zero."""
    symbol = heyoka().expression
    return [symbol(entry) if isinstance(entry, float) else entry for entry in entries]


def _signed(along: Any, across: Any) -> Any:
    """Size of the only slip there is, which keeps its sign until a step ends at its zero."""
    return heyoka().par[SIGN] * (along + across)


def _size(faint: Any) -> _Speed:
    return lambda along, across: heyoka().sqrt(along * along + across * across + faint**2)


def _changes(symbol: Any) -> bool:
    """Whether a symbol, or float, is another number in the course of a motion."""
    library = heyoka()
    if isinstance(symbol, float):
        return False
    timeless = library.subs(symbol, {library.time: library.make_vars("time")})
    return bool(library.get_variables([timeless]))


def _expressed(what: str, function: Callable[[Any], Any], argument: Any) -> Any:
    try:
        # What is no number at all fails in a sum.
        said = 0.0 + function(argument)
        return said if isinstance(said, heyoka().expression) else number("it", said)
    except (TypeError, ValueError, AttributeError) as error:
        raise CannotCompileError(
            f"method 'taylor' cannot express {what} ({error}); it must do with arithmetic and the "
            "functions of analysis.problem.elementary"
        ) from error
