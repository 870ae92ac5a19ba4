"""What else to try where a run of the engine has not got there."""

from mbs_models.integrators import Integrator
from mbs_models.scene import Scene


def advice(scene: Scene, integrator: Integrator) -> str:
    """Other ways to simulate the same motion, the most promising one first.

    Parameters
    ----------
    scene : Scene
    integrator : Integrator
        What has been tried.
    """
    ways = []
    if scene.scenario.contact is None:
        best = Scene(scene.scenario)
        if not best.has_constraints:
            if scene.built_as != best.built_as:
                ways.append(f"formulation {best.built_as!r}, which has no constraints")
            elif not integrator.controls_step:
                ways.append("integrator 'DOPRI5', which controls its step")
        ways.append("the in-house equations (analysis.simulate, stiff ones with method 'Radau')")
    if integrator.implicit or integrator.controls_step:
        ways.append("a smaller step" if integrator.implicit else "another local tolerance")
    return f"try {', or '.join(ways)}" if ways else "try a smaller step"
