"""What the commands on nonlinear dynamics do."""

import argparse
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from analysis import Scenario
from analysis.data.names import ArgumentError
from analysis.nonlinear import family as families
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import CycleFamily
from analysis.nonlinear.heteroclinic import fall, heteroclinic_connection
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from validation.commands.options import chosen_end, parse_spins, run_options
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import counted, progress_bar
from validation.kit.tables import Table
from validation.studies.nonlinear import tables

_SIDE = 0.05
"""Distance in rad/s from the connection at which the picture shows motions."""

_SIZES = ("amplitude", "lowest", "half_multiplier", "tilt", "largest_tilt")
"""What only some kinds of motion have."""


def cycles(options: argparse.Namespace) -> Result:
    """Tell the periodic motions: some at given spins, a family, or one over a parameter."""
    spins = None if options.spin is None else parse_spins(options.spin).tolist()
    chosen = [name for name in ("rotating", "asymmetric", "over") if getattr(options, name)]
    if len(chosen) > 1:
        raise ArgumentError(chosen[1], f"does not go together with {chosen[0]}")
    if chosen in (["rotating"], ["asymmetric"]) and spins is not None:
        raise ArgumentError("spin", f"does not go together with {chosen[0]}: a family has many")
    if chosen != ["over"] and options.amplitude is not None:
        raise ArgumentError("amplitude", "belongs to --over; a family goes through all amplitudes")
    scenario = _reduced(options)
    if chosen == ["over"]:
        return _over(options, scenario, spins)
    if spins is not None:
        return _at(scenario, spins)
    find = {"rotating": _rotating, "asymmetric": _asymmetric}
    return find[chosen[0]](scenario) if chosen else _family(scenario)


def _motions(
    shown: Sequence[Table],
    motions: Iterable[dict[str, Any]],
    draw: Callable[[], Any],
    *,
    events: Iterable[dict[str, Any]] = (),
    reason: str | None = None,
    **more: Any,
) -> Result:
    """What is told of motions of any kind.

    Parameters
    ----------
    shown : sequence of Table
        The motions first.
    motions : iterable of dict
    draw : callable
        Makes axes of the picture.
    events : iterable of dict
        What happens along them: a motion, and its kind.
    reason : str, optional
        Why the family ends early.
    **more
        What JSON is told besides.
    """
    values = {"motions": [*motions], "events": [*events], "reason": reason, **more}
    notes = [] if reason is None else [f"The family ends early: {reason}."]
    return Result(tables=shown, values=values, draw=lambda: draw().figure, notes=notes)


def _told(motion: Any, **more: Any) -> dict[str, Any]:
    """A motion as plain data."""
    names = ("spin", *_SIZES, "period", "multiplier", "log_strong", "stable")
    return more | {name: getattr(motion, name) for name in names if hasattr(motion, name)}


def _at(scenario: Scenario, spins: Sequence[float]) -> Result:
    from validation.studies.nonlinear import figures

    found = [families.cycle_at(scenario, spin) for spin in counted(spins, "spins")]
    draw = partial(figures.cycle_portrait, found)
    return _motions([tables.cycle_table(found)], map(_told, found), draw)


def _family(scenario: Scenario) -> Result:
    family = _symmetric(scenario)
    normal, growth = hopf_type(scenario), None
    small = tables.small_cycles(family)
    if len(small) > 4:
        spins, amplitudes = ([getattr(c, name) for c in small] for name in ("spin", "amplitude"))
        growth = fitted_growth(spins, amplitudes, normal.spin)
    found = families.bifurcations(family)
    return _motions(
        [
            tables.cycle_table(family.cycles),
            tables.hopf_table(normal, growth),
            tables.bifurcation_table(found, family.cycles),
        ],
        map(_told, family.cycles),
        partial(_diagram, family),
        events=[_told(each.cycle, kind=each.kind) for each in found],
        reason=family.reason,
        hopf={**asdict(normal), "kind": normal.kind, "curvature": normal.curvature},
        growth=None if growth is None else asdict(growth),
    )


def _symmetric(scenario: Scenario) -> CycleFamily:
    with progress_bar("amplitude {n:.3g} of {total:.3g} rad") as progress:
        return families.cycle_family(scenario, progress=progress)


def _diagram(family: CycleFamily) -> Any:
    from validation.kit.figures import new_figure
    from validation.studies.nonlinear import figures

    _, axes = new_figure(4, height=11.0, share=False)
    figures.period_diagram(family, axes=axes[1:])
    return figures.bifurcation_diagram(family, axes=axes[0])


