"""Friction laws of the contact."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import cos, isfinite, sin
from typing import Any, ClassVar

from analysis.problem.checks import Described, bound, numbers, positive, within
from analysis.problem.elementary import exp, hypot, tanh
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import STEEPEST_FRICTION, Load, default
from analysis.problem.user_modules import Kinds, error_text, place

_LITTLE = 1e-7
"""Slip over the finest speed of a law at which its force is still linear."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionLaw(Described):
    """Friction as a function of slip and load: force = -load * per_speed(‖slip‖) * slip or any.

    A law of one's own derives from this class, as a frozen dataclass, and says `per_speed` and
    `finest_speed`. One that opposes slip in some directions more than in others, or not in
    proportion to the load, says `force` in place of `per_speed`, and sets `IS_ISOTROPIC` or
    `IS_PROPORTIONAL` to False. Both sides then take it; the laws of this module are written a
    second time for the engine, in `mbs_models.friction`.

    Parameters
    ----------
    load : {"weight", "contact"}
        What presses the disk on the table: its weight m g, Eq. (81), times the cosine of the
        table's inclination, whatever the contact does while it is closed; or the actual normal
        contact force, Eq. (79), and nothing where that pulls. On a penalty contact that lets go,
        see `PenaltyContact`.

    Raises
    ------
    ValueError
        If the load is unknown, or a declared number of friction, which a law of one's own may
        have as well, is out of its range.
    """

    TABLE = "friction"

    IS_ISOTROPIC: ClassVar[bool] = True
    """Whether slip is opposed in all directions alike."""

    IS_PROPORTIONAL: ClassVar[bool] = True
    """Whether the force grows in proportion to the load."""

    load: Load = default("friction.load")

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        """Force of the table on the disk in N, along its edge and across it.

        Parameters
        ----------
        along, across : float
            Slip velocity along the edge, e_x of the R-frame, and across it in m/s. Numbers of
            another kind, whose derivatives are exact, come where stability is asked for:
            functions of `analysis.problem.elementary` take them, too.
        load : float
            In N, not negative. A disk that does not touch the table is not asked for.
        """
        factor = -load * self.per_speed(hypot(along, across))
        return factor * along, factor * across

    def per_speed(self, speed: float) -> float:
        """Friction force for each newton of load and each m/s of slip, in s/m, not negative.

        Parameters
        ----------
        speed : float
            Slip speed in m/s, not negative.

        Raises
        ------
        ValueError
            If the law is another function than of that.
        """
        fault = f"has no force for each newton of load and each m/s of slip, got {speed:g} m/s"
        if self.is_simple:
            fault = "must say per_speed or force"
        raise ArgumentError("law", fault, f"friction law {LAWS.name_of(type(self))!r}")

    @property
    @abstractmethod
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends; steps are chosen by it."""

    @property
    def gradient(self) -> float:
        """Slope of the force at no slip for each newton of load, in s/m (paper: mu / epsilon).

        The linear stability of stationary motions depends on the law by this number alone.

        Raises
        ------
        ValueError
            If the law has no such number: see `per_speed`.
        """
        return self.per_speed(0.0)

    @property
    def is_simple(self) -> bool:
        """Whether `per_speed` says it all, isotropic and in proportion to the load."""
        return type(self).force is FrictionLaw.force

    @property
    def follows_contact(self) -> bool:
        """Whether the force is in proportion to that of the contact, and vanishes with it."""
        return self.load == "contact" and self.IS_PROPORTIONAL

    def slope(self, load: float) -> float:
        """Slope of the force at no slip in N s/m under a load in N, in the steepest direction."""
        if self.is_simple:
            return load * self.per_speed(0.0)
        little = _LITTLE * self.finest_speed
        forces = self.force(little, 0.0, load)[0], self.force(0.0, little, load)[1]
        return -min(forces) / little

    @property
    def is_on(self) -> bool:
        """Whether there is any friction, at no slip or at any of `SPEEDS`."""
        slips = (slip for speed in SPEEDS for slip in ((speed, 0.0), (0.0, speed)))
        return self.slope(1.0) > 0.0 or any(any(self.force(*slip, 1.0)) for slip in slips)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Smoothed(FrictionLaw):
    """Friction that sets in over a slip speed."""

    smoothing: float = default("friction.smoothing")

    def __post_init__(self) -> None:
        least = self.slope(1.0) * self.smoothing / STEEPEST_FRICTION
        what = f"coefficient / {STEEPEST_FRICTION:g}"
        bound("smoothing", self.smoothing, "be at least", least, what)

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        return self.smoothing


@dataclass(frozen=True, slots=True, kw_only=True)
class _Regularised(_Smoothed):
    """Coulomb friction of one coefficient, smoothed over a slip speed."""

    coefficient: float = default("friction.coefficient")


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothCoulomb(_Regularised):
    """Smooth Coulomb friction, Eq. (3): force = -coefficient * load * slip / (‖slip‖ + smoothing).

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(_Smoothed):
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

    static: float = default("friction.static")
    kinetic: float = default("friction.kinetic")
    stribeck_speed: float = default("friction.stribeck_speed")

    def __post_init__(self) -> None:
        bound("kinetic", self.kinetic, "not exceed", self.static, "static")
        _Smoothed.__post_init__(self)

    def per_speed(self, speed: float) -> float:
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        drop = exp(-((speed / self.stribeck_speed) ** 2))
        coefficient = self.kinetic + (self.static - self.kinetic) * drop
        return coefficient / (speed + self.smoothing)

    @property
    def finest_speed(self) -> float:
        """Slip speed in m/s over which the law bends."""
        return min(self.smoothing, self.stribeck_speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class TanhCoulomb(_Regularised):
    """Coulomb friction regularised by force = -coefficient * load * tanh(‖slip‖ / smoothing).

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
        if isinstance(speed, float) and speed < 1e-4 * self.smoothing:
            # Two terms of the series: the next one is below rounding.
            return self.coefficient / self.smoothing * (1.0 - relative * relative / 3.0)
        return self.coefficient * tanh(relative) / speed


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

    finest_speed: ClassVar[float] = 1.0
    """It bends nowhere: a slip speed of the motions of a disk."""

    viscosity: float = default("friction.viscosity")

    def per_speed(self, speed: float) -> float:  # noqa: ARG002 - the same at every speed
        """Force for each newton of load and each m/s; see `FrictionLaw`."""
        return self.viscosity


@dataclass(frozen=True, slots=True, kw_only=True)
class AnisotropicCoulomb(_Smoothed):
    """Smooth Coulomb friction with two coefficients, along the edge of the disk and across it.

    With M = diag(along, across) the force is -load * M² slip / (‖M slip‖ + max(M) * smoothing).
    Its largest values make an ellipse, and it is that point of it which takes the most power from
    the slip (S. Goyal, A. Ruina and J. Papadopoulos, Wear 143, 1991). With two equal coefficients
    it is `SmoothCoulomb`.

    Parameters
    ----------
    along, across : float
        Friction coefficients, positive.
    smoothing : float
        As in `SmoothCoulomb`.
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    IS_ISOTROPIC = False

    along: float = default("friction.along")
    across: float = default("friction.across")

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        """Force in N; see `FrictionLaw`."""
        x, y = self.along * along, self.across * across
        factor = -load / (hypot(x, y) + max(self.along, self.across) * self.smoothing)
        return factor * self.along * x, factor * self.across * y


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerLawCoulomb(_Regularised):
    """Smooth Coulomb friction that grows with a power of the load.

    The force is that of `SmoothCoulomb` under the load
    reference_load * (load / reference_load)**exponent. Rubber on a smooth, elastic contact has an
    exponent of 2/3 (A. Schallamach, Proc. Phys. Soc. B 65, 1952).

    Parameters
    ----------
    coefficient, smoothing : float
        As in `SmoothCoulomb`, under the reference load.
    reference_load : float
        In N, positive.
    exponent : float
        From 0.1 to 2.
    load : {"weight", "contact"}
        See `FrictionLaw`. Where friction feeds back on the contact force, that comes from a
        scalar equation, which may have no solution, or several, of which it is the least.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    IS_PROPORTIONAL = False

    reference_load: float = default("friction.reference_load")
    exponent: float = default("friction.exponent")

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        """Force in N; see `FrictionLaw`."""
        load = self.reference_load * (load / self.reference_load) ** self.exponent
        factor = -load * self.coefficient / (hypot(along, across) + self.smoothing)
        return factor * along, factor * across


@dataclass(frozen=True, slots=True, kw_only=True)
class LubricatedCoulomb(_Regularised):
    """Smooth Coulomb friction and a viscous film that does not know the load.

    The force is -(coefficient * load / (‖slip‖ + smoothing) + film) * slip, also under no load of
    an ideal contact; on a penalty contact that lets go, the film does so with it.

    Parameters
    ----------
    coefficient, smoothing : float
        As in `SmoothCoulomb`.
    film : float
        Force of the film for each m/s of slip in N s/m, not negative.
    load : {"weight", "contact"}
        See `FrictionLaw`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    IS_PROPORTIONAL = False

    film: float = default("friction.film")

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        """Force in N; see `FrictionLaw`."""
        factor = -(load * self.coefficient / (hypot(along, across) + self.smoothing) + self.film)
        return factor * along, factor * across


LAWS = Kinds[FrictionLaw](
    "LAWS",
    "friction law",
    "friction.law",
    FrictionLaw,
    (
        SmoothCoulomb,
        Stribeck,
        TanhCoulomb,
        ViscousFriction,
        AnisotropicCoulomb,
        PowerLawCoulomb,
        LubricatedCoulomb,
    ),
)
"""Laws by name, as files and the command line know them; others are `module:class`."""


_LOADS = (0.1, 10.0)
"""Loads in N at which a law of one's own is tried."""

SPEEDS = tuple(10.0**power for power in range(-6, 2))
"""Slip speeds in m/s at which one is tried before a run."""


class LawError(ArithmeticError):
    """A friction law of one's own cannot be worked out at some slip, or says no number there."""


def asked(law: FrictionLaw, name: str) -> Callable[..., Any]:
    """What says `per_speed` or `force` of a law; one of one's own is blamed for what goes wrong.

    Returns
    -------
    callable
        It raises `LawError` where the law meets an `ArithmeticError` or says no finite numbers,
        asked with finite floats. What else it raises goes on, with a note.
    """
    ask = getattr(law, name)
    if type(law) in LAWS.values():
        return ask

    def told(*given: Any) -> Any:
        said = _said(law, name, *given)
        with suppress(TypeError, ValueError):
            along, across = said if name == "force" else (said, 0.0)
            if isfinite(along + across):
                return said
        if not _are_finite(given):
            return said
        raise LawError(f"{_at(law, name, given)} must say finite numbers, got {said!r}")

    return told


def _said(law: FrictionLaw, name: str, *given: Any) -> Any:
    """What a law says, or what it raises as `asked` tells it."""
    try:
        return getattr(law, name)(*given)
    except Exception as error:
        if not _are_finite(given):
            raise
        fault = f"{_at(law, name, given)} fails: {error_text(error)}"
        fault += place(error, type(law).__module__)
        if isinstance(error, ArithmeticError):
            raise LawError(fault) from error
        error.add_note(fault)
        raise


def _are_finite(given: Sequence[Any]) -> bool:
    """Whether a law is asked with plain numbers; a step that was too long asks with others."""
    return all(isinstance(each, float) and isfinite(each) for each in given)


def _at(law: FrictionLaw, name: str, given: Sequence[float]) -> str:
    """What a law is asked, in words."""
    listed = ", ".join(f"{each:.6g}" for each in given)
    return f"friction law {LAWS.name_of(type(law))!r}: {name}({listed})"


def check_answers(law: FrictionLaw) -> None:
    """Raise if what a law says is no friction: one of one's own may say anything."""
    if type(law) in LAWS.values():
        return
    with LAWS.answering(law):
        speed = positive("finest_speed", law.finest_speed)
        for load in _LOADS:
            within("slope of force at no slip", law.slope(load) / load, 0.0, STEEPEST_FRICTION)
            if not law.is_simple:
                _check_force(law, speed, load)


def check_slipping(law: FrictionLaw) -> None:
    """Raise if what a law says where the disk slips is no friction; see `asked`.

    A scenario is made without that: a law of one's own may take long, and a run has a limit.
    """
    if type(law) not in LAWS.values():
        for speed in SPEEDS:
            for load in _LOADS:
                _check_force(law, speed, load)


def _check_force(law: FrictionLaw, speed: float, load: float) -> None:
    """Raise `ValueError` if a force drives slip, or is not what its class says of it."""
    for turn in (0.3, 1.9, 4.0):
        x, y = speed * cos(turn), speed * sin(turn)
        at = f"{type(law).__name__}.force({x:.3g}, {y:.3g}, {load:g})"
        along, across = forces = numbers(at, _said(law, "force", x, y, load), ("along", "across"))
        size = abs(along) + abs(across)
        if along * x + across * y > 1e-12 * size * speed:
            raise ValueError(f"{at} must not drive the slip, got {forces}")
        if law.IS_ISOTROPIC and abs(along * y - across * x) > 1e-9 * size * speed:
            raise ValueError(f"{at} must be against the slip if IS_ISOTROPIC, got {forces}")
        twice = _said(law, "force", x, y, 2.0 * load)
        if law.IS_PROPORTIONAL and abs(twice[0] - 2.0 * along) > 1e-9 * size:
            raise ValueError(f"{at} must double with the load if IS_PROPORTIONAL, got {forces}")
