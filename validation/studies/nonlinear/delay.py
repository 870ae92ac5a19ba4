"""The law of the delay: how far below the Hopf point a disk is lost whose spin is slowed."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from analysis import Dissipation, Scenario, Start
from analysis.data.sampled import Source
from validation.nonlinear.passage import Passage, SlowPair, follow

SMALL = 0.02
"""Deviation in rad from which the slowed disks start."""


def slowed(lever: float, source: Source) -> Passage:
    """Passage of a disk that starts inverted at the Hopf point and is slowed by pivoting friction.

    Parameters
    ----------
    lever : float
        Of the pivoting friction in m.
    source : {"engine", "in-house"}
    """
    spin = SlowPair.of(Scenario()).spin
    start = Start(beta=np.pi / 2, gamma=np.pi / 2 + SMALL, spin=spin)
    scenario = Scenario.rest(dissipation=Dissipation(pivoting=lever), start=start)
    # What the slowest takes, and less for the others: the slower the spin falls, the later.
    return follow(scenario, 20.0 * float(np.sqrt(1e-5 / lever)), source)


class DelayLaw(NamedTuple):
    """How far below the Hopf point a disk is lost over the rate at which its spin falls.

    Parameters
    ----------
    exponent, error : float
        Power of the rate, fitted, and its standard error; the law says 1/2.
    growth : float
        Logarithm of the growth from the crossing to the loss by the law, from the fit of the
        square of the delay.
    """

    exponent: float
    error: float
    growth: float


def delay_law(rates: npt.ArrayLike, delays: npt.ArrayLike) -> DelayLaw:
    """Fit the delays of disks of the paper that start alike.

    Parameters
    ----------
    rates, delays : array_like, shape (n,)
        Rates of decay in rad/s² and Hopf point less lowest spin in rad/s.

    Raises
    ------
    ValueError
        If there are less than three, or one is none.
    """
    x, y = np.log(np.array(rates, float)), np.log(np.array(delays, float))
    if x.size < 3 or not np.all(np.isfinite([x, y])):
        raise ValueError("rates must be 3 or more, of disks that fall through the Hopf point")
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    pair = SlowPair.of(Scenario())
    below, above = pair.over(pair.spin + np.array((-0.5, 0.5)))[0]
    growths = np.exp(2.0 * y - x) * (below - above) / 2.0
    return DelayLaw(float(slope), float(np.sqrt(covariance[0, 0])), float(np.mean(growths)))
