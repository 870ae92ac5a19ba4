"""A friction law that hangs, crashes or fails, for runs that have to survive it."""

import os
from dataclasses import dataclass

from analysis import SmoothCoulomb

FAILS, CRASHES, HANGS = 0.4, 0.5, 0.6
"""Coefficients that it goes wrong at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wayward(SmoothCoulomb):
    def per_speed(self, speed: float) -> float:
        if speed > 0.0:
            if self.coefficient == FAILS:
                raise LookupError("no such friction")
            if self.coefficient == CRASHES:
                os._exit(7)
            while self.coefficient == HANGS:
                pass
        return SmoothCoulomb.per_speed(self, speed)
