"""The subcommand `scene`: what is in a scene, and why."""

import argparse

from analysis import STEEL_DISK, PenaltyContact, SmoothCoulomb
from mbs_models.inventory import Inventory, inventory
from mbs_models.scene import Scene
from validation.commands.options import chosen_dissipation
from validation.kit.tables import Table


def scene(options: argparse.Namespace) -> int:
    """Print the items of a scene; the options are those of `tippedisk scene`."""
    contact = None
    if options.stiffness is not None:
        contact = PenaltyContact.damped(
            options.stiffness, STEEL_DISK, half_thickness=options.half_thickness
        )
    elif options.half_thickness:
        raise ValueError(
            f"--half-thickness needs the penalty contact of --stiffness, got "
            f"{options.half_thickness:g}"
        )
    listed = inventory(
        Scene(
            level=options.model,
            formulation=options.formulation,
            friction=SmoothCoulomb(coefficient=options.mu, load=options.load),
            contact=contact,
            dissipation=chosen_dissipation(options),
        )
    )
    table = scene_table(listed)
    print(f"{table.title}\n{table.to_text()}\n{table.note}")
    return 0


def scene_table(listed: Inventory) -> Table:
    """Table of an inventory; the note sums it up."""
    scene = listed.scene
    return Table(
        name=f"scene-{scene.level}-{scene.formulation}",
        title=f"Model {scene.level}, formulation {scene.formulation}",
        columns=(
            "item",
            "engine type",
            "coordinates",
            "equations",
            "of them idle",
            "user function",
            "why",
        ),
        rows=[
            [
                f"{item.kind} {item.number}",
                item.type,
                item.coordinates or None,
                item.equations or None,
                item.idle or None,
                ", ".join(item.user_functions) or None,
                item.why,
            ]
            for item in listed.items
        ],
        note=f"{listed.coordinates} coordinates, {listed.equations} algebraic equations "
        f"({listed.constraints} constraints; an idle equation only says that an unused "
        f"constraint force is zero), {listed.user_functions} user functions.",
    )
