"""The quantities of a scenario, each declared once: what it means, its unit, range and default.

The data types check by these declarations, and the keys and comments of a scenario's file, the
options of the command line, the axes of sweeps and the documentation come from them. A further
number of a scenario is a declaration here and a field of its data type. Importing this loads
neither NumPy nor what takes long, so that the command line can list its options at once.
"""

from collections.abc import Iterable
from math import inf, pi
from typing import Any, Literal, NamedTuple, get_args

Load = Literal["weight", "contact"]
LOADS: tuple[Load, ...] = get_args(Load)

Constraint = Literal[
    "contact", "fixed-cog", "no-slip-along", "no-slip-across", "constant-spin", "held-tilt-rate"
]


class Held(NamedTuple):
    """What a constraint holds, and by which forces.

    Parameters
    ----------
    demands : dict
        From the name of each multiplier, in R-frame axes, to the condition that it keeps.
    unit : str
        Of the multipliers.
    rate : str
        Coordinate whose rate stays that of the start, so that its multiplier does work; empty
        where velocities are held at zero.
    """

    demands: dict[str, str]
    unit: str = "N"
    rate: str = ""


HELD: dict[Constraint, Held] = {
    "contact": Held({"normal_force": "contact g_N = z - r sin(beta) = 0"}),
    "fixed-cog": Held(
        {
            "cog_force_x": "fixed centre of gravity g_Sx = x + e cos(gamma) = 0",
            "cog_force_y": "fixed centre of gravity g_Sy = y + e cos(beta) sin(gamma) = 0",
        }
    ),
    "no-slip-along": Held({"tangential_force": "no tangential slip gamma_x = 0"}),
    "no-slip-across": Held({"lateral_force": "no lateral slip gamma_y = 0"}),
    "constant-spin": Held({"spin_torque": "constant spin gamma_alpha = 0"}, "N m", "alpha"),
    "held-tilt-rate": Held({"tilt_torque": "constant rate of beta"}, "N m", "beta"),
}
"""Constraints by name, in the order of their rows and multipliers.

The disk touches the table; its centre of gravity stays above one point; its contact point does
not slip along the edge (the direction e_x of the R-frame), or across it; its spin is constant;
and it tilts at a constant rate.
"""

CONSTRAINTS: tuple[Constraint, ...] = tuple(HELD)

Level = Literal[1, 2, 3, 4]
LEVELS: tuple[Level, ...] = get_args(Level)

LARGEST_VALUE = 1e100
"""Size of any number that is squared; the squares of larger ones overflow."""

STEEPEST_FRICTION = 1e12
"""Coefficient over smoothing in s/m; beyond, the decay of slip hides all else behind rounding."""

FASTEST_TURN = 1e5
"""Rate of an angle at the start in rad/s; long before, the rim of a steel disk bursts."""

FARTHEST = 1e6
"""Place in m, or speed in m/s, at the start; farther out, places have too few digits."""

THINNEST_RIM = 1e-9
"""Half thickness of a rounded rim in m: some atoms."""


_FEW = 5
"""Most words that fit into a line with what they are for."""


