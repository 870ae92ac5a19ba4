"""The price of carrying what a scene does not need, and of starting a command."""

import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from statistics import median

from analysis import MODELS, Scenario, SmoothCoulomb
from mbs_models import Scene
from mbs_models.ballast import BALLAST, Ballast, six_axes
from mbs_models.integrators import IntegratorName, find_integrator
from mbs_models.model import Model
from mbs_models.runs import run
from mbs_models.scene import build
from validation.kit.report import Job, Section
from validation.kit.tables import Table

SMOOTH = SmoothCoulomb(coefficient=0.0)
MODEL_1, MODEL_2, MODEL_3, MODEL_4 = (Scenario(constraints=each) for each in MODELS.values())
DURATION = 0.5
STEP = 5e-4

Build = Callable[[], Model]

START_UPS: dict[str, str] = {
    "report": "validation.studies.full_report",
    "simulate --source engine": "validation.commands.basic, mbs_models",
    "simulate --source in-house": "validation.commands.basic",
    "show": "validation.commands.show, validation.kit.figures",
    "scenario": "validation.commands.scenario",
    "check": "validation.commands.scenario, validation.studies.crosscheck",
    "eigenvalues --source engine": (
        "validation.commands.stability, validation.studies.stability.eigenvalue_check"
    ),
    "eigenvalues --source in-house": "validation.commands.stability",
    "critical": "validation.commands.stability, validation.studies.stability.tables",
    "cycles": "validation.commands.nonlinear",
    "heteroclinic": "validation.commands.nonlinear",
    "passage": "validation.commands.nonlinear",
    "sweep": "validation.commands.sweep",
    "map": "validation.commands.maps",
    "scene": "validation.commands.scene",
    "work-precision": ("validation.commands.studies, validation.studies.work_precision.section"),
    "robustness": "validation.commands.studies, validation.studies.robustness.section",
    "animate": "validation.commands.animate, validation.kit.animation.player",
    "rest --source engine": "validation.commands.rest, mbs_models",
    "rest --source in-house": "validation.commands.rest",
}
"""From each subcommand, with its source if that matters, to what it imports when it runs."""

HEAVY = ("numpy", "scipy", "exudyn", "matplotlib")


@dataclass(frozen=True, slots=True, kw_only=True)
class Overhead:
    """Run times with and without a part.

    Parameters
    ----------
    part : str
    scene : str
    carried, left_out : float
        Engine time of a run in s, the least over the repeats.
    spread : float
        Median of the runs without the part over the least of them.
    """

    part: str
    scene: str
    carried: float
    left_out: float
    spread: float


def overhead(
    part: str,
    scene: str,
    carried: Build,
    left_out: Build,
    *,
    repeats: int,
    integrator: IntegratorName | None = None,
) -> Overhead:
    """Measure two models against each other, in turns, after a warm-up each."""
    times: list[list[float]] = [[], []]
    for _ in range(repeats + 1):
        for which, make in enumerate((carried, left_out)):
            times[which].append(_seconds(make(), integrator))
    return Overhead(
        part=part,
        scene=scene,
        carried=min(times[0][1:]),
        left_out=min(times[1][1:]),
        spread=median(times[1][1:]) / min(times[1][1:]),
    )


def _seconds(model: Model, name: IntegratorName | None) -> float:
    constrained = model.has_constraints(model.scenario)
    integrator = find_integrator(model.name, name, constrained=constrained)
    spacing = 5e-3
    samples = run(
        model,
        integrator,
        spacing=spacing,
        intervals=round(DURATION / spacing),
        substeps=round(spacing / STEP),
    )
    return samples.seconds


def _with(scene: Scene, ballast: Ballast) -> Model:
    model = build(scene)
    ballast(model)
    return model


def overheads(repeats: int) -> list[Overhead]:
    """Measure every part that could be left out.

    Parameters
    ----------
    repeats : int
        Runs of each kind, of which the fastest counts.
    """
    result = [
        overhead(
            part,
            f"{scene.built_as}, {scene.scenario.name}, "
            f"{'with' if scene.scenario.rubs else 'without'} friction",
            partial(_with, scene, BALLAST[part]),
            partial(build, scene),
            repeats=repeats,
        )
        for part, scene in _ballast_cases()
    ]
    return result + _alternatives(repeats)


def _ballast_cases() -> list[tuple[str, Scene]]:
    bare = [
        Scene(replace(MODEL_1, friction=SMOOTH), "contact-tree"),
        Scene(replace(MODEL_2, friction=SMOOTH), "euler-tree"),
        Scene(replace(MODEL_2, friction=SMOOTH), "floating"),
    ]
    rough = [
        Scene(MODEL_2, "euler-tree"),
        Scene(MODEL_2, "floating"),
    ]
    first, *others = BALLAST
    return [(first, scene) for scene in bare] + [
        (part, scene) for part in others for scene in rough
    ]


