"""The command `scene`: what is in a scene, and why."""

import argparse

from mbs_models.inventory import inventory
from mbs_models.scene import Scene
from validation.commands.output import Result
from validation.commands.scenarios import chosen_scenario
from validation.kit.tables import Table


def scene(options: argparse.Namespace) -> Result:
    """List the items of a scene; a note sums them up."""
    scene = Scene(scenario=chosen_scenario(options), formulation=options.formulation)
    listed = inventory(scene)
    table = Table.of(
        listed.items,
        {
            "item": lambda item: f"{item.kind} {item.number}",
            "engine type": lambda item: item.type,
            "coordinates": lambda item: item.coordinates or None,
            "equations": lambda item: item.equations or None,
            "of them idle": lambda item: item.idle or None,
            "user function": lambda item: ", ".join(item.user_functions) or None,
            "why": lambda item: item.why,
        },
        title=f"{scene.scenario.name}, formulation {scene.built_as}",
        note=f"{listed.coordinates} coordinates, {listed.equations} algebraic equations "
        f"({listed.constraints} constraints; an idle equation only says that an unused "
        f"constraint force is zero), {listed.user_functions} user functions.",
    )
    return Result(tables=[table])
