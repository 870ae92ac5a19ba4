"""Rigid bodies on a table: mass properties and the lowest point of the surface."""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import minimize

from analysis.problem.checks import Array, Described, bound
from analysis.problem.elementary import Members, cos, sin
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import default
from analysis.problem.user_modules import reads

Triple = tuple[Any, Any, Any]

_DIRECTIONS = 2000
"""In which the lowest place of a centre of gravity is looked for at first."""


@dataclass(frozen=True, kw_only=True)
class Body(Described):
    """A rigid body that touches a table with the lowest point of its surface.

    The body frame sits at the geometric centre G; x points to the centre of gravity S. A body of
    one's own derives from this class, as a frozen dataclass, and says `lowest_point`; both sides
    then take it. The bodies of `analysis.problem.bodies` are written a second time for the engine.

    Parameters
    ----------
    radius : float
        Largest distance of the surface from G in m, by which lengths are judged.
    mass : float
        In kg.
    eccentricity : float
        Distance from G to S in m, from 0 to less than the radius.
    inertia_x, inertia_y, inertia_z : float
        Moments of inertia about G in kg m².
    inertia_xy, inertia_xz, inertia_yz : float
        Further entries of the inertia tensor about G in kg m²: the sums of -x y dm and so on. By
        default zero: the axes are principal axes.

    Raises
    ------
    ValueError
        If a value is out of range, or if no rigid body has these moments of inertia: about S the
        principal ones must be positive and none may exceed the sum of the two others.
    """

    TABLE = "disk"

    is_round_disk: ClassVar[bool] = False
    """Whether it is a disk with a circle for an edge, on which joints roll and plates drag air."""

    has_edge: ClassVar[bool] = False
    """Whether its lowest point is undefined in some attitude, unless the edge is rounded."""

    SURFACE: ClassVar[tuple[str, ...] | None] = None
    """Fields besides the radius that its surface depends on, if these are numbers of any kind.
    Code is then made, and compiled, once for all bodies of a class."""

    radius: float
    mass: float
    eccentricity: float
    inertia_x: float
    inertia_y: float
    inertia_z: float
    inertia_xy: float = default("disk.inertia_xy")
    inertia_xz: float = default("disk.inertia_xz")
    inertia_yz: float = default("disk.inertia_yz")

    def __post_init__(self) -> None:
        bound("eccentricity", self.eccentricity, "be less than", self.radius, "radius")
        names, moments = ("inertia_x", "inertia_y", "inertia_z"), self.inertia_about_cog
        if self.has_products:
            product = next(name for name in PRODUCTS if not _is_zero(getattr(self, name)))
            names, moments = (product,) * 3, self.principal_moments
        pairs = [*zip(names, moments, strict=True)]
        whole = sum(moments)
        wrong = [name for name, moment in pairs if moment <= 0.0]
        # A lamina meets the bound exactly, so rounding must not refuse it.
        wrong += [name for name, each in pairs if each > (whole - each) * (1.0 + 1e-12)]
        if wrong:
            raise ArgumentError(
                wrong[0],
                "must leave principal moments about the COG (those of y and z are smaller there "
                "by mass * eccentricity²) that are positive and of which none exceeds the sum of "
                f"the two others, got {', '.join(f'{each:g}' for each in moments)}",
            )

    @property
    def products(self) -> tuple[float, float, float]:
        """Entries xy, xz and yz of the inertia tensor in kg m², about S as about G."""
        return self.inertia_xy, self.inertia_xz, self.inertia_yz

    @property
    def has_products(self) -> bool:
        """Whether the axes of the body are other than principal axes."""
        return not all(map(_is_zero, self.products))

    @property
    def is_plain(self) -> bool:
        """Whether it is a disk as the paper's: round, and on principal axes."""
        return self.is_round_disk and not self.has_products

    @property
    def inertia_about_cog(self) -> tuple[float, float, float]:
        """Moments of inertia about S in kg m²."""
        shift = self.mass * self.eccentricity**2
        return self.inertia_x, self.inertia_y - shift, self.inertia_z - shift

    @property
    def tensor(self) -> Array:
        """Inertia tensor about G in kg m², shape (3, 3); (n, 3, 3) of `Members`."""
        return self._tensor((self.inertia_x, self.inertia_y, self.inertia_z))

    @property
    def tensor_about_cog(self) -> Array:
        """Inertia tensor about S in kg m², of the same shape."""
        return self._tensor(self.inertia_about_cog)

    def _tensor(self, moments: tuple[float, float, float]) -> Array:
        xx, yy, zz, xy, xz, yz = np.broadcast_arrays(*moments, *self.products)
        rows = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
        return np.moveaxis(rows, (0, 1), (-2, -1))

    @cached_property
    def principal_moments(self) -> tuple[float, float, float]:
        """Principal moments of inertia about S in kg m², the least one first."""
        moments = np.linalg.eigvalsh(self.tensor_about_cog).T
        least, middle, largest = moments.tolist() if moments.ndim == 1 else moments.view(Members)
        return least, middle, largest

    @property
    def contact_mobility(self) -> float:
        """Acceleration of the contact point by a force on it, at most, in 1/kg."""
        return 1.0 / self.mass + (self.radius + self.eccentricity) ** 2 / self.principal_moments[0]

    @abstractmethod
    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Triple:
        """Lowest point of the surface seen from G in m, in axes of the body.

        It is asked with numbers of several kinds, floats, arrays, complex and dual numbers and the
        recorder's symbols: the four operations, and the functions of one number of
        `analysis.problem.elementary`.

        Parameters
        ----------
        up : sequence of 3 numbers
            The vertical in axes of the body, of unit length.
        half_thickness : number
            Of the contact in m; a body without an edge has no use for it.
        """

    def clearance(self, beta: Any, gamma: Any, half_thickness: Any = 0.0) -> Triple:
        """Height of G over the lowest point in m, and its slopes in beta and gamma in m/rad.

        Parameters
        ----------
        beta, gamma : number
            Inclination and rotation angle in rad.
        half_thickness : number
            Of the contact in m.
        """
        sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
        x, y, z = self.lowest_point((sb * sg, sb * cg, cb), half_thickness)
        # The point moves over the surface, which is level there.
        return (
            -(x * sb * sg + y * sb * cg + z * cb),
            -(x * cb * sg + y * cb * cg - z * sb),
            -(x * sb * cg - y * sb * sg),
        )

    def resting_place(self, half_thickness: float) -> tuple[float, float]:
        """Height of S in m where the body lies stable, and the sine of the lean of its z axis.

        That is the lowest there is, at the least potential energy. The lean is the angle between
        the plane of x and y and the table: 0 for a disk that lies flat, 1 for one on its edge.
        """
        return _lowest_place(self, half_thickness, reads(type(self).lowest_point, type(self)))


