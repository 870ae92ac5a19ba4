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
    items = inventory(scene)
    coordinates, equations, idle, functions = (
        sum(each)
        for each in zip(
            *((i.coordinates, i.equations, i.idle, len(i.user_functions)) for i in items),
            strict=True,
        )
    )
    table = Table.of(
        items,
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
        note=f"{coordinates} coordinates, {equations} algebraic equations ({equations - idle} "
        "constraints; an idle equation only says that an unused constraint force is zero), "
        f"{functions} user functions.",
    )
    return Result(tables=[table])
