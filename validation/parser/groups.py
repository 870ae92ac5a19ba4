"""Options that several subcommands share: those that describe the problem.

None of them has a default of its own: what is not given is that of the scenario's file, or else
of the data types. Angles stay text until the data types read them.
"""

import argparse
from collections.abc import Sequence
from typing import Any

from analysis.data.quantities import SECTIONS, Quantity, of_table
from validation.parser.paths import PICTURES, existing, table, writable

SOURCES = ("engine", "in-house")
FORMULATIONS = ("floating", "floating-lie", "euler-tree", "contact-tree")
FORMS = ("index-1", "reduced", "free-body")
INTEGRATORS = ("RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha")
METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor")
SYSTEMS = ("full", "reduced", "numeric")
CONDITIONS = ("inverted", "lost")
MOTIONS = ("inverted", "noninverted")


def add_scenario(parser: argparse.ArgumentParser, *, file: bool = False) -> None:
    """Everything that describes a scenario; the arguments are those of `add_problem`."""
    add_problem(parser, file=file)
    _add_tables(parser, ("contact", "dissipation", "start"))


def add_problem(parser: argparse.ArgumentParser, *, file: bool = False) -> None:
    """Everything but contact and start: scenario, constraints, disk, friction, table.

    Parameters
    ----------
    parser : ArgumentParser
    file : bool
        Whether the scenario's file is the first argument instead of an option.
    """
    name: dict[str, Any] = {"nargs": "?"} if file else {}
    parser.add_argument(
        "scenario" if file else "--scenario",
        type=existing(),
        metavar="FILE",
        help="scenario, .toml, or a stored run to repeat, .npz",
        **name,
    )
    _add_tables(parser, ("", "disk", "friction", "table"))


def _add_tables(parser: argparse.ArgumentParser, tables: Sequence[str]) -> None:
    for name in tables:
        group = parser.add_argument_group(name or "problem", SECTIONS[name].about)
        for quantity in of_table(name).values():
            _add_quantity(group, quantity)


def _add_quantity(group: Any, quantity: Quantity) -> None:
    """Take the option of a quantity; its value stays text until it is read."""
    unit = f", in {quantity.unit}" if quantity.unit else ""
    usual = f" ({quantity.shown_default})" if quantity.shown_default else ""
    about = f"{quantity.meaning}{unit}{usual}".replace("%", "%%")
    how: dict[str, Any] = {"dest": quantity.key, "help": about}
    if quantity.is_switch:
        how["action"] = argparse.BooleanOptionalAction
    elif quantity.choices and quantity.key not in ("constraints", "friction.law"):
        how |= {"choices": list(map(str, quantity.choices))}
    else:
        how["metavar"] = quantity.metavar
    group.add_argument(quantity.flag, **how)


def add_output(parser: argparse.ArgumentParser) -> None:
    """Where the numbers go; they are printed as a table if none of these is given."""
    add = parser.add_argument
    add("--json", action="store_true", help="print everything as JSON")
    add("--csv", type=table, metavar="FILE", help="write a table of all digits, .csv or -")
    add("--plot", type=writable(*PICTURES), metavar="PICTURE", help="write a .png, .svg or .pdf")


def add_source(parser: argparse.ArgumentParser, default: str = "engine") -> None:
    """Who computes."""
    parser.add_argument(
        "--source", choices=SOURCES, default=default, help="who computes (default: %(default)s)"
    )


def add_stop_when(parser: argparse.ArgumentParser, what: str) -> None:
    """A condition to end at; `what` says what happens there."""
    parser.add_argument(
        "--stop-when",
        metavar="CONDITION",
        help=f"{what}: {', '.join(CONDITIONS)}, or where module:function, a function of the "
        "State, turns negative",
    )


def add_law_name(parser: argparse.ArgumentParser) -> None:
    """The law of a stored run, which executes nothing itself."""
    parser.add_argument(
        "--law",
        metavar="MODULE:CLASS",
        help="friction law of one's own that the motion was run with: imports it",
    )
