"""The whole description of a problem, for both sides and for every analysis."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, asdict, dataclass
from dataclasses import fields as dataclass_fields
from typing import Any

from analysis.data.checks import choice
from analysis.data.constraint_set import (
    MODELS,
    ConstraintSet,
    Level,
    constraint_set,
    model_of,
    set_name,
)
from analysis.data.contact import PenaltyContact
from analysis.data.disk import STEEL_DISK, Disk
from analysis.data.dissipation import Dissipation
from analysis.data.friction import FrictionLaw, SmoothCoulomb, check_answers, law_from, law_values
from analysis.data.names import suggesting_fields
from analysis.data.start import Start
from analysis.data.state import State
from analysis.data.table import Table

PAPER_FRICTION = SmoothCoulomb()
HORIZONTAL = Table()
NO_DISSIPATION = Dissipation()
TABLE_3 = Start()


class _Remembering:
    """Place for the state at the start, which is asked for often and takes long to work out."""

    __slots__ = ("_initial_state",)
    _initial_state: State


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario(_Remembering):
    """What is to be studied. Nothing in it says how, or with which side.

    Every field may be replaced alone (`dataclasses.replace`): what follows from the fields, such
    as the state at the start, is computed when it is asked for.

    Parameters
    ----------
    constraints : iterable of str
        Some of `CONSTRAINTS`; `MODELS` holds the paper's four sets. Model 1 by default.
    disk : Disk
        The paper's disk by default.
    friction : FrictionLaw
        The paper's values by default.
    table : Table
        Horizontal by default.
    contact : PenaltyContact, optional
        A compliant contact in place of the ideal bilateral constraint; for Model 1.
    dissipation : Dissipation
        What takes energy besides friction and damping, on a penalty contact; nothing by default.
    start : Start or State
        Table 3 by default, made consistent with the constraints. A `State` is taken as it is.

    Raises
    ------
    ValueError
        If a field is of the wrong kind, or does not fit the others.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from analysis import Scenario, Start
    >>> scenario = Scenario()
    >>> scenario.name
    'Model 1'
    >>> round(replace(scenario, start=Start(beta=1.0)).initial_state.coordinates[2], 6)
    0.037866
    """

    constraints: ConstraintSet = MODELS[1]
    disk: Disk = STEEL_DISK
    friction: FrictionLaw = PAPER_FRICTION
    table: Table = HORIZONTAL
    contact: PenaltyContact | None = None
    dissipation: Dissipation = NO_DISSIPATION
    start: Start | State = TABLE_3

    def __post_init__(self) -> None:
        for name, kind in KINDS.items():
            value = getattr(self, name)
            if not isinstance(value, kind) and not (name == "contact" and value is None):
                raise ValueError(f"{name} must be a {kind.__name__}, got {value!r}")
        if not isinstance(self.start, Start | State):
            raise ValueError(f"start must be a Start or a State, got {self.start!r}")
        check_answers(self.friction)
        object.__setattr__(self, "constraints", constraint_set(self.constraints))
        if self.contact is not None:
            if self.model != 1:
                raise ValueError(
                    "contact must be left out, or constraints be those of Model 1: a penalty "
                    f"contact takes no further constraint, got {self.name}"
                )
            self.contact.check(self.disk, self.weight)
        else:
            if self.dissipation.is_on:
                raise ValueError(
                    "dissipation acts on a penalty contact alone, and contact is left out"
                )
            if isinstance(self.start, Start) and self.start.height:
                raise ValueError(
                    "height must be 0 or left out on an ideal contact, got "
                    f"{self.start.height:g}; a penalty contact lets the disk fall"
                )
        # A start that breaks a constraint is refused here, and not when it is first used.
        _ = self.initial_state

    @classmethod
    def rest(cls, **fields: Any) -> "Scenario":
        """Scenario for the way to rest: a rounded rim on a stiff, damped table.

        Parameters
        ----------
        **fields
            As in `Scenario`. By default friction acts on the actual contact force, and the
            contact is `PenaltyContact.rounded`.
        """
        fields.setdefault("friction", SmoothCoulomb(load="contact"))
        fields.setdefault("contact", PenaltyContact.rounded(fields.get("disk", STEEL_DISK)))
        return cls(**fields)

    @property
    def name(self) -> str:
        """What to call its constraints: "Model 3", or their names."""
        return set_name(self.constraints)

    @property
    def model(self) -> Level | None:
        """Number of the paper's model with these constraints, if there is one."""
        return model_of(self.constraints)

    @property
    def weight(self) -> float:
        """Force in N with which the resting disk presses on the table: m g if that is level."""
        return self.disk.mass * self.table.pressing

    @property
    def slip_decay(self) -> float:
        """Rate in 1/s at which friction under the weight brakes slip, at most."""
        return self.friction.gradient * self.weight * self.disk.contact_mobility

    @property
    def rubs(self) -> bool:
        """Whether friction may act: there is some, and some slip is not held at zero."""
        held = "no-slip-along" in self.constraints and "no-slip-across" in self.constraints
        return self.friction.is_on and not held

    @property
    def penalty_contact(self) -> PenaltyContact:
        """The compliant contact; `ValueError` if there is none."""
        if self.contact is None:
            raise ValueError("contact must be a PenaltyContact, got None, the ideal contact")
        return self.contact

    @property
    def initial_state(self) -> State:
        """State at the start, consistent with the constraints unless given as a `State`."""
        try:
            remembered: State = self._initial_state
        except AttributeError:
            remembered = self._state()
            object.__setattr__(self, "_initial_state", remembered)
        return remembered

    def _state(self) -> State:
        if isinstance(self.start, State):
            return self.start
        if self.contact is None:
            return self.start.state(self.constraints, self.disk)
        return self.start.state(
            self.constraints,
            self.disk,
            half_thickness=self.contact.half_thickness,
            height=-self.contact.resting_penetration(self.weight),
        )

    def require_horizontal_table(self, analysis: str) -> None:
        """Raise `ValueError` if the table leans, which this analysis does not know of.

        Parameters
        ----------
        analysis : str
            What to call it, such as "the reduced system".
        """
        if not self.table.is_horizontal:
            raise ValueError(
                f"{analysis} needs a horizontal table, got an inclination of "
                f"{self.table.inclination:g} rad"
            )

    def values(self) -> dict[str, Any]:
        """The scenario as plain data, to be stored; `from_values` makes it again."""
        values: dict[str, Any] = {
            "constraints": list(self.constraints),
            "disk": asdict(self.disk),
            "friction": law_values(self.friction),
            "table": asdict(self.table),
            "dissipation": asdict(self.dissipation),
            "start": {
                name: list(value) if isinstance(value, tuple) else value
                for name, value in asdict(self.start).items()
                if value is not None
            },
        }
        if self.contact is not None:
            values["contact"] = asdict(self.contact)
        return values

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> "Scenario":
        """Scenario from what `values` has returned.

        Parameters
        ----------
        values : mapping
            Any of its keys may be missing and then stands for the default.

        Raises
        ------
        ValueError
            If a key or a value is unknown, of the wrong kind or out of range.
        """
        given = dict(values)
        for name in given:
            choice("scenario", name, ("constraints", *KINDS, "start"))
        for name in (*KINDS, "start"):
            if not isinstance(given.get(name, {}), Mapping):
                raise ValueError(f"{name} must be a table, got {given[name]!r}")
        start = given.get("start", {})
        makers: dict[str, Callable[..., Any]] = {
            **KINDS,
            "friction": lambda **law: law_from(law),
            "start": State if "coordinates" in start or "rates" in start else Start,
        }
        fields: dict[str, Any] = {
            name: _made(name, make, given[name]) for name, make in makers.items() if name in given
        }
        if "constraints" in given:
            fields["constraints"] = given["constraints"]
        return cls(**fields)


def _made(name: str, make: Callable[..., Any], values: Mapping[str, Any]) -> Any:
    if isinstance(make, type):
        known = [field.name for field in dataclass_fields(make)]
        for key in values:
            choice(name, key, known)
        missing = [
            field.name
            for field in dataclass_fields(make)
            if field.default is MISSING and field.name not in values
        ]
        if missing:
            raise ValueError(f"{name} must hold {', '.join(missing)}, which are missing")
    return make(**values)


KINDS: dict[str, type] = {
    "disk": Disk,
    "friction": FrictionLaw,
    "table": Table,
    "contact": PenaltyContact,
    "dissipation": Dissipation,
}
"""Classes of the tables of a scenario that are told by their fields."""
