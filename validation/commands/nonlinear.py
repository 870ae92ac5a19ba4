"""What the subcommands on nonlinear dynamics do; each returns the exit code."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analysis import Scenario
from analysis.nonlinear import family as families
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import CycleFamily
from analysis.nonlinear.heteroclinic import fall, heteroclinic_connection
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from validation.commands.options import chosen_end
from validation.commands.output import deliver, save
from validation.commands.scenarios import chosen_scenario
from validation.commands.stability import parse_spins
from validation.kit.progress import counted, progress_bar
from validation.kit.tables import Table
from validation.studies.nonlinear import tables

_SIDE = 0.05
"""Distance in rad/s from the connection at which the picture shows motions."""


def cycles(options: argparse.Namespace) -> int:
    """Print, store or plot the periodic motions."""
    spins = None if options.spins is None else parse_spins(options.spins)
    scenario = _reduced(options)
    if options.over is not None:
        return _cycles_over(options, scenario, None if spins is None else spins.tolist())
    if options.rotating:
        return _rotating(options, scenario)
    if options.asymmetric:
        return _asymmetric(options, scenario)
    if options.amplitude is not None:
        raise ValueError("--amplitude belongs to --over; a family goes through all amplitudes")
    if spins is not None:
        found = [families.cycle_at(scenario, spin) for spin in counted(spins.tolist(), "spins")]
        deliver(options, [tables.cycle_table(found)], {"cycles": _cycle_values(found)})
        if options.plot is not None:
            from validation.studies.nonlinear import figures

            save(figures.cycle_portrait(found).figure, options.plot)
        return 0
    with progress_bar("amplitude {n:.3g} of {total:.3g} rad") as progress:
        family = families.cycle_family(scenario, progress=progress)
    shown, values = _family(scenario, family)
    deliver(options, shown, values)
    if options.plot is not None:
        _plot_family(family, options.plot)
    if family.reason is not None and not options.json:
        print(f"The family ends early: {family.reason}.")
    return 0


def heteroclinic(options: argparse.Namespace) -> int:
    """Print, store or plot the heteroclinic connection."""
    scenario = _reduced(options)
    if options.over is not None:
        return _connections_over(options, scenario)
    found = heteroclinic_connection(scenario)
    slow = tables.prediction(scenario)
    values = {
        **asdict(found),
        "saddle_index": found.saddle_index,
        "prediction": None if slow is None else slow.spin,
    }
    deliver(options, [tables.connection_table(found, slow, None)], values)
    if options.plot is not None:
        from validation.studies.nonlinear import figures

        ways = [fall(scenario, found.spin + side) for side in (-_SIDE, 0.0, _SIDE)]
        names = [f"{found.spin + side:.6f} rad/s" for side in (-_SIDE, 0.0, _SIDE)]
        save(figures.connection_portrait(ways, names).figure, options.plot)
    return 0


def _rotating(options: argparse.Namespace, scenario: Scenario) -> int:
    from analysis.nonlinear.rotating import folds, rotating_family

    _no_spin(options, "--rotating")
    with progress_bar("rotating motion {n:.0f} of {total:.0f}") as progress:
        family = rotating_family(scenario, progress=progress)
    turns = folds(family)
    values = {
        "connection": family.connection.spin,
        "rotations": _values(family.rotations, "tilt", "largest_tilt"),
        "folds": _values(turns, "tilt", "largest_tilt"),
        "reason": family.reason,
    }
    deliver(options, [tables.rotation_table(family, turns)], values)
    if options.plot is not None:
        from validation.studies.nonlinear import figures

        save(figures.rotation_diagram(family).figure, options.plot)
    return 0


def _asymmetric(options: argparse.Namespace, scenario: Scenario) -> int:
    from analysis.nonlinear.asymmetric import changes, first_asymmetric_family

    _no_spin(options, "--asymmetric")
    with progress_bar("symmetric cycle {n:.3g} of {total:.3g} rad") as progress:
        symmetric = families.cycle_family(scenario, progress=progress)
    with progress_bar("cycle {n:.0f} of {total:.0f}") as progress:
        family = first_asymmetric_family(symmetric, progress=progress)
    found = changes(family.cycles)
    names = ("amplitude", "lowest")
    values = {
        "born": _cycle_values([family.bifurcation.cycle])[0],
        "cycles": _values(family.cycles, *names),
        "changes": [{"kind": kind, **_values([each], *names)[0]} for kind, each in found],
        "reason": family.reason,
    }
    deliver(options, [tables.asymmetric_table(family, found)], values)
    if options.plot is not None:
        from validation.studies.nonlinear import figures

        save(figures.asymmetric_diagram(family, symmetric).figure, options.plot)
    return 0


def _no_spin(options: argparse.Namespace, option: str) -> None:
    if options.spins is not None:
        raise ValueError(f"--spin does not go together with {option}: a family has many spins")


def _cycles_over(
    options: argparse.Namespace, scenario: Scenario, spins: list[float] | None
) -> int:
    from analysis.nonlinear.over import cycles_over
    from validation.studies.nonlinear import over
    from validation.sweeps.axes import axis_from_text

    axis = axis_from_text(options.over)
    if (spins is None) == (options.amplitude is None) or (spins is not None and len(spins) > 1):
        raise ValueError("--over needs what is held: one --spin, or --amplitude")
    values, scenarios = over.scenarios_over(scenario, axis)
    held = {"amplitude": options.amplitude} if spins is None else {"spin": spins[0]}
    found = cycles_over(scenarios, **held)
    table = over.cycles_table(axis, values, found)
    rows = [
        {axis.field: value, **each}
        for value, each in zip(values, _cycle_values(found.cycles), strict=False)
    ]
    deliver(options, [table], {"cycles": rows, "reason": found.reason})
    if options.plot is not None:
        shown = "spin in rad/s" if spins is None else "amplitude in rad"
        save(over.draw(table, axis.log, (shown, "multiplier")).figure, options.plot)
    return 0


def _connections_over(options: argparse.Namespace, scenario: Scenario) -> int:
    from validation.studies.nonlinear import over
    from validation.sweeps.axes import axis_from_text

    axis = axis_from_text(options.over)
    values, scenarios = over.scenarios_over(scenario, axis)
    ends = [over.End.of(each) for each in counted(scenarios, axis.field)]
    table = over.ends_table(axis, values, ends)
    rows = [{axis.field: value, **asdict(end)} for value, end in zip(values, ends, strict=True)]
    deliver(options, [table], {"ends": rows})
    if options.plot is not None:
        save(over.draw(table, axis.log, table.columns[1:4]).figure, options.plot)
    return 0


def passage(options: argparse.Namespace) -> int:
    """Print, store or plot when an inverted disk is lost."""
    from validation.studies.nonlinear.passage import SPACING, follow, passage_table

    end = chosen_end(options, SPACING)
    found = follow(chosen_scenario(options, rest=options.rest), end, options.source)
    values = {
        "hopf": found.pair.spin,
        "frequency": found.pair.frequency,
        "crossing": found.crossing,
        "lost": found.lost,
        "predicted": found.predicted,
        "lowest_spin": found.lowest_spin,
        "rate": found.rate,
    }
    name = found.pair.scenario.name
    deliver(options, [passage_table([(name, found)])], values)
    if options.plot is not None:
        from validation.studies.nonlinear import figures

        save(figures.passage_diagram([(name, found)])[0].figure, options.plot)
    return 0


def _reduced(options: argparse.Namespace) -> Scenario:
    """Scenario of the options, of Model 4 unless they say otherwise."""
    if options.model is None and options.constraints is None and options.scenario is None:
        options.model = 4
    return chosen_scenario(options)


def _family(scenario: Scenario, family: CycleFamily) -> tuple[list[Table], dict[str, Any]]:
    normal = hopf_type(scenario)
    small = tables.small_cycles(family)
    growth = None
    if len(small) > 4:
        growth = fitted_growth(
            [cycle.spin for cycle in small], [cycle.amplitude for cycle in small], normal.spin
        )
    found = families.bifurcations(family)
    values = {
        "hopf": {**asdict(normal), "kind": normal.kind, "curvature": normal.curvature},
        "growth": None if growth is None else asdict(growth),
        "cycles": _cycle_values(family.cycles),
        "bifurcations": [{"kind": each.kind, **_cycle_values([each.cycle])[0]} for each in found],
        "reason": family.reason,
    }
    shown = [
        tables.cycle_table(family.cycles),
        tables.hopf_table(normal, growth),
        tables.bifurcation_table(found, family.cycles),
    ]
    return shown, values


def _cycle_values(cycles: Sequence[Cycle]) -> list[dict[str, Any]]:
    return _values(cycles, "amplitude", "half_multiplier")


def _values(motions: Sequence[Any], *own: str) -> list[dict[str, Any]]:
    names = ("spin", *own, "period", "multiplier", "log_strong", "stable")
    return [{name: getattr(each, name) for name in names} for each in motions]


def _plot_family(family: CycleFamily, path: Path) -> None:
    from validation.kit.figures import new_figure
    from validation.studies.nonlinear import figures

    figure, axes = new_figure(4, height=11.0, share=False)
    figures.bifurcation_diagram(family, axes=axes[0])
    figures.period_diagram(family, axes=axes[1:])
    save(figure, path)
