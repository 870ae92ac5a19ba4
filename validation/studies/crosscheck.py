"""Engine against in-house equations: the paper's models, all sets of constraints, other bodies."""

from collections.abc import Iterator
from itertools import product
from math import inf, pi
from typing import Any

import numpy as np
import pandas as pd

from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    Disk,
    EllipticDisk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Sphere,
    Start,
)
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES, Source
from mbs_models import Scene, formulations
from validation.comparison.limits import largest
from validation.run import run_to_rest
from validation.studies import comparisons
from validation.study import Check, Content, Row, Rows, Study, at_most, equal, grade

TITLE = "Engine against in-house equations"

MODELS_OF_PAPER, SETS, OTHERS = "the paper's models", "sets of constraints", "other bodies"


STATES = {MODELS_OF_PAPER: 250, SETS: 50, OTHERS: 50}
"""Random states of each scene."""

TOP = Sphere(
    radius=0.02,
    mass=0.02,
    eccentricity=0.003,
    inertia_x=3.0e-6,
    inertia_y=2.98e-6,
    inertia_z=2.98e-6,
)
"""A tippe top: a sphere with its centre of gravity off its middle."""

COMPOSED = Disk.of_parts(
    (0.045, 0.01, 7700.0),
    holes=[(-0.02, 0.0, 0.012), (0.01, 0.02, 0.005)],
    masses=[(0.0, 0.03, 0.02)],
)
"""A disk whose centre of gravity does not lie on a principal axis."""

ELLIPSE = EllipticDisk(
    radius=0.045,
    other_radius=0.035,
    mass=0.4,
    eccentricity=0.003,
    inertia_x=2.2e-4,
    inertia_y=2.1e-4,
    inertia_z=4.0e-4,
)

SPUN = Scenario(
    disk=TOP,
    friction=SmoothCoulomb(smoothing=0.01, load="contact"),
    contact=PenaltyContact.rounded(TOP, stiffness=1e4),
    start=Start(beta=pi / 2, gamma=-pi / 2 + 0.1, spin=150.0),
)
"""The tippe top, spun about its axis with the centre of gravity low, a little aslant."""

TURNED = 1e-7
"""By how much in s the times may differ at which the tippe top has turned over,"""

KEPT = 1e-9
"""and Jellett's constant from its first value, relative."""


def cases() -> dict[str, tuple[str, Scenario]]:
    """The paper's models on either load, every possible set of constraints, and other bodies.

    Each with what it is one of, as in `STATES`.
    """
    found = {}
    for load, level in product(LOADS, LEVELS):
        scenario = Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))
        found[f"Model {level}, load {load}"] = MODELS_OF_PAPER, scenario
    spring = PenaltyContact.damped(1e5, ELLIPSE)
    return {
        **found,
        **{" + ".join(each): (SETS, Scenario(constraints=each)) for each in POSSIBLE_SETS},
        "composed disk": (OTHERS, Scenario(disk=COMPOSED)),
        "sphere": (OTHERS, Scenario(disk=TOP)),
        "ellipse": (OTHERS, Scenario(disk=ELLIPSE)),
        "ellipse on a spring": (OTHERS, Scenario(disk=ELLIPSE, contact=spring)),
    }


def is_defined(quantity: str, scenario: Scenario) -> bool:
    """Whether it can be compared: spectra, where a body can spin upright on the ideal contact."""
    can_spin = scenario.contact is None and not scenario.disk.has_products
    return can_spin or not quantity.startswith("eigenvalues")


def measure(case: tuple[str, Scenario]) -> Iterator[Row]:
    """All comparisons of a case that are defined."""
    kind, scenario = case
    how: Any = {"states": STATES[kind], "end": None if kind == SETS else comparisons.END}
    for formulation in formulations(scenario):
        for each in comparisons.compare_scene(Scene(scenario, formulation), **how):
            if is_defined(each.quantity, scenario):
                yield {"kind": kind, **each._asdict()}


STUDY = Study(name="crosscheck", cases=cases, measure=measure)


