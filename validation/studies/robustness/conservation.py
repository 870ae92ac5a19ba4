"""What long runs must keep: their constraints, their energy balance, and constants of motion."""

from dataclasses import dataclass

import numpy as np

import analysis
from analysis import MODELS, Form, Level, Method, Scenario, SmoothCoulomb, Trajectory
from analysis.data.checks import Array
from analysis.data.frames import poses, twists
from mbs_models import Formulation, IntegratorName
from validation.kit.ways import Way
from validation.study import Row, Study

SAMPLES_PER_SECOND = 200

DRIFT_END, FREE_END = 5.0, 2.0
"""In s."""


ENERGY = 1e-4
"""Largest residual of the energy balance over weight times radius."""

GROWTH = 1.5
"""Largest drift in the second half of the time over that in the first that is none that grows."""


@dataclass(frozen=True, slots=True)
class LongRun:
    """A way to integrate a model over a long time.

    Parameters
    ----------
    model : {1, 2, 3, 4}
    way : Way
    accuracy : float
        Step in s of the engine, local tolerance of the in-house side.
    limit : float
        Largest drift over the radius, or change of what is conserved.
    grows : bool
        Whether the drift may go on growing.
    """

    model: Level
    way: Way
    accuracy: float
    limit: float
    grows: bool = False

    def simulate(self, end: float, **friction: float) -> Trajectory:
        """Run it from Table 3 up to `end` in s."""
        law = SmoothCoulomb(**friction)
        scenario = Scenario(constraints=MODELS[self.model], friction=law)
        times = np.linspace(0.0, end, round(SAMPLES_PER_SECOND * end) + 1)
        accuracy = "step" if self.way.source == "engine" else "local_tolerance"
        return self.way.run(scenario, times, **{accuracy: self.accuracy})


def _engine(formulation: Formulation, integrator: IntegratorName) -> Way:
    return Way(source="engine", formulation=formulation, integrator=integrator)


def _in_house(form: Form, method: Method) -> Way:
    return Way(source="in-house", formulation=form, integrator=method)


DRIFTING = {
    "acceleration level (index 1), tolerance 1e-6": LongRun(
        3, _in_house("index-1", "RK45"), 1e-6, limit=1e-5, grows=True
    ),
    "acceleration level (index 1), tolerance 1e-10": LongRun(
        3, _in_house("index-1", "DOP853"), 1e-10, limit=1e-9, grows=True
    ),
    "velocity level (index 2), engine, Euler tree, 1 ms": LongRun(
        3, _engine("euler-tree", "TrapezoidalIndex2"), 1e-3, limit=1e-5
    ),
    "velocity level (index 2), engine, floating, 1 ms": LongRun(
        3, _engine("floating", "TrapezoidalIndex2"), 1e-3, limit=1e-5
    ),
    "generalized α (position level but the contact), engine, Euler tree, 1 ms": LongRun(
        3, _engine("euler-tree", "GeneralizedAlpha"), 1e-3, limit=1e-5
    ),
    "minimal coordinates, engine, contact tree, 5 ms (Model 1)": LongRun(
        1, _engine("contact-tree", "RK44"), 5e-3, limit=1e-14
    ),
    "minimal coordinates, in-house reduced, 1e-6 (Model 4)": LongRun(
        4, _in_house("reduced", "RK45"), 1e-6, limit=1e-14
    ),
}
"""By the level on which the constraints are met."""

_FREE = {
    _engine("contact-tree", "RK67"): 1e-10,
    _engine("contact-tree", "RK44"): 1e-6,
    _engine("contact-tree", "TrapezoidalIndex2"): 1e-3,
    _engine("euler-tree", "TrapezoidalIndex2"): 1e-3,
    _engine("euler-tree", "GeneralizedAlpha"): 1e-3,
    _engine("floating", "TrapezoidalIndex2"): 1e-3,
    _engine("floating-lie", "TrapezoidalIndex2"): 1e-3,
    _in_house("index-1", "DOP853"): 1e-8,
}

FREE = {
    way.name: LongRun(1, way, 1e-3 if way.source == "engine" else 1e-9, limit)
    for way, limit in _FREE.items()
}
"""Model 1, to be run without friction, by way."""


def drift(long: LongRun) -> list[Row]:
    """Constraint and energy residuals of a run with friction."""
    run = long.simulate(DRIFT_END)
    position, velocity = map(np.abs, analysis.constraint_drift(run))
    disk = run.scenario.disk
    half = run.times <= 0.5 * DRIFT_END
    scale = run.scenario.weight * disk.radius
    return [
        {
            "end": float(run.times[-1]),
            "position": np.max(position),
            "at_end": position[-1],
            "growth": np.max(position[~half]) / np.max(position[half]),
            "velocity": np.max(velocity),
            "energy": np.max(np.abs(analysis.energy_residual(run))) / scale,
            "allowed": long.limit * disk.radius,
        }
    ]


def conserved(long: LongRun) -> list[Row]:
    """Largest changes of the four constants of motion of Model 1 without friction.

    The table's force is vertical then. So it changes neither the horizontal momentum nor, having
    no moment about the vertical through the COG, the vertical angular momentum; and it does no
    work.
    """
    run = long.simulate(FREE_END, coefficient=0.0)
    disk = run.scenario.disk
    kinetic, potential = analysis.energies(run.scenario, run.coordinates, run.rates)
    momentum, spin = _momenta(run)
    speed = disk.radius * abs(run.rates[0, 3])
    return [
        {
            "energy": _change(kinetic + potential) / (run.scenario.weight * disk.radius),
            "momentum": max(_change(momentum[:, k]) for k in (0, 1)) / (disk.mass * speed),
            "spin": _change(spin) / abs(float(spin[0])),
            "allowed": long.limit,
        }
    ]


def _momenta(run: Trajectory) -> tuple[Array, Array]:
    """Momentum, shape (n, 3), and vertical angular momentum about the COG, shape (n,)."""
    _, rotation = poses(run.coordinates)
    velocity, angular = twists(run.coordinates, run.rates)
    arm = rotation[:, :, 0] * run.scenario.disk.eccentricity
    momentum = run.scenario.disk.mass * (velocity + np.cross(angular, arm))
    local = np.einsum("nji,nj->ni", rotation, angular)
    moments = np.array(run.scenario.disk.inertia_about_cog)
    spin: Array = np.einsum("ni,ni->n", rotation[:, 2, :], moments * local)
    return momentum, spin


def _change(values: Array) -> float:
    return float(np.max(np.abs(values - values[0])))


DRIFT = Study(
    name="robustness-drift",
    cases=lambda: DRIFTING,
    measure=drift,
    columns={
        "position": "largest residual of the constraints in m",
        "growth": "largest position residual of the second half of the time over the first's",
        "velocity": "largest residual in m/s",
        "energy": "largest residual of the energy balance over weight times radius",
    },
)

CONSERVED = Study(
    name="robustness-conserved",
    cases=lambda: FREE,
    measure=conserved,
    columns={
        "energy": "largest change over weight times radius",
        "momentum": "of the horizontal one over mass times rim speed",
        "spin": "of the vertical angular momentum about the COG, relative",
    },
)
