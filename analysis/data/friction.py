"""Friction laws of the contact."""

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, get_args

from analysis.data.checks import choice, not_negative, positive, within
from analysis.data.elementary import exp, tanh
from analysis.data.limits import LARGEST_FRICTION, SMOOTHING_RANGE, STEEPEST_FRICTION
from analysis.data.names import Named, nearest, suggesting_fields
from analysis.data.own import is_own, own_object

Load = Literal["weight", "contact"]
LOADS: tuple[Load, ...] = get_args(Load)


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionLaw(ABC):
    """Isotropic friction: force = -load * per_speed(|slip|) * slip.

    A law of one's own derives from this class, as a frozen dataclass, and says `per_speed` and
    `finest_speed`. Both sides then take it; the laws of this module are written a second time for
    the engine, in `mbs_models.friction`.

    Parameters
    ----------
    load : {"weight", "contact"}
        What presses the disk on the table: its weight m g, Eq. (81), whatever the contact does
        while it is closed, or the actual normal contact force, Eq. (79), and nothing where that
        pulls.

    Raises
    ------
    ValueError
        If the load is unknown.
    """

    load: Load = "weight"

    def __post_init__(self) -> None:
        choice("load", self.load, LOADS)

    @abstractmethod
    def per_speed(self, speed: float) -> float:
        """Friction force for each newton of load and each m/s of slip, in s/m, not negative.

        Parameters
        ----------
        speed : float
            Slip speed in m/s, not negative.
        """

    def per_speed_slope(self, speed: float) -> float:
        """Derivative of `per_speed` by the speed in s²/m², at no slip that to the right.

        A law of one's own need not say it: it then comes from differences of sixth order, good
        to some 1e-10 of the gradient over `finest_speed` where the law is smooth.
        """
        step = 1e-3 * max(self.finest_speed, speed)
        if speed < 3.0 * step:
            weights = (-49 / 20, 6.0, -15 / 2, 20 / 3, -15 / 4, 6 / 5, -1 / 6)
            nodes = range(7)
        else:
            weights = (-1 / 60, 3 / 20, -3 / 4, 0.0, 3 / 4, -3 / 20, 1 / 60)
            nodes = range(-3, 4)
        pairs = zip(weights, nodes, strict=True)
        return sum(w * self.per_speed(speed + k * step) for w, k in pairs) / step

    @property
    @abstractmethod
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends; steps are chosen by it."""

    @property
    def gradient(self) -> float:
        """Slope of the force at no slip for each newton of load, in s/m (paper: mu / epsilon).

        The linear stability of stationary motions depends on the law by this number alone.
        """
        return self.per_speed(0.0)

    @property
    def is_on(self) -> bool:
        """Whether there is any friction."""
        return self.gradient > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _Regularised(FrictionLaw):
    """Coulomb friction of one coefficient, smoothed over a slip speed."""

    coefficient: float = 0.3
    smoothing: float = 0.1

    def __post_init__(self) -> None:
        FrictionLaw.__post_init__(self)
        check_coefficient(self, "coefficient")
        check_smoothing(self)

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        return self.smoothing


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothCoulomb(_Regularised):
    """Smooth Coulomb friction, Eq. (3): force = -coefficient * load * slip / (|slip| + smoothing).

    Parameters
    ----------
    coefficient : float
        Friction coefficient, not negative (paper: mu).
    smoothing : float
        Slip speed in m/s at which half of the full force acts, positive (paper: epsilon).
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    def per_speed(self, speed: float) -> float:
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        return self.coefficient / (speed + self.smoothing)

    def per_speed_slope(self, speed: float) -> float:
        """Derivative of `per_speed`; see `FrictionLaw`."""
        return -self.coefficient / (speed + self.smoothing) ** 2


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(FrictionLaw):
    """Smooth Coulomb friction whose coefficient falls from a static to a kinetic value.

    The coefficient at a slip speed v is
    kinetic + (static - kinetic) * exp(-(v / stribeck_speed)²).

    Parameters
    ----------
    static, kinetic : float
        Coefficients at little and at much slip, not negative; the static one is not below the
        kinetic one.
    stribeck_speed : float
        Slip speed in m/s at which the drop has come down to 1/e, positive.
    smoothing : float
        As in `SmoothCoulomb`.
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    static: float = 0.45
    kinetic: float = 0.3
    stribeck_speed: float = 0.2
    smoothing: float = 0.1

    def __post_init__(self) -> None:
        FrictionLaw.__post_init__(self)
        check_coefficient(self, "static")
        check_coefficient(self, "kinetic")
        if self.kinetic > self.static:
            raise ValueError(
                f"kinetic must not exceed static = {self.static:g}, got {self.kinetic:g}"
            )
        speed = within(
            "stribeck_speed", positive("stribeck_speed", self.stribeck_speed), *SMOOTHING_RANGE
        )
        object.__setattr__(self, "stribeck_speed", speed)
        check_smoothing(self)

    def per_speed(self, speed: float) -> float:
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        drop = exp(-((speed / self.stribeck_speed) ** 2))
        coefficient = self.kinetic + (self.static - self.kinetic) * drop
        return coefficient / (speed + self.smoothing)

    def per_speed_slope(self, speed: float) -> float:
        """Derivative of `per_speed`; see `FrictionLaw`."""
        relative = speed / self.stribeck_speed
        drop = (self.static - self.kinetic) * exp(-(relative**2))
        change = -2.0 * relative / self.stribeck_speed * drop
        return (change - self.per_speed(speed)) / (speed + self.smoothing)

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        return min(self.smoothing, self.stribeck_speed)


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class TanhCoulomb(_Regularised):
    """Coulomb friction regularised by force = -coefficient * load * tanh(|slip| / smoothing).

    All its derivatives exist, at no slip too, where Eq. (3) has a kink in the second.

    Parameters
    ----------
    coefficient : float
        Friction coefficient, not negative.
    smoothing : float
        Slip speed in m/s at which 76 % of the full force acts, positive.
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    def per_speed(self, speed: float) -> float:
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        relative = speed / self.smoothing
        if isinstance(relative, float) and relative < 1e-4:
            # Two terms of the series: the next one is below rounding.
            return self.coefficient / self.smoothing * (1.0 - relative * relative / 3.0)
        return self.coefficient * tanh(relative) / speed

    def per_speed_slope(self, speed: float) -> float:
        """Derivative of `per_speed`; see `FrictionLaw`."""
        relative, unit = speed / self.smoothing, self.coefficient / self.smoothing**2
        if relative < 0.05:
            # The difference below would lose digits; the next term is below 1e-13 of this.
            square = relative * relative
            series = 2 / 3 - square * (8 / 15 - square * (34 / 105 - square * 496 / 2835))
            return -unit * relative * (series + square**4 * 2764 / 31185)
        high = tanh(relative)
        return unit * ((1.0 - high * high) - high / relative) / relative


