"""The runs from Table 3 to rest, and what is told of each of them."""

from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np

from analysis import (
    CAUSES,
    STEEL_DISK,
    Dissipation,
    PenaltyContact,
    Phases,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
)
from analysis.data.trajectory import Source
from validation.run import run, run_to_rest
from validation.study import Row, Study

SLIDING = "sliding friction only"
SHOWN = "dry rolling, pivoting"
VISCOUS = "viscous rolling, pivoting"
CASES = {
    SLIDING: Dissipation(),
    SHOWN: Dissipation(rolling_dry=1e-3, pivoting=5e-5),
    VISCOUS: Dissipation(rolling_viscous=1e-3, pivoting=5e-5),
}

SPACING = 5e-3
"""Of the samples in s."""

STEP = 5e-5
"""Of the engine in s: the damper's small energy is right to two digits then."""

STEPS = dict.fromkeys(CASES, STEP) | {VISCOUS: 1e-4}
"""By case; where the damper takes more, so is a longer step."""

END = 80.0
"""Longest time in s; all but the sliding disk rest before."""

ENGINE_END = 26.5
"""The same for the engine, whose sliding disk has been rolling for some while by then."""

EVERY = 4
"""Every so many samples the tilt is kept, up to `ENGINE_END`."""

WINDOWS = ((24.0, 30.0), (45.0, 55.0), (70.0, 80.0))
"""Times in s over which the loss of the sliding disk is averaged."""

FASTER = (1e-3, 1e-6)
"""By how much faster in rad/s the start spins in two variants."""

PHASES = tuple(field.name for field in fields(Phases))


class Case(NamedTuple):
    """A run: which losses, who makes it, until when, and what is changed."""

    losses: str
    source: Source = "in-house"
    end: float = END
    step: float | None = None
    stiffness: float = 1e6
    half_thickness: float = 2e-4
    faster: float = 0.0
    whole: bool = False

    @property
    def scenario(self) -> Scenario:
        """What is run."""
        contact = PenaltyContact.rounded(
            STEEL_DISK, stiffness=self.stiffness, half_thickness=self.half_thickness
        )
        start = Start(spin=Start().spin + self.faster)
        return Scenario.rest(contact=contact, dissipation=CASES[self.losses], start=start)


VARIANTS = {
    "stiffness doubled": Case(SHOWN, stiffness=2e6),
    "rim half as thick": Case(SHOWN, half_thickness=1e-4),
    **{f"spin {more:g} rad/s faster": Case(SHOWN, faster=more) for more in FASTER},
}
"""What is changed against the in-house run."""

BEGIN, COARSE, IDEAL = "engine, first second", "engine, sixfold step", "Model 1, ideal contact"


def name_of(losses: str, source: str) -> str:
    """Name of the unchanged run of a case on one side."""
    return f"{losses}: {source}"


def stored_cases() -> dict[str, Case]:
    """The long runs."""
    engine = {
        name_of(losses, "engine"): Case(losses, "engine", ENGINE_END, STEPS[losses])
        for losses in CASES
    }
    short = {BEGIN: Case(SHOWN, "engine", 1.0, STEP)}
    return {name_of(SLIDING, "in-house"): Case(SLIDING)} | engine | VARIANTS | short


def fresh_cases() -> dict[str, Case | None]:
    """Those made for each report: in-house, and the engine's through inversion and fall."""
    return {
        name_of(SHOWN, "in-house"): Case(SHOWN, whole=True),
        name_of(VISCOUS, "in-house"): Case(VISCOUS),
        COARSE: Case(SHOWN, "engine", 13.0, 6 * STEP),
        IDEAL: None,
    }


def measure(case: Case | None) -> list[Row]:
    """What is told of a run; without a case, of Model 1 with its ideal contact."""
    if case is None:
        times = np.arange(0.0, 19.5, SPACING)
        friction = SmoothCoulomb(load="contact")
        ideal = run(Scenario(friction=friction), times, source="in-house", local_tolerance=1e-9)
        told = {"source": IDEAL, "end": times[-1], "inversion": ideal.inversion.time}
        return [told | {"inversion_lost": ideal.inversion.lost}]
    control: dict[str, Any] = {"step": case.step} if case.step else {"local_tolerance": 1e-10}
    motion = run_to_rest(case.scenario, case.end, source=case.source, spacing=SPACING, **control)
    row = course(motion) | {"losses": case.losses, "complete": _is_complete(motion, case.end)}
    if case.losses == SLIDING and case.end >= WINDOWS[-1][1]:
        row |= losses(motion)
    if case.whole:
        row |= {name: getattr(motion, name) for name in SpatialMotion.STORED_ARRAYS[:-1]}
    return [row]


def _is_complete(motion: SpatialMotion, end: float) -> bool:
    return motion.rest_time is not None or bool(motion.times[-1] > end - 1e-9)


def course(motion: SpatialMotion) -> Row:
    """Phases, face up, budget up to `ENGINE_END`, and tilt of a run sampled every `SPACING`."""
    until = motion.times <= ENGINE_END + 1e-9
    energy = motion.energies.sum(axis=1)[until]
    return {
        "source": motion.source,
        "end": motion.times[-1],
        **{phase: getattr(motion.phases, phase) for phase in PHASES},
        "face": "first" if motion.tilt[-1] < np.pi / 2 else "second",
        "energy": energy[0],
        "left": energy[-1],
        "taken": motion.dissipated[until][-1],
        "unexplained": np.max(np.abs(motion.energy_residual[until])),
        "rise": max(0.0, np.max(np.diff(energy))),
        "force": np.min(motion.normal_force),
        "tilt": motion.tilt[until][::EVERY],
    }


def losses(motion: SpatialMotion) -> Row:
    """What a creeping disk loses over each of `WINDOWS`, as lists."""
    energy, times = motion.energies.sum(axis=1), motion.times
    found: dict[str, list[float]] = {}
    for window in WINDOWS:
        first, last = np.searchsorted(times, np.array(window) - 1e-9)
        part = slice(first, last + 1)
        slip = motion.slip_speeds[part]
        viscous = motion.scenario.friction.gradient * motion.normal_force[part] * slip**2
        for name, value in {
            "lean": np.mean(motion.leaning[part]),
            "slip": np.mean(slip),
            "mean_energy": np.mean(energy[part]),
            "loss": (energy[first] - energy[last]) / (times[last] - times[first]),
            "viscous_loss": np.mean(viscous),
        }.items():
            found.setdefault(name, []).append(float(value))
    return found


COLUMNS = {
    **dict.fromkeys(PHASES, "when the phase began in s"),
    "complete": "whether it ran until rest, or to the end asked for",
    "energy": "at the start in J",
    "left": "energy at the end, or after 26.5 s, in J",
    "taken": f"energy in J that each of {', '.join(CAUSES)} had taken by then",
    "unexplained": "largest energy residual in J",
    "rise": "largest rise of the energy between two samples in J",
    "force": "least contact force in N",
    "tilt": f"in rad, every {EVERY * SPACING:g} s up to 26.5 s",
}

STUDY = Study(
    name="rest",
    cases=stored_cases,
    measure=measure,
    sample=(BEGIN, "rim half as thick"),
    confirm={
        **dict.fromkeys(PHASES, 1e-2),
        "face": None,
        "complete": None,
        "tilt": 1e-5,
        "taken": 1e-6,
        "force": 1e-2,
    },
    columns=COLUMNS,
)
FRESH = Study(name="rest-fresh", cases=fresh_cases, measure=measure, columns=COLUMNS)
