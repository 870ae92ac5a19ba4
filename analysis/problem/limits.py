"""How much may be asked for: beyond these limits a call is refused before it computes anything."""

from dataclasses import dataclass

from analysis.problem.names import ArgumentError

DEFAULT_TOLERANCE = 1e-8
"""Largest error of beta and gamma in rad of a run that is asked for none."""

REST_SPACING = 2e-3
"""Time in s between samples of a motion to rest that is asked for none."""

MOST_STEPS = 100_000_000
"""Steps of a run, of all its repetitions together; each takes 20 µs or more, a compiled one 2."""

OVERRUN = 3.0
"""Times the steps that a run was expected to take, and"""

SPARE_SECONDS = 20.0
"""processor time of the further ones, after which it is given up unless it has a time limit."""

LARGEST_STORAGE = 2_000_000_000
"""Bytes that the samples of a motion may take, in memory or in a file."""

LONGEST_MOTION = 1e9
"""End of a motion in s: thirty years."""

SHORTEST_STEP = 1e-15
"""Step in s; a light wave takes longer to swing once."""

PLAYBACK_SPEEDS = (1e-6, 1e6)
"""Of an animation; 1 is real time."""

SLOWEST_FRAMES = 0.01
"""Frames per second of an animated picture; the format cannot hold much slower ones."""

MOST_SPINS = 100_000
"""Spins for which eigenvalues may be asked for at once."""

MOST_SCENARIOS = 10_000
"""Scenarios through which cycles or connections are followed; a cycle takes a tenth of a second, a
connection some seconds."""

MOST_STARTS = 10_000
"""Starts of a search for stationary motions; each takes some 20 ms."""

MOST_WORKERS = 1000
"""Processes of one machine; each takes some 100 MB."""

WIDEST_PICTURE = 2000
"""Width and height of an animated picture in pixels."""

MOST_KEYFRAMES = 1_000_000
"""Poses of an animation."""

LEAST_TILT = 1e-6
"""Leaning in rad down to which Euler angles, singular on a flat disk, describe a pose."""

JAMMING = 1.0 - 1e-9
"""Newtons of normal force beyond which those that each one calls for through friction jam the
contact. From there to one, the force has no digits left."""

CONTACT_JAMS = "the contact jams (Painlevé's paradox)"
"""What is said there."""


def check_storage(name: str, samples: float, columns: int) -> None:
    """Check that samples of so many numbers each can be held.

    Parameters
    ----------
    name : str
        Of what asks for them, for the message.
    samples : float
    columns : int

    Raises
    ------
    ValueError
        If they take more than `LARGEST_STORAGE`.
    """
    if 8 * columns * samples > LARGEST_STORAGE:
        most = LARGEST_STORAGE // (8 * columns)
        raise ArgumentError(
            name,
            f"asks for {float(samples):.3g} samples of {columns} numbers each; at most {most} are "
            "held",
        )


def duration(seconds: float) -> str:
    """A time in words: "12 s", "3.4 min" or "2.1 h"."""
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.1f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """What a run will take, told from its arguments to within a factor of some three for most.

    Parameters
    ----------
    steps : float
        Number of steps, of all repetitions together.
    seconds : float
        Processor time in s on a machine of today.
    argument, value : str
        The argument that asks for so many, and its value.
    doubt : str
        Why the run will probably fail in the end; empty if it need not.
    """

    steps: float
    seconds: float
    argument: str
    value: str
    doubt: str = ""

    def check(self) -> None:
        """Raise `ValueError` if the run takes more than `MOST_STEPS`."""
        if self.steps > MOST_STEPS:
            raise ArgumentError(
                self.argument,
                f"{self.value} would take about {self.steps:.1e} steps; at most "
                f"{MOST_STEPS:.0e} are made",
            )

    @property
    def most(self) -> float:
        """Steps after which the run is given up: it goes another way than expected."""
        return OVERRUN * self.steps + SPARE_SECONDS * self.steps / self.seconds

    def __str__(self) -> str:
        doubt = f"; {self.doubt}" if self.doubt else ""
        cause = f"{self.argument} {self.value}"
        time = duration(self.seconds)
        return f"about {self.steps:.1e} steps, roughly {time}, for {cause}{doubt}"