PRODUCTS = ("inertia_xy", "inertia_xz", "inertia_yz")
"""Fields of a body that are zero on principal axes."""


def _is_zero(product: Any) -> bool:
    return isinstance(product, float) and product == 0.0


@lru_cache(maxsize=64)
def _lowest_place(body: Body, half_thickness: float, _read: Any) -> tuple[float, float]:
    """See `Body.resting_place`; kept for as long as what the surface depends on is the same."""

    def height(up: Array) -> Any:
        x, y, z = up / np.sqrt((up**2).sum(axis=0))
        p, q, s = body.lowest_point((x, y, z), half_thickness)
        return (body.eccentricity - p) * x - q * y - s * z

    # Directions on a spiral, evenly over the sphere.
    z = 1.0 - (2.0 * np.arange(_DIRECTIONS) + 1.0) / _DIRECTIONS
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(_DIRECTIONS)
    side = np.sqrt(1.0 - z * z)
    directions = np.array((side * np.cos(turn), side * np.sin(turn), z))
    first = directions[:, int(np.argmin(height(directions)))]
    options = {"xatol": 1e-9, "fatol": 1e-15 * body.radius, "maxiter": 4000, "maxfev": 4000}
    found = minimize(height, first, method="Nelder-Mead", options=options)
    axis = found.x / np.linalg.norm(found.x)
    return float(found.fun), float(np.hypot(axis[0], axis[1]))
