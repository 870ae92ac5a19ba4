"""The price of carrying what a scene does not need, and of starting the programs."""

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from statistics import median

import numpy as np
import pandas as pd

from analysis import MODELS, Scenario, SmoothCoulomb
from analysis.data.checks import Array
from mbs_models import Scene
from mbs_models.ballast import BALLAST, Ballast, six_axes
from mbs_models.integrators import IntegratorName, find_integrator
from mbs_models.model import Model
from mbs_models.runs import run
from mbs_models.scene import build
from validation.kit.limits import largest
from validation.kit.timing import in_turns, interval
from validation.page.content import Content, Rows
from validation.study import Row, Study, at_most

TITLE = "Lean scenes"

SMOOTH = SmoothCoulomb(coefficient=0.0)
MODEL_1, MODEL_2, MODEL_3, MODEL_4 = (Scenario(constraints=each) for each in MODELS.values())
DURATION, STEP, SPACING = 0.25, 5e-4, 5e-3
"""Of a run, of its steps and between its samples in s."""

PAIRS = 11
SAME = 1e-9
"""Most that a part which a scene does not need may change of what is sampled, in SI units."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A scene with and without something; `same` if the motion is that of the same scene."""

    part: str
    scene: str
    carried: Callable[[], Model]
    left_out: Callable[[], Model]
    same: bool
    integrator: IntegratorName | None = None


def pairs() -> dict[str, Pair]:
    """Parts added to scenes, and costlier ways to the same motion or to the next simpler model."""
    bare = [
        Scene(replace(MODEL_1, friction=SMOOTH), "contact-tree"),
        Scene(replace(MODEL_2, friction=SMOOTH), "euler-tree"),
        Scene(replace(MODEL_2, friction=SMOOTH), "floating"),
    ]
    tree, free = Scene(MODEL_2, "euler-tree"), Scene(MODEL_2, "floating")
    friction, sensors, *others = BALLAST
    made = [_ballast(friction, BALLAST[friction], scene) for scene in bare]
    made += [_ballast(sensors, BALLAST[sensors], scene) for scene in (tree, free)]
    made += [_ballast(part, BALLAST[part], free) for part in others]
    made.append(_ballast("six joint axes where three do", six_axes, tree))
    beside: list[tuple[str, str, Scene, Scene]] = [
        (
            "contact as a constraint, not by topology",
            "euler-tree and contact-tree, Model 1",
            Scene(MODEL_1, "euler-tree"),
            Scene(MODEL_1, "contact-tree"),
        ),
        (
            "Euler parameters, not a rotation vector",
            "floating and floating-lie, Model 2",
            free,
            Scene(MODEL_2, "floating-lie"),
        ),
        (
            "constraint of the spin (Model 4 against 3)",
            "euler-tree",
            Scene(MODEL_4, "euler-tree"),
            Scene(MODEL_3, "euler-tree"),
        ),
        (
            "carrier and constraint of the spin (Model 4 against 3)",
            "floating",
            Scene(MODEL_4, "floating"),
            Scene(MODEL_3, "floating"),
        ),
    ]
    made += [
        Pair(
            part=part,
            scene=name,
            carried=partial(build, one),
            left_out=partial(build, other),
            same=False,
            integrator="TrapezoidalIndex2",
        )
        for part, name, one, other in beside
    ]
    return {f"{pair.part}: {pair.scene}": pair for pair in made}


def _ballast(part: str, ballast: Ballast, scene: Scene) -> Pair:
    friction = "with" if scene.scenario.rubs else "without"
    return Pair(
        part=part,
        scene=f"{scene.built_as}, {scene.scenario.name}, {friction} friction",
        carried=partial(_with, scene, ballast),
        left_out=partial(build, scene),
        same=True,
    )


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
        constrained = model.has_constraints(model.scenario)
        samples = run(
            model,
            find_integrator(model.name, pair.integrator, constrained=constrained),
            spacing=SPACING,
            intervals=round(DURATION / SPACING),
            substeps=round(SPACING / STEP),
        )
        spent += samples.seconds
        ends[make] = samples.records[-1]

    both = (pair.carried, pair.left_out)
    calls = [partial(timed, make) for make in both]
    carried, left_out = in_turns(*calls, pairs=PAIRS, clock=lambda: spent)
    middle, low, high = interval([a / b for a, b in zip(carried, left_out, strict=True)])
    change = np.max(np.abs(ends[both[0]] - ends[both[1]])) if pair.same else None
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


def programs() -> dict[str, str]:
    """What is started, as code of a new process."""
    return {
        "Python alone": "",
        "tippedisk --help": "from validation.cli import main\ntry: main(['--help'])\n"
        "except SystemExit: pass",
        "import analysis": "import analysis",
        "import mbs_models": "import mbs_models",
    }


def start(code: str) -> list[Row]:
    """Time of whole processes by the clock."""

    def call() -> None:
        subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)

    (seconds,) = in_turns(call, pairs=3, clock=time.perf_counter)
    return [{"time": 1e3 * min(seconds)}]


STARTS = Study(name="start-up", cases=programs, measure=start, timed=("time",))
STUDIES = (PRICES, STARTS)


def present(rows: Rows) -> Content:
    """Prices of parts, and times to start."""
    table, started = rows["lean"], rows["start-up"]
    dear, none = table[table["least"] > 0.0], table[(table["least"] <= 0.0) & (table["most"] > 0)]
    shown = pd.DataFrame(
        {
            "part carried": table["part"],
            "scene": table["scene"],
            "with in ms": table["carried"],
            "without in ms": table["left out"],
            "price in %": table["price"].round(1) + 0.0,
            "from": table["least"].round(1) + 0.0,
            "to": table["most"].round(1) + 0.0,
        }
    )
    same = table[table["part"].isin([*BALLAST, "six joint axes where three do"])]
    change = largest(same["change"])
    return Content(
        numbers={
            "duration": DURATION,
            "step": STEP,
            "pairs": PAIRS,
            "dear": len(dear),
            "none": len(none),
            "number": len(table),
            "dearest": table.loc[table["price"].idxmax()],
            "change": change,
        },
        tables={
            "prices": shown,
            "start-up": pd.DataFrame(
                {"process": started["case"], "time in ms": started["time"].round()}
            ),
        },
        checks=[at_most("lean: what parts that are not needed change of a motion", change, SAME)],
    )
