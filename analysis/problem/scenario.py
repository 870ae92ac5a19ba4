"""The whole description of a problem, for both sides and every analysis, also as plain data."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from functools import cache, cached_property
from math import inf
from typing import Any

from analysis.problem.bodies import BODIES, check_surface
from analysis.problem.body import PRODUCTS, Body
from analysis.problem.checks import Described, choice, instance, one
from analysis.problem.constraints import MODELS, ConstraintSet, constraint_set, model_of, set_name
from analysis.problem.contact import Dissipation, PenaltyContact, Table
from analysis.problem.disk import DISKS, STEEL_DISK, Disk
from analysis.problem.friction import LAWS, FrictionLaw, SmoothCoulomb, check_answers
from analysis.problem.names import ArgumentError, nearest
from analysis.problem.quantities import PLATE, RING, SIX, Level, default, listed
from analysis.problem.start import Start, State, check_leaning
from analysis.problem.values import read_value

KINDS: dict[str, type] = {
    "disk": Body,
    "friction": FrictionLaw,
    "table": Table,
    "contact": PenaltyContact,
    "dissipation": Dissipation,
}
"""Classes of the tables of a scenario that are told by their fields."""

_SHAPES = (("name",), (*SIX, *PRODUCTS), RING, (*PLATE, "holes", "masses"))
"""Names that tell a disk together."""

_DISK_FORMS = f"{'; or '.join(map(', '.join, _SHAPES))}; or body and what it takes"

Names = tuple[str, ...]

_HOLDING_TILT = {"fixed-cog", "no-slip-across", "held-tilt-rate"}
"""Constraints that hold the tilt twice where the disk is centred."""

_TOUCHING = 1e-14
"""Rounding of a contact's depth, over the radius."""


