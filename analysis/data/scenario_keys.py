"""Keys of a scenario's file: what each means, its unit and what is allowed."""

from dataclasses import dataclass

from analysis.data.disk import DISKS
from analysis.data.friction import LAWS, LOADS
from analysis.data.limits import (
    FASTEST_TURN,
    LARGEST_ANGLE,
    LARGEST_DAMPING,
    LARGEST_FRICTION,
    LARGEST_RESISTANCE,
    LEAST_TILT,
    SMOOTHING_RANGE,
    STEEPEST_FRICTION,
    STIFFEST_CONTACT,
    STRONGEST_GRAVITY,
)


@dataclass(frozen=True, slots=True)
class Key:
    """A key: its meaning with what is allowed, and the unit of the number that it takes.

    `unit` is empty for a plain number, None for what is no number.
    """

    meaning: str
    unit: str | None = ""

    def __str__(self) -> str:
        return f"{self.unit}; {self.meaning}" if self.unit else self.meaning


SIX = ("radius", "mass", "eccentricity", "inertia_x", "inertia_y", "inertia_z")
"""Keys of a disk of any shape, in place of a ring's."""

RING = ("radius", "hole_radius", "hole_distance", "thickness", "density")
"""Keys of a disk of uniform density with a round hole."""

_SLIP = f"from {SMOOTHING_RANGE[0]:g} to {SMOOTHING_RANGE[1]:g}"
_COEFFICIENT = f"from 0 to {LARGEST_FRICTION:g}"
_RESISTANCE = {name: f"from 0 to {most:g}" for name, most in LARGEST_RESISTANCE.items()}
_TURN = f"from {-FASTEST_TURN:g} to {FASTEST_TURN:g}"
_ANGLE = f"from {-LARGEST_ANGLE:g} to {LARGEST_ANGLE:g}"

KEYS: dict[str, dict[str, Key]] = {
    "disk": {
        "name": Key(" or ".join(f'"{name}"' for name in DISKS), None),
        "radius": Key("of the rolling edge, above 0", "m"),
        "hole_radius": Key("not negative", "m"),
        "hole_distance": Key(
            "of the hole from the centre; with hole_radius less than radius", "m"
        ),
        "thickness": Key("above 0", "m"),
        "density": Key("above 0", "kg/m³"),
        "mass": Key("above 0", "kg"),
        "eccentricity": Key("of the centre of gravity S from the centre G, below radius", "m"),
        "inertia_x": Key("about G, along the line from G to S, above 0", "kg m²"),
        "inertia_y": Key("across it in the disk, above mass * eccentricity²", "kg m²"),
        "inertia_z": Key("normal to it; about S none above the others' sum", "kg m²"),
    },
    "friction": {
        "law": Key(", ".join(f'"{name}"' for name in LAWS) + ' or own "module:Class"', None),
        "load": Key(
            f'what presses the disk down: "{LOADS[0]}" m g, or the "{LOADS[1]}" force', None
        ),
        "coefficient": Key(_COEFFICIENT),
        "smoothing": Key(f"slip speed over which friction sets in, {_SLIP}", "m/s"),
        "static": Key(f"coefficient at little slip, {_COEFFICIENT}, not below kinetic"),
        "kinetic": Key(f"coefficient at much slip, {_COEFFICIENT}"),
        "stribeck_speed": Key(f"slip speed over which it drops, {_SLIP}", "m/s"),
        "viscosity": Key(f"force for each N and m/s, from 0 to {STEEPEST_FRICTION:g}", "s/m"),
    },
    "table": {
        "gravity": Key(f"above 0, at most {STRONGEST_GRAVITY:g}", "m/s²"),
        "inclination": Key("against the horizontal, from 0 to less than pi/2", "rad"),
        "downhill": Key(f"direction of descent from the x axis, {_ANGLE}", "rad"),
    },
    "contact": {
        "stiffness": Key(
            f"at most {STIFFEST_CONTACT:g}; the disk may sink in by 1 % of its radius", "N/m"
        ),
        "damping": Key(f"from 0 to {LARGEST_DAMPING:g}", "N s/m"),
        "half_thickness": Key("of a rounded rim, from 0 (thin disk) to the radius", "m"),
        "bilateral": Key("whether the contact may pull: true or false", None),
    },
    "dissipation": {
        "rolling_dry": Key(f"part of the contact force, {_RESISTANCE['rolling_dry']}"),
        "rolling_viscous": Key(_RESISTANCE["rolling_viscous"], "s/m"),
        "pivoting": Key(f"lever, {_RESISTANCE['pivoting']}", "m"),
        "air_drag": Key(f"density times drag coefficient, {_RESISTANCE['air_drag']}", "kg/m³"),
        "rolling_smoothing": Key("contour speed over which rolling_dry sets in, above 0", "m/s"),
        "pivoting_smoothing": Key("spin over which pivoting sets in, above 0", "rad/s"),
    },
    "start": {
        "beta": Key(f"inclination, from {LEAST_TILT:g} to pi - {LEAST_TILT:g}", "rad"),
        "gamma": Key(f"rotation angle of the disk, {_ANGLE}", "rad"),
        "spin": Key(f"rate of alpha, {_TURN}", "rad/s"),
        "alpha": Key(_ANGLE, "rad"),
        "beta_rate": Key(_TURN, "rad/s"),
        "gamma_rate": Key(_TURN, "rad/s"),
        "x": Key("of the geometric centre in the frame that turns with alpha", "m"),
        "y": Key("of the same", "m"),
        "x_rate": Key("rate of x", "m/s"),
        "y_rate": Key("rate of y", "m/s"),
        "height": Key(
            "of the lowest point over the table, not negative; 0 without [contact]", "m"
        ),
        "coordinates": Key("x, y, z, alpha, beta, gamma in m and rad", None),
        "rates": Key("their rates in m/s and rad/s", None),
    },
}
"""By table, in the order of a file."""

NEEDED = {
    "disk": 'name = "steel" in it is the paper\'s',
    "friction": "empty, it stands for the paper's law",
    "table": "empty, it stands for a horizontal one",
    "start": "empty, it stands for the paper's Table 3",
}
"""Tables that a file must hold, with the shortest way to that."""
