"""The axes of the study: along each, motions become extreme in one respect."""

from collections.abc import Iterator
from dataclasses import replace
from math import pi, radians, sqrt

from analysis import (
    MODELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    Disk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from validation.studies.robustness import ended
from validation.studies.robustness.cases import HardProblem

QUICK: dict[str, tuple[str, ...]] = {
    "smoothing ε in m/s": ("1", "1e-2"),
    "contact stiffness in N/m": ("1e4",),
    "start above the table": ("5 mm, undamped",),
    "spin in rad/s": ("0", "-40"),
    "contact load: spin, μ": ("200 rad/s, 0.3",),
    "tilt β in rad": ("π − 0.01",),
    "eccentricity in m": ("1e-9",),
    "inertia about the COG": ("lamina",),
    "radius of the disk in m": ("0.001",),
    "friction μ": ("0",),
    "start": ("inverted, below critical spin",),
    "sampling, duration": ("2 samples, 0.5 s", "2 samples, rolling fast"),
    "inclination of the table": ("2°",),
    "constraint set": (
        "contact + no-slip-along",
        "contact + no-slip-along + no-slip-across",
        "contact + fixed-cog + constant-spin",
    ),
    ended.AXIS: ended.QUICK,
}
"""Labels of the sample of each axis that the quick version runs, in Model 1 or none of them."""


def problems(*, quick: bool) -> list[HardProblem]:
    """All problems, or the sample `QUICK` of them."""
    found: list[HardProblem] = []
    for constraints in MODELS.values():
        base = Scenario(constraints=constraints)
        found += _smoothing(base)
        found += [*_stiffness(base), *_drops(base)] if base.model == 1 else ()
        found += _spin(base)
        found += _contact_load(base)
        found += _tilt(base)
        found += _eccentricity(base)
        found += _inertia(base)
        found += [scaled(base, size) for size in (1e-3, 10.0)]
        found += _friction(base)
        found += _rest(base)
        found += _sampling(base)
        found += _long(base)
        found += _inclination(base)
    found += [*_constraint_sets(), *ended.problems()]
    if quick:
        return [
            each
            for each in found
            if each.scenario.model in {1, None} and each.label in QUICK[each.axis]
        ]
    return found


def _smoothing(base: Scenario) -> Iterator[HardProblem]:
    for digits in (0, 2, 3, 4, 5, 6, 8) if base.model == 1 else (0, 2, 3, 4, 5, 8):
        yield HardProblem(
            axis="smoothing ε in m/s",
            label=f"1e-{digits}" if digits else "1",
            scenario=replace(base, friction=SmoothCoulomb(smoothing=10.0**-digits)),
            cover="all" if digits < 3 else "first",
        )


def _stiffness(base: Scenario) -> Iterator[HardProblem]:
    for digits in (4, 6, 9):
        contact = PenaltyContact.damped(10.0**digits, base.disk)
        yield HardProblem(
            axis="contact stiffness in N/m",
            label=f"1e{digits}",
            scenario=replace(base, friction=SmoothCoulomb(load="contact"), contact=contact),
            cover="all",
        )


def _drops(base: Scenario) -> Iterator[HardProblem]:
    undamped, damped = PenaltyContact(stiffness=1e5), PenaltyContact.damped(1e5, base.disk)
    for height, contact, label in (
        (1e-3, undamped, "1 mm, undamped"),
        (5e-3, undamped, "5 mm, undamped"),
        (1e-3, damped, "1 mm, damped"),
        (5e-3, damped, "5 mm, damped"),
    ):
        yield HardProblem(
            axis="start above the table",
            label=label,
            scenario=replace(
                base,
                friction=SmoothCoulomb(load="contact"),
                contact=contact,
                start=Start(height=height),
            ),
            end=0.1,
        )


def _spin(base: Scenario) -> Iterator[HardProblem]:
    for spin in (0.0, 100.0, 300.0, 1000.0, -40.0):
        yield HardProblem(
            axis="spin in rad/s",
            label=f"{spin:g}",
            scenario=replace(base, start=Start(spin=spin)),
            end=0.05 if spin == 1000.0 else 0.5,
            cover="all" if spin == 100.0 else "first",
        )


def _contact_load(base: Scenario) -> Iterator[HardProblem]:
    """Friction by the contact force; the fast ones end where the contact would pull."""
    for spin, coefficient in ((100, 0.3), (200, 0.3), (300, 0.3), (40, 2), (40, 3), (300, 3)):
        yield HardProblem(
            axis="contact load: spin, μ",
            label=f"{spin:g} rad/s, {coefficient:g}",
            scenario=replace(
                base,
                friction=SmoothCoulomb(coefficient=coefficient, load="contact"),
                start=Start(spin=spin),
            ),
            cover="all" if spin == 200 or coefficient == 3 else "first",
        )


def _tilt(base: Scenario) -> Iterator[HardProblem]:
    for beta, label, end, samples in (
        (1e-4, "1e-4", 4e-4, 101),
        (0.01, "0.01", 4e-3, 101),
        (pi - 0.01, "π − 0.01", 4e-3, 101),
        *([(1e-4, "1e-4, beyond the fall", 0.1, 11)] if base.model == 1 else []),
    ):
        yield HardProblem(
            axis="tilt β in rad",
            label=label,
            scenario=replace(base, start=Start(beta=beta)),
            end=end,
            samples=samples,
        )


def body(moments: tuple[float, float, float], eccentricity: float) -> Disk:
    """The steel disk with other moments about the COG, and the COG elsewhere.

    Parameters
    ----------
    moments : tuple of 3 floats
        About the COG in kg m², so that a rigid body exists for every eccentricity.
    eccentricity : float
        In m.
    """
    disk = STEEL_DISK
    shift = disk.mass * eccentricity**2
    a, b, c = moments
    return replace(
        disk, eccentricity=eccentricity, inertia_x=a, inertia_y=b + shift, inertia_z=c + shift
    )


def _eccentricity(base: Scenario) -> Iterator[HardProblem]:
    radius = base.disk.radius
    for value, label in ((0.0, "0"), (1e-9, "1e-9"), (0.99 * radius, "0.99 r")):
        disk = body(base.disk.inertia_about_cog, value)
        yield HardProblem(
            axis="eccentricity in m",
            label=label,
            scenario=replace(base, disk=disk),
            end=0.25,
        )


def _inertia(base: Scenario) -> Iterator[HardProblem]:
    """Flat bodies, in which one moment is the sum of the others, and rods, in which one is none.

    A rod of no moment at all is no rigid body: one in a thousand is left.
    """
    e, r = base.disk.eccentricity, base.disk.radius
    for label, parts, eccentricity in (
        ("lamina", (0.25, 0.25, 0.5), 0.0),
        ("lamina, COG at 0.9 r", (0.25, 0.25, 0.5), 0.9 * r),
        ("flat across x", (0.5, 0.25, 0.25), e),
        ("flat across y", (0.25, 0.5, 0.25), e),
        ("rod along x", (3e-4, 0.3, 0.3), e),
        ("rod along y", (0.3, 3e-4, 0.3), e),
        ("rod along z", (0.3, 0.3, 3e-4), e),
    ):
        a, b, c = (part * base.disk.mass * r**2 for part in parts)
        disk = body((a, b, c), eccentricity)
        yield HardProblem(
            axis="inertia about the COG",
            label=label,
            scenario=replace(base, disk=disk),
            end=0.25,
        )


def scaled(base: Scenario, radius: float) -> HardProblem:
    """Table 3 for a steel disk of another size, at the same Froude number.

    Lengths are scaled by s, times by the root of s, speeds and smoothing likewise, so that the
    angles of the motion are those of the original.
    """
    scale = radius / STEEL_DISK.radius
    disk = Disk.ring(
        radius=radius,
        hole_radius=0.015 * scale,
        hole_distance=0.02 * scale,
        thickness=0.01 * scale,
        density=7700.0,
    )
    return HardProblem(
        axis="radius of the disk in m",
        label=f"{radius:g}",
        scenario=replace(
            base,
            disk=disk,
            friction=SmoothCoulomb(smoothing=0.1 * sqrt(scale)),
            start=Start(spin=40.0 / sqrt(scale)),
        ),
        end=0.5 * sqrt(scale),
        cover="all" if scale < 1.0 else "first",
    )


def _friction(base: Scenario) -> Iterator[HardProblem]:
    for coefficient in (0.0, 10.0):
        yield HardProblem(
            axis="friction μ",
            label=f"{coefficient:g}",
            scenario=replace(base, friction=SmoothCoulomb(coefficient=coefficient)),
        )


def _rest(base: Scenario) -> Iterator[HardProblem]:
    for label, gamma, spin in (
        ("at rest", -pi / 2 + 0.1, 0.0),
        ("at rest, COG above", pi / 2, 0.0),
        ("noninverted spinning", -pi / 2, 40.0),
        ("inverted, below critical spin", pi / 2, 20.0),
    ):
        yield HardProblem(
            axis="start",
            label=label,
            scenario=replace(base, start=Start(gamma=gamma, spin=spin)),
        )


def _sampling(base: Scenario) -> Iterator[HardProblem]:
    for samples, end in ((2, 0.5), (3, 2.0)):
        yield HardProblem(
            axis="sampling, duration",
            label=f"{samples} samples, {end:g} s",
            scenario=base,
            end=end,
            samples=samples,
        )
    yield HardProblem(
        axis="sampling, duration",
        label="2 samples, rolling fast",
        scenario=replace(base, start=Start(beta=1.0, gamma=0.0, spin=50.0)),
        end=0.3,
        samples=2,
    )


def _long(base: Scenario) -> Iterator[HardProblem]:
    """Through inversion and fall; tens of seconds in Model 1, and inverted for longer."""
    for end in (5.0, 10.0, 20.0) if base.model == 1 else (5.0, 10.0):
        yield HardProblem(
            axis="sampling, duration",
            label=f"{end:g} s",
            scenario=base,
            end=end,
            samples=round(100 * end) + 1,
            cover="first" if end == 5.0 else "fastest",
        )
    if base.model != 1:
        return
    yield HardProblem(
        axis="sampling, duration",
        label="50 s, to inverted spinning",
        # With this friction inverted spinning is stable.
        scenario=replace(
            base, friction=SmoothCoulomb(smoothing=0.2), start=Start(gamma=pi / 2 - 0.1)
        ),
        end=50.0,
        samples=5001,
        cover="fastest",
    )


def _inclination(base: Scenario) -> Iterator[HardProblem]:
    for degrees in (2, 30):
        yield HardProblem(
            axis="inclination of the table",
            label=f"{degrees}°",
            scenario=replace(base, table=Table(inclination=radians(degrees), downhill=1.0)),
        )


def _constraint_sets() -> Iterator[HardProblem]:
    """Sets of constraints that are none of the paper's models."""
    for constraints in POSSIBLE_SETS:
        scenario = Scenario(constraints=constraints)
        if scenario.model is None:
            yield HardProblem(axis="constraint set", label=scenario.name, scenario=scenario)
