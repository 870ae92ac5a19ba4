"""A page on which the disk is spun by hand: the equations of Model 1, integrated in the browser.

The equations are those of `analysis.mechanics`, recorded and written as JavaScript; a player shows
the motion. The page needs no network and no other file.
"""

from types import SimpleNamespace
from typing import Any

from analysis import MODELS, Disk, Scenario, SmoothCoulomb, Start
from analysis.mechanics.attitude import paper_of, state_of
from analysis.mechanics.newton_euler import Structure
from analysis.mechanics.recorded import NUMBERS, STATE, disk_of, numbers, recording
from analysis.mechanics.recorder import Recorder, Symbol
from analysis.motion.endings import REACHED
from analysis.motion.inversion import STAYING
from analysis.problem.elementary import cos, sin
from validation.animation import player
from validation.animation.body import shape

TITLE = "The tippedisk, spun by hand"

HOLES = range(0, 30, 2)
"""Distances of the hole from the centre in mm that the page knows."""


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
    return recorder.javascript(
        [
            *(*_turned(alpha, x, y), z),
            *(cb * cos(sums), sb * cos(differences), sb * sin(differences), cb * sin(sums)),
            *_turned(alpha, x, y - disk.radius * cos(beta)),
            spin + cos(beta) * rolling,
        ]
    )


def _turned(alpha: Symbol, x: Symbol, y: Symbol) -> tuple[Symbol, Symbol]:
    return cos(alpha) * x - sin(alpha) * y, sin(alpha) * x + cos(alpha) * y


def _disk(distance: float) -> dict[str, Any]:
    disk = Disk.ring(hole_distance=distance)
    scenario = Scenario(disk=disk)
    return {
        "numbers": numbers(scenario),
        "braking": scenario.weight * disk.contact_mobility,
        "radius": disk.radius,
        "shape": shape(disk)._asdict(),
    }


def page() -> player.Page:
    """The page, which needs no kernel, network or other file."""
    disks = {str(distance): _disk(1e-3 * distance) for distance in HOLES}
    body = player.render(
        "play.html",
        title=TITLE,
        start=Start(),
        settings={
            "columns": player.COLUMNS,
            "gamma": Start().gamma,
            "disks": disks,
            "reached": REACHED,
            "staying": STAYING,
        },
        equations=equations(),
    )
    return player.Page(title=TITLE, fragment=body, height=72.0)
