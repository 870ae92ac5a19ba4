"""Families of periodic motions, continued in their amplitude or tilt.

Symmetric cycles begin in the Hopf point. Where they lose their symmetry, cycles without it branch
off, and a shift of gamma leads to the first of them; they are followed in their largest deviation
of gamma, which grows smoothly through the bifurcation, and their mirror images have it as the
least one. On the cylinder of gamma the heteroclinic connection is a pair of loops,
one for either sense of turning: on one side of its spin they join to the swinging cycles, on the
other side each becomes a rotating motion of its own (a gluing bifurcation).
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import accumulate, islice
from operator import methodcaller

import numpy as np
import numpy.typing as npt

from analysis.mechanics.paper import critical_speed
from analysis.nonlinear import flow
from analysis.nonlinear.collocation import (
    SPIN,
    STEEPEST,
    VALUE,
    NoCycleError,
    hopf_cycle,
    slow_rotation,
    solve,
)
from analysis.nonlinear.following import Family, between, events, having, onward
from analysis.nonlinear.heteroclinic import NoConnectionError, heteroclinic_connection
from analysis.nonlinear.motions import Event, PeriodicMotion
from analysis.problem.checks import (
    Array,
    function,
    instance,
    optional,
    real_array,
    several,
    turn_rate,
    within,
)
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.solve.watch import Progress

AMPLITUDES: Array = np.append(0.03, np.linspace(0.1, 3.0, 30))
"""Amplitudes in rad from near the Hopf point, where its family may fold at once; further ones
close in on the connection."""

_LEAD = 0.9
"""Part of the first of other amplitudes up to which those above lead there."""

BEYOND: Array = np.concatenate(((0.005, 0.02), np.linspace(0.05, 4.5, 90)))
"""Amplitudes in rad beyond that of the bifurcation, at which cycles without symmetry are looked
for; a whole turn is more than any was seen to have."""

TILTS: Array = np.concatenate(
    (np.geomspace(1e-4, 0.02, 6), np.linspace(0.04, 0.2, 9), np.linspace(0.25, 1.5, 26))
)
"""Tilts in rad beyond that of the connection, to a disk that is nearly flat."""

_SAME_END = 1e-6
"""Distance in rad from the connection at which a family ends."""

_CLOSING = 16
"""Amplitudes between the last of `AMPLITUDES` and that."""

_FIRST = 0.05
"""How much larger in rad than at the bifurcation the first cycle without symmetry is."""

_TILT = 0.9
"""Of the first rotating motion in rad: any friction leads to it from that without slip."""


def _rising(name: str, values: npt.ArrayLike, low: float, high: float, allowed: str) -> Array:
    """Return values that rise strictly from `low` to `high`, both excluded."""
    wanted = real_array(name, values)
    proper = wanted.ndim == 1 and wanted.size and np.all(np.diff(wanted, prepend=low) > 0.0)
    if not proper or wanted[-1] >= high:
        raise ValueError(f"{name} must rise strictly {allowed}, got {values!r}")
    return wanted


# --- Symmetric cycles ---------------------------------------------------------------------------


def cycle_family(
    scenario: Scenario,
    amplitudes: npt.ArrayLike | None = None,
    *,
    progress: Progress | None = None,
) -> Family:
    """Follow the periodic motions of the reduced system from the Hopf point.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.
    amplitudes : array_like, shape (n,), optional
        Amplitudes of gamma about pi/2 in rad, rising, between 0 and 2 pi; by default up to
        the heteroclinic connection, which lies at pi or beyond; see `Connection`.
    progress : callable, optional
        Called after each cycle with how many there are and how many are wanted.

    Raises
    ------
    ValueError
        If the amplitudes are no such, or the scenario has no cycles.
    NoCycleError
        If not even the first cycle is found.
    """
    optional(function, "progress", progress)
    flow.require_cycles(scenario, STEEPEST)
    values, count, before = _amplitudes(scenario), AMPLITUDES.size + _CLOSING, 0
    if amplitudes is not None:
        wanted = _rising("amplitudes", amplitudes, 0.0, 2.0 * np.pi, "between 0 and 2 pi")
        # One step from the Hopf point may be too far, and halving it of no help.
        lead = AMPLITUDES[_LEAD * wanted[0] > AMPLITUDES]
        values, count, before = iter((*lead, *wanted)), wanted.size, lead.size
    found = onward(hopf_cycle(scenario), values, through_folds=amplitudes is None)
    found = islice(found, before, None)
    return Family.of(critical_speed(scenario).spin, found, progress=progress, wanted=count)


def _amplitudes(scenario: Scenario) -> Iterator[float]:
    """Those from the Hopf point to the connection, which is looked for when they come to it.

    Raises
    ------
    NoCycleError
        If none is found: nobody knows how far the family goes.
    """
    yield from AMPLITUDES.tolist()
    try:
        last = heteroclinic_connection(scenario).last_amplitude
    except NoConnectionError as error:
        raise NoCycleError(str(error)) from error
    yield from (last - np.geomspace(0.1 + last - np.pi, _SAME_END, _CLOSING)).tolist()


def cycle_at(scenario: Scenario, spin: float) -> PeriodicMotion:
    """The symmetric cycle at a spin: that of smallest amplitude if there are several.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        In rad/s, nearer to the critical speed than half of it, as the connection is looked for.

    Raises
    ------
    ValueError
        If the scenario has no cycles, or none at this spin.
    NoCycleError
        If the iteration fails.
    """
    flow.require_cycles(scenario, STEEPEST)
    born = hopf_cycle(scenario)
    at_fold = methodcaller("characteristic", born.ends.changes["fold"])
    low, high = 0.5 * born.spin, 1.5 * born.spin
    why = "within half the critical speed of it, where cycles are looked for"
    within("spin", spin, low, high, is_above=True, is_below=True, why=why)

    def upto() -> Iterator[PeriodicMotion]:
        """Cycles from the Hopf point to the first one beyond the spin, folds among them."""
        yield born
        before = born
        for last in onward(born, _amplitudes(scenario), through_folds=True):
            folds = having(at_fold, before, last)
            for each in (*(motion for _, motion in folds), last):
                yield each
                if min(before.spin, each.spin) <= spin <= max(before.spin, each.spin):
                    return
                before = each

    family = Family.of(born.spin, upto())
    spins = [each.spin for each in family.motions]
    if not min(spins) <= spin <= max(spins):
        ends = f"; the family ends: {family.reason}" if family.reason else ""
        raise ArgumentError(
            "spin",
            f"must lie between {min(spins):.9g} and {max(spins):.9g} rad/s, where there are "
            f"cycles{ends}, got {spin!r}",
        )
    before, last = family.motions[-2:]
    _, cycle = between(before, last, lambda each: each.spin - spin)
    return solve(cycle, cycle.place_with(spin=spin), SPIN)


def cycles_over(
    scenarios: Sequence[Scenario], *, amplitude: float | None = None, spin: float | None = None
) -> Family:
    """Follow a symmetric cycle through scenarios, at a given amplitude or a given spin.

    Every cycle starts from that of the scenario before; where that fails, from the Hopf point of
    its own.

    Parameters
    ----------
    scenarios : sequence of Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity; each near the one
        before.
    amplitude : float, optional
        Of gamma about pi/2 in rad, between 0 and pi.
    spin : float, optional
        In rad/s; either this or the amplitude.

    Raises
    ------
    ValueError
        If there are no scenarios, one has no cycles at all, not one of the two is given, or the
        first scenario has no cycle there.
    NoCycleError
        If the first cycle is not found.

    Examples
    --------
    >>> from analysis import MODELS, Scenario, SmoothCoulomb
    >>> laws = [SmoothCoulomb(coefficient=mu) for mu in (0.2, 0.4)]
    >>> scenarios = [Scenario(constraints=MODELS[4], friction=law) for law in laws]
    >>> found = cycles_over(scenarios, amplitude=1.0)
    >>> [round(cycle.spin, 3) for cycle in found.motions]
    [30.696, 30.7]
    """
    scenarios = several("scenarios", scenarios, "Scenario")
    if not scenarios:
        raise ValueError("scenarios must be 1 or more, got 0")
    if (amplitude is None) == (spin is None):
        raise ValueError(f"amplitude or spin must be given, got {amplitude} and {spin}")
    for scenario in scenarios:
        flow.require_cycles(scenario, STEEPEST)
    spin = optional(turn_rate, "spin", spin)
    wanted = () if amplitude is None else (flow.open_amplitude(amplitude),)

    def first(scenario: Scenario) -> PeriodicMotion:
        if spin is not None:
            return cycle_at(scenario, spin)
        return cycle_family(scenario, wanted).motions[0]

    def further(last: PeriodicMotion, scenario: Scenario) -> PeriodicMotion:
        with suppress(NoCycleError):
            place, held = last.place_with(value=amplitude, spin=spin), SPIN if spin else VALUE
            return solve(replace(last, scenario=scenario), place, held)
        try:
            return first(scenario)
        except (NoCycleError, ValueError) as error:
            raise NoCycleError(
                f"{error}; the last good one has {last.value:.9g} rad at a spin of "
                f"{last.spin:.9g} rad/s"
            ) from error

    found = accumulate(scenarios[1:], further, initial=first(scenarios[0]))
    return Family.of(critical_speed(scenarios[0]).spin, found)


# --- Cycles without symmetry --------------------------------------------------------------------


def asymmetric_family(
    breaking: Event, amplitudes: npt.ArrayLike | None = None, *, progress: Progress | None = None
) -> Family:
    """Follow the cycles that branch off where symmetric ones lose their symmetry.

    Parameters
    ----------
    breaking : Event
        Of the kind "symmetry-breaking", into larger cycles.
    amplitudes : array_like, shape (n,), optional
        Largest deviations of gamma in rad, rising, beyond that of the bifurcation; by default
        up to 4.5 rad further.
    progress : callable, optional
        As in `cycle_family`.

    Raises
    ------
    ValueError
        If the event is another one, or the amplitudes are no such.
    NoCycleError
        If there is no cycle without symmetry beside the bifurcation.
    """
    optional(function, "progress", progress)
    if instance("breaking", breaking, Event).kind != "symmetry-breaking":
        raise ValueError(f"breaking must be symmetry-breaking, got {breaking.kind!r}")
    born = breaking.motion
    wanted = born.value + BEYOND if amplitudes is None else amplitudes
    wanted = _rising("amplitudes", wanted, born.value, np.inf, f"beyond {born.value:.6g}")
    times, states = born.whole
    # To the one side it then swings further than to the other.
    value, swings = born.value + _FIRST, states + _FIRST * np.eye(3)[1]
    start = replace(born, kind="asymmetric", value=value, times=times, states=swings)
    found = onward(solve(start), wanted.tolist(), through_folds=amplitudes is None)
    family = Family.of(born.spin, found, progress=progress, wanted=wanted.size)
    return replace(family, born=Event(breaking.kind, born))


def first_asymmetric_family(family: Family, *, progress: Progress | None = None) -> Family:
    """Cycles without symmetry from the first place of a family where some branch off.

    Parameters
    ----------
    family : Family
        Of symmetric cycles.
    progress : callable, optional
        As in `cycle_family`.

    Raises
    ------
    NoCycleError
        If no cycle of the family loses its symmetry, or none without it is found.
    """
    reason = "no cycle of the family loses its symmetry"
    for each in events(family):
        if each.kind == "symmetry-breaking":
            try:
                return asymmetric_family(each, progress=progress)
            except NoCycleError as error:
                reason = str(error)
    raise NoCycleError(reason)


# --- Rotating motions ---------------------------------------------------------------------------


def rotating_family(
    scenario: Scenario, tilts: npt.ArrayLike | None = None, *, progress: Progress | None = None
) -> Family:
    """Follow the rotating motions that begin in the heteroclinic connection.

    Where friction is weak and smooth, it may be a connection of inverted spinning with itself.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.
    tilts : array_like, shape (n,), optional
        Tilts in rad, rising, between that of the `Connection` and pi/2; by default up to 1.5 rad
        beyond the former.
    progress : callable, optional
        As in `cycle_family`.

    Raises
    ------
    ValueError
        If the tilts are no such, or the scenario has no cycles or too steep a friction.
    NoConnectionError
        If there is no connection.
    NoCycleError
        If none is found.
    """
    optional(function, "progress", progress)
    optional(_rising, "tilts", tilts, 0.0, np.pi / 2, "between 0 and pi/2")
    flow.require_cycles(scenario, STEEPEST)
    connection = heteroclinic_connection(scenario)
    least = connection.least_tilt
    beyond = least + TILTS
    chosen = beyond[beyond <= TILTS[-1]] if tilts is None else tilts
    allowed = f"between {least:.6g}, the tilt of the connection, and pi/2"
    wanted = _rising("tilts", chosen, least, np.pi / 2, allowed)
    first = solve(slow_rotation(scenario, _TILT))
    split = int(np.searchsorted(wanted, first.value))
    down, up = wanted[:split][::-1].tolist(), wanted[split:].tolist()
    ways = (onward(first, way, through_folds=tilts is None) for way in (down, up))
    return Family.of(connection.spin, *ways, progress=progress, wanted=wanted.size)
