"""Subcommands on periodic motions, their end, and slow passage."""

import argparse
from typing import Any

from validation.parser.groups import add_output, add_problem


def add_cycles(commands: "argparse._SubParsersAction[Any]") -> None:
    """Take `cycles` into the commands."""
    cycles = commands.add_parser(
        "cycles",
        help="periodic motions of the reduced system, with their multipliers",
        description="Follow the periodic motions of the reduced system (Model 4) from the Hopf "
        "point of inverted spinning to their end, with period, Floquet multipliers and "
        "bifurcations; or find those at given spins.",
    )
    cycles.set_defaults(module="nonlinear")
    cycles.add_argument(
        "--spin",
        dest="spins",
        nargs="+",
        metavar="SPIN",
        help="only the cycles at these spins in rad/s: values, or first:last:number",
    )
    add_output(cycles)
    add_problem(cycles)


def add_heteroclinic(commands: "argparse._SubParsersAction[Any]") -> None:
    """Take `heteroclinic` into the commands."""
    heteroclinic = commands.add_parser(
        "heteroclinic",
        help="the heteroclinic connection in which the cycles end",
        description="Find the spin at which the motion that leaves noninverted spinning ends in "
        "it again, to 1e-9 rad/s, beside its prediction to first order on the slow manifold. The "
        "picture shows that motion on either side of the connection.",
    )
    heteroclinic.set_defaults(module="nonlinear")
    add_output(heteroclinic)
    add_problem(heteroclinic)
