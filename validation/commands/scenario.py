"""The subcommands `scenario` and `check`: a problem as a file, and the two sides on it."""

import argparse

from analysis.data.scenario_file import scenario_text
from validation.commands.scenarios import chosen_scenario


def scenario(options: argparse.Namespace) -> int:
    """Print a scenario as a commented file."""
    print(scenario_text(chosen_scenario(options, rest=options.rest)), end="")
    return 0


def check(options: argparse.Namespace) -> int:
    """Print how the engine and the in-house equations agree; 1 if they do not."""
    chosen = chosen_scenario(options)
    from validation.studies.crosscheck import check_scenario

    table = check_scenario(chosen)
    print(f"{table.title}\n{table.to_text()}")
    if table.note:
        print(table.note)
    failed = sum(cell is False for row in table.rows for cell in row)
    print("All agree." if not failed else f"{failed} of {len(table.rows)} checks FAIL.")
    return 1 if failed else 0
