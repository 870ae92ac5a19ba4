"""The price of carrying what a scene does not need."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from functools import partial

import numpy as np

from analysis import MODELS, Level, Scenario, SmoothCoulomb
from analysis.problem.checks import Array
from mbs_models import Formulation, Scene
from mbs_models.integrators import find_integrator
from mbs_models.inventory import BALLAST, Ballast
from mbs_models.runs import run
from mbs_models.scene import build
from validation.comparison.limits import largest
from validation.measurement.timing import (  # noqa: F401 # the text names it
    CONFIDENCE,
    in_turns,
    interval,
)
from validation.study import Content, Row, Rows, Study, at_most

TITLE = "Lean scenes"

DURATION, STEP, SPACING = 0.125, 5e-4, 5e-3
"""Of a run, of its steps and between its samples in s."""

PAIRS = 31
SAME = 1e-9
"""Most that a part which a scene does not need may change of what is sampled, in SI units."""


def cases() -> dict[str, tuple[str, Scene]]:
    """Names of parts with scenes that do not need them, by both."""
    bare, tree, free = scene(1, "contact-tree"), scene(2, "euler-tree"), scene(2, "floating")
    smooth = SmoothCoulomb(coefficient=0.0)
    friction, sensors, *others = BALLAST
    idle = [
        (friction, replace(each, scenario=replace(each.scenario, friction=smooth)))
        for each in (bare, tree, free)
    ]
    idle += [(sensors, tree), *((part, free) for part in (sensors, *others))]
    return {f"{part}: {scene_name(each)}": (part, each) for part, each in idle}


def scene(level: Level, formulation: Formulation) -> Scene:
    """A model of the paper."""
    return Scene(Scenario(constraints=MODELS[level]), formulation)


def scene_name(scene: Scene) -> str:
    """Formulation, model and whether anything rubs."""
    friction = "with" if scene.scenario.rubs else "without"
    return f"{scene.built_as}, {scene.scenario.name}, {friction} friction"


def timed(scene: Scene, *parts: Ballast) -> tuple[float, Array]:
    """Processor time in s of a run with some parts added, and the state at its end."""
    count = round(DURATION / SPACING)
    times, steps = np.linspace(0.0, DURATION, count + 1), np.full(count, round(SPACING / STEP))
    with closing(build(scene)) as model:
        for add in parts:
            add(model)
            model.system.Assemble()
        recording = run(model, find_integrator(scene, None), times, steps)
        return recording.seconds, np.hstack(model.decode(recording.records[-1:]))


def price(case: tuple[str, Scene]) -> Iterator[Row]:
    """Times of the engine's runs with and without a part, in turns, and what the part changes."""
    part, scene = case
    runs = in_turns(partial(timed, scene, BALLAST[part]), partial(timed, scene), pairs=PAIRS)
    (carried, there), (left_out, here) = (zip(*same, strict=True) for same in runs)
    ratios = interval([a / b for a, b in zip(carried, left_out, strict=True)])
    price, least, most = (100.0 * (ratio - 1.0) for ratio in ratios)
    yield {
        "part carried": part,
        "scene": scene_name(scene),
        "price in %": price,
        "from": least,
        "to": most,
        "change": np.max(np.abs(there[-1] - here[-1])),
    }


PRICES = Study(name="lean", cases=cases, measure=price, timed=True)
STUDIES = (PRICES,)


def present(rows: Rows) -> Content:
    """Prices of parts."""
    table, change = rows["lean"], largest(rows["lean"]["change"])
    dear = table["from"] > 0.0
    percents = ["price in %", "from", "to"]
    # No -0.
    rounded = table[percents].round(1) + 0.0
    shown = table.drop(columns=["case", "change"]).assign(**rounded)
    return Content(
        numbers={
            "dear": int(dear.sum()),
            "unclear": int((~dear & (table["to"] >= 0.0)).sum()),
            "saving": rounded["price in %"][table["to"] < 0.0],
            "dearest": table.loc[table["price in %"].idxmax()],
            "change": change,
        },
        tables={"prices": shown},
        checks=[at_most("lean: what parts that are not needed change of a motion", change, SAME)],
    )
