"""Eigenvalues of the stationary motions: engine against in-house."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, linear_sum_assignment

import analysis
import mbs_models
from analysis import STEEL_DISK, Disk, FrictionLaw, Level, SmoothCoulomb
from analysis.data.checks import Array
from analysis.stability import spectra
from mbs_models import Formulation, Motion
from validation.kit.tables import Table

ComplexArray = npt.NDArray[np.complex128]

EIGENVALUE_LIMIT = 1e-5
"""Largest difference that passes, relative to the larger of |lambda| and 1."""

CHECKED_SPINS = np.linspace(0.0, 60.0, 25)
"""Spins of the comparison in rad/s."""

SYSTEM_OF_LEVEL: dict[Level, spectra.System] = {
    1: "full",
    2: "model2",
    3: "reduced",
    4: "reduced",
}
"""In-house system with the eigenvalues of each model."""

LEVEL_OF_SYSTEM: dict[spectra.System, Level] = {
    "full": 1,
    "reduced": 4,
    "model1": 1,
    "model2": 2,
    "model3": 3,
    "model4": 4,
}
"""Model of the engine with the eigenvalues of each in-house system."""

Case = tuple[Level, Formulation]


def cases() -> list[Case]:
    """Every level and formulation."""
    return [
        (level, formulation)
        for level in analysis.LEVELS
        for formulation in mbs_models.formulations(level)
    ]


def engine_matrices(
    level: Level,
    spins: Array,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
    disk: Disk = STEEL_DISK,
    friction: FrictionLaw | None = None,
) -> Array:
    """State matrices of the engine over the spin, shape (n, k, k): `mbs_models.state_matrix`."""
    return np.array(
        [
            mbs_models.state_matrix(
                mbs_models.stationary_scene(
                    level,
                    spin,
                    motion=motion,
                    formulation=formulation,
                    disk=disk,
                    friction=friction,
                )
            )
            for spin in spins.tolist()
        ]
    )


def distance(found: ComplexArray, expected: ComplexArray) -> float:
    """Largest difference of two sets of as many eigenvalues, matched for the smallest sum.

    Relative to the larger of |lambda| and 1.
    """
    gaps = np.abs(found[:, None] - expected) / np.maximum(np.abs(expected), 1.0)
    rows, columns = linear_sum_assignment(gaps)
    return float(np.max(gaps[rows, columns]))


@dataclass(frozen=True, slots=True, kw_only=True)
class EigenvalueCheck:
    """Largest difference of engine and in-house eigenvalues over the spins, for both motions.

    `stock` is that of the engine's own eigenvalue function, where it has as many eigenvalues.
    """

    case: Case
    inverted: float
    noninverted: float
    stock: float | None

    @property
    def passed(self) -> bool:
        """Whether both motions stay below `EIGENVALUE_LIMIT`."""
        return max(self.inverted, self.noninverted) <= EIGENVALUE_LIMIT


def check_eigenvalues(case: Case) -> EigenvalueCheck:
    """Compare the eigenvalues of one level and formulation at all spins and both motions."""
    level, formulation = case
    friction = SmoothCoulomb()
    worst: dict[Motion, float] = {}
    stock: list[float] = []
    for motion in mbs_models.MOTIONS:
        expected = spectra.eigenvalues(
            SYSTEM_OF_LEVEL[level], STEEL_DISK, friction, CHECKED_SPINS, motion
        )
        found = np.linalg.eigvals(
            engine_matrices(level, CHECKED_SPINS, formulation=formulation, motion=motion)
        )
        worst[motion] = max(distance(f, e) for f, e in zip(found, expected, strict=True))
        for spin, right in zip(CHECKED_SPINS.tolist(), expected, strict=True):
            own = mbs_models.stock_eigenvalues(
                mbs_models.stationary_scene(level, spin, motion=motion, formulation=formulation)
            )
            if own.size == right.size:
                stock.append(distance(own, right))
    return EigenvalueCheck(
        case=case,
        inverted=worst["inverted"],
        noninverted=worst["noninverted"],
        stock=max(stock) if len(stock) == 2 * CHECKED_SPINS.size else None,
    )


def table(checks: list[EigenvalueCheck]) -> Table:
    """Table of eigenvalue checks."""
    return Table(
        name="eigenvalues",
        title=f"Eigenvalues, engine against in-house, at {CHECKED_SPINS.size} spins from 0 to "
        "60 rad/s: largest difference relative to max(|λ|, 1)",
        columns=(
            "model",
            "formulation",
            "inverted",
            "noninverted",
            f"at most {EIGENVALUE_LIMIT:g}",
            "engine's own ComputeODE2Eigenvalues",
        ),
        rows=[
            [
                *check.case,
                check.inverted,
                check.noninverted,
                check.passed,
                "other number of eigenvalues" if check.stock is None else check.stock,
            ]
            for check in checks
        ],
        note="The engine's accelerations are differentiated along the constraint manifold; the "
        "neutral directions (the angle α and its rate) are left out. The engine's own function is "
        "right for the contact tree, which has no constraints.",
    )


def stock_table(spin: float = 30.0) -> Table:
    """What the engine's own constrained eigenvalues say at one spin, and what is right."""
    rows = []
    for level, formulation in cases():
        scene = mbs_models.stationary_scene(level, spin, formulation=formulation)
        right = mbs_models.eigenvalues(scene)
        stock = mbs_models.stock_eigenvalues(scene)
        nearest = np.min(np.abs(stock[:, None] - right), axis=0) / np.maximum(np.abs(right), 1.0)
        rows.append(
            [
                level,
                formulation,
                right.size,
                stock.size,
                float(np.max(right.real)),
                float(np.max(stock.real)),
                float(np.max(nearest)),
            ]
        )
    return Table(
        name="stock-eigenvalues",
        title=f"The engine's own ComputeODE2Eigenvalues at {spin:g} rad/s, inverted",
        columns=(
            "model",
            "formulation",
            "eigenvalues",
            "its eigenvalues",
            "largest real part in 1/s",
            "its largest real part",
            "worst relative distance of a right eigenvalue to its nearest one",
        ),
        rows=rows,
        note="With constraints it linearises the applied forces and projects them into the null "
        "space of the constraint Jacobian. The constraint forces turn with the disk, and that "
        "stiffness (m g r of the contact force among it) is left out; nonholonomic constraints "
        "are not covered, as its documentation says. Compare the two columns of largest real "
        "parts: right for the contact tree, which has no constraints, and wrong wherever there "
        "is one.",
    )


def engine_critical_spin(level: Level, low: float, high: float, frequency: float) -> float:
    """Spin between two bounds at which an engine eigenvalue crosses the imaginary axis in rad/s.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    low, high : float
        Bounds between which the real part changes its sign once.
    frequency : float
        Approximate imaginary part there in rad/s, which picks the eigenvalue.
    """

    def real_part(spin: float) -> float:
        values = mbs_models.eigenvalues(mbs_models.stationary_scene(level, spin))
        return float(values[np.argmin(np.abs(values.imag - frequency))].real)

    return float(brentq(real_part, low, high, xtol=1e-9))
