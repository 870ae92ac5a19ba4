"""The numbers that the paper prints beside ours, and its misprints."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy.optimize import brentq

import mbs_models
from analysis import (
    GRAVITY,
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Level,
    Scenario,
    SmoothCoulomb,
)
from analysis.mechanics import paper
from analysis.stability.printed import (
    critical_speed,
    first_order,
    paper_numbers,
    printed_matrices,
    reduced_matrices,
)
from validation.page.content import Content, Rows, Verdict
from validation.run import run
from validation.studies.comparisons import random_state
from validation.studies.stability import measured
from validation.studies.stability.eigenvalue_check import ComplexArray, spinning
from validation.studies.stability.measured import rounds_to
from validation.studies.stability.variants import MATRIX_CHANGES
from validation.study import Check, Row, Study, at_most, equal

TITLE = "The numbers the paper prints"

HERE, TABLE_1 = "unrounded disk", "Table 1"
"""Columns with what is computed from either disk."""

APART = 1e-6
"""Largest relative difference of the engine's numbers, and part of what a misprint leaves over
that may be left when it is corrected."""

THIRD = "largest Re λ₃ from 0 to 50 rad/s"

DISK = {
    "mass m": ("mass", "0.435 kg"),
    "eccentricity e": ("eccentricity", "2.5e-3 m"),
    "A": ("inertia_x", "0.249e-3 kg m²"),
    "B": ("inertia_y", "0.227e-3 kg m²"),
    "C": ("inertia_z", "0.468e-3 kg m²"),
}
"""Table 1: fields of a disk and what is printed."""

_, COMPUTED, FREQUENCY, BORN, LIMIT, LOWER, UPPER, *RUBBING = measured.IN_PAPER

WHY = {
    FREQUENCY: "misprint: its own formula i √c gives what is found here",
    LOWER: "not found; see the variants tried in the section on stability",
    UPPER: "not found; see the variants tried in the section on stability",
    RUBBING[0]: "printed for no smoothing; that of Section 2.2 gives another",
    RUBBING[1]: "printed for no smoothing; that of Section 2.2 gives another",
    RUBBING[3]: "cut after its second digit",
}
"""Numbers that do not come out to the printed digits, and why."""


# --- The engine's numbers -----------------------------------------------------------------------


def _spectrum(level: Level, spin: float, smoothing: float = 0.1) -> ComplexArray:
    """Eigenvalues of inverted spinning in the engine, by their real parts."""
    friction = SmoothCoulomb(smoothing=smoothing)
    scene = spinning(Scenario(constraints=MODELS[level], friction=friction), spin)
    return np.sort_complex(mbs_models.eigenvalues(scene))


def _pair_gap(spin: float) -> float:
    """Square of the difference of the reduced system's slow eigenvalues: negative for a pair."""
    _, one, other = _spectrum(4, spin)
    return float(((one - other) ** 2).real)


def engine_numbers(_: Any) -> list[Row]:
    """Numbers of Sections 3 and 6 from the engine's eigenvalues, and the bound of λ₃."""
    spins = np.linspace(0.0, 50.0, 26)
    critical = critical_speed(Scenario(constraints=MODELS[4])).spin
    # The error of the limit is of the order of the squared smoothing.
    coarse, fine = (
        float(_spectrum(4, measured.SPIN, each)[0].real) * each / 0.1 for each in (1e-2, 1e-3)
    )
    found = {
        FREQUENCY: float(np.max(_spectrum(4, critical).imag)),
        BORN: float(brentq(_pair_gap, 10.0, 15.0, xtol=1e-9)),
        LIMIT: (100.0 * fine - coarse) / 99.0,
    }
    for names, smoothing in ((RUBBING[:2], 0.1), (RUBBING[2:], 0.01)):
        eighth, seventh = _spectrum(1, measured.SPIN, smoothing)[:2].real.tolist()
        found |= dict(zip(names, (seventh, eighth), strict=True))
    third = reduced_matrices(Scenario(constraints=MODELS[4]), spins)
    here = float(np.max(np.min(np.linalg.eigvals(third).real, axis=1)))
    engine = max(float(_spectrum(4, spin)[0].real) for spin in spins.tolist())
    rows: list[Row] = [{"quantity": name, "engine": value} for name, value in found.items()]
    return [*rows, {"quantity": THIRD, "engine": engine, HERE: here}]


