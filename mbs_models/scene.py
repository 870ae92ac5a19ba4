"""What is to be built: one frozen description of a scene."""

from dataclasses import dataclass, field
from typing import Literal, get_args

from analysis.data.checks import choice
from analysis.data.contact import PenaltyContact
from analysis.data.disk import STEEL_DISK, Disk
from analysis.data.dissipation import Dissipation
from analysis.data.friction import FrictionLaw, SmoothCoulomb
from analysis.data.state import LEVELS, Level, State, consistent_start

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)


def formulations(level: Level) -> tuple[Formulation, ...]:
    """Formulations that exist for Model `level`, the most accurate one first."""
    choice("level", level, LEVELS)
    if level == 1:
        return ("contact-tree", "euler-tree", "floating", "floating-lie")
    return ("euler-tree", "floating", "floating-lie")


def default_formulation(level: Level, friction: FrictionLaw) -> Formulation:
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
    friction : FrictionLaw
    start : State, optional
        By default Table 3, made consistent with the model; on a penalty contact that is lowered
        by the resting penetration. A given start is taken as it is: on a penalty contact it may
        lie above the table or in it, and `PenaltyContact.lowered` makes one that rests.
    contact : PenaltyContact, optional
        Penalty contact (Model 1, not `contact-tree`); by default the ideal bilateral constraint
        of the paper. With a rounded rim, the free body alone is regular when it lies flat.
    dissipation : Dissipation
        What takes energy besides friction and damping, on the penalty contact of a free body;
        by default nothing, and nothing of it is in the scene.

    Raises
    ------
    ValueError
        If an argument is unknown, or the formulation cannot build this model.
    """

    level: Level = 1
    formulation: Formulation = None  # type: ignore[assignment]  # filled in below
    disk: Disk = STEEL_DISK
    friction: FrictionLaw = field(default_factory=SmoothCoulomb)
    start: State = None  # type: ignore[assignment]  # filled in below
    contact: PenaltyContact | None = None
    dissipation: Dissipation = field(default_factory=Dissipation)

    def __post_init__(self) -> None:
        available = formulations(self.level)
        if self.formulation is None:
            object.__setattr__(self, "formulation", self._default_formulation())
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
        if self.dissipation.is_on and (self.contact is None or not self._is_free_body):
            raise ValueError(
                "dissipation needs a penalty contact and one of the formulations floating, "
                f"floating-lie, got contact {self.contact!r} and {self.formulation!r}"
            )
        if self.start is None:
            start = consistent_start(self.level, self.disk)
            if self.contact is not None:
                start = self.contact.lowered(self.disk, start)
            object.__setattr__(self, "start", start)

    @classmethod
    def rest(
        cls,
        *,
        disk: Disk = STEEL_DISK,
        friction: FrictionLaw | None = None,
        start: State | None = None,
        contact: PenaltyContact | None = None,
        dissipation: Dissipation | None = None,
    ) -> "Scene":
        """Scene for the way to rest: a free body with a rounded rim on a stiff table.

        Parameters
        ----------
        disk : Disk
        friction : SmoothCoulomb, optional
            By default on the actual contact force.
        start : State, optional
            As in `Scene`.
        contact : PenaltyContact, optional
            By default `PenaltyContact.rounded`.
        dissipation : Dissipation, optional

        Raises
        ------
        ValueError
            If an argument does not fit the others.
        """
        return cls(
            formulation="floating-lie",
            disk=disk,
            friction=friction or SmoothCoulomb(load="contact"),
            start=start,  # type: ignore[arg-type]  # filled in
            contact=contact or PenaltyContact.rounded(disk),
            dissipation=dissipation or Dissipation(),
        )

    def _default_formulation(self) -> Formulation:
        if self.contact is None:
            return default_formulation(self.level, self.friction)
        rest = self.contact.is_rounded or self.dissipation.is_on
        return "floating-lie" if rest else "euler-tree"

    def _check_penalty(self, contact: PenaltyContact) -> None:
        if self.level != 1:
            raise ValueError(f"a penalty contact exists for Model 1 alone, got level {self.level}")
        if self.formulation == "contact-tree":
            raise ValueError(
                "formulation 'contact-tree' closes the contact by its topology and has no room "
                "for a penalty contact; use one of euler-tree, floating, floating-lie"
            )
        if contact.is_rounded and not self._is_free_body:
            raise ValueError(
                f"half_thickness must be 0 in formulation {self.formulation!r}, which is singular "
                f"when the disk lies flat, got {contact.half_thickness:g}; use floating or "
                "floating-lie"
            )
        contact.check(self.disk)

    @property
    def _is_free_body(self) -> bool:
        return self.formulation.startswith("floating")

    @property
    def has_constraints(self) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take.

        Euler parameters bring one of their own.
        """
        if self.contact is not None:
            return self.formulation == "floating"
        return self.formulation != "contact-tree"
