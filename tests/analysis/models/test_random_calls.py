"""Any command line of random values works, or says in one line why it does not."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import analysis
import mbs_models
from analysis import MODELS, STEEL_DISK, Scenario, Start
from analysis.data.quantities import QUANTITIES
from analysis.data.scenario_text import scenario_text
from tests.helpers import random_trajectory
from tests.scenario_texts import with_key
from validation import cli
from validation.commands import rest
from validation.commands import simulate as simulating
from validation.parser.runs import SOURCES

NUMBERS = st.one_of(
    st.floats(),
    st.integers(-(10**20), 10**20),
    st.floats(-3.0, 3.0),
    st.floats(0.0, 1e-250),
    st.floats(1e250),
    st.floats(-16.0, 16.0).map(lambda digits: 10.0**digits),
    st.sampled_from(["", "x", "1e400", "-0", "nan", "inf", "1_000", "١٢", "0x10", "1:2:3"]),
    st.sampled_from(
        ["pi/2", "-pi", "90deg", "1/0", "contact", "contact,no-slip-along", "tanh", "ellipse"]
    ),
).map(str)

PROBLEM = [each.flag for each in QUANTITIES.values()]
LOSSES = [each.flag for each in QUANTITIES.values() if each.table == "dissipation"]
SIMULATE = (*PROBLEM, "--end", "--samples", "--tolerance", "--step", "--time-limit")
REST = (*PROBLEM, "--step", "--end")
SIDES = st.sampled_from(SOURCES)


def with_values(*names: str) -> st.SearchStrategy[list[str]]:
    """Some of these options, each with some value, as one word so that it may begin with -."""
    return st.dictionaries(st.sampled_from(names), NUMBERS, max_size=3).map(
        lambda chosen: [f"{name}={value}" for name, value in chosen.items()]
    )


ANSWERED: Counter[bool] = Counter()
"""Calls that were taken, and calls that were refused."""


@pytest.fixture
def _counted() -> Iterator[None]:
    """Fail where all calls of a test are refused: it would show nothing then."""
    ANSWERED.clear()
    yield
    assert ANSWERED[True] >= 5, ANSWERED


def answer(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Run a command line and check how it answers."""
    capsys.readouterr()
    code = cli.main(words)
    shown = capsys.readouterr()
    ANSWERED[code != 2] += 1
    # A run that fails has passed all checks.
    assert code in (0, 1, 2)
    # A number that looks as if it were meant in another unit is doubted in a line of its own.
    doubts = tuple(f"tippedisk {words[0]}: {each.name} is in " for each in QUANTITIES.values())
    lines = [line for line in shown.err.splitlines() if not line.startswith(doubts)]
    assert len(lines) <= 1
    if code:
        assert lines[0].startswith(f"tippedisk {words[0]}: error: ")
        assert shown.out == ""


QUICK = settings(
    max_examples=100,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@pytest.fixture
def nothing_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accept what passes all checks in place of simulating it."""

    def accept(*_: Any, **__: Any) -> Any:
        raise ArithmeticError("accepted")

    monkeypatch.setattr(analysis, "simulate", accept)
    monkeypatch.setattr(mbs_models, "simulate", accept)
    monkeypatch.setattr(analysis, "simulate_to_rest", accept)
    monkeypatch.setattr(mbs_models, "simulate_to_rest", accept)
    monkeypatch.setattr(simulating, "announce", lambda _, effort, __=None: effort.check())
    monkeypatch.setattr(rest, "announce", lambda _, effort, __=None: effort.check())


COMMANDS = {
    "simulate --out {folder}/run.npz --source": SIMULATE,
    "rest --source": REST,
    "eigenvalues --spin=30 --system=reduced --source": ("--mu", "--eps", "--spin"),
    "scenario": PROBLEM,
    "scene": ("--mu", "--stiffness", "--half-thickness", "--model", *LOSSES),
}


@pytest.mark.usefixtures("nothing_is_computed", "_counted")
@pytest.mark.parametrize("call", COMMANDS)
@QUICK
@given(st.data())
def test_command_answers_in_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, call: str, data: st.DataObject
) -> None:
    words = call.format(folder=tmp_path).split()
    if words[-1] == "--source":
        words.append(data.draw(SIDES))
    answer([*words, *data.draw(with_values(*COMMANDS[call]))], capsys)


TABLE_3 = Start().state(MODELS[1], STEEL_DISK)


@pytest.mark.usefixtures("_counted")
@QUICK
@given(with_values("--begin", "--end", "--speed"), with_values("--fps", "--width"))
def test_animate_answers_in_one_line(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    given_options: list[str],
    of_a_gif: list[str],
) -> None:
    random_trajectory().save(tmp_path / "run.npz")
    words = ["animate", str(tmp_path / "run.npz"), *given_options]
    answer(words, capsys)
    # Drawing takes seconds; what is drawn has passed all checks but that of the width.
    monkeypatch.setattr("validation.kit.animation.gif._pixels", None)
    if of_a_gif and not any(name.startswith("--width") for name in of_a_gif):
        of_a_gif.append("--width=1")
        answer([*words, "--out", str(tmp_path / "run.gif"), *of_a_gif], capsys)


LITERALS = st.one_of(
    st.floats().map(repr),
    st.integers(-(10**30), 10**30).map(str),
    st.sampled_from(["true", '"pi/2"', '"x"', '""', "[1, [2]]", "{a = 1}", "1979-05-27", "1e400"]),
    st.sampled_from(["0x10", "1_000", "'steel'", '"tanh"', '"os:path"', "9" * 5000, "-0.0"]),
)


@pytest.mark.usefixtures("_counted")
@pytest.mark.slow
@settings(QUICK, max_examples=200)
@given(
    st.sampled_from([Scenario(), Scenario.rest(), Scenario(start=TABLE_3)]),
    st.lists(
        st.tuples(
            st.sampled_from([(each.table, each.name) for each in QUANTITIES.values()]), LITERALS
        ),
        min_size=1,
        max_size=3,
    ),
)
def test_any_value_of_a_key_is_answered_in_one_line(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    scenario: Scenario,
    entries: list[tuple[tuple[str, str], str]],
) -> None:
    text = scenario_text(scenario)
    for (table, key), literal in entries:
        if f"\n[{table}]\n" in text:
            text = with_key(text, table, key, literal)
    (tmp_path / "my.toml").write_text(text)
    answer(["scenario", str(tmp_path / "my.toml")], capsys)


def test_eigenvalues_of_the_steepest_friction_are_followed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    # Differences of rounding only, divided by each other, overflowed.
    answer(["eigenvalues", "--spin", "3", "--mu", "1e9", "--eps", "1e-3"], capsys)
    answer(["eigenvalues", "--spin", "3", "--mu", "0", "--eps", "1e-12"], capsys)
