"""The disk as a thin spheroid on a plane: contact point, and how fast it moves along the rim.

A spheroid of semi-axes r, r, c has a smooth lowest point in every attitude. The circle of
radius r, its limit, has none when it lies flat; a torus of tube radius c has none either.
With u the upward vertical in the body frame, D = diag(r², r², c²) and H = sqrt(u^T D u), the
lowest point is -D u / H from the centre, and H is the height of the centre over it.

The thin disk has H = r sin(beta). The spheroid lies higher by about c² cos²(beta) / (2 r
sin(beta)), second order in c, and by c when flat; a torus by c (1 - sin(beta)), first order.

All vectors are tuples of three floats in the body frame.
"""

from math import sqrt

Vector3 = tuple[float, float, float]


def contact_point(radius: float, half_thickness: float, upward: Vector3) -> Vector3:
    """Lowest point of the spheroid relative to its centre in m."""
    a, b = radius * radius, half_thickness * half_thickness
    x, y, z = upward
    height = support_height(radius, half_thickness, upward)
    return -a * x / height, -a * y / height, -b * z / height


def support_height(radius: float, half_thickness: float, upward: Vector3) -> float:
    """Height of the centre above the lowest point in m."""
    x, y, z = upward
    return sqrt(radius * radius * (x * x + y * y) + half_thickness * half_thickness * z * z)


def contour_velocity(
    radius: float, half_thickness: float, upward: Vector3, turning: Vector3
) -> Vector3:
    """Velocity in m/s at which the contact point moves over the surface of the spheroid.

    This is -(D - D u (D u)^T / H²) / H applied to the rate of `upward`. The matrix is symmetric
    and takes the vertical to zero, so that the velocity is horizontal.

    Parameters
    ----------
    radius, half_thickness : float
        Semi-axes in m.
    upward : tuple of 3 floats
        Unit vector along the vertical.
    turning : tuple of 3 floats
        Horizontal vector: the rate of `upward`, for velocities.
    """
    a, b = radius * radius, half_thickness * half_thickness
    x, y, z = upward
    p, q, s = turning
    height = support_height(radius, half_thickness, upward)
    share = (a * (x * p + y * q) + b * z * s) / (height * height)
    return (
        -a * (p - share * x) / height,
        -a * (q - share * y) / height,
        -b * (s - share * z) / height,
    )
