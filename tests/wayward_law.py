"""Friction laws of one's own; those that hang, crash, fail or say anything have to be survived."""

import os
from dataclasses import dataclass
from math import hypot
from typing import Any

from analysis import FrictionLaw, SmoothCoulomb

CRASHES, HANGS, EXITS, EXITS_AT_ONCE = 0.5, 0.6, 0.7, 0.8
"""Coefficients that it goes wrong at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wayward(SmoothCoulomb):
    def per_speed(self, speed: float) -> float:
        if self.coefficient == EXITS_AT_ONCE:
            raise SystemExit(3)
        if speed > 0.0:
            if self.coefficient == EXITS:
                raise SystemExit(3)
            if self.coefficient == CRASHES:
                os._exit(7)
            while self.coefficient == HANGS:
                pass
        return SmoothCoulomb.per_speed(self, speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Answering(FrictionLaw):
    """Law that answers with what it is given."""

    says: Any
    finest_speed: Any = 0.1

    def per_speed(self, speed: float) -> Any:
        return self.says(speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pushing(Answering):
    """Law with any force."""

    def force(self, along: Any, across: Any, load: Any) -> Any:
        return self.says(along, across, load)


@dataclass(frozen=True, slots=True, kw_only=True)
class Own(FrictionLaw):
    """A good one, with a parameter of each kind: force = -strength * load * slip / sqrt(...)."""

    strength: float = 0.3
    kind: str = 'quoted "so" \\ and\tso'
    order: int = 2
    smooth: bool = True
    nothing: float | None = None

    def per_speed(self, speed: float) -> float:
        return self.strength / hypot(0.1 * self.order, speed)

    @property
    def finest_speed(self) -> float:
        return 0.1 * self.order
