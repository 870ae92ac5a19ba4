"""The commands `simulate` and `rest`: one run of a scenario."""

from collections.abc import Iterator
from typing import Annotated, Any

from analysis import Scenario, SpatialMotion, StoredRun
from analysis.motion.outcomes import OUTCOMES
from analysis.problem.checks import whole
from analysis.problem.limits import REST_SPACING
from analysis.problem.names import ArgumentError
from analysis.stability.linearisation import unstable_start
from validation.commands.options import announced, checked_end
from validation.display.figures import comparison, draw_story
from validation.display.tables import Table
from validation.parser.commands import Group
from validation.parser.files import Result
from validation.parser.kinds import AnyProblem, MotionOut
from validation.parser.runs import RunOptions
from validation.run import even_times, rest_effort, run, run_effort, run_to_rest
from validation.sweeps.case import outcome


def simulate(
    *,
    problem: AnyProblem,
    how: Annotated[dict[str, Any], Group(RunOptions)],
    end: float = 2.0,
    samples: int = 201,
    out: MotionOut = None,
) -> Result:
    """Simulate a scenario and store the motion.

    The file holds times (N,), coordinates and rates (N, 6) in the order x, y, z, alpha, beta,
    gamma of the co-rotating ones (m, rad, m/s, rad/s), multipliers (N, k), the first of which is
    the normal force in N, and meta, a JSON string with the scenario, versions and the error
    estimate. The table of --csv has the samples, --json what a sweep keeps of a case.

    Parameters
    ----------
    end
        End of the simulation in s.
    samples
        Number of evenly spaced samples.
    out
        Store the motion, .npz or -.
    """
    whole("samples", samples, least=2)
    scenario = problem.scenario()
    times = even_times(scenario, checked_end(end), samples, "samples")
    effort = run_effort(scenario, times, **how)
    with announced("simulate", effort, how.get("time_limit")) as progress:
        motion = run(scenario, times, **how, progress=progress)
    estimate = motion.error_estimate
    accuracy = "" if estimate is None else f", estimated error {estimate:.1e} rad"
    name = "in memory alone; --out stores it" if out is None else out
    made = f"{name}: {motion.times.size} samples of {scenario.name}{accuracy}"
    warnings = list(_warnings(motion))
    pulling = (
        f"the contact pulls from t = {first:.6g} s to {last:.6g} s"
        for first, last in motion.pulling
    )
    more = {"samples": motion.times.size, "pulling": motion.pulling, "notes": warnings}
    return Result(
        values=outcome(motion) | more,
        csv=motion.to_csv,
        files=[(out, motion.save)],
        draw=lambda: comparison([(scenario.name, motion)]),
        notes=[made, *warnings, *pulling],
    )


def rest(
    *,
    problem: AnyProblem,
    how: Annotated[
        dict[str, Any], Group(RunOptions, "source", "tolerance", "step", "stop_when", "time_limit")
    ],
    end: float = 80.0,
    out: MotionOut = None,
) -> Result:
    """Simulate the disk from the paper's start until it lies still.

    Simulate the disk on a stiff unilateral contact until it lies still, and print what a sweep
    keeps of a case: when each phase began, where the energy went, and so on. By default the rim is
    rounded, friction takes the contact force as its load, and nothing but sliding friction and the
    contact's damper takes energy; then the disk does not lie flat.

    The disk is inverted from the first time at which its centre of gravity has risen to 90% of its
    largest height above the geometric centre and from which it stays above that centre for 1 s; if
    the motion ends before, it is not decided.

    Parameters
    ----------
    tolerance
        Largest error in rad and parts of the energy (1e-3).
    step
        Engine only: a single run of fixed steps of at most so many s instead.
    time_limit
        Processor time in s after which the run ends as it is, without an error estimate (none).
    end
        Longest time in s.
    out
        Store the motion, .npz or -.
    """
    checked_end(end, REST_SPACING)
    scenario = problem.scenario(rest=True)
    if scenario.contact is None:
        raise ArgumentError(
            "scenario",
            "needs a penalty contact on the way to rest, and its is ideal; give --stiffness and "
            "--half-thickness, or the table [contact]",
        )
    effort = rest_effort(scenario, end, **how)
    with announced("rest", effort, how.get("time_limit")) as progress:
        motion = run_to_rest(scenario, end, **how, progress=progress)
    remarks = list(_remarks(motion))
    return Result(
        tables=[_story(motion)],
        values=outcome(motion) | {"notes": remarks},
        files=[(out, motion.save)],
        draw=lambda: draw_story(motion),
        notes=remarks,
    )


def _story(motion: SpatialMotion) -> Table:
    """What became of the disk: when each phase began, where the energy went, how sure that is."""
    found: dict[str, Any] = outcome(motion)
    return Table(
        title=f"The way to rest of {motion.scenario.name}, {motion.source}",
        columns=("what", "value", "unit"),
        rows=[
            (name, value, OUTCOMES[name] or "")
            for name, value in found.items()
            if value is not None
        ],
    )


def _warnings(motion: StoredRun) -> Iterator[str]:
    """What is to be said of a start, and of an end before its time."""
    if warning := unstable_start(motion.scenario):
        yield warning
    if motion.ending is not None:
        yield str(motion.ending)


def _remarks(motion: SpatialMotion) -> Iterator[str]:
    """What else is to be said of the motion."""
    if motion.inversion.outcome == "not decided":
        yield "inversion not decided: the disk was up, and the motion ended too soon after"
    yield from _warnings(motion)
    if motion.ending is None and motion.phases.rest is None:
        yield (
            f"not at rest after {motion.times[-1]:g} s, leaning by {motion.leaning[-1]:.4g} rad"
            + _lacking(motion.scenario)
        )


def _lacking(scenario: Scenario) -> str:
    """What a disk needs that is to come to rest, and does not have."""
    if not scenario.table.is_horizontal:
        return "; downhill it creeps, since friction takes some slip to hold it"
    losses = scenario.dissipation
    rolls_freely = not losses.rolling_dry and not losses.rolling_viscous
    # A sphere has nothing to lie flat on.
    is_lacking = scenario.disk.has_edge and rolls_freely
    flat = "; lying flat needs --rolling or --rolling-viscous" if is_lacking else ""
    return flat if losses.pivoting else f"{flat}; lying still needs --pivoting"