# --- Misprints ----------------------------------------------------------------------------------


def misprints(_: Any) -> list[Row]:
    """What each misprinted equation leaves over, as printed and as corrected."""
    return [
        {
            "place": place,
            "printed": printed,
            "right": right,
            "measured by": how,
            **dict(zip(("as printed", "corrected"), map(float, left_over()), strict=True)),
        }
        for place, (printed, right, how, left_over) in PLACES.items()
    ]


def _sizes(left_over: Iterable[npt.ArrayLike]) -> tuple[float, float]:
    """Largest numbers of what is left over as printed and as corrected."""
    one, other = (float(np.max(np.abs(each))) for each in left_over)
    return one, other


def _linear_friction() -> tuple[float, float]:
    scenario, spin = Scenario(), np.array([40.0])
    right = printed_matrices(paper_numbers(scenario))
    printed = MATRIX_CHANGES["(53) and (54) with the printed signs"](right)
    force = scenario.friction.gradient * scenario.weight
    engine = mbs_models.state_matrix(spinning(scenario, *spin))
    systems = (first_order(each, spin, force)[0] for each in (printed, right))
    largest = np.max(np.abs(engine))
    return _sizes((each - engine) / largest for each in systems)


def _contact_rate() -> tuple[float, float]:
    state = random_state(Scenario(), np.random.default_rng(1))
    r, beta, beta_rate = STEEL_DISK.radius, state.coordinates[4], state.rates[4]
    second = mbs_models.acceleration(Scenario(), state)[0]
    common = second[2] + r * beta_rate**2 * np.sin(beta)
    return _sizes(common - r * each * np.cos(beta) for each in (beta_rate**2, second[4]))


def _frame() -> tuple[float, float]:
    e_x, e_y, e_z = np.eye(3)
    return _sizes(np.linalg.norm(np.cross(e_z, e_x) - axis) for axis in (e_x, e_y))


def _velocities() -> tuple[float, float]:
    state = random_state(Scenario(constraints=MODELS[4]), np.random.default_rng(1))
    (_, _, _, _, beta, gamma), (_, y_rate, _, spin, beta_rate, _) = state.coordinates, state.rates
    e = STEEL_DISK.eccentricity
    common = y_rate - e * np.sin(beta) * np.sin(gamma) * beta_rate
    known = (np.sin(gamma), np.cos(gamma))
    return _sizes(common - e * spin * np.cos(beta) ** 2 * each for each in known)


def _lost_spin() -> tuple[float, float]:
    scenarios = (Scenario(constraints=MODELS[level]) for level in (3, 4))
    return _sizes(np.diff(run(s, [0.0, 0.5], tolerance=1e-6).rate("alpha")) for s in scenarios)


def _start() -> tuple[float, float]:
    right = Scenario(constraints=MODELS[2]).initial_state.coordinates
    places = ((0.0, 0.0, *right[2:]), right)
    return _sizes(paper.constraint_positions(MODELS[2], STEEL_DISK, each)[1:] for each in places)


PLACES: dict[str, tuple[str, str, str, Callable[[], tuple[float, float]]]] = {
    "(53), (54)": (
        *("D_C, B_C = −d […]", "+d […]", "state matrix, engine, relative"),
        _linear_friction,
    ),
    "(74)": ("−r β̇² cos β", "−r β̈ cos β", "accelerations, engine, in m/s²", _contact_rate),
    "(86)": ("e_x = e_z × e_x", "e_y = e_z × e_x", "axes of the frame", _frame),
    "(97)": ("second entry … sin γ", "… cos γ", "velocities of Model 4 in m/s", _velocities),
    "Table 2": ("constant spin: Model 3", "Model 4", "spin, engine, in rad/s", _lost_spin),
    "Table 3": ("x = 0", "x = −e cos γ", "g_S of (83) in m", _start),
}
"""Misprints: what is printed, what is right, what tells, and how much either leaves over there."""

