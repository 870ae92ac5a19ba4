"""Any command line of random values works, or says in one line why it does not."""

from collections import Counter
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import analysis
import mbs_models
from analysis.problem.choices import SOURCES
from analysis.problem.quantities import QUANTITIES
from tests.calls import answer

NUMBERS = st.one_of(
    st.floats(),
    st.integers(-(10**20), 10**20),
    st.floats(-3.0, 3.0),
    st.floats(0.0, 1e-250),
    st.floats(-16.0, 16.0).map(lambda digits: 10.0**digits),
    st.sampled_from(["", "x", "1e400", "-0", "nan", "inf", "1_000", "١٢", "0x10", "1:2:3"]),
    st.sampled_from(["pi/2", "-pi", "90deg", "1/0", "contact,no-slip-along", "tanh", "ellipse"]),
).map(str)

PROBLEM = [each.flag for each in QUANTITIES.values()]
LOSSES = [each.flag for each in QUANTITIES.values() if each.table == "dissipation"]
COMMANDS = {
    "simulate --out new.npz --source": (
        *PROBLEM, "--end", "--samples", "--tolerance", "--step", "--time-limit",
    ),
    "rest --source": (*PROBLEM, "--step", "--end"),
    "eigenvalues --spin=3 --source": ("--mu", "--eps", "--spin"),
    "eigenvalues --spin=3 --system=reduced --source": ("--mu", "--eps", "--spin"),
    "scenario": PROBLEM,
    "scene": ("--mu", "--stiffness", "--half-thickness", "--model", *LOSSES),
    "animate run.npz": ("--begin", "--end", "--speed"),
}  # fmt: skip
"""Commands and options that get a random value."""

QUICK = settings(
    max_examples=100,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


def is_taken(words: list[str]) -> bool:
    """Run a command line, check how it answers, and say whether it passes all checks."""
    shown = answer(*words)
    # A run that fails has passed all checks.
    assert shown.code in (0, 1, 2)
    # A number that looks as if it were meant in another unit is doubted in a line of its own.
    doubts = tuple(f"tippedisk {words[0]}: {each.name} is in " for each in QUANTITIES.values())
    lines = [line for line in shown.err.splitlines() if not line.startswith(doubts)]
    assert len(lines) <= 1
    if shown.code:
        assert lines[0].startswith(f"tippedisk {words[0]}: error: ")
        assert shown.out == ""
    return shown.code != 2


@pytest.mark.parametrize("call", COMMANDS)
def test_command_answers_in_one_line(call: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def accept(*_: Any, **__: Any) -> Any:
        """Take what passes all checks in place of simulating it."""
        raise ArithmeticError("accepted")

    for side in (analysis, mbs_models):
        for name in ("simulate", "simulate_to_rest"):
            monkeypatch.setattr(side, name, accept)
    answers: Counter[bool] = Counter()

    @QUICK
    @given(
        st.sampled_from(SOURCES),
        st.dictionaries(st.sampled_from(COMMANDS[call]), NUMBERS, max_size=3),
    )
    def tried(source: str, chosen: dict[str, str]) -> None:
        words = [*call.split(), *([source] if call.endswith("--source") else [])]
        # A value may begin with a minus sign.
        options = [f"{name}={value}" for name, value in chosen.items()]
        answers[is_taken([*words, *options])] += 1

    tried()
    # Where all calls are refused, nothing is shown.
    assert answers[True] >= 5, answers
