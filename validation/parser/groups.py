"""Options that several subcommands share: those that describe the problem.

None of them has a default of its own: what is not given is that of the scenario's file, or else
of the data types. Angles stay text until the data types read them.
"""

import argparse
from typing import Any

from validation.parser.paths import PICTURES, existing, table, writable

SOURCES = ("engine", "in-house")
MODELS = (1, 2, 3, 4)
CONSTRAINTS = ("contact", "fixed-cog", "no-slip-along", "no-slip-across", "constant-spin")
FORMULATIONS = ("floating", "floating-lie", "euler-tree", "contact-tree")
FORMS = ("index-1", "reduced", "free-body")
INTEGRATORS = (
    *("RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha"),
    *("DOP853", "Radau", "LSODA"),
)
METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor")
LOADS = ("weight", "contact")
DISKS = ("steel", "steel-rounded")
SYSTEMS = ("full", "reduced", "numeric")
CONDITIONS = ("inverted", "lost")
MOTIONS = ("inverted", "noninverted")


def add_scenario(parser: argparse.ArgumentParser, *, file: bool = False) -> None:
    """Everything that describes a scenario; the arguments are those of `add_problem`."""
    add_problem(parser, file=file)
    _add_contact(parser)
    _add_start(parser)


def add_problem(parser: argparse.ArgumentParser, *, file: bool = False) -> None:
    """Everything but contact and start: scenario, constraints, disk, friction, table.

    Parameters
    ----------
    parser : ArgumentParser
    file : bool
        Whether the scenario's file is the first argument instead of an option.
    """
    problem = parser.add_argument_group(
        "problem", "Options given here override the file; angles may be pi/2 or 90deg, too."
    )
    add = problem.add_argument
    name: dict[str, Any] = {"nargs": "?"} if file else {}
    add(
        "scenario" if file else "--scenario",
        type=existing(),
        metavar="FILE",
        help="scenario, .toml, or a stored run to repeat, .npz",
        **name,
    )
    constraints = problem.add_mutually_exclusive_group()
    constraints.add_argument(
        "--model", type=int, choices=MODELS, help="constraints of a model of the paper (1)"
    )
    constraints.add_argument(
        "--constraints",
        metavar="LIST",
        help=f"or any of {', '.join(CONSTRAINTS)}, with commas between",
    )
    _add_disk(parser)
    _add_friction(parser)
    add = parser.add_argument_group("table").add_argument
    add("--gravity", type=float, metavar="M/S2", help="gravitational acceleration in m/s² (9.81)")
    add("--inclination", metavar="ANGLE", help="of the table in rad (0)")
    add("--downhill", metavar="ANGLE", help="direction of descent from the x axis in rad (0)")


def _add_disk(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument_group(
        "disk", "One by name, some of whose values may be replaced; or one with a round hole."
    ).add_argument
    add("--disk", choices=DISKS, help="the paper's, unrounded (default) or as printed")
    add("--radius", type=float, metavar="M", help="in m, with the next five or with a hole")
    add("--mass", type=float, metavar="KG", help="in kg")
    add("--eccentricity", type=float, metavar="M", help="of the centre of gravity in m")
    for axis in "xyz":
        add(f"--inertia-{axis}", type=float, metavar="KGM2", help="about the centre in kg m²")
    add(
        "--hole-radius",
        type=float,
        metavar="M",
        help="in m; the next three and --radius go with it",
    )
    add("--hole-distance", type=float, metavar="M", help="from the centre in m")
    add("--thickness", type=float, metavar="M", help="in m")
    add("--density", type=float, metavar="KG/M3", help="in kg/m³")


def _add_friction(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument_group("friction").add_argument
    add("--mu", type=float, metavar="MU", help="friction coefficient (0.3)")
    add(
        "--eps", type=float, metavar="M/S", help="smoothing speed of the friction law in m/s (0.1)"
    )
    add(
        "--law",
        metavar="LAW",
        help="smooth-coulomb, stribeck, tanh, viscous or module:class, with its parameters "
        "behind commas, as in tanh,coefficient=0.4",
    )
    add(
        "--load",
        choices=LOADS,
        help="what presses the disk down: its weight m g, or the normal contact force",
    )


def _add_contact(parser: argparse.ArgumentParser) -> None:
    """Penalty contact, and what takes energy on it."""
    add = parser.add_argument_group(
        "contact", "A spring and a damper in place of the ideal contact, for Model 1."
    ).add_argument
    add("--stiffness", type=float, metavar="N/M", help="in N/m")
    add("--damping", type=float, metavar="NS/M", help="in N s/m (half of the critical one)")
    add("--half-thickness", type=float, metavar="M", help="of a rounded rim in m")
    add("--bilateral", action="store_true", default=None, help="let the contact pull")
    add("--rolling", type=float, metavar="PART", help="dry rolling resistance on the contour (0)")
    add("--rolling-viscous", type=float, metavar="S/M", help="viscous one, in s/m (0)")
    add("--pivoting", type=float, metavar="M", help="lever of the pivoting friction in m (0)")
    add(
        "--air-drag",
        type=float,
        metavar="KG/M3",
        help="air density times drag coefficient in kg/m³ (0)",
    )


def _add_start(parser: argparse.ArgumentParser) -> None:
    """Where and how fast the motion begins."""
    add = parser.add_argument_group(
        "start", "The paper's Table 3 by default; what is not given meets the constraints."
    ).add_argument
    add("--spin", type=float, metavar="RAD/S", help="rate of alpha in rad/s (40)")
    add("--beta", metavar="ANGLE", help="inclination in rad (pi/2)")
    add("--gamma", metavar="ANGLE", help="rotation angle in rad (-pi/2 + 0.1)")
    add("--alpha", metavar="ANGLE", help="in rad (0)")
    add("--beta-rate", type=float, metavar="RAD/S", help="in rad/s (0)")
    add("--gamma-rate", type=float, metavar="RAD/S", help="in rad/s (-spin * cos(beta))")
    for name in "xy":
        add(
            f"--{name}",
            type=float,
            metavar="M",
            help="of the geometric centre in m, in the turning frame",
        )
        add(f"--{name}-rate", type=float, metavar="M/S", help="its rate in m/s")
    add("--height", type=float, metavar="M", help="over the table in m, with --stiffness")


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
