"""From a scene to its model in the engine."""

from mbs_models.floating import Floating, FloatingLie
from mbs_models.model import Model
from mbs_models.scene import Formulation, Scene
from mbs_models.trees import ContactTree, EulerTree

_MODELS: dict[Formulation, type[Model]] = {
    "floating": Floating,
    "floating-lie": FloatingLie,
    "euler-tree": EulerTree,
    "contact-tree": ContactTree,
}


def build(scene: Scene) -> Model:
    """Build and assemble `scene` in the engine.

    Parameters
    ----------
    scene : Scene
    """
    return _MODELS[scene.built_as](scene)
