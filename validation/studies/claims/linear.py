"""What the paper says of the eigenvalues (Sections 3.2, 6 and 8, Appendix B)."""

import numpy as np

from analysis import MODELS, FrictionLaw, Scenario, SmoothCoulomb
from analysis.stability.critical import critical_speeds
from analysis.stability.spectra import eigenvalues
from validation.study import Row, grade, within

SPINS = np.linspace(0.0, 50.0, 101)
"""Of Figures 6, 10 and 11 in rad/s."""

FRICTIONS = ((0.3, 0.1), (0.1, 0.1), (1.0, 0.1), (0.3, 0.01))
"""Coefficients and smoothing speeds in m/s: the paper's and others."""

STEEP = SmoothCoulomb(smoothing=0.01)
"""That the printed λ₇ and λ₈ suggest."""

FAST = 40.0
"""Spin in rad/s at which it is told how fast the reduced system converges."""

SAME = 1e-6
"""Difference in rad/s of critical speeds that are the same."""

ROUNDING = 1e-6
"""Size in 1/s of an eigenvalue that is none."""


def judge() -> dict[str, Row]:
    """All statements on eigenvalues."""
    falling = eigenvalues(Scenario(), SPINS, motion="noninverted").real.max(axis=1)
    here, steep = (_rubbing(each) for each in (Scenario().friction, STEEP))
    first, second, third = eigenvalues(Scenario(constraints=MODELS[4]), [0.0])[0]
    resting = first.real > ROUNDING and abs(second) < ROUNDING and third.real < -ROUNDING
    return {
        "noninverted": {"grows": falling, "verdict": grade(yes=bool(falling.min() > 0.0))},
        "rubbing": within(here, 0.1, 0.5) | {"steep": steep},
        "resting": {"values": (first.real, second.real, third.real)}
        | {"verdict": grade(yes=bool(resting))},
        "friction": _friction(),
    }


def _rubbing(law: FrictionLaw) -> float:
    """By how much the eigenvalues λ₇ and λ₈ of sliding friction change with the spin, relative."""
    values = eigenvalues(Scenario(friction=law), SPINS).real[:, -2:]
    return float(np.max(np.ptp(values, axis=0) / np.abs(values).max(axis=0)))


def _friction() -> Row:
    """Critical speed and decay of the reduced system by friction."""
    speeds, rates = [], []
    for coefficient, smoothing in FRICTIONS:
        law = SmoothCoulomb(coefficient=coefficient, smoothing=smoothing)
        scenario = Scenario(constraints=MODELS[4], friction=law)
        (hopf,) = critical_speeds(scenario, (20.0, 40.0), system="numeric").hopf
        speeds.append(hopf.spin)
        rates.append(float(eigenvalues(scenario, [FAST]).real.max()))
    apart, spread = np.ptp(speeds), np.ptp(rates)
    verdict = grade(yes=bool(apart <= SAME < spread), partly=bool(apart <= SAME))
    return {"apart": apart, "rates": rates, "verdict": verdict}
