"""What is to be built: one frozen description of a scene."""

from dataclasses import dataclass, field
from typing import Literal, get_args

from analysis.checks import choice
from analysis.disk import STEEL_DISK, Disk
from analysis.friction import SmoothCoulomb
from analysis.state import LEVELS, Level, State, consistent_start
from mbs_models.contact import PenaltyContact

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)


def formulations(level: Level) -> tuple[Formulation, ...]:
    """Formulations that exist for Model `level`, the most accurate one first."""
    choice("level", level, LEVELS)
    if level == 1:
        return ("contact-tree", "euler-tree", "floating", "floating-lie")
    return ("euler-tree", "floating", "floating-lie")


def default_formulation(level: Level, friction: SmoothCoulomb) -> Formulation:
    """Formulation that is most accurate for Model `level` and knows the load of its friction."""
    return formulations(level)[0] if friction.load == "weight" else "euler-tree"


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A scene for the multibody engine.

    Parameters
    ----------
    level : {1, 2, 3, 4}
        Model of Table 2; each adds a constraint.
    formulation : {"floating", "floating-lie", "euler-tree", "contact-tree"}, optional
        How the disk is built. `floating`: free rigid body with Euler parameters and joints;
        `floating-lie`: the same with a rotation vector integrated on the Lie group;
        `euler-tree`: kinematic tree in the paper's coordinates, and joints; `contact-tree`
        (Model 1): kinematic tree whose topology closes the contact, without constraints. By
        default that of `default_formulation`.
    disk : Disk
    friction : SmoothCoulomb
    start : State, optional
        By default Table 3, made consistent with the model; on a penalty contact that is lowered
        by the resting penetration. A given start is taken as it is: on a penalty contact it may
        lie above the table or in it, and `PenaltyContact.lowered` makes one that rests.
    contact : PenaltyContact, optional
        Unilateral penalty contact (Model 1, not `contact-tree`); by default the ideal bilateral
        constraint of the paper.

    Raises
    ------
    ValueError
        If an argument is unknown, or the formulation cannot build this model.
    """

    level: Level = 1
    formulation: Formulation = None  # type: ignore[assignment]  # filled in below
    disk: Disk = STEEL_DISK
    friction: SmoothCoulomb = field(default_factory=SmoothCoulomb)
    start: State = None  # type: ignore[assignment]  # filled in below
    contact: PenaltyContact | None = None

    def __post_init__(self) -> None:
        available = formulations(self.level)
        if self.formulation is None:
            chosen = default_formulation(self.level, self.friction)
            if self.contact is not None and chosen == "contact-tree":
                chosen = "euler-tree"
            object.__setattr__(self, "formulation", chosen)
        choice("formulation", self.formulation, FORMULATIONS)
        if self.formulation not in available:
            raise ValueError(
                f"formulation {self.formulation!r} exists for Model 1 alone, got level "
                f"{self.level}; use one of {', '.join(available)}"
            )
        if self.contact is not None:
            self._check_penalty(self.contact)
        elif self.formulation == "contact-tree" and self.friction.load == "contact":
            raise ValueError(
                "formulation 'contact-tree' has no contact constraint whose force the load "
                "'contact' could take; use the load 'weight' or another formulation"
            )
        if self.start is None:
            start = consistent_start(self.level, self.disk)
            if self.contact is not None:
                start = self.contact.lowered(self.disk, start)
            object.__setattr__(self, "start", start)

    def _check_penalty(self, contact: PenaltyContact) -> None:
        if self.level != 1:
            raise ValueError(f"a penalty contact exists for Model 1 alone, got level {self.level}")
        if self.formulation == "contact-tree":
            raise ValueError(
                "formulation 'contact-tree' closes the contact by its topology and has no room "
                "for a penalty contact; use one of euler-tree, floating, floating-lie"
            )
        contact.check(self.disk)

    @property
    def has_constraints(self) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take.

        Euler parameters bring one of their own.
        """
        if self.contact is not None:
            return self.formulation == "floating"
        return self.formulation != "contact-tree"