class Quantity(NamedTuple):
    """What a scenario can be told.

    Parameters
    ----------
    key : str
        Table and key of a scenario's file, "start.spin"; also the field of the data type.
    meaning : str
    unit : str
        Empty for a plain number and for what is none; what is in "rad" is an angle.
    default
        None where there is none, or where it follows from the rest.
    least, most : float
        What is allowed.
    is_above, is_below : bool
        Whether `least` and `most` themselves are left out.
    why : str
        Why no more is allowed.
    choices : tuple
        Words that are allowed in place of numbers.
    option : str
        Of the command line without its dashes, where it is not called as the key.
    usual : str
        The default in words, where it follows from the rest.
    doubted : float
        Size beyond which the number may be meant in another unit.
    """

    key: str
    meaning: str
    unit: str = ""
    default: Any = None
    least: float = -inf
    most: float = inf
    is_above: bool = False
    is_below: bool = False
    why: str = ""
    choices: tuple[Any, ...] = ()
    option: str = ""
    usual: str = ""
    doubted: float = inf

    @property
    def table(self) -> str:
        """Of a scenario's file; empty for what stands outside of tables."""
        return self.key.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Last part of the key: the field of a data type."""
        return self.key.rpartition(".")[2]

    @property
    def flag(self) -> str:
        """Option of the command line, with its dashes."""
        return f"--{self.option or self.name.replace('_', '-')}"

    @property
    def metavar(self) -> str:
        """What stands for its value in the help of the command line."""
        if self.is_word:
            return "LIST" if self.key == "constraints" else self.name.upper()
        name = self.unit.upper().replace(" ", "").replace("²", "2").replace("³", "3")
        return "ANGLE" if self.is_angle else name or "NUMBER"

    @property
    def is_word(self) -> bool:
        """Whether it takes one of a few words or marks, between which nothing lies."""
        return bool(self.choices)

    @property
    def is_switch(self) -> bool:
        """Whether it is true or false."""
        return self.choices == (True, False)

    @property
    def is_text(self) -> bool:
        """Whether it takes words."""
        return self.is_word and isinstance(self.choices[0], str)

    @property
    def is_angle(self) -> bool:
        """Whether it may be written as pi/2 or 90deg."""
        return self.unit == "rad"

    @property
    def allowed(self) -> str:
        """Range or choice in words; empty if everything is."""
        if self.choices:
            return listed(str(each).lower() for each in self.choices)
        low, high = short(self.least), short(self.most)
        if self.most >= LARGEST_VALUE:
            return "" if self.least == -inf else f"{'above' if self.is_above else 'from'} {low}"
        if self.is_above:
            return f"above {low}, {'less than' if self.is_below else 'at most'} {high}"
        return f"from {low} to {'less than ' if self.is_below else ''}{high}"

    @property
    def comment(self) -> str:
        """Unit, meaning and, unless these are many words, what is allowed, in a line of ASCII."""
        is_listed = self.allowed and len(self.choices) <= _FEW
        about = f"{self.meaning} ({self.allowed})" if is_listed else self.meaning
        line = f"{self.unit}; {about}" if self.unit else about
        return line.replace("²", "^2").replace("³", "^3")

    @property
    def shown_default(self) -> str:
        """The default in words."""
        return self.usual or ("" if self.default is None else short(self.default))


SPELLED = {pi: "pi", pi / 2: "pi/2", -pi / 2: "-pi/2", -pi / 2 + 0.1: "-pi/2 + 0.1"}
"""Texts that say angles in rad exactly, and shorter than their digits."""


def short(value: Any) -> str:
    """Number as people write it."""
    if not isinstance(value, float):
        return str(value).lower()
    return SPELLED.get(value, f"{value:g}")


def listed(names: Iterable[str], word: str = "or") -> str:
    """Names with commas and a word between them."""
    *others, last = names
    return f"{', '.join(others)} {word} {last}" if others else last


class Section(NamedTuple):
    """A table of a scenario's file, and a group of options.

    Parameters
    ----------
    about : str
        What its options are.
    needed : str
        The shortest way to it, where a file must hold it.
    """

    about: str
    needed: str = ""


SECTIONS: dict[str, Section] = {
    "": Section("Options given here override the file; angles may be pi/2 or 90deg, too."),
    "disk": Section(
        "One by name, or other values; a geometry is the paper's ring but for what is given.",
        'name = "steel" in it is the paper\'s',
    ),
    "friction": Section(
        "A law keeps what is not given, or has the paper's values.",
        "empty, it stands for the paper's law",
    ),
    "table": Section("How it leans.", "empty, it stands for a horizontal one"),
    "contact": Section("A spring and a damper in place of the ideal contact, for Model 1."),
    "dissipation": Section("What else takes energy, on such a contact."),
    "start": Section(
        "The paper's Table 3 by default; what is not given meets the constraints.",
        "empty, it stands for the paper's Table 3",
    ),
}
"""By name, in the order of a file."""


def _size(key: str, meaning: str, unit: str, **more: Any) -> Quantity:
    return Quantity(key, meaning, unit, least=0.0, most=LARGEST_VALUE, is_above=True, **more)


def _rate(key: str, meaning: str, usual: str) -> Quantity:
    return Quantity(key, meaning, "rad/s", least=-FASTEST_TURN, most=FASTEST_TURN, usual=usual)


def _place(key: str, meaning: str, unit: str) -> Quantity:
    usual = "by the constraints"
    return Quantity(key, meaning, unit, least=-FARTHEST, most=FARTHEST, usual=usual)


def _angle(key: str, meaning: str, default: float = 0.0) -> Quantity:
    # The last digits of larger ones are too coarse for a motion.
    return Quantity(key, meaning, "rad", default, -1e6, 1e6)


def _coefficient(key: str, meaning: str, default: float, **more: Any) -> Quantity:
    # So large only for a viscous law, with a smoothing as large.
    return Quantity(key, meaning, "", default, 0.0, 1e9, **more)


def _slip(key: str, meaning: str, default: float, option: str = "") -> Quantity:
    # Slower slip passes less than an atom in a minute.
    return Quantity(key, meaning, "m/s", default, 1e-12, 1e9, option=option)


_DECLARED = (
    Quantity("model", "constraints of a model of the paper", default=1, choices=LEVELS),
    Quantity("constraints", "the contact and others, in place of a model",
             choices=CONSTRAINTS, usual="those of the model"),
    Quantity("disk.name", "the paper's, unrounded or as printed", default="steel",
             option="disk", choices=("steel", "steel-rounded")),
    Quantity("disk.body", "what else it is, or own module:Class", default="disk",
             choices=("disk", "sphere", "ellipse")),
    _size("disk.radius", "of the edge; of other bodies the largest", "m", default=0.045,
          doubted=1.0),
    Quantity("disk.hole_radius", "with hole_distance less than radius", "m", 0.015, 0.0),
    Quantity("disk.hole_distance", "of the hole from the centre G", "m", 0.02, 0.0),
    _size("disk.thickness", "of the disk", "m", default=0.01),
    _size("disk.density", "of the disk", "kg/m³", default=7700.0),
    _size("disk.mass", "of the disk", "kg"),
    Quantity("disk.eccentricity", "of the centre of gravity S from G, less than radius", "m",
             least=0.0),
    _size("disk.inertia_x", "about G, along the line from G to S", "kg m²"),
    _size("disk.inertia_y", "across it; above mass * eccentricity²", "kg m²"),
    _size("disk.inertia_z", "normal to it; about S below others' sum", "kg m²"),
    Quantity("disk.inertia_xy", "entry of the tensor, the sum of -x y dm", "kg m²", 0.0),
    Quantity("disk.inertia_xz", "the same of -x z dm", "kg m²", 0.0),
    Quantity("disk.inertia_yz", "the same of -y z dm", "kg m²", 0.0),
    _size("disk.other_radius", "ellipse: smaller semi-axis", "m", default=0.04),
    _angle("disk.long_axis", "ellipse: its larger semi-axis from the line G to S"),
    Quantity("friction.law", "by name, or own module:Class", default="smooth-coulomb",
             choices=("smooth-coulomb", "stribeck", "tanh", "viscous", "anisotropic",
                      "power-law", "lubricated")),
    Quantity("friction.load", "what presses: m g cos(inclination), or the contact's force",
             default="weight", choices=LOADS),
    _coefficient("friction.coefficient", "friction coefficient", 0.3, option="mu"),
    _slip("friction.smoothing", "slip speed over which it sets in", 0.1, "eps"),
    _coefficient("friction.static", "stribeck: coefficient at little slip, not below kinetic",
                 0.45),
    _coefficient("friction.kinetic", "stribeck: coefficient at much slip", 0.3),
    _slip("friction.stribeck_speed", "stribeck: slip speed over which it drops", 0.2),
    Quantity("friction.viscosity", "viscous: force for each N and m/s", "s/m", 3.0, 0.0,
             STEEPEST_FRICTION),
    _coefficient("friction.along", "anisotropic: coefficient along the edge", 0.3, is_above=True),
    _coefficient("friction.across", "anisotropic: coefficient across the edge", 0.2,
                 is_above=True),
    Quantity("friction.reference_load", "power-law: load of the coefficient", "N",
             1.0, 0.0, 1e9, is_above=True),
    Quantity("friction.exponent", "power-law: power of the load", "", 2.0 / 3.0, 0.1, 2.0),
    Quantity("friction.film", "lubricated: force of the film for each m/s", "N s/m", 0.1, 0.0,
             STEEPEST_FRICTION),
    # A centrifuge has as much; 9.81 is behind the paper's printed results.
    Quantity("table.gravity", "gravitational acceleration", "m/s²", 9.81, 0.0, 1e6,
             is_above=True),
    Quantity("table.inclination", "against the horizontal", "rad", 0.0, 0.0, pi / 2,
             is_below=True),
    _angle("table.downhill", "direction of descent from the x axis"),
    # Solid steel of the disk's size has some 1e10.
    Quantity("contact.stiffness", "the disk may sink in by 1 % of its radius", "N/m",
             None, 0.0, 1e12, is_above=True),
    Quantity("contact.damping", "of the damper", "N s/m", 0.0, 0.0, 1e9,
             usual="0 in a file; by options half of the critical one"),
    Quantity("contact.half_thickness", "of a rounded rim, at most the radius; 0: thin disk",
             "m", 0.0, 0.0),
    Quantity("contact.bilateral", "whether the contact may pull", default=False,
             choices=(True, False)),
    Quantity("dissipation.rolling_dry", "dry resistance on the contour, a part of the force", "",
             0.0, 0.0, 1.0, option="rolling"),
    Quantity("dissipation.rolling_viscous", "viscous resistance on the contour", "s/m", 0.0, 0.0,
             1e3),
    Quantity("dissipation.pivoting", "lever of the pivoting friction", "m", 0.0, 0.0, 1.0),
    # Water has 1e3.
    Quantity("dissipation.air_drag", "density of the air times drag coefficient", "kg/m³", 0.0,
             0.0, 1e4),
    Quantity("dissipation.rolling_smoothing", "contour speed over which dry rolling sets in",
             "m/s", 0.01, 0.0, is_above=True),
    Quantity("dissipation.pivoting_smoothing", "spin over which pivoting sets in", "rad/s", 0.1,
             0.0, is_above=True),
    Quantity("start.beta", "inclination", "rad", pi / 2, 0.0, pi, is_above=True,
             is_below=True, why="in rad, where the Euler angles are regular"),
    _angle("start.gamma", "rotation angle of the disk", -pi / 2 + 0.1),
    Quantity("start.spin", "rate of alpha", "rad/s", 40.0, -FASTEST_TURN, FASTEST_TURN),
    _angle("start.alpha", "direction of the disk's edge"),
    _rate("start.beta_rate", "rate of beta", "0, or what the constraints leave"),
    _rate("start.gamma_rate", "rate of gamma", "-spin * cos(beta)"),
    _place("start.x", "of the geometric centre in the frame that turns with alpha", "m"),
    _place("start.y", "of the same", "m"),
    _place("start.x_rate", "rate of x", "m/s"),
    _place("start.y_rate", "rate of y", "m/s"),
    Quantity("start.height", "of the lowest point over the table; 0 on an ideal contact", "m",
             least=0.0, most=FARTHEST, usual="pressed in by the weight"),
)  # fmt: skip

QUANTITIES: dict[str, Quantity] = {each.key: each for each in _DECLARED}
"""By key, in the order of a file."""

KEYS: dict[str, str] = {each.name: each.key for each in _DECLARED} | {
    each.option: each.key for each in _DECLARED if each.option and not each.choices
}
"""By the last part of the key, which no two quantities have in common, and numbers by an option
that is called otherwise."""


def declared(key: str) -> Quantity:
    """Quantity of a key; a plain number for a parameter of a law or body of one's own."""
    return QUANTITIES.get(key) or Quantity(key, "of one's own")


PLATE = ("radius", "thickness", "density")
"""Keys of a disk of uniform density; further round holes and masses are lists."""

RING = ("radius", "hole_radius", "hole_distance", "thickness", "density")
"""Keys of a disk of uniform density with a round hole."""

SIX = ("radius", "mass", "eccentricity", "inertia_x", "inertia_y", "inertia_z")
"""Keys of a disk of any shape, in place of those."""


def of_table(table: str) -> dict[str, Quantity]:
    """Quantities of a table by their names, in order."""
    return {each.name: each for each in _DECLARED if each.table == table}


def default(key: str) -> Any:
    """Default of a quantity."""
    return QUANTITIES[key].default
