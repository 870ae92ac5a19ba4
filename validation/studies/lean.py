"""The price of carrying what a scene does not need."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from statistics import median
from typing import NamedTuple

import numpy as np

from analysis import MODELS, Level, Scenario, SmoothCoulomb
from analysis.data.checks import Array
from mbs_models import Formulation, Scene
from mbs_models.ballast import BALLAST, Ballast, six_axes
from mbs_models.integrators import find_integrator
from mbs_models.model import Model
from mbs_models.runs import run
from mbs_models.scene import build
from validation.kit.limits import largest
from validation.kit.timing import in_turns, interval
from validation.page.content import Content, Rows
from validation.study import Row, Study, at_most

TITLE = "Lean scenes"

TREE: Formulation = "euler-tree"
FREE: Formulation = "floating"

DURATION, STEP, SPACING = 0.125, 5e-4, 5e-3
"""Of a run, of its steps and between its samples in s."""

PAIRS = 11
SAME = 1e-9
"""Most that a part which a scene does not need may change of what is sampled, in SI units."""


class Pair(NamedTuple):
    """A scene with and without something that it does not need."""

    part: str
    scene: str
    carried: Callable[[], Model]
    left_out: Callable[[], Model]


def pairs() -> dict[str, Pair]:
    """Idle parts added to scenes, by their names."""
    bare = [scene(1, "contact-tree"), scene(2, TREE), scene(2, FREE)]
    smooth = SmoothCoulomb(coefficient=0.0)
    bare = [replace(each, scenario=replace(each.scenario, friction=smooth)) for each in bare]
    tree, free = scene(2, TREE), scene(2, FREE)
    friction, sensors, *others = BALLAST
    idle = [(friction, each) for each in bare] + [(sensors, each) for each in (tree, free)]
    idle += [(part, free) for part in others]
    made = [_idle(part, BALLAST[part], each) for part, each in idle]
    made.append(_idle("six joint axes where three do", six_axes, tree))
    return {f"{pair.part}: {pair.scene}": pair for pair in made}


def scene(level: Level, formulation: Formulation) -> Scene:
    """A model of the paper."""
    return Scene(Scenario(constraints=MODELS[level]), formulation)


def _idle(part: str, ballast: Ballast, scene: Scene) -> Pair:
    friction = "with" if scene.scenario.rubs else "without"
    name = f"{scene.built_as}, {scene.scenario.name}, {friction} friction"
    return Pair(part, name, partial(_with, scene, ballast), partial(build, scene))


def _with(scene: Scene, ballast: Ballast) -> Model:
    model = build(scene)
    ballast(model)
    return model


def price(pair: Pair) -> list[Row]:
    """Times of the engine's runs with and without a part, in turns, and what the part changes."""
    spent = 0.0
    ends: dict[Callable[[], Model], Array] = {}

    def timed(make: Callable[[], Model]) -> None:
        nonlocal spent
        model = make()
        samples = run(
            model,
            find_integrator(Scene(model.scenario, model.name), None),
            spacing=SPACING,
            intervals=round(DURATION / SPACING),
            substeps=round(SPACING / STEP),
        )
        spent += samples.seconds
        ends[make] = samples.records[-1]

    both = (pair.carried, pair.left_out)
    calls = (partial(timed, make) for make in both)
    carried, left_out = in_turns(*calls, pairs=PAIRS, clock=lambda: spent)
    middle, low, high = interval([a / b for a, b in zip(carried, left_out, strict=True)])
    change = np.max(np.abs(ends[both[0]] - ends[both[1]]))
    return [
        {
            "part": pair.part,
            "scene": pair.scene,
            "carried": 1e3 * median(carried),
            "left out": 1e3 * median(left_out),
            "price": 100.0 * (middle - 1.0),
            "least": 100.0 * (low - 1.0),
            "most": 100.0 * (high - 1.0),
            "change": change,
        }
    ]


PRICES = Study(
    name="lean",
    cases=pairs,
    measure=price,
    timed=("carried", "left out"),
    columns={
        "carried": "median time of a run with the part in ms",
        "left out": "the same without",
        "price": "median of the ratios of pairs less 1 in %",
        "least": "second of the ratios of pairs",
        "most": "last but one",
        "change": "largest of all that is sampled at the end, in SI units",
    },
)


STUDIES = (PRICES,)


def present(rows: Rows) -> Content:
    """Prices of parts."""
    table = rows["lean"]
    headings = {
        "part": "part carried",
        "scene": "scene",
        "carried": "with in ms",
        "left out": "without in ms",
        "price": "price in %",
        "least": "from",
        "most": "to",
    }
    rounded = table.round(dict.fromkeys(("price", "least", "most"), 1))
    change = largest(table["change"])
    idle = (table["least"] <= 0.0) & (table["most"] > 0.0)
    return Content(
        numbers={
            "dear": int((table["least"] > 0.0).sum()),
            "none": int(idle.sum()),
            "number": len(table),
            "dearest": table.loc[table["price"].idxmax()],
            "change": change,
        },
        tables={"prices": rounded[list(headings)].rename(columns=headings)},
        checks=[at_most("lean: what parts that are not needed change of a motion", change, SAME)],
    )