def _alternatives(repeats: int) -> list[Overhead]:
    """Costlier ways to the same motion, or to the next simpler model.

    Each is a pair of scenes, the costlier one first, or the same scene built in two ways.
    """
    tree = Scene(MODEL_2, "euler-tree")
    pairs: list[tuple[str, str, Build, Build]] = [
        (
            "six joint axes where three do",
            "euler-tree, Model 2",
            partial(_with, tree, six_axes),
            partial(build, tree),
        ),
    ]
    scenes: list[tuple[str, str, Scene, Scene]] = [
        (
            "contact as a constraint, not by topology",
            "euler-tree and contact-tree, Model 1",
            Scene(MODEL_1, "euler-tree"),
            Scene(MODEL_1, "contact-tree"),
        ),
        (
            "Euler parameters, not a rotation vector",
            "floating and floating-lie, Model 2",
            Scene(MODEL_2, "floating"),
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
    pairs += [(part, name, partial(build, a), partial(build, b)) for part, name, a, b in scenes]
    return [
        overhead(part, name, carried, left_out, repeats=repeats, integrator="TrapezoidalIndex2")
        for part, name, carried, left_out in pairs
    ]


def overhead_table(found: Sequence[Overhead]) -> Table:
    """Table of run times with against without."""
    return Table.of(
        found,
        {
            "part carried": lambda each: each.part,
            "scene": lambda each: each.scene,
            "run time with in ms": lambda each: 1e3 * each.carried,
            "without in ms": lambda each: 1e3 * each.left_out,
            "price in %": lambda each: round(100.0 * (each.carried / each.left_out - 1.0), 1),
            "scatter in %": lambda each: round(100.0 * (each.spread - 1.0), 1),
        },
        name="lean-scenes",
        title="The price of carrying what a scene does not need",
        note=f"Engine time of {DURATION:g} s from Table 3 at step {STEP:g} s, sampled every 5 ms, "
        "the fastest of the repeats; scatter is how far their median lies above the fastest. A "
        "price within the scatter is none.",
    )


def start_up(repeats: int) -> Table:
    """Time until each subcommand answers `--help`, and of the imports it makes when it runs.

    Parameters
    ----------
    repeats : int
        Processes of each kind, of which the fastest counts.
    """
    rows = []
    # Several subcommands import the same, and the two sources of one answer with the same help.
    timed: dict[str, tuple[float, str]] = {}
    helped: dict[str, float] = {}
    for command, modules in {"(Python alone)": "", **START_UPS}.items():
        if modules not in timed:
            code = "import sys" + (f", {modules}" if modules else "")
            code += f"; print(*(name for name in {HEAVY!r} if name in sys.modules))"
            timed[modules] = _fastest([sys.executable, "-c", code], repeats)
        word = command.partition(" ")[0]
        if modules and word not in helped:
            helped[word] = 1e3 * _fastest(help_call(command), repeats)[0]
        seconds, loaded = timed[modules]
        rows.append([command, helped.get(word), 1e3 * seconds, loaded or "none of them"])
    return Table(
        name="start-up",
        title="Start-up of each subcommand",
        columns=(
            "subcommand",
            "answer to --help in ms",
            "imports when it runs in ms",
            f"of {', '.join(HEAVY)} it loads",
        ),
        rows=rows,
        note="Whole processes, from start to end, the fastest of the repeats.",
    )


def help_call(command: str) -> list[str]:
    """Call that asks a subcommand for help."""
    code = "from validation.cli import main; main()"
    return [sys.executable, "-c", code, command.split(maxsplit=1)[0], "--help"]


def _fastest(command: Sequence[str], repeats: int) -> tuple[float, str]:
    """Least time of whole processes in s, and what they print."""
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        seconds.append(time.perf_counter() - begin)
    return min(seconds), done.stdout.strip()


def jobs(*, quick: bool) -> list[Job]:
    """Jobs for `run_jobs`; the keys start with "lean"."""
    return [
        Job(("lean", "prices"), overheads, (2 if quick else 9,)),
        Job(("lean", "start-up"), start_up, (1 if quick else 5,), on_all_code=True),
    ]


def section(results: dict[tuple[str, ...], object]) -> Section:
    """Section of the report from the results of `jobs`."""
    found, start = results["lean", "prices"], results["lean", "start-up"]
    assert isinstance(found, list)
    assert isinstance(start, Table)
    return Section(
        name="lean",
        title="Lean scenes",
        paragraphs=[
            (
                "A scene holds what its model, contact, friction and outputs call for and nothing "
                "else; `tippedisk scene` lists it with the reason for each item. What follows is "
                "the price of carrying more."
            )
        ],
        tables=[overhead_table(found), start],
    )
