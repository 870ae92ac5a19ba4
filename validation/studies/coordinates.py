"""A sketch of the paper's coordinates, projected from the disk's own equations of place."""

from math import cos, pi, sin

_BETA, _GAMMA = 1.0, 0.7
"""Attitude of the sketch in rad."""

_AZIMUTH, _ELEVATION = 0.5, 0.35
"""Of the view in rad."""

_SCALE = 105.0
_ORIGIN = (170.0, 232.0)

Point = tuple[float, float, float]


def _flat(point: Point) -> tuple[float, float]:
    """Place in the picture of a point in units of the radius, z up."""
    x, y, z = point
    across = cos(_AZIMUTH) * x + sin(_AZIMUTH) * y
    depth = -sin(_AZIMUTH) * x + cos(_AZIMUTH) * y
    up = cos(_ELEVATION) * z + sin(_ELEVATION) * depth
    return _ORIGIN[0] + _SCALE * across, _ORIGIN[1] - _SCALE * up


def _in_disk(angle: float, length: float = 1.0) -> Point:
    """Point of the disk, its angle counted from the horizontal diameter e_x^R."""
    across, up = length * cos(angle), length * sin(angle)
    # The lowest point of the disk lies at the origin, on the table.
    return across, cos(_BETA) * (up + 1.0), sin(_BETA) * (up + 1.0)


def _path(points: list[Point], style: str, *, close: bool = False) -> str:
    text = " L".join(f"{x:.1f},{y:.1f}" for x, y in map(_flat, points))
    return f'<path d="M{text}{" Z" if close else ""}" {style}/>'


def _text(point: Point, words: str, shift: tuple[float, float] = (5.0, -5.0)) -> str:
    x, y = _flat(point)
    return f'<text x="{x + shift[0]:.1f}" y="{y + shift[1]:.1f}">{words}</text>'


def _dot(point: Point, radius: float = 3.5) -> str:
    x, y = _flat(point)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="currentColor"/>'


def _turn(first: float, last: float) -> list[float]:
    return [first + (last - first) * step / 40 for step in range(41)]


_THIN = 'fill="none" stroke="currentColor" stroke-width="1.2"'
_DASHED = f'{_THIN} stroke-dasharray="5 4"'
_ARC = 'fill="none" stroke="#d55e00" stroke-width="2"'
_DISK = 'fill="#0072b2" fill-opacity="0.22" stroke="#0072b2" stroke-width="2"'
_TABLE = 'fill="currentColor" fill-opacity="0.07" stroke="none"'


def sketch() -> str:
    """The disk on the table with centre, centre of gravity, contact point and angles, as SVG."""
    centre = _in_disk(0.0, 0.0)
    foot: Point = (0.0, centre[1], 0.0)
    parts = [
        _path([(-1.3, -0.8, 0.0), (1.5, -0.8, 0.0), (1.5, 1.3, 0.0), (-1.3, 1.3, 0.0)], _TABLE,
              close=True),
        _path([_in_disk(angle) for angle in _turn(0.0, 2 * pi)], _DISK, close=True),
        _path([centre, _in_disk(0.0, 1.35)], _THIN),
        _text(_in_disk(0.0, 1.35), "e<tspan dy=\"3\">x</tspan>", (4.0, 4.0)),
        _path([centre, _in_disk(_GAMMA, 1.2)], _DASHED),
        _path([_in_disk(angle, 0.42) for angle in _turn(0.0, _GAMMA)], _ARC),
        _text(_in_disk(0.5 * _GAMMA, 0.46), "γ", (2.0, 4.0)),
        # Inclination: between the table and the line from the contact point to the centre.
        _path([(0.0, 0.0, 0.0), (0.0, 1.2, 0.0)], _DASHED),
        _path([(0.0, 0.0, 0.0), centre], _DASHED),
        _path([(0.0, 0.55 * cos(a), 0.55 * sin(a)) for a in _turn(0.0, _BETA)], _ARC),
        _text((0.0, 0.6 * cos(0.4 * _BETA), 0.6 * sin(0.4 * _BETA)), "β", (3.0, 4.0)),
        # Spin: about the vertical through the centre.
        _path([foot, (0.0, centre[1], 2.1)], _DASHED),
        _path([(0.2 * cos(a), centre[1] + 0.2 * sin(a), 1.95) for a in _turn(-1.0, 4.0)], _ARC),
        _text((0.0, centre[1], 1.95), "α", (26.0, 2.0)),
        _dot(centre),
        _text(centre, "G", (-17.0, -4.0)),
        _dot(_in_disk(_GAMMA, 0.62), 4.5),
        _text(_in_disk(_GAMMA, 0.62), "S", (7.0, 0.0)),
        _dot((0.0, 0.0, 0.0)),
        _text((0.0, 0.0, 0.0), "C", (-16.0, 10.0)),
    ]  # fmt: skip
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 300" role="img" '
        'font-family="system-ui, sans-serif" font-size="15" fill="currentColor" '
        'aria-label="Disk on a table with its angles">' + "".join(parts) + "</svg>"
    )