@suggesting_fields
@dataclass(frozen=True, slots=True, kw_only=True)
class ViscousFriction(FrictionLaw):
    """Friction in proportion to slip: force = -viscosity * load * slip.

    Parameters
    ----------
    viscosity : float
        Force for each newton of load and each m/s, in s/m, not negative.
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    viscosity: float = 3.0

    def __post_init__(self) -> None:
        FrictionLaw.__post_init__(self)
        viscosity = not_negative("viscosity", self.viscosity)
        within("viscosity", viscosity, 0.0, STEEPEST_FRICTION)
        object.__setattr__(self, "viscosity", viscosity)

    def per_speed(self, speed: float) -> float:  # noqa: ARG002 - the same at every speed
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        return self.viscosity

    def per_speed_slope(self, speed: float) -> float:  # noqa: ARG002 - the same at every speed
        """Derivative of `per_speed`; see `FrictionLaw`."""
        return 0.0

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        # It bends nowhere: a slip speed of the motions of a disk.
        return 1.0


LAWS: dict[str, type[FrictionLaw]] = Named(
    "LAWS",
    {
        "smooth-coulomb": SmoothCoulomb,
        "stribeck": Stribeck,
        "tanh": TanhCoulomb,
        "viscous": ViscousFriction,
    },
)
"""Laws by name, as files and the command line know them; others are `module:class`."""


def law_values(law: FrictionLaw) -> dict[str, Any]:
    """Name and parameters of a law, to be stored; `law_from` makes it again."""
    names = {kind: name for name, kind in LAWS.items()}
    name = names.get(type(law), f"{type(law).__module__}:{type(law).__qualname__}")
    return {"law": name} | asdict(law)


def law_from(values: dict[str, Any]) -> FrictionLaw:
    """Law from its name and parameters.

    Parameters
    ----------
    values : dict
        `law`, one of `LAWS` or `module:class`, and the parameters of that law. A module that is
        named is imported, which runs it, but within `analysis.data.own.foreign_names`.

    Raises
    ------
    ValueError
        If the law is unknown or a parameter is not one of its own, or out of range.
    """
    parameters = dict(values)
    name = parameters.pop("law", "smooth-coulomb")
    kind = law_class(name)
    known = [field.name for field in fields(kind)]
    for parameter in parameters:
        choice(f"parameter of the friction law {name}", parameter, known)
    try:
        return kind(**parameters)
    except ValueError:
        raise
    except (Exception, SystemExit) as error:
        said = error if isinstance(error, TypeError) else f"{type(error).__name__}: {error}"
        raise ValueError(f"friction law {name!r} cannot be made: {said}") from error


def law_class(name: Any) -> type[FrictionLaw]:
    """Class of a law by its name; see `law_from`."""
    if isinstance(name, str) and name in LAWS:
        return LAWS[name]
    if not is_own(name):
        listed = ", ".join(LAWS)
        raise ValueError(
            f"friction law must be one of {listed} or module:class, got {name!r}"
            f"{nearest(name, LAWS)}"
        )
    kind = own_object("friction law", name)
    if not isinstance(kind, type) or not issubclass(kind, FrictionLaw):
        raise ValueError(f"friction law {name!r} must be a class derived from FrictionLaw")
    return kind


def check_answers(law: FrictionLaw) -> None:
    """Raise if what a law says is no friction: one of one's own may say anything."""
    name = law_values(law)["law"]
    if name in LAWS:
        return
    try:
        positive("finest_speed", law.finest_speed)
        gradient = not_negative("per_speed(0)", law.per_speed(0.0))
        within("per_speed(0)", gradient, 0.0, STEEPEST_FRICTION)
    except (Exception, SystemExit) as error:
        said = error if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
        raise ValueError(f"friction law {name!r}: {said}") from error