def _rotating(scenario: Scenario) -> Result:
    from analysis.nonlinear.rotating import folds, rotating_family
    from validation.studies.nonlinear import figures

    with progress_bar("rotating motion {n:.0f} of {total:.0f}") as progress:
        family = rotating_family(scenario, progress=progress)
    turns = folds(family)
    return _motions(
        [tables.rotation_table(family, turns)],
        map(_told, family.rotations),
        partial(figures.rotation_diagram, family),
        events=[_told(each, kind="fold") for each in turns],
        reason=family.reason,
        connection=family.connection.spin,
    )


def _asymmetric(scenario: Scenario) -> Result:
    from analysis.nonlinear.asymmetric import changes, first_asymmetric_family
    from validation.studies.nonlinear import figures

    symmetric = _symmetric(scenario)
    with progress_bar("cycle {n:.0f} of {total:.0f}") as progress:
        family = first_asymmetric_family(symmetric, progress=progress)
    found = changes(family.cycles)
    born: Cycle = family.bifurcation.cycle
    return _motions(
        [tables.asymmetric_table(family, found)],
        map(_told, family.cycles),
        partial(figures.asymmetric_diagram, family, symmetric),
        events=[
            _told(born, kind="symmetry breaking"),
            *(_told(each, kind=kind) for kind, each in found),
        ],
        reason=family.reason,
    )


def _over(options: argparse.Namespace, scenario: Scenario, spins: list[float] | None) -> Result:
    from analysis.nonlinear.over import cycles_over
    from validation.studies.nonlinear import over

    axis = _axis(options)
    if (spins is None) == (options.amplitude is None) or (spins is not None and len(spins) > 1):
        raise ArgumentError("over", "needs what is held: one --spin, or --amplitude")
    values, scenarios = over.scenarios_over(scenario, axis)
    held = {"amplitude": options.amplitude} if spins is None else {"spin": spins[0]}
    found = cycles_over(scenarios, **held)
    table = over.cycles_table(axis, values, found)
    shown = ("spin in rad/s" if spins is None else "amplitude in rad", "multiplier")
    return _motions(
        [table],
        [
            _told(each, **{axis.field: value})
            for value, each in zip(values, found.cycles, strict=False)
        ],
        lambda: over.draw(table, axis.log, shown),
        reason=found.reason,
    )


def _axis(options: argparse.Namespace) -> Any:
    """What --over goes through."""
    from validation.sweeps.axes import axis_from_text

    try:
        return axis_from_text(options.over)
    except ValueError as error:
        raise ArgumentError("over", f"tells no axis: {error}") from None


def heteroclinic(options: argparse.Namespace) -> Result:
    """Tell the heteroclinic connection."""
    from validation.studies.nonlinear import figures

    scenario = _reduced(options)
    if options.over is not None:
        return _connections_over(options, scenario)
    found = heteroclinic_connection(scenario)
    slow = tables.prediction(scenario)
    sides = [found.spin + side for side in (-_SIDE, 0.0, _SIDE)]

    def picture() -> Any:
        ways = [fall(scenario, spin) for spin in sides]
        return figures.connection_portrait(ways, [f"{spin:.6f} rad/s" for spin in sides]).figure

    return Result(
        tables=[tables.connection_table(found, slow, None)],
        values={
            **asdict(found),
            "saddle_index": found.saddle_index,
            "prediction": None if slow is None else slow.spin,
        },
        draw=picture,
    )


def _connections_over(options: argparse.Namespace, scenario: Scenario) -> Result:
    from validation.studies.nonlinear import over

    axis = _axis(options)
    values, scenarios = over.scenarios_over(scenario, axis)
    ends = [over.End.of(each) for each in counted(scenarios, axis.field)]
    table = over.ends_table(axis, values, ends)
    rows = [{axis.field: value, **asdict(end)} for value, end in zip(values, ends, strict=True)]
    return Result(
        tables=[table],
        values={"ends": rows},
        draw=lambda: over.draw(table, axis.log, table.columns[1:4]).figure,
    )


def passage(options: argparse.Namespace) -> Result:
    """Tell when an inverted disk is lost."""
    from validation.studies.nonlinear import figures
    from validation.studies.nonlinear.passage import SPACING, follow, passage_table

    end = chosen_end(options, SPACING)
    scenario = chosen_scenario(options, rest=options.rest)
    found = follow(scenario, end, run_options(options)["source"])
    named = [(found.pair.scenario.name, found)]
    own = ("crossing", "lost", "predicted", "lowest_spin", "rate")
    return Result(
        tables=[passage_table(named)],
        values={"hopf": found.pair.spin, "frequency": found.pair.frequency}
        | {name: getattr(found, name) for name in own},
        draw=lambda: figures.passage_diagram(named)[0].figure,
    )


def _reduced(options: argparse.Namespace) -> Scenario:
    """Scenario of the options, of Model 4 unless they say otherwise."""
    if options.model is None and options.constraints is None and options.scenario is None:
        options.model = 4
    return chosen_scenario(options)