def turn_over(source: Source) -> list[Row]:
    """When `SPUN` has turned over, and how far Jellett's constant has moved meanwhile."""
    step: dict[str, Any] = {"step": 1e-4} if source == "engine" else {}
    motion = run_to_rest(SPUN, 2.4, source=source, stop_when="inverted", **step)
    turned, constant = motion.ending and motion.ending.time, jellett(motion)
    return [{"turned": turned, "jellett": np.max(np.abs(constant / constant[0] - 1.0))}]


def jellett(motion: SpatialMotion) -> Array:
    """Jellett's constant of a sphere that is symmetric about x, in kg m²/s, shape (n,).

    That is the product of the angular momentum L about S and the line from the contact point to S,
    over the radius. Forces at the contact have no moment about the line, and what the turning w of
    the body changes of it counts for nothing, since L (w x e_x) = 0.
    """
    body, rotations = motion.scenario.disk, motion.rotations
    turning = np.einsum("nij,ni->nj", rotations, motion.angular_velocities)
    line = rotations[:, 2] + np.array((body.eccentricity / body.radius, 0.0, 0.0))
    return np.sum(turning * body.inertia_about_cog * line, axis=1)


TIPPE_TOP = Study(
    name="tippe-top", cases=lambda: {source: source for source in SOURCES}, measure=turn_over
)
STUDIES = (STUDY, TIPPE_TOP)


def present(rows: Rows) -> Content:
    """Every comparison with its limit, the paper's models and the sets of constraints apart."""
    found = rows["crosscheck"]
    aggregated: dict[str, Any] = {
        "scenes": ("case", "size"),
        "random states": ("counted", "min"),
        "time in s": ("lasting", "min"),
        "largest": ("difference", largest),
        "at most": ("criterion", "max"),
    }
    worst = found.groupby(["kind", "quantity"], sort=False).agg(**aggregated)
    told = _tippe_top(rows["tippe-top"])
    checks = [*_checks(worst.reset_index(), told)]
    models = worst.loc[MODELS_OF_PAPER]
    parts = {"accelerations": "accelerations|forces", "motions": "motion in", "eigenvalues": "eig"}
    most = {
        name: largest(models.filter(regex=part, axis=0)["largest"]) for name, part in parts.items()
    }
    return Content(
        numbers={
            **most,
            "scenes": int(models["scenes"].max()),
            "answer": grade(yes=all(check.holds for check in checks)),
            **told,
        },
        tables={
            "agreement": worst.reset_index(names=["compared over", "quantity"]),
            "scenes": found.set_index(["case", "formulation", "quantity"])["difference"]
            .unstack(sort=False)
            .reset_index(),
        },
        checks=checks,
    )


def _tippe_top(rows: pd.DataFrame) -> Row:
    """What is told of the tippe top: when it has turned over, and how far both sides agree."""
    turned, moved = rows["turned"], largest(rows["jellett"])
    apart = float(turned.max() - turned.min()) if turned.notna().all() else inf
    return {"turned": turned, "turned_apart": apart, "jellett_moved": moved}


def _checks(worst: pd.DataFrame, told: Row) -> Iterator[Check]:
    """Whether all scenes and states were compared and agree, and the tippe top turns over."""
    for row in worst.to_dict("records"):
        kind, name = row["kind"], f"crosscheck: {row['quantity']}, {row['kind']}"
        yield at_most(name, row["largest"], row["at most"])
        scenes = sum(
            len(formulations(scenario))
            for other, scenario in cases().values()
            if other == kind and is_defined(row["quantity"], scenario)
        )
        yield equal(f"{name}, scenes", row["scenes"], scenes)
        if row["quantity"] == "accelerations":
            states = row["random states"]
            yield equal(f"{name}, states with a solution", states, STATES[kind])
        elif row["quantity"] == comparisons.MOTION:
            yield equal(f"{name}, least time in s", row["time in s"], comparisons.END)
    yield at_most("tippe top: turned over, in s", told["turned_apart"], TURNED)
    yield at_most("tippe top: Jellett's constant", told["jellett_moved"], KEPT)
