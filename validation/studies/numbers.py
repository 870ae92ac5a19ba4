"""The numbers that the paper prints beside ours, and its misprints."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

import mbs_models
from analysis import GRAVITY, MODELS, ROUNDED_STEEL_DISK, STEEL_DISK, Scenario
from analysis.mechanics import paper
from validation.run import run
from validation.studies.comparisons import random_state, spinning
from validation.studies.stability import measured
from validation.studies.stability.measured import CLOSED, ENGINE, HERE, HOPF, LIMIT, THIRD
from validation.studies.stability.variants import MATRIX_CHANGES
from validation.study import Check, Content, Row, Rows, Study, at_most, equal, grade

TITLE = "The numbers the paper prints"

APART = 1e-6
"""Largest relative difference of the engine's numbers, and part of what a misprint leaves over
that may be left when it is corrected."""

DIGITS = "to the printed digits"

DISK = {
    "mass m": ("mass", "0.435 kg"),
    "eccentricity e": ("eccentricity", "2.5e-3 m"),
    "A": ("inertia_x", "0.249e-3 kg m²"),
    "B": ("inertia_y", "0.227e-3 kg m²"),
    "C": ("inertia_z", "0.468e-3 kg m²"),
}
"""Table 1: fields of a disk and what is printed."""

WHY = {
    measured.FREQUENCY: "its own formula i √c gives 6.9 from 29.9 to 30.3 rad/s, not at Ω_crit",
    measured.RUBBING[3]: "cut after its second digit",
    **dict.fromkeys(HOPF, "not found; see the variants in the section on stability"),
    **dict.fromkeys(
        measured.RUBBING[:2], "printed without ε; with that of Section 2.2 it is another"
    ),
}
"""Numbers that do not come out to the printed digits, and why."""


# --- Misprints: what is left over as printed and as corrected -----------------------------------

LeftOver = Iterable[npt.ArrayLike]


def _linear_friction() -> LeftOver:
    scenario, spin = Scenario(), np.array([40.0])
    right = paper.printed_matrices(paper.paper_numbers(scenario))
    printed = MATRIX_CHANGES["(53) and (54) with the printed signs"](right)
    force = scenario.friction.gradient * scenario.weight
    engine = mbs_models.state_matrix(spinning(scenario, *spin))
    systems = (paper.first_order(each, spin, force)[0] for each in (printed, right))
    return ((each - engine) / np.max(np.abs(engine)) for each in systems)


def _remainder() -> LeftOver:
    law, slips = Scenario().friction, np.array([1e-8, 1e-9])
    left = slips * (law.gradient - np.array([law.per_speed(slip) for slip in slips]))
    power = np.log(left[0] / left[1]) / np.log(slips[0] / slips[1])
    return (power - each for each in (3.0, 2.0))


def _contact_rate() -> LeftOver:
    state = random_state(Scenario(), np.random.default_rng(1))
    r, beta, beta_rate = STEEL_DISK.radius, state.coordinates[4], state.rates[4]
    second = mbs_models.acceleration(Scenario(), state)[0]
    common = second[2] + r * beta_rate**2 * np.sin(beta)
    return (common - r * each * np.cos(beta) for each in (beta_rate**2, second[4]))


def _height_rate() -> LeftOver:
    state = random_state(Scenario(), np.random.default_rng(1))
    r, beta, beta_rate = STEEL_DISK.radius, state.coordinates[4] - np.pi / 2, state.rates[4]
    second = mbs_models.acceleration(Scenario(), state)[0]
    common = second[2] + r * second[4] * np.sin(beta)
    return (common + sign * r * beta_rate**2 * np.cos(beta) for sign in (-1.0, 1.0))


def _frame() -> LeftOver:
    e_x, e_y, e_z = np.eye(3)
    return (np.linalg.norm(np.cross(e_z, e_x) - axis) for axis in (e_x, e_y))


def _velocities() -> LeftOver:
    state = random_state(Scenario(constraints=MODELS[4]), np.random.default_rng(1))
    (_, _, _, _, beta, gamma), (_, y_rate, _, spin, beta_rate, _) = state.coordinates, state.rates
    e = STEEL_DISK.eccentricity
    common = y_rate - e * np.sin(beta) * np.sin(gamma) * beta_rate
    known = (np.sin(gamma), np.cos(gamma))
    return (common - e * spin * np.cos(beta) ** 2 * each for each in known)


def _lost_spin() -> LeftOver:
    scenarios = (Scenario(constraints=MODELS[level]) for level in (3, 4))
    return (np.diff(run(each, [0.0, 0.5], tolerance=1e-6).spin) for each in scenarios)


def _start() -> LeftOver:
    right = Scenario(constraints=MODELS[2]).initial_state.coordinates
    places = ((0.0, 0.0, *right[2:]), right)
    return (paper.constraint_positions(MODELS[2], STEEL_DISK, each)[1:] for each in places)


PLACES = {
    "(39)": _height_rate,
    "(41), (42)": _remainder,
    "(53), (54)": _linear_friction,
    "(74)": _contact_rate,
    "(86)": _frame,
    "(97)": _velocities,
    "Table 2": _lost_spin,
    "Table 3": _start,
}


def misprints(_: Any) -> Iterator[Row]:
    """The largest number that is left over at each place."""
    for place, left_over in PLACES.items():
        printed, corrected = (np.max(np.abs(each)) for each in left_over())
        yield {"place": place, "as printed": printed, "corrected": corrected}


MISPRINTS = Study(name="misprints", cases=measured.paper, measure=misprints)
STUDIES = (measured.NUMBERS, MISPRINTS)


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Every printed number with what is computed, and every misprint with what it leaves over."""
    found = rows[measured.NUMBERS.name].drop(columns="case").set_index("quantity")
    wrong = rows[MISPRINTS.name]
    third, critical = found.loc[THIRD, [ENGINE, HERE]], found.at[CLOSED, HERE]
    printed = _beside(found.drop(THIRD))
    # What is printed without a smoothing is tried with two.
    agreed = (printed[DIGITS] == "yes").groupby(printed["quantity"].str.partition(",")[0]).any()
    return Content(
        numbers={
            "total": len(agreed),
            "agree": int(agreed.sum()),
            "unfound": len(HOPF),
            "answer": grade(yes=bool(agreed.all()), partly=True),
            "sharp": printed[printed["quantity"].isin((CLOSED, LIMIT))].to_dict("records"),
            "third": third,
            "left": wrong.set_index("place").to_dict("index"),
            "density": STEEL_DISK.mass / (np.pi * 0.01 * (0.045**2 - 0.015**2)),
            "gravity": [GRAVITY * (each / critical) ** 2 for each in (30.915, 30.925)],
        },
        tables={"printed": printed},
        checks=[*_checks(printed, third, wrong)],
    )


