"""What is to be built: a scenario, and how the engine is to build it."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

from analysis.data.checks import choice
from analysis.data.constraint_set import MODELS
from analysis.data.scenario import Scenario
from analysis.data.state import State

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)

_BY_ACCURACY: tuple[Formulation, ...] = (
    "contact-tree",
    "euler-tree",
    "floating",
    "floating-lie",
)
_TO_REST: tuple[Formulation, ...] = ("floating-lie", "floating")

_PAPER = Scenario()


def formulations(scenario: Scenario) -> tuple[Formulation, ...]:
    """Formulations that can build a scenario, the most accurate one first.

    Parameters
    ----------
    scenario : Scenario
    """
    contact = scenario.contact
    lies_flat = contact is not None and (contact.is_rounded or scenario.dissipation.is_on)
    ranked = _TO_REST if lies_flat else _BY_ACCURACY
    return tuple(each for each in ranked if not _obstacle(scenario, each))


def _obstacle(scenario: Scenario, formulation: Formulation) -> str:
    """Why a formulation cannot build a scenario; empty if it can."""
    contact = scenario.contact
    if formulation == "contact-tree":
        if scenario.constraints != MODELS[1]:
            return f"exists for Model 1 alone, got {scenario.name}"
        if contact is not None:
            return "closes the contact by its topology and has no room for a penalty contact"
        if scenario.friction.load == "contact":
            return (
                "has no contact constraint whose force the load 'contact' of the friction law "
                "could take"
            )
    if formulation == "euler-tree" and contact is not None:
        if contact.is_rounded:
            return (
                "is singular when the disk lies flat, which a contact with half_thickness = "
                f"{contact.half_thickness:g} lasts until"
            )
        if scenario.dissipation.is_on:
            return "knows no dissipation besides friction and the contact's damping"
    return ""


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
    """

    scenario: Scenario = _PAPER
    formulation: Formulation | None = None

    def __post_init__(self) -> None:
        if self.formulation is None:
            return
        choice("formulation", self.formulation, FORMULATIONS)
        if why := _obstacle(self.scenario, self.formulation):
            able = ", ".join(formulations(self.scenario))
            raise ValueError(f"formulation {self.formulation!r} {why}; use one of {able}")

    @property
    def built_as(self) -> Formulation:
        """The formulation, the default one if none is given."""
        return self.formulation or formulations(self.scenario)[0]

    @property
    def has_constraints(self) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take.

        Euler parameters bring one of their own.
        """
        if self.scenario.contact is not None:
            return self.built_as == "floating"
        return self.built_as != "contact-tree"

    def starting_at(self, state: State) -> "Scene":
        """The same scene with this state as its start."""
        return replace(self, scenario=replace(self.scenario, start=state))
