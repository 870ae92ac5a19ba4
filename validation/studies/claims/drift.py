"""Whether the centre of gravity hardly moves horizontally (Sect. 4.2)."""

import numpy as np

from analysis import Trajectory
from analysis.data.checks import Array
from analysis.mechanics import paper
from validation.studies.claims.claim import Claim, grade


def cog_path(run: Trajectory) -> tuple[Array, Array]:
    """Horizontal position and velocity of the COG in the inertial frame, each shape (n, 2)."""
    e = run.scenario.disk.eccentricity
    x, y, _, alpha, beta, gamma = run.coordinates.T
    xd, yd, _, alpha_d, beta_d, gamma_d = run.rates.T
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    across, along = x + e * cg, y + e * cb * sg
    across_d = xd - e * sg * gamma_d - along * alpha_d
    along_d = yd - e * sb * sg * beta_d + e * cb * cg * gamma_d + across * alpha_d
    c, s = np.cos(alpha), np.sin(alpha)
    position = np.column_stack((c * across - s * along, s * across + c * along))
    velocity = np.column_stack((c * across_d - s * along_d, s * across_d + c * along_d))
    return position, velocity


def claims(run: Trajectory) -> list[Claim]:
    """Section 4.2, from a run of Model 1 that lasts beyond the inversion."""
    position, velocity = cog_path(run)
    away = np.linalg.norm(position - position[0], axis=1)
    slip = np.array(
        [
            paper.tangential_directions(run.scenario.disk, z).T @ u
            for z, u in zip(run.coordinates, run.rates, strict=True)
        ]
    )
    until = run.inversion_time or float(run.times[-1])
    rising = run.times <= until
    speeds = [_rms(values[rising]) for values in (velocity, slip)]
    ratio = speeds[0] / speeds[1]
    r, e = run.scenario.disk.radius, run.scenario.disk.eccentricity
    farthest = float(np.max(away[run.times <= 2.0]))
    return [
        Claim(
            place="Sect. 4.2",
            statement="the centre of gravity hardly moves horizontally",
            criterion="in Model 1 at most by the eccentricity within 2 s; partly: by twice that",
            measured=f"{1e3 * farthest:.1f} mm, {farthest / e:.1f} times the eccentricity or "
            f"{farthest / r:.2f} of the radius; {1e3 * np.max(away):.0f} mm until "
            f"{run.times[-1]:g} s",
            verdict=grade(yes=farthest <= e, partly=farthest <= 2 * e),
        ),
        Claim(
            place="Sect. 4.2",
            statement="the part of the slip that comes from horizontal motion is negligible",
            criterion="in Model 1, until the inversion, the root mean square of the COG's speed "
            "is at most 10 % of that of the slip; partly: 50 %",
            measured=f"{100 * ratio:.0f} %: {speeds[0]:.3f} of {speeds[1]:.3f} m/s",
            verdict=grade(yes=ratio <= 0.1, partly=ratio <= 0.5),
        ),
    ]


def _rms(vectors: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))