def _beside(found: pd.DataFrame) -> pd.DataFrame:
    """Printed numbers of Table 1 and of Sections 3 and 6, with what either side computes."""
    disks = {HERE: STEEL_DISK, measured.TABLE_1: ROUNDED_STEEL_DISK}
    given: list[Row] = [
        {"quantity": name, "printed": text}
        | {column: getattr(disk, field) for column, disk in disks.items()}
        for name, (field, text) in DISK.items()
    ]
    table = pd.concat([pd.DataFrame(given), found.reset_index()], ignore_index=True)
    right = map(measured.rounds_to, table[HERE], table["printed"])
    table[DIGITS] = ["yes" if each else "no" for each in right]
    return table.assign(**{"why not": table["quantity"].map(WHY).fillna("")})


def _checks(
    printed: pd.DataFrame, third: "pd.Series[float]", wrong: pd.DataFrame
) -> Iterator[Check]:
    """Whether what is not explained comes out on both sides, and corrections leave nothing over.

    Of λ₃ Section 6 says that it stays below -100 1/s.
    """
    for row in printed.to_dict("records"):
        name, is_explained = f"numbers: {row['quantity']}", row["why not"] != ""
        yield equal(f"{name}, {DIGITS}", row[DIGITS], "no" if is_explained else "yes")
        if row["quantity"] not in (*DISK, CLOSED):
            apart = abs(row[ENGINE] - row[HERE]) / abs(row[HERE])
            yield at_most(f"{name}, engine", apart, APART)
    for side in third.index:
        yield at_most(f"numbers: {THIRD}, {side}", third[side], -100.0)
    yield equal("misprints: corrected", len(wrong), len(PLACES))
    for row in wrong.to_dict("records"):
        name = f"misprint {row['place']}: left over when corrected"
        yield at_most(name, row["corrected"], APART * row["as printed"])
