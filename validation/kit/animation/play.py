"""A page on which the disk is spun by hand: the equations of Model 1, integrated in the browser.

The equations are those of `analysis.mechanics`, recorded and written as JavaScript; a player shows
the motion. The page needs no network and no other file.
"""

import json
from types import SimpleNamespace
from typing import Any, NamedTuple

from jinja2 import Environment

from analysis import MODELS, Disk, Scenario, SmoothCoulomb, Start
from analysis.data.elementary import cos, sin
from analysis.mechanics.newton_euler import Structure
from analysis.mechanics.recorded import NUMBERS, STATE, disk_of, numbers, recording
from analysis.mechanics.recorder import Recorder, Symbol
from analysis.mechanics.states import paper_of, state_of
from validation.kit.animation import player
from validation.kit.animation.body import shape
from validation.kit.animation.keyframes import COLUMNS

DURATION = 5.0
"""Time in s that is played."""

STEP = 1e-3
"""Longest step in s of the classic Runge-Kutta method,"""

STABLE = 1.5
"""which takes this part of the time in which friction brakes slip, where that is shorter."""

SHOWN = 4e-3
"""Time in s between two poses that are kept."""

HOLES = tuple(range(0, 30, 2))
"""Distances of the hole from the centre in mm that the page knows."""


class Slider(NamedTuple):
    """A number that can be chosen on the page, in SI units.

    `factor` is that of the unit in which the page shows it.
    """

    name: str
    label: str
    least: float
    most: float
    step: float
    value: float
    factor: float = 1.0


SLIDERS = (
    Slider("spin", "spin in rad/s", 0.0, 60.0, 0.5, Start().spin),
    Slider("beta", "inclination β in rad", 0.3, 1.57, 0.01, 1.57),
    Slider("coefficient", "friction coefficient μ", 0.02, 1.0, 0.01, 0.3),
    Slider("smoothing", "smoothing speed ε in m/s", 0.01, 0.5, 0.01, 0.1),
    Slider("hole_distance", "distance of the hole in mm", 0.0, 0.028, 0.002, 0.02, 1e3),
)


def equations() -> str:
    """JavaScript of what `play.js` calls, by name, each from constants and functions."""
    recorder, results = recording(Structure(MODELS[1], "weight"))
    made = {
        "derivative": recorder.javascript(results),
        "perSpeed": _friction(),
        "start": _start(),
        "pose": _pose(),
    }
    return "{\n" + ",\n".join(f"{name}: {text}" for name, text in made.items()) + "\n}"


def _friction() -> str:
    names = ("coefficient", "smoothing")
    recorder = Recorder(names, ("speed",))
    law: Any = SimpleNamespace(**dict(zip(names, recorder.constants, strict=True)))
    return recorder.javascript([SmoothCoulomb.per_speed(law, *recorder.variables)])  # type: ignore[arg-type]


def _start() -> str:
    """State at the start as `Start` has it without constraints but the contact."""
    recorder = Recorder(NUMBERS, ("beta", "gamma", "spin"))
    disk, (beta, gamma, spin) = disk_of(recorder.constants), recorder.variables
    coordinates = 0.0, 0.0, disk.radius * sin(beta), 0.0, beta, gamma
    rates = 0.0, 0.0, 0.0, spin, 0.0, -spin * cos(beta)
    return recorder.javascript(state_of(disk, coordinates, rates))


def _pose() -> str:
    """Columns of the player from a state; `frames.quaternions` is their measure in the tests."""
    recorder = Recorder(NUMBERS, STATE)
    disk = disk_of(recorder.constants)
    (x, y, z, alpha, beta, gamma), (*_, spin, _, rolling) = paper_of(disk, recorder.variables)
    sb, cb = sin(0.5 * beta), cos(0.5 * beta)
    sums, differences = 0.5 * (alpha + gamma), 0.5 * (alpha - gamma)
    found: dict[str, Symbol] = {
        "z": z,
        "qw": cb * cos(sums),
        "qx": sb * cos(differences),
        "qy": sb * sin(differences),
        "qz": cb * sin(sums),
        "spin": spin + cos(beta) * rolling,
    }
    found["x"], found["y"] = _turned(alpha, x, y)
    found["contactX"], found["contactY"] = _turned(alpha, x, y - disk.radius * cos(beta))
    return recorder.javascript([found[name] for name in COLUMNS])


def _turned(alpha: Symbol, x: Symbol, y: Symbol) -> tuple[Symbol, Symbol]:
    return cos(alpha) * x - sin(alpha) * y, sin(alpha) * x + cos(alpha) * y


def settings() -> dict[str, Any]:
    """Plain data of the page: its sliders, its disks and how it integrates."""
    return {
        "columns": COLUMNS,
        "duration": DURATION,
        "step": STEP,
        "stable": STABLE,
        "shown": SHOWN,
        "gamma": Start().gamma,
        "holes": [1e-3 * distance for distance in HOLES],
        "disks": [_disk(1e-3 * distance) for distance in HOLES],
    }


def _disk(distance: float) -> dict[str, Any]:
    disk = Disk.ring(hole_distance=distance)
    scenario = Scenario(disk=disk)
    return {
        "numbers": numbers(scenario),
        "braking": scenario.weight * disk.contact_mobility,
        "radius": disk.radius,
        "shape": shape(disk)._asdict(),
    }


def page() -> str:
    """The page as HTML."""
    data = json.dumps(settings(), default=lambda outline: outline.round(5).tolist())
    frame = player.frame(name="spun", title="The motion", is_heavy=True)
    template = Environment(autoescape=True).from_string(player.asset("play.html"))
    return template.render(
        sliders=SLIDERS,
        # Begins to play when the page is opened.
        player=frame.replace("<figure ", "<figure data-alone ", 1),
        data=data,
        equations=equations(),
        script=player.asset("play.js"),
    )