_SPEEDS = tuple(10.0**power for power in range(-6, 2))
"""Slip speeds in m/s at which a law of one's own is tried before a run."""


def check_slipping(law: FrictionLaw) -> None:
    """Raise if what a law says where the disk slips is no friction; what it raises goes on.

    A scenario is made without that: a law of one's own may take long, and a run has a limit.
    """
    if type(law) in LAWS.values():
        return
    name = law_values(law)["law"]
    for speed in _SPEEDS:
        not_negative(f"per_speed({speed:g}) of friction law {name!r}", law.per_speed(speed))


def check_coefficient(law: FrictionLaw, name: str) -> None:
    """Raise if a coefficient of a law is out of range; keep it as a float."""
    value = not_negative(name, getattr(law, name))
    object.__setattr__(law, name, within(name, value, 0.0, LARGEST_FRICTION))


def check_smoothing(law: Any) -> None:
    """Raise if the smoothing of a law is out of range or too steep; keep it as a float."""
    smoothing = within("smoothing", positive("smoothing", law.smoothing), *SMOOTHING_RANGE)
    object.__setattr__(law, "smoothing", smoothing)
    largest = law.gradient * smoothing
    if largest > STEEPEST_FRICTION * smoothing:
        raise ValueError(
            f"smoothing must be at least coefficient / {STEEPEST_FRICTION:g} = "
            f"{largest / STEEPEST_FRICTION:g}, got {smoothing:g}"
        )
