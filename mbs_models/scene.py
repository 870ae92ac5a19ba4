"""What is to be built: a scenario, and how the engine is to build it; and the building."""

from dataclasses import dataclass, replace
from math import sin

from analysis.problem.checks import choice, instance
from analysis.problem.choices import ENGINE_FORMULATIONS, EngineFormulation
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.problem.start import State
from mbs_models.floating import Floating, FloatingLie
from mbs_models.model import Model
from mbs_models.trees import ContactTree, EulerTree

_BY_ACCURACY: tuple[type[Model], ...] = (ContactTree, EulerTree, Floating, FloatingLie)

CLASSES: dict[EngineFormulation, type[Model]] = {each.name: each for each in _BY_ACCURACY}

FREE_BELOW = 0.02
"""Sine of the inclination below which a free body comes first: the mass matrix of a tree becomes
singular with its square, and rounding in accelerations grows against that."""

_PAPER = Scenario()


def formulations(scenario: Scenario) -> tuple[EngineFormulation, ...]:
    """Formulations that can build a scenario, the most accurate one first.

    Parameters
    ----------
    scenario : Scenario

    Raises
    ------
    ValueError
        If it is no scenario.

    Examples
    --------
    >>> from analysis import Scenario
    >>> from mbs_models import formulations
    >>> formulations(Scenario())
    ('contact-tree', 'euler-tree', 'floating', 'floating-lie')
    """
    contact = instance("scenario", scenario, Scenario).contact
    lies_flat = contact is not None and (scenario.is_smooth or scenario.dissipation.is_on)
    # Of free bodies, which alone can lie flat, the one that explicit steps can take comes first.
    ranked = _BY_ACCURACY[::-1] if lies_flat else _BY_ACCURACY
    if contact is None and sin(scenario.initial_state.coordinates[4]) < FREE_BELOW:
        ranked = tuple(sorted(ranked, key=lambda each: each.has_euler_angles))
    return tuple(each.name for each in ranked if not each.obstacle(scenario))


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene for the multibody engine.

    Parameters
    ----------
    scenario : Scenario
        Model 1 with the paper's values by default.
    formulation : {"floating", "floating-lie", "euler-tree", "contact-tree"}, optional
        How the disk is built. `floating`: free rigid body with Euler parameters and joints;
        `floating-lie`: the same with a rotation vector integrated on the Lie group;
        `euler-tree`: kinematic tree in the paper's coordinates, and joints; `contact-tree`
        (Model 1): kinematic tree whose topology closes the contact, without constraints. By
        default the first of `formulations(scenario)`.

    Raises
    ------
    ValueError
        If the formulation is unknown or cannot build this scenario.

    Examples
    --------
    >>> from analysis import MODELS, Scenario
    >>> from mbs_models import Scene
    >>> Scene(Scenario(constraints=MODELS[2])).built_as
    'euler-tree'
    """

    scenario: Scenario = _PAPER
    formulation: EngineFormulation | None = None

    def __post_init__(self) -> None:
        instance("scenario", self.scenario, Scenario)
        if self.formulation is None:
            return
        choice("formulation", self.formulation, ENGINE_FORMULATIONS)
        if why := CLASSES[self.formulation].obstacle(self.scenario):
            able = ", ".join(formulations(self.scenario))
            raise ValueError(f"formulation {self.formulation!r} {why}; use one of {able}")

    @classmethod
    def of(cls, given: "Scene | Scenario") -> "Scene":
        """The scene itself, or that of a scenario in its default formulation.

        Raises
        ------
        ValueError
            If it is neither.
        """
        if isinstance(given, Scene | Scenario):
            return cls(given) if isinstance(given, Scenario) else given
        raise ArgumentError("scene", f"must be a Scene or a Scenario, got {given!r}")

    @property
    def built_as(self) -> EngineFormulation:
        """The formulation, the default one if none is given."""
        return self.formulation or formulations(self.scenario)[0]

    @property
    def has_constraints(self) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take.

        Euler parameters bring one of their own.
        """
        return CLASSES[self.built_as].has_constraints(self.scenario)

    @property
    def without_angles(self) -> EngineFormulation | None:
        """A formulation that can build it, too, without the Euler angles that this one has."""
        if not CLASSES[self.built_as].has_euler_angles:
            return None
        able = formulations(self.scenario)
        return next((each for each in able if not CLASSES[each].has_euler_angles), None)

    @property
    def freed(self) -> "Scene | None":
        """The same without Euler angles, if it has these, is free to have none, and can."""
        free = self.without_angles if self.formulation is None else None
        return replace(self, formulation=free) if free else None

    def starting_at(self, state: State) -> "Scene":
        """The same scene with this state as its start."""
        return replace(self, scenario=replace(self.scenario, start=state))


def build(scene: Scene | Scenario) -> Model:
    """Build and assemble a scene in the engine, to go on there by oneself.

    Parameters
    ----------
    scene : Scene or Scenario

    Returns
    -------
    Model
        Its `system` is an `exudyn.MainSystem` at the start of the scenario; `settle` gives it the
        accelerations there, without which solvers begin with wrong ones. It stays in memory until
        `Model.close` frees it.

    Raises
    ------
    ValueError
        If it is neither.

    Examples
    --------
    >>> from analysis import Scenario
    >>> from mbs_models import build
    >>> model = build(Scenario())
    >>> model.assembly.reasons["node", 0]
    'the joint coordinates'
    """
    scene = Scene.of(scene)
    return CLASSES[scene.built_as](scene.scenario)
