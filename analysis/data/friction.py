"""Friction laws of the contact."""

from abc import abstractmethod
from dataclasses import asdict, dataclass
from typing import Any

from analysis.data.checks import choice, not_negative, positive, within
from analysis.data.described import Described
from analysis.data.elementary import exp, tanh
from analysis.data.names import ArgumentError, Named
from analysis.data.own import made, own_class
from analysis.data.quantities import LOADS, QUANTITIES, STEEPEST_FRICTION, Load, default


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionLaw(Described):
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

    load: Load = default("friction.load")

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

    TABLE = "friction"

    coefficient: float = default("friction.coefficient")
    smoothing: float = default("friction.smoothing")

    def __post_init__(self) -> None:
        check_steepness(self, self.smoothing)

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        return self.smoothing


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

    TABLE = "friction"

    static: float = default("friction.static")
    kinetic: float = default("friction.kinetic")
    stribeck_speed: float = default("friction.stribeck_speed")
    smoothing: float = default("friction.smoothing")

    def __post_init__(self) -> None:
        if self.kinetic > self.static:
            raise ArgumentError(
                "kinetic", f"must not exceed static = {self.static:g}, got {self.kinetic:g}"
            )
        check_steepness(self, self.smoothing)

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

    TABLE = "friction"

    viscosity: float = default("friction.viscosity")

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
    dict(
        zip(
            QUANTITIES["friction.law"].choices,
            (SmoothCoulomb, Stribeck, TanhCoulomb, ViscousFriction),
            strict=True,
        )
    ),
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
    name = parameters.pop("law", default("friction.law"))
    return made("friction law", name, law_class(name), parameters, "law")


def law_class(name: Any) -> type[FrictionLaw]:
    """Class of a law by its name; see `law_from`."""
    return own_class("friction law", name, LAWS, FrictionLaw, "law")


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
        said = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
        raise ArgumentError("law", said, f"friction law {name!r}:") from error


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


def check_steepness(law: FrictionLaw, smoothing: float) -> None:
    """Raise if friction sets in too steeply over the smoothing of a law in m/s."""
    largest = law.gradient * smoothing
    if largest > STEEPEST_FRICTION * smoothing:
        raise ArgumentError(
            "smoothing",
            f"must be at least coefficient / {STEEPEST_FRICTION:g} = "
            f"{largest / STEEPEST_FRICTION:g}, got {smoothing:g}",
        )
