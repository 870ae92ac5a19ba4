"""Bodies of several kinds, for tests of both sides."""

from dataclasses import dataclass, replace
from typing import Any

from analysis import Body, Disk
from analysis.problem.elementary import sqrt
from analysis.problem.quantities import SIX
from validation.studies import crosscheck


def of_six(*numbers: float, kind: type[Body] = Disk, **more: float) -> Any:
    """A body by its radius, mass, eccentricity and moments of inertia about G, and more."""
    return kind(**dict(zip(SIX, numbers, strict=True)), **more)


COMPOSED, TIPPE_TOP = crosscheck.COMPOSED, crosscheck.TOP

LOPSIDED = replace(COMPOSED, inertia_xz=5e-6, inertia_yz=-4e-6)

ELLIPSE = replace(crosscheck.ELLIPSE, long_axis=0.4, inertia_xy=1e-5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Egg(Body):
    """A body of one's own: longer along x than across it."""

    waist: float = 0.8

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Any:  # noqa: ARG002
        a, b = self.radius**2, (self.waist * self.radius) ** 2
        x, y, z = up
        height = sqrt(a * (x * x) + b * (y * y + z * z))
        return -(a * x) / height, -(b * y) / height, -(b * z) / height


OWN: Any = {"kind": Egg, "inertia_xy": 1e-7, "inertia_xz": 2e-7, "inertia_yz": -3e-7}
EGG = of_six(0.02, 0.02, 0.003, 3.0e-6, 2.98e-6, 3.1e-6, **OWN)

BODIES: dict[str, Body] = {
    "composed": COMPOSED,
    "lopsided": LOPSIDED,
    "sphere": TIPPE_TOP,
    "ellipse": ELLIPSE,
    "own": EGG,
}

RINGS: dict[str, Body] = {
    "ring": Disk.ring(hole_radius=0.01),
    "hole ahead": Disk.of_parts((0.045, 0.01, 7700.0), [(0.02, 0.0, 0.012)]),
}