@dataclass(frozen=True, kw_only=True)
class Scenario(Described):
    """What is to be studied. Nothing in it says how, or with which side.

    Every field may be replaced alone (`dataclasses.replace`): what follows from the fields, such
    as the state at the start, is computed when it is asked for.

    Parameters
    ----------
    constraints : iterable of str
        Some of `CONSTRAINTS`; `MODELS` holds the paper's four sets. Model 1 by default.
    disk : Body
        The paper's disk by default. Constraints besides the contact hold a round disk alone.
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

    constraints: ConstraintSet = MODELS[default("model")]
    disk: Body = STEEL_DISK
    friction: FrictionLaw = SmoothCoulomb()
    table: Table = Table()
    contact: PenaltyContact | None = None
    dissipation: Dissipation = Dissipation()
    start: Start | State = Start()

    def __post_init__(self) -> None:
        for name, kind in KINDS.items():
            if name != "contact" or self.contact is not None:
                instance(name, getattr(self, name), kind)
        if not isinstance(self.start, Start | State):
            raise ArgumentError("start", f"must be a Start or a State, got {self.start!r}")
        check_answers(self.friction)
        ordered = constraint_set(self.constraints)
        object.__setattr__(self, "constraints", ordered)
        self._check_body()
        self._check_contact()
        # A start that breaks a constraint is refused here, and not when it is first used.
        start = self.initial_state
        if self.contact is None or not self.is_smooth:
            check_leaning(start.coordinates[4])

    def _check_body(self) -> None:
        """Refuse what is known of a round disk alone, and what a centred one cannot take."""
        check_surface(self.disk)
        is_round = self.disk.is_round_disk
        if not self.friction.IS_ISOTROPIC and (self.half_thickness > 0.0 or not is_round):
            raise ArgumentError(
                "friction",
                "must be isotropic unless the body is a disk with a sharp rim: there may else "
                f"be no edge that has a direction, got {self.friction!r}",
            )
        if is_round:
            if not self.disk.eccentricity and {*self.constraints} >= _HOLDING_TILT:
                raise ArgumentError(
                    "constraints",
                    "must be independent: with its centre of gravity fixed, a centred disk that "
                    "does not slip across its edge keeps its tilt, whose rate is held once more; "
                    "leave one out",
                )
            return
        kind = one(type(self.disk))
        if self.model != 1:
            raise ArgumentError(
                "constraints", f"must be those of Model 1 for {kind}, got {self.name}"
            )
        if self.dissipation.air_drag:
            raise ArgumentError(
                "air_drag", "acts on the faces of a round disk alone, and the body is " + kind
            )

    def _check_contact(self) -> None:
        if self.contact is not None:
            if self.model != 1:
                raise ArgumentError(
                    "contact",
                    "must be left out, or constraints be those of Model 1: a penalty contact "
                    f"takes no further constraint, got {self.name}",
                )
            self.contact.check(self.disk, self.weight)
            return
        if self.dissipation.is_on:
            raise ArgumentError(
                "dissipation", "acts on a penalty contact alone, which has a stiffness; got none"
            )
        if isinstance(self.start, Start) and self.start.height:
            raise ArgumentError(
                "height",
                "must be 0 or left out on an ideal contact, got "
                f"{self.start.height:g}; a penalty contact lets the disk fall",
            )

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
    def fall(self) -> float:
        """Angular acceleration in rad/s² with which it falls over, at most."""
        return self.table.gravity / self.disk.radius

    @property
    def slip_decay(self) -> float:
        """Rate in 1/s at which friction under the weight brakes slip, at most."""
        return self.friction.slope(self.weight) * self.disk.contact_mobility

    @property
    def friction_gradient(self) -> float:
        """Slope of friction at no slip for each newton of the weight in s/m, at most."""
        return self.friction.slope(self.weight) / self.weight

    @property
    def finest_slip(self) -> float:
        """Slip speed in m/s over which friction bends; infinite where nothing rubs.

        Of runs to a tolerance, the error in a step is smaller: slip that leaps over it from step
        to step may look the same in two runs, and wrong.
        """
        return self.friction.finest_speed if self.rubs else inf

    @property
    def rubs(self) -> bool:
        """Whether friction may act: there is some, and some slip is not held at zero."""
        held = "no-slip-along" in self.constraints and "no-slip-across" in self.constraints
        return self.friction.is_on and not held

    @property
    def may_pull(self) -> bool:
        """Whether the contact holds the disk down as well as up."""
        return self.contact is None or self.contact.bilateral

    @property
    def kinked_load(self) -> float:
        """Size in N of the load of friction, if that ends where the contact pulls; else 0."""
        ends = self.may_pull and self.rubs and self.friction.load == "contact"
        return self.weight if ends else 0.0

    def pressing_force(self, force: float) -> float:
        """Normal force in N, which rounding is kept out of where a penalty contact only touches.

        Whether it pulls there would be decided by the last digits of a height.
        """
        hidden = 0.0
        if self.contact is not None:
            hidden = _TOUCHING * self.contact.stiffness * self.disk.radius
        return 0.0 if abs(force) <= hidden else force

    @property
    def penalty_contact(self) -> PenaltyContact:
        """The compliant contact; `ValueError` if there is none."""
        if self.contact is None:
            raise ValueError("contact must be a PenaltyContact, got None, the ideal contact")
        return self.contact

    @cached_property
    def initial_state(self) -> State:
        """State at the start, consistent with the constraints unless given as a `State`."""
        if isinstance(self.start, State):
            return self.start
        sunk = self.resting_penetration
        return self.start.state(self.constraints, self.disk, self.half_thickness, -sunk)

    @property
    def friction_fades(self) -> bool:
        """Whether there is friction to be faded out where the contact opens; see `FULL_GRIP`."""
        return self.rubs and not (self.may_pull or self.friction.follows_contact)

    @property
    def resting_penetration(self) -> float:
        """Depth in m to which the weight presses the body into the table; 0 if that is hard."""
        return 0.0 if self.contact is None else self.contact.resting_penetration(self.weight)

    @property
    def half_thickness(self) -> float:
        """Half thickness of the rim in m; 0 where it is sharp."""
        return 0.0 if self.contact is None else self.contact.half_thickness

    @property
    def is_smooth(self) -> bool:
        """Whether the lowest point of the body is defined in every attitude."""
        return self.half_thickness > 0.0 or not self.disk.has_edge

    def values(self) -> dict[str, Any]:
        """The scenario as plain data, to be stored; `from_values` makes it again."""
        parts = {name: getattr(self, name) for name in (*KINDS, "start")}
        values = {name: as_plain(part) for name, part in parts.items() if part is not None}
        return {"constraints": list(self.constraints)} | values

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
        for name in instance("scenario", values, Mapping):
            choice("scenario", name, ("constraints", *KINDS, "start"))
        return cls(**{name: made_part(name, each) for name, each in values.items()})


def require_level(scenario: Scenario, analysis: str) -> None:
    """Raise `ValueError` unless the table is horizontal; see `require_plain`."""
    instance("scenario", scenario, Scenario)
    if not scenario.table.is_horizontal:
        fault = (
            f"needs a horizontal table, got an inclination of {scenario.table.inclination:g} rad"
        )
        raise ArgumentError("inclination", fault, analysis)


def steady(scenario: Scenario) -> Scenario:
    """The scenario without pivoting friction and air drag, with which no spinning lasts."""
    lasting = replace(scenario.dissipation, pivoting=0.0, air_drag=0.0)
    return replace(scenario, dissipation=lasting)


def require_lasting(scenario: Scenario, analysis: str) -> None:
    """Raise `ValueError` unless a spin lasts: on a horizontal table, without what brakes it."""
    require_level(scenario, analysis)
    loss = scenario.dissipation
    if loss.pivoting or loss.air_drag:
        fault = (
            "must have neither pivoting friction nor air drag, by which the spin decays, got "
            f"{loss.pivoting:g} m and {loss.air_drag:g} kg/m³"
        )
        raise ArgumentError("dissipation", fault, analysis)


def require_plain(scenario: Scenario, analysis: str) -> None:
    """Raise `ValueError` unless table and disk are as the paper's: level, round, principal.

    Parameters
    ----------
    scenario : Scenario
    analysis : str
        What to call what knows of nothing else, such as "the reduced system".
    """
    require_level(scenario, analysis)
    if not scenario.disk.is_plain:
        fault = (
            "needs a round disk whose line from centre to centre of gravity is a principal axis"
        )
        raise ArgumentError("disk", f"{fault}, got {scenario.disk!r}", analysis)


# --- Parts as plain data -------------------------------------------------------------------------


def as_plain(part: Any) -> dict[str, Any]:
    """Plain data of a part, to be stored; `made_part` makes it again."""
    if isinstance(part, Disk) and part.parts is not None:
        return dict(part.parts)
    values = {each.name: getattr(part, each.name) for each in fields(part)}
    if isinstance(part, FrictionLaw):
        return {"law": LAWS.name_of(type(part))} | values
    if isinstance(part, Body):
        name = {} if type(part) is Disk else {"body": BODIES.name_of(type(part))}
        return name | {key: each for key, each in values.items() if each or key not in PRODUCTS}
    if isinstance(part, Start):
        return {name: value for name, value in values.items() if value is not None}
    return values


def made_part(table: str, values: Any) -> Any:
    """What a table of a scenario describes.

    Parameters
    ----------
    table : str
        Its name, or "constraints", which are handed on.
    values : mapping
        Data by the names of the fields; a disk by its name or its geometry, too.

    Raises
    ------
    ArgumentError
        If a key is missing or unknown, or a value out of range.
    """
    return values if table == "constraints" else maker(table, values)(**values)


def told_constraints(model: Any = None, constraints: Any = None) -> Any:
    """Constraints of a model of the paper, or those that are given in place of it."""
    if model is None and constraints is None:
        fault = "or constraints is missing; model = 1 is the disk on the table"
        raise ArgumentError("model", fault)
    if model is not None and constraints is not None:
        raise ArgumentError("constraints", "do not go together with model")
    if model is None:
        return constraints
    level: Any = read_value("model", model)
    return MODELS[level]


def maker(table: str, values: Any) -> Callable[..., Any]:
    """What makes the object of a table; `ArgumentError` if a key is missing or unknown."""
    if not isinstance(values, Mapping):
        raise ArgumentError(table, f"must be a table, got {values!r}")
    make, known, needed = _form(table, values)
    for name in values:
        if name not in known:
            is_shape = table == "disk" and "body" not in values
            allowed = _DISK_FORMS if is_shape else listed(known, "and")
            besides = {each for shape in _SHAPES if is_shape and name in shape for each in shape}
            apart = [each for each in values if besides and each not in besides]
            why = f"does not go with {listed(apart, 'or')}" if apart else "is unknown here"
            fault = f"{why}; [{table}] takes {allowed}{nearest(name, known)}"
            raise ArgumentError(f"{table}.{name}", fault, name)
    if missing := [name for name in needed if name not in values]:
        raise ArgumentError(table, f"lacks {listed(missing, 'and')}", f"[{table}]")
    return make


def _form(table: str, values: Mapping[str, Any]) -> tuple[Callable[..., Any], Names, Names]:
    """What makes the object of a table, the names that it takes, and those that it needs."""
    if table == "friction":
        return LAWS.made, *_names(LAWS.find(values.get("law")), "law")
    if table != "disk":
        is_state = table == "start" and ("coordinates" in values or "rates" in values)
        kind = State if is_state else KINDS.get(table, Start)
        return kind, *_names(kind)
    if "name" in values:
        return lambda name: DISKS[choice("name", name, DISKS)], ("name",), ()
    kind = BODIES.find(values.get("body"))
    if kind is Disk and ("holes" in values or "masses" in values):
        return _composed, (*PLATE, "holes", "masses"), PLATE
    if kind is Disk and any(name in values for name in RING[1:]):
        return Disk.ring, RING, RING
    return BODIES.made, *_names(kind, "body")


@cache
def _names(kind: Any, *further: str) -> tuple[Names, Names]:
    """Names that a class takes, and those that it needs."""
    needed = tuple(each.name for each in fields(kind) if each.default is MISSING)
    return (*further, *(each.name for each in fields(kind))), needed


def _composed(*, holes: Any = (), masses: Any = (), **plate: Any) -> Disk:
    return Disk.of_parts([plate[name] for name in PLATE], holes, masses)
