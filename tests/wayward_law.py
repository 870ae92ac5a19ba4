"""Friction laws that hang, crash, fail or say anything, for runs that have to survive them."""

import os
from dataclasses import dataclass
from typing import Any

from analysis import FrictionLaw, SmoothCoulomb

FAILS, CRASHES, HANGS, EXITS = 0.4, 0.5, 0.6, 0.7
"""Coefficients that it goes wrong at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wayward(SmoothCoulomb):
    def per_speed(self, speed: float) -> float:
        if speed > 0.0:
            if self.coefficient == FAILS:
                raise LookupError("no such friction")
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
