"""From a scene to its model in the engine."""

from mbs_models.formulations import CLASSES
from mbs_models.model import Model
from mbs_models.scene import Scene


def build(scene: Scene) -> Model:
    """Build and assemble `scene` in the engine.

    Parameters
    ----------
    scene : Scene
    """
    return CLASSES[scene.built_as](scene.scenario)
