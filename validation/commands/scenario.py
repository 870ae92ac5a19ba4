"""The commands `scenario` and `check`: a problem as a file, and the two sides on it."""

from analysis import scenario_text
from analysis.problem.checks import whole
from validation.commands.options import checked_end
from validation.commands.output import Result
from validation.parser.kinds import AnyProblem, NamedProblem, Numbers


def scenario(problem: NamedProblem, *, rest: bool = False) -> int:
    """Print a problem as a commented file, to be changed and run.

    Print the whole problem as a TOML file, which says of every key what it is and what is allowed:
    the paper's; or that of a file or a stored run; with what the options change.

    Parameters
    ----------
    rest
        Start from the defaults of `tippedisk rest`.
    """
    print(scenario_text(problem.scenario(rest=rest)), end="")
    return 0


def check(*, problem: AnyProblem, end: float = 2.0, states: int = 100) -> Numbers:
    """Compare engine and in-house equations on a scenario of your own.

    Compare accelerations, trajectories and, where they are defined, eigenvalues of a scenario
    between the in-house equations and every formulation of the engine that can build it. Exit code
    1 if they disagree.

    Parameters
    ----------
    end
        Of the motions in s, at most.
    states
        Random states for accelerations.
    """
    chosen, end = problem.scenario(), checked_end(end)
    whole("states", states)
    from validation.studies import comparisons

    checks = comparisons.compare_scenario(chosen, states=states, end=end)
    failed = sum(each.agrees is False for each in checks)
    held = sum(each.agrees is True for each in checks)
    return Result(
        tables=[comparisons.table(checks)],
        notes=[f"{failed} checks FAIL." if failed else f"All {held} checks hold."],
        code=1 if failed else 0,
    )
