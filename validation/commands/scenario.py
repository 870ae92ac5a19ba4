"""A problem as a file, the two sides on it, and its scene: `scenario`, `check` and `scene`."""

from operator import attrgetter
from textwrap import fill
from typing import Any

import numpy as np

from analysis import Scenario, scenario_text
from analysis.problem.checks import whole
from analysis.problem.choices import EngineFormulation
from validation.animation.keyframes import seen_from
from validation.commands.options import checked_end
from validation.display.figures import against_limits, draw_still, new_figure
from validation.display.tables import Table
from validation.parser.files import Result
from validation.parser.kinds import AnyProblem, NamedProblem

_WIDEST = 62
"""Letters in a line of a title."""


def scenario(problem: NamedProblem, *, rest: bool = False) -> None:
    """Print a problem as a commented file, to be changed and run.

    Print the whole problem as a TOML file, which says of every key what it is and what is allowed:
    the paper's; or that of a file or a stored run; with what the options change.

    Parameters
    ----------
    rest
        Start from the defaults of `tippedisk rest`.
    """
    print(scenario_text(problem.scenario(rest=rest)), end="")


def check(*, problem: AnyProblem, end: float = 2.0, states: int = 100) -> Result:
    """Compare engine and in-house equations on a scenario of your own.

    Compare accelerations, trajectories and, where they are defined, eigenvalues of a scenario
    between the in-house equations and every formulation of the engine that can build it. Exit code
    1 if they disagree; what cannot be compared is told with the reason and counts for neither.

    Parameters
    ----------
    end
        Of the motions in s, at most.
    states
        Random states for accelerations.
    """
    chosen, end = problem.scenario(), checked_end(end)
    whole("states", states)
    from mbs_models.scene import Scene
    from validation.studies import comparisons

    # What no formulation can build is refused: no check of it would be one that holds.
    Scene(scenario=chosen)
    checks = comparisons.compare_scenario(chosen, states=states, end=end)
    failed = sum(each.agrees is False for each in checks)
    held = sum(each.agrees is True for each in checks)
    compared = [
        (
            # What has no mark in the picture says why.
            f"{each.formulation}: {each.quantity}" + ", not defined" * (each.agrees is None),
            *(each.difference, each.criterion, each.agrees),
        )
        for each in checks
    ]
    return Result(
        tables=[comparisons.table(checks)],
        draw=lambda: against_limits(compared),
        notes=[_verdict(failed, held, len(checks))],
        code=1 if failed else 0,
    )


def _verdict(failed: int, held: int, count: int) -> str:
    """What is found in all, of comparisons of which some may not be defined."""
    left = count - failed - held
    said = f"{failed} checks FAIL" if failed else f"All {held} checks hold"
    return f"{said}; {left} cannot be made." if left else f"{said}."


def scene(*, problem: AnyProblem, formulation: EngineFormulation | None = None) -> Result:
    """List what is in a scene of the engine, and why.

    List the nodes, objects, markers and loads of a scene with the reason for each, and count its
    coordinates, constraints and user functions. The picture is the disk at its start.

    Parameters
    ----------
    formulation
        How the disk is built (the most accurate).
    """
    from mbs_models.inventory import inventory
    from mbs_models.scene import Scene

    scene = Scene(scenario=problem.scenario(), formulation=formulation)
    items = inventory(scene)
    coordinates, equations, idle = (
        sum(map(attrgetter(name), items)) for name in ("coordinates", "equations", "idle")
    )
    functions = sum(len(each.user_functions) for each in items)
    rows: list[Any] = [
        {
            "item": f"{item.kind} {item.number}",
            "engine type": item.type,
            "coordinates": item.coordinates or None,
            "equations": item.equations or None,
            "of them idle": item.idle or None,
            "user function": ", ".join(item.user_functions) or None,
            "why": item.why,
        }
        for item in items
    ]
    unused = f" ({idle} of them idle: an unused constraint force is zero)" if idle else ""
    table = Table.of(
        rows,
        title=f"{scene.scenario.name}, formulation {scene.built_as}",
        note=f"{coordinates} coordinates, {equations} algebraic "
        f"equation{'s' * (equations != 1)}{unused}, "
        f"{functions} user function{'s' * (functions != 1)}.",
    )
    return Result(tables=[table], draw=lambda: _start(scene.scenario))


def _start(scenario: Scenario) -> Any:
    """Figure of the disk at its start."""
    state = scenario.initial_state
    figure, axes = new_figure(width=5.0, height=4.4)
    draw_still(axes, scenario.disk, np.array(state.coordinates))
    marks = ("a point of the edge", "centre of gravity", "geometric centre")
    for line, name in zip(axes.lines[-len(marks) :], marks, strict=True):
        line.set(label=name, linestyle="none")
    beta, gamma = state.coordinates[4:]
    attitude = f"β = {beta:.4g} rad, γ = {gamma:.4g} rad, α turns with {state.rates[3]:.4g} rad/s"
    words = filter(None, (f"{scenario.name} at its start", seen_from(scenario)))
    what = fill(", ".join(words), _WIDEST, break_on_hyphens=False)
    axes.set_title(f"{what}\n{attitude}", fontsize=10)
    figure.legend(loc="outside lower center", ncols=3, fontsize=8, handletextpad=0.0)
    return figure
