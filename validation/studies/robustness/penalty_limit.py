"""The penalty contact against the ideal one as it gets stiffer."""

from dataclasses import dataclass, replace

import numpy as np

import analysis
import mbs_models
from analysis import STEEL_DISK, Load, PenaltyContact, Scenario, SmoothCoulomb
from mbs_models import Scene
from validation.studies.robustness.reference import deviation

STIFFNESSES = (1e4, 1e5, 1e6, 1e7)
"""In N/m; beyond, the error meets that of the integration."""

TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class PenaltyError:
    """How far the penalty contact is from the ideal one.

    Parameters
    ----------
    stiffness : float
        In N/m.
    load : {"weight", "contact"}
    angles : float
        Largest difference of beta and gamma from Model 1 in rad, from Table 3 over 0.5 s.
    normal_force : float
        Largest difference of the normal force in N after the first 50 ms.
    estimate : float
        The run's own estimate of its integration error in rad.
    step : float
        In s.
    """

    stiffness: float
    load: Load
    angles: float
    normal_force: float
    estimate: float
    step: float


def penalty_error(stiffness: float, load: Load) -> PenaltyError:
    """Compare the damped penalty contact with the in-house Model 1.

    The disk starts at its resting penetration. The normal force at the start of Model 1 is
    not quite the weight, so a small bounce is left, which the damping takes away.
    """
    ideal = Scenario(friction=SmoothCoulomb(load=load))
    times = np.linspace(0.0, 0.5, 51)
    truth = analysis.simulate(ideal, times, tolerance=1e-10)
    contact = PenaltyContact.damped(stiffness, STEEL_DISK)
    scene = Scene(replace(ideal, contact=contact), "euler-tree")
    run = mbs_models.simulate(
        scene, times, tolerance=max(TOLERANCE, 1e-3 / stiffness), integrator="RK44"
    )
    settled = times >= 0.05
    difference = np.abs(run.normal_force - truth.normal_force)[settled]
    return PenaltyError(
        stiffness=stiffness,
        load=load,
        angles=deviation(run, truth),
        normal_force=float(np.max(difference)),
        estimate=float(run.error_estimate or 0.0),
        step=float(run.method["step"] or 0.0),
    )
