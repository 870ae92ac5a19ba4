"""Subcommands on periodic motions, their end, and slow passage."""

import argparse

from validation.parser.base import Commands
from validation.parser.groups import add_output, add_problem, add_scenario, add_source


def add_cycles(commands: Commands) -> None:
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
    what = cycles.add_mutually_exclusive_group()
    what.add_argument(
        "--rotating",
        action="store_true",
        help="instead, the motions beyond the heteroclinic end, in which gamma turns round",
    )
    what.add_argument(
        "--asymmetric",
        action="store_true",
        help="instead, the cycles without mirror symmetry, where symmetric ones lose it",
    )
    _add_over(what)
    cycles.add_argument(
        "--amplitude", type=float, metavar="RAD", help="of the cycle that --over follows"
    )
    add_output(cycles)
    add_problem(cycles)


def add_heteroclinic(commands: Commands) -> None:
    """Take `heteroclinic` into the commands."""
    heteroclinic = commands.add_parser(
        "heteroclinic",
        help="the heteroclinic connection in which the cycles end",
        description="Find the spin at which the motion that leaves noninverted spinning ends in "
        "it again, to 1e-9 rad/s, beside its prediction to first order on the slow manifold. The "
        "picture shows that motion on either side of the connection.",
    )
    heteroclinic.set_defaults(module="nonlinear")
    _add_over(heteroclinic)
    add_output(heteroclinic)
    add_problem(heteroclinic)


def _add_over(parser: "argparse._ActionsContainer") -> None:
    parser.add_argument(
        "--over",
        metavar="AXIS",
        help="go through a parameter, as in sweep: mu=0.1:1:10:log, eps=0.01,0.1, "
        "hole-distance=0.01:0.025:4",
    )


def add_passage(commands: Commands) -> None:
    """Take `passage` into the commands."""
    passage = commands.add_parser(
        "passage",
        help="when an inverted disk is lost as its spin decays",
        description="Run a scenario, by default Model 1 from the paper's start, and tell when its "
        "falling spin passes the Hopf point of inverted spinning, when the inversion is lost, and "
        "when it should be by the eigenvalues alone.",
    )
    passage.set_defaults(module="nonlinear")
    add_source(passage, "in-house")
    add = passage.add_argument
    add("--end", type=float, default=22.0, help="longest time in s (22)")
    add("--rest", action="store_true", help="start from the defaults of `tippedisk rest`")
    add_output(passage)
    add_scenario(passage)