ENGINE = Study(
    name="printed-numbers-engine", cases=measured.paper, measure=engine_numbers, keys=("quantity",)
)
MISPRINTS = Study(name="misprints", cases=measured.paper, measure=misprints, keys=("place",))
STUDIES = (measured.NUMBERS, ENGINE, MISPRINTS)


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Every printed number with what is computed, and every misprint with what it leaves over."""
    engine = rows[ENGINE.name].set_index("quantity")
    printed = _beside(rows[measured.NUMBERS.name], engine["engine"])
    wrong = rows[MISPRINTS.name].drop(columns="case")
    agree = printed[DIGITS] == "yes"
    critical = critical_speed(Scenario(constraints=MODELS[4])).spin
    return Content(
        numbers={
            "printed": printed.to_dict("records"),
            "agree": int(agree.sum()),
            "sharp": {name: printed.set_index("quantity").loc[name] for name in SHARP},
            "third": engine.loc[THIRD],
            "density": STEEL_DISK.mass / (np.pi * 0.01 * (0.045**2 - 0.015**2)),
            "gravity": [GRAVITY * (each / critical) ** 2 for each in (30.915, 30.925)],
        },
        tables={"printed": printed, "misprints": wrong},
        checks=list(_checks(printed, engine.loc[THIRD], wrong)),
        verdicts=[
            Verdict(
                statement="The numbers that the paper prints come out.",
                answer="yes" if agree.all() else "partly",
                numbers=f"{agree.sum()} of {len(agree)} to the printed digits; the others are "
                f"explained beside them. {len(wrong)} misprints in equations and tables are "
                "corrected.",
                criterion="what is computed from the unrounded disk rounds to what is printed; a "
                "misprint contradicts the engine's accelerations or a constraint.",
                good=bool(agree.all()),
            )
        ],
    )


DIGITS = "to the printed digits"
SHARP = (measured.CLOSED, LIMIT)
"""Numbers with enough digits to tell both disks apart."""


def _beside(found: pd.DataFrame, engine: "pd.Series[float]") -> pd.DataFrame:
    """Printed numbers of Table 1 and of Sections 3 and 6, with what either side computes."""
    disk: list[Row] = [
        {
            "quantity": name,
            "printed": text,
            HERE: getattr(STEEL_DISK, field),
            TABLE_1: getattr(ROUNDED_STEEL_DISK, field),
        }
        for name, (field, text) in DISK.items()
    ]
    known = found.rename(columns={"paper": "printed"}).set_index("quantity")
    known["engine"] = known["engine"].combine_first(engine)
    results = known[["printed", HERE, TABLE_1, "engine"]].reindex(measured.IN_PAPER)
    table = pd.concat([pd.DataFrame(disk), results.reset_index()], ignore_index=True)
    table[DIGITS] = [
        "yes" if rounds_to(row[HERE], row["printed"].split()[0]) else "no"
        for row in table.to_dict("records")
    ]
    return table.assign(why=table["quantity"].map(WHY).fillna(""))


def _checks(
    printed: pd.DataFrame, third: "pd.Series[float]", wrong: pd.DataFrame
) -> Iterator[Check]:
    """Whether what is not explained comes out on both sides, and corrections leave nothing over.

    Of λ₃ Section 6 says that it stays below -100 1/s.
    """
    for row in printed.to_dict("records"):
        name = f"numbers: {row['quantity']}"
        yield equal(f"{name}, {DIGITS}", row[DIGITS], "no" if row["why"] else "yes")
        if row["quantity"] in measured.IN_PAPER and row["quantity"] != measured.CLOSED:
            apart = abs(row["engine"] - row[HERE]) / abs(row[HERE])
            yield at_most(f"{name}, engine", apart, APART)
    for side in third.index[1:]:
        yield at_most(f"numbers: {THIRD}, {side}", third[side], -100.0)
    yield equal("misprints: corrected", len(wrong), len(PLACES))
    for row in wrong.to_dict("records"):
        name = f"misprint {row['place']}: left over when corrected"
        yield at_most(name, row["corrected"], APART * row["as printed"])
