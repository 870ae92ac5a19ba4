"""The commands `scenario` and `check`: a problem as a file, and the two sides on it."""

import argparse
from typing import Any

from analysis import scenario_text
from analysis.data.checks import whole
from validation.commands.options import chosen_end
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario


def scenario(options: argparse.Namespace) -> int:
    """Print a scenario as a commented file."""
    print(scenario_text(chosen_scenario(options, rest=options.rest)), end="")
    return 0


def check(options: argparse.Namespace) -> Result:
    """Say how the engine and the in-house equations agree; 1 if they do not."""
    chosen, end = chosen_scenario(options), chosen_end(options)
    whole("states", options.states)
    from validation.studies import comparisons

    checks = comparisons.compare_scenario(chosen, states=options.states, end=end)
    failed = sum(each.agrees is False for each in checks)
    held = sum(each.agrees is True for each in checks)
    return Result(
        tables=[comparisons.table(checks)],
        notes=[f"{failed} checks FAIL." if failed else f"All {held} checks hold."],
        draw=lambda: _picture(checks),
        code=1 if failed else 0,
    )


def _picture(checks: Any) -> Any:
    """Figure of the differences as parts of what is allowed."""
    from validation.kit import figures

    shown = [each for each in checks if each.difference is not None]
    figure, axes = figures.new_figure(height=1.0 + 0.3 * len(shown))
    names = [f"{each.quantity}, {each.formulation}" for each in shown]
    axes.plot([each.difference / each.criterion for each in shown], names, "o", color="black")
    axes.axvline(1.0, color=figures.COLOURS[2])
    axes.set(xscale="log", xlabel="largest difference over what is allowed")
    return figure
