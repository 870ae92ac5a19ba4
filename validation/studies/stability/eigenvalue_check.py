"""Eigenvalues of the stationary motions: engine against in-house."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, linear_sum_assignment

import mbs_models
from analysis import LEVELS, MODELS, MOTIONS, ConstraintSet, Level, Motion, Scenario, Start
from analysis.data.checks import Array
from analysis.stability import spectra
from mbs_models import Formulation, Scene
from validation.kit.limits import holds, largest
from validation.kit.tables import Table
from validation.studies.stability.tables import stable_range

ComplexArray = npt.NDArray[np.complex128]

EIGENVALUE_LIMIT = 1e-5
"""Largest difference that passes, relative to the larger of |lambda| and 1."""

CHECKED_SPINS = np.linspace(0.0, 60.0, 25)
"""Spins of the comparison in rad/s."""

FEW_SPINS = np.array([0.0, 17.0, 30.0, 60.0])
"""Spins of the comparison over all sets of constraints in rad/s."""

Case = tuple[Level, Formulation]


def cases() -> list[Case]:
    """Every model of the paper and formulation."""
    return [
        (level, formulation)
        for level in LEVELS
        for formulation in mbs_models.formulations(Scenario(constraints=MODELS[level]))
    ]


def spinning(
    scenario: Scenario,
    spin: float,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
) -> Scene:
    """Scene that starts on a stationary motion of a scenario."""
    start = Start.stationary(spin, motion)
    return Scene(scenario=replace(scenario, start=start), formulation=formulation)


def engine_matrices(
    scenario: Scenario,
    spins: Array,
    *,
    formulation: Formulation | None = None,
    motion: Motion = "inverted",
) -> Array:
    """State matrices of the engine over the spin, shape (n, k, k): `mbs_models.state_matrix`."""
    return np.array(
        [
            mbs_models.state_matrix(
                spinning(scenario, spin, formulation=formulation, motion=motion)
            )
            for spin in spins.tolist()
        ]
    )


def worst_difference(
    scenario: Scenario, spins: Array, formulation: Formulation, motion: Motion
) -> float:
    """Largest difference of engine and in-house eigenvalues over the spins; see `distance`."""
    expected = spectra.eigenvalues(scenario, spins, motion=motion)
    found = np.linalg.eigvals(
        engine_matrices(scenario, spins, formulation=formulation, motion=motion)
    )
    return largest(distance(f, e) for f, e in zip(found, expected, strict=True))


def distance(found: ComplexArray, expected: ComplexArray) -> float:
    """Largest difference of two sets of eigenvalues, matched for the smallest sum.

    Relative to the larger of |lambda| and 1; infinite if there are none, not as many in both, or
    one is no number.
    """
    if found.shape != expected.shape or not np.all(np.isfinite([found, expected])):
        return np.inf
    gaps = np.abs(found[:, None] - expected) / np.maximum(np.abs(expected), 1.0)
    rows, columns = linear_sum_assignment(gaps)
    return largest(gaps[rows, columns].tolist())


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
        return holds(largest((self.inverted, self.noninverted)), EIGENVALUE_LIMIT)


def check_eigenvalues(case: Case) -> EigenvalueCheck:
    """Compare the eigenvalues of one model and formulation at all spins and both motions."""
    level, formulation = case
    scenario = Scenario(constraints=MODELS[level])
    worst: dict[Motion, float] = {}
    stock: list[float] = []
    for motion in MOTIONS:
        worst[motion] = worst_difference(scenario, CHECKED_SPINS, formulation, motion)
        expected = spectra.eigenvalues(scenario, CHECKED_SPINS, motion=motion)
        for spin, right in zip(CHECKED_SPINS.tolist(), expected, strict=True):
            own = mbs_models.stock_eigenvalues(
                spinning(scenario, spin, formulation=formulation, motion=motion)
            )
            if own.size == right.size:
                stock.append(distance(own, right))
    return EigenvalueCheck(
        case=case,
        inverted=worst["inverted"],
        noninverted=worst["noninverted"],
        stock=largest(stock) if len(stock) == 2 * CHECKED_SPINS.size else None,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SetCheck:
    """What one set of constraints makes of inverted spinning, and whether both sides say so.

    `difference` is the largest one of engine and in-house eigenvalues over all formulations, both
    motions and `FEW_SPINS`.
    """

    name: str
    formulations: int
    eigenvalues: int
    stable: str
    difference: float

    @property
    def passed(self) -> bool:
        """Whether all stay below `EIGENVALUE_LIMIT`."""
        return holds(self.difference, EIGENVALUE_LIMIT)


def check_set(constraints: ConstraintSet) -> SetCheck:
    """Compare the eigenvalues of one set of constraints in every formulation."""
    scenario = Scenario(constraints=constraints)
    formulations = mbs_models.formulations(scenario)
    return SetCheck(
        name=scenario.name,
        formulations=len(formulations),
        eigenvalues=spectra.eigenvalues(scenario, [0.0]).size,
        stable=stable_range(scenario, (0.0, 60.0)),
        difference=largest(
            worst_difference(scenario, FEW_SPINS, formulation, motion)
            for formulation in formulations
            for motion in MOTIONS
        ),
    )


def sets_table(checks: list[SetCheck]) -> Table:
    """Table of the checks of all sets of constraints."""
    return Table.of(
        checks,
        {
            "constraints": lambda check: check.name,
            "eigenvalues": lambda check: check.eigenvalues,
            "stable spins from 0 to 60 rad/s": lambda check: check.stable,
            "formulations": lambda check: check.formulations,
            "engine against in-house": lambda check: check.difference,
            f"at most {EIGENVALUE_LIMIT:g}": lambda check: check.passed,
        },
        name="eigenvalues-of-sets",
        title="Inverted spinning under every possible set of constraints",
        worst="engine against in-house",
        note="In-house, the index-1 system is linearised along the constraint manifold without "
        "coordinates of its own. The difference is the largest one relative to max(|λ|, 1) over "
        f"all formulations, both motions and {FEW_SPINS.size} spins. Holding the spin changes no "
        "eigenvalue, and without any slip nothing damps.",
    )


def table(checks: list[EigenvalueCheck]) -> Table:
    """Table of eigenvalue checks."""
    return Table.of(
        checks,
        {
            "model": lambda check: check.case[0],
            "formulation": lambda check: check.case[1],
            "inverted": lambda check: check.inverted,
            "noninverted": lambda check: check.noninverted,
            f"at most {EIGENVALUE_LIMIT:g}": lambda check: check.passed,
            "engine's own ComputeODE2Eigenvalues": lambda check: (
                "other number of eigenvalues" if check.stock is None else check.stock
            ),
        },
        name="eigenvalues",
        title=f"Eigenvalues, engine against in-house, at {CHECKED_SPINS.size} spins from 0 to "
        "60 rad/s: largest difference relative to max(|λ|, 1)",
        worst="inverted",
        note="The engine's accelerations are differentiated along the constraint manifold; the "
        "neutral directions (the angle α and its rate) are left out. The engine's own function is "
        "right for the contact tree, which has no constraints.",
    )


def stock_table(spin: float = 30.0) -> Table:
    """What the engine's own constrained eigenvalues say at one spin, and what is right."""
    rows = []
    for level, formulation in cases():
        scene = spinning(Scenario(constraints=MODELS[level]), spin, formulation=formulation)
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
    scenario = Scenario(constraints=MODELS[level])

    def real_part(spin: float) -> float:
        values = mbs_models.eigenvalues(spinning(scenario, spin))
        return float(values[np.argmin(np.abs(values.imag - frequency))].real)

    return float(brentq(real_part, low, high, xtol=1e-9))
