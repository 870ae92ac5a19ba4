"""Any stationary motion linearised, upright or tilted, sliding or not.

The matrices of `linear_numeric` are polynomials of the spin, which holds for upright spinning
alone, without slip. Here the same flow is linearised at one spin and one attitude.
"""

import numpy as np

from analysis.data.scenario import Scenario
from analysis.stability.linear_numeric import LinearFlow, Tangents
from analysis.stability.linear_reduced import ComplexArray


def stationary_eigenvalues(
    scenario: Scenario, spin: float, place: tuple[float, float, float, float]
) -> ComplexArray:
    """Eigenvalues of a stationary motion in 1/s, shape (k,), by falling real part.

    The neutral ones are left out: those of the direction in which the disk stands, of the
    neighbouring spin where it is free, and of the place on the table where that is free.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    spin : float
        In rad/s.
    place : tuple of 4 floats
        x and y of the geometric centre in the turning frame in m, beta and gamma in rad, of a
        motion in which they do not change.

    Raises
    ------
    ValueError
        If the table leans or the contact is compliant.
    ArithmeticError
        If the motion is not stationary.
    """
    flow = LinearFlow(scenario)
    x, y, beta, gamma = place
    state = flow.stationary(spin, (x, y, scenario.disk.radius * np.sin(beta), 0.0, beta, gamma))
    change = float(np.max(np.abs(flow.accelerations(state)))) / (
        1.0 + (spin / flow.frequency) ** 2
    )
    if change > 1e-6:
        raise ArithmeticError(
            f"a motion at {spin:.9g} rad/s with beta {beta:.6g} and gamma {gamma:.6g} rad is not "
            f"stationary: its accelerations are {change:.1e} of those of the spinning"
        )
    normals, jacobian = flow.normals(state), flow.jacobian(state)
    tangents = Tangents(normals, flow.neutral(drift=False))
    (matrix,), _ = tangents.matrices(jacobian[None], normals[None])
    values = np.linalg.eigvals(flow.frequency * matrix).astype(complex)
    return values[np.lexsort((-values.imag, -values.real))]
