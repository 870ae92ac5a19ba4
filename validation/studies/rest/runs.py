"""The runs from Table 3 to rest, and what is told of each of them."""

from dataclasses import dataclass

import numpy as np

from analysis import (
    STEEL_DISK,
    Dissipation,
    PenaltyContact,
    Phases,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
)
from analysis.data.checks import Array
from validation.kit.report import Job
from validation.run import run, run_to_rest
from validation.studies.rest.creep import Loss, losses

SLIDING = "sliding friction only"
SHOWN = "dry rolling, pivoting"
CASES = {
    SLIDING: Dissipation(),
    SHOWN: Dissipation(rolling_dry=1e-3, pivoting=5e-5),
    "viscous rolling, pivoting": Dissipation(rolling_viscous=1e-3, pivoting=5e-5),
}

SPACING = 5e-3
STEP = 5e-5
"""Of the engine in s: the damper's small energy is right to two digits then."""

STEPS = dict.fromkeys(CASES, STEP) | {"viscous rolling, pivoting": 1e-4}
"""By case; where the damper takes more, so is a longer step."""

END = 80.0
"""Longest time in s; all but the sliding disk rest before."""

ENGINE_END = 26.5
"""The same for the engine, whose sliding disk has been rolling for some while by then."""

EVERY = 4
"""Every so many samples the tilt is kept."""

DECIMALS = 11
"""Of the kept tilt in rad."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Course:
    """What is told of a run to rest.

    Parameters
    ----------
    source : {"engine", "in-house"}
    spacing : float
        Of the samples of the tilt in s, the first one at 0.
    tilt : ndarray, shape (n,)
        In rad, up to `ENGINE_END`.
    phases : Phases
    face : str
        Which face lies up at last.
    energy, left : float
        Energy in J at the start and at the end, or at `ENGINE_END`.
    taken : ndarray, shape (6,)
        Energy in J that each of `CAUSES` has taken until then.
    unexplained, rise : float
        Largest energy residual and largest rise of the energy between two samples until then, J.
    force : float
        Least contact force in N.
    losses : tuple of Loss
        Over those of `creep.WINDOWS` that the run has passed.
    """

    source: str
    spacing: float
    tilt: Array
    phases: Phases
    face: str
    energy: float
    left: float
    taken: Array
    unexplained: float
    rise: float
    force: float
    losses: tuple[Loss, ...] = ()

    @property
    def times(self) -> Array:
        """Of the samples of the tilt in s, shape (n,)."""
        result: Array = self.spacing * np.arange(self.tilt.size, dtype=float)
        return result

    @classmethod
    def of(cls, motion: SpatialMotion) -> "Course":
        """That of a motion sampled every `SPACING`."""
        until = motion.times <= ENGINE_END
        energy = motion.energies.sum(axis=1)[until]
        return cls(
            source=motion.source,
            spacing=EVERY * SPACING,
            tilt=np.round(motion.tilt[until][::EVERY], DECIMALS),
            phases=motion.phases,
            face="first" if motion.tilt[-1] < np.pi / 2 else "second",
            energy=float(energy[0]),
            left=float(energy[-1]),
            taken=motion.dissipated[until][-1],
            unexplained=float(np.max(np.abs(motion.energy_residual[until]))),
            rise=float(max(0.0, np.max(np.diff(energy)))),
            force=float(np.min(motion.normal_force)),
            losses=losses(motion),
        )

    def apart(self, other: "Course") -> Array:
        """Differences of the tilt in rad over the samples that both have, shape (n,)."""
        count = min(self.tilt.size, other.tilt.size)
        result: Array = np.abs(self.tilt[:count] - other.tilt[:count])
        return result


def run_engine(case: str, step: float, end: float = ENGINE_END) -> Course:
    """Run a case in the engine with steps in s, up to an end in s."""
    scenario = Scenario.rest(dissipation=CASES[case])
    return Course.of(run_to_rest(scenario, end, step=step, spacing=SPACING))


def run_in_house(
    case: str, stiffness: float = 1e6, half_thickness: float = 2e-4, spin: float = 40.0
) -> Course:
    """Run a case with the in-house equations."""
    return Course.of(move_in_house(case, stiffness, half_thickness, spin))


def move_in_house(
    case: str, stiffness: float = 1e6, half_thickness: float = 2e-4, spin: float = 40.0
) -> SpatialMotion:
    """The whole motion of such a run."""
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    scenario = Scenario.rest(contact=contact, dissipation=CASES[case], start=Start(spin=spin))
    return run_to_rest(scenario, END, source="in-house", spacing=SPACING, local_tolerance=1e-10)


def run_model_1() -> tuple[float | None, float | None]:
    """Times in s at which Model 1, with its ideal contact, inverts and loses the inversion."""
    times = np.arange(0.0, 19.5, SPACING)
    scenario = Scenario(friction=SmoothCoulomb(load="contact"))
    found = run(scenario, times, source="in-house", local_tolerance=1e-9)
    inversion = found.inversion
    return inversion.time, inversion.lost


def jobs() -> list[Job]:
    """Runs behind the tables, the long ones first."""
    return [
        Job(("rest", SLIDING, "in-house"), run_in_house, (SLIDING,)),
        *(Job(("rest", case, "engine"), run_engine, (case, STEPS[case])) for case in CASES),
        Job(("rest", SHOWN, "stiffness doubled"), run_in_house, (SHOWN, 2e6)),
        Job(("rest", SHOWN, "rim half as thick"), run_in_house, (SHOWN, 1e6, 1e-4)),
        Job(("rest", SHOWN, "spin 0.001 rad/s faster"), run_in_house, (SHOWN, 1e6, 2e-4, 40.001)),
        *(
            Job(("rest", case, "in-house"), run_in_house, (case,))
            for case in CASES
            if case != SLIDING
        ),
        Job(("rest", SLIDING, "Model 1"), run_model_1),
    ]
