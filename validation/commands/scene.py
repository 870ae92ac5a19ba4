"""The command `scene`: what is in a scene, and why."""

from mbs_models.inventory import inventory
from mbs_models.scene import Scene
from validation.commands.output import Result
from validation.kit.tables import Table
from validation.parser.kinds import AnyProblem, Numbers
from validation.parser.runs import Formulation


def scene(*, problem: AnyProblem, formulation: Formulation | None = None) -> Numbers:
    """List what is in a scene of the engine, and why.

    List the nodes, objects, markers and sensors of a scene with the reason for each, and count its
    coordinates, constraints and user functions.

    Parameters
    ----------
    formulation
        How the disk is built (the most accurate).
    """
    scene = Scene(scenario=problem.scenario(), formulation=formulation)
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
