"""The subcommands `scenario` and `check`: a problem as a file, and the two sides on it."""

import argparse

from analysis.data.scenario_text import scenario_text
from validation.commands.options import chosen_end
from validation.commands.scenarios import chosen_scenario


def scenario(options: argparse.Namespace) -> int:
    """Print a scenario as a commented file."""
    print(scenario_text(chosen_scenario(options, rest=options.rest)), end="")
    return 0


def check(options: argparse.Namespace) -> int:
    """Print how the engine and the in-house equations agree; 1 if they do not."""
    chosen, end = chosen_scenario(options), chosen_end(options)
    if options.states < 1:
        raise ValueError(f"--states must be at least 1, got {options.states}")
    from validation.studies import crosscheck

    checks = crosscheck.check_scenario(chosen, states=options.states, end=end)
    table = crosscheck.table(checks)
    print(f"{table.title}\n{table.to_text()}")
    failed = sum(each.verdict is False for each in checks)
    held = sum(each.verdict is True for each in checks)
    print(f"{failed} checks FAIL." if failed else f"All {held} checks hold.")
    return 1 if failed else 0
