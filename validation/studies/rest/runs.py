"""The runs from Table 3 to rest, and what is told of each of them."""

from dataclasses import fields, replace
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
from analysis.motion.quantities import filled
from analysis.problem.choices import SOURCES, Source
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

SMOOTHED = {
    "pivoting smoothed over 1 rad/s": replace(CASES[SHOWN], pivoting_smoothing=1.0),
    "rolling smoothed over 1 mm/s": replace(CASES[SHOWN], rolling_smoothing=1e-3),
}
"""Losses that set in over ten times, or a tenth of, the usual speeds."""

SPACING = 5e-3
"""Of the samples in s."""

EVERY = 4
"""Every so many samples the tilt is kept."""

END, ENGINE_END = 80.0, 26.5
"""Longest times in s in-house and in the engine, whose sliding disk has been rolling for some time
by then; all others rest before."""

STEPS = {SLIDING: 5e-5, SHOWN: 5e-5, VISCOUS: 1e-4}
"""Of the engine in s: the damper's energy is right to two digits; where it takes more, so is a
longer step."""

WINDOW = (70.0, 80.0)
"""Times in s over which the loss of the sliding disk is averaged."""

FASTER = {f"spin {more:g} rad/s faster": more for more in (1e-3, 1e-5)}
"""By how much faster in rad/s the start spins in two variants: errors of runs would hide less."""

PHASES = tuple(field.name for field in fields(Phases))
TAKEN = tuple(f"taken_by_{cause}" for cause in CAUSES)


class Case(NamedTuple):
    """A run: which losses, who makes it, until when, and what is changed."""

    losses: str
    source: Source = "in-house"
    end: float = END
    step: float | None = None
    stiffness: float = 1e6
    half_thickness: float = 2e-4
    start: Start = Start()

    @property
    def scenario(self) -> Scenario:
        """What is run."""
        losses = (CASES | SMOOTHED)[self.losses]
        contact = PenaltyContact.rounded(
            STEEL_DISK, stiffness=self.stiffness, half_thickness=self.half_thickness
        )
        return Scenario.rest(contact=contact, dissipation=losses, start=self.start)

    def run(self) -> SpatialMotion:
        """Until it rests, or to its end."""
        control: dict[str, Any] = {"step": self.step} if self.step else {"local_tolerance": 1e-10}
        return run_to_rest(self.scenario, self.end, source=self.source, spacing=SPACING, **control)


COARSE, IDEAL = "engine, sixfold step", "Model 1, ideal contact"
ENGINE, INHOUSE = ({each: f"{each}: {source}" for each in CASES} for source in SOURCES)
"""Names of the unchanged runs by losses."""

VARIANTS = {
    "stiffness doubled": Case(SHOWN, stiffness=2e6),
    "rim half as thick": Case(SHOWN, half_thickness=1e-4),
    **{name: Case(SHOWN, start=Start(spin=40.0 + more)) for name, more in FASTER.items()},
    **{name: Case(name) for name in SMOOTHED},
}
"""What is changed against the in-house run."""


def stored_cases() -> dict[str, Case]:
    """The long runs, and the engine's through inversion and fall with a longer step."""
    engine = {ENGINE[each]: Case(each, "engine", ENGINE_END, STEPS[each]) for each in CASES}
    coarse = {COARSE: Case(SHOWN, "engine", 13.0, 6 * STEPS[SHOWN])}
    return {INHOUSE[SLIDING]: Case(SLIDING)} | engine | VARIANTS | coarse


def fresh_cases() -> dict[str, Case | None]:
    """Those that are made for each report."""
    return {INHOUSE[each]: Case(each) for each in (SHOWN, VISCOUS)} | {IDEAL: None}


def measure(case: Case | None) -> list[Row]:
    """What is told of a run; without a case, of Model 1 with its ideal contact."""
    if case is None:
        times = np.arange(0.0, 19.5, SPACING)
        friction = SmoothCoulomb(load="contact")
        ideal = run(Scenario(friction=friction), times, source="in-house", local_tolerance=1e-9)
        phases = {"inversion": ideal.inversion.time, "inversion_lost": ideal.inversion.lost}
        return [{"end": times[-1], **phases}]
    motion = case.run()
    row = course(motion)
    if case == Case(SLIDING):
        row |= losses(motion)
    if case == Case(SHOWN):
        row |= {name: getattr(motion, name) for name in filled(SpatialMotion)}
    return [row]


def course(motion: SpatialMotion) -> Row:
    """Phases, face up, and up to `ENGINE_END` budget and tilt of a run sampled every `SPACING`."""
    until = motion.times <= ENGINE_END + 1e-9
    energy = motion.energies.sum(axis=1)[until]
    return {
        "end": motion.times[-1],
        **{phase: getattr(motion.phases, phase) for phase in PHASES},
        "face": "first" if motion.tilt[-1] < np.pi / 2 else "second",
        "energy": energy[0],
        **dict(zip(TAKEN, motion.dissipated[until][-1], strict=True)),
        "left": energy[-1],
        "unexplained": np.max(np.abs(motion.energy_residual[until])),
        "rise": np.max(np.diff(energy), initial=0.0),
        "force": np.min(motion.normal_force),
        "tilt": motion.tilt[until][::EVERY],
    }


def losses(motion: SpatialMotion) -> Row:
    """What a creeping disk loses over `WINDOW`, and what a viscous law gives."""
    first, last = np.searchsorted(motion.times, np.array(WINDOW) - 1e-9)
    energy = motion.energies.sum(axis=1)
    viscosity = motion.scenario.friction.gradient * motion.normal_force
    curves = {
        "lean": motion.leaning,
        "mean_energy": energy,
        "viscous_loss": viscosity * motion.slip_speeds**2,
    }
    row: Row = {name: np.mean(values[first : last + 1]) for name, values in curves.items()}
    taken = motion.times[last] - motion.times[first]
    return row | {"loss": (energy[first] - energy[last]) / taken}


COLUMNS = {
    **dict.fromkeys(PHASES, "when the phase began in s"),
    "face": "which lies up at last",
    "energy": "at the start in J",
    "left": f"energy at the end, or after {ENGINE_END:g} s, in J",
    "unexplained": "largest energy residual in J",
    "rise": "largest rise of the energy between two samples in J",
    "force": "least contact force in N",
    "tilt": f"in rad, every {EVERY * SPACING:g} s up to {ENGINE_END:g} s",
}

STUDY = Study(
    name="rest",
    cases=stored_cases,
    measure=measure,
    sample=(COARSE,),
    confirm={"tilt": 1e-5, "face": None, "force": 1e-2}
    | dict.fromkeys(PHASES, 1e-2)
    | dict.fromkeys(TAKEN, 1e-6),
    columns=COLUMNS,
)
FRESH = Study(name="rest-fresh", cases=fresh_cases, measure=measure)
