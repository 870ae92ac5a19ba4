"""The command line: what every command and every option of it has in common."""

import json
import shutil
import subprocess
from argparse import Action, BooleanOptionalAction
from importlib.metadata import version
from pathlib import Path

import pytest

import analysis
from analysis.motion.endings import CONDITIONS
from analysis.motion.inversion import DEFINITION
from analysis.problem.quantities import QUANTITIES
from analysis.stability.spectra import SYSTEMS
from tests.calls import Answer, answer, printed, python, refusal
from tests.helpers import mostly_slow
from validation import report
from validation.maps.problems import PROBLEMS
from validation.parser.commands import Command, commands
from validation.parser.kinds import DISK, METHOD

NEEDED = {
    "show": "run.npz",
    "sweep": "spin=30,31 --out a.db",
    "map": "spin-friction",
    "eigenvalues": "--spin 30",
    "animate": "run.npz",
    "study": "claims",
}
"""What a command cannot do without."""

PATHS = ("out", "csv", "plot", "text", "results")
"""Options that take a path that may lead anywhere."""

BESIDE = {"amplitude": "--over mu=0.1,0.2", "fps": "--out a.gif", "width": "--out a.gif"}
"""What an option belongs to."""

QUICK = (
    "simulate --source in-house --end 0.05 --samples 3",
    "rest --source in-house --end 0.05",
    "eigenvalues --system reduced --spin 30 40",
    "scene",
)
FINDING = (
    *QUICK,
    "critical --system reduced --spin 30:32",
    "cycles --spin 30.9",
    "heteroclinic",
    "sweep spin=30,31 --model 4 --end 0.02 --workers 1 --out a.db",
    "map spin-friction --cells 1 --levels 0 --end 0.05 --witnesses 0 --workers 1",
    "check --states 2 --end 0.05",
)
"""Calls of commands that find something."""

COMMANDS = commands()
EVERY = pytest.mark.parametrize("command", COMMANDS, ids=[each.name for each in COMMANDS])


def test_choices_are_those_of_the_packages() -> None:
    studies = {name: report.find(name).STUDIES for name in (*DISK, *METHOD)}
    stored = [name for name, some in studies.items() if any(each.is_stored for each in some)]
    for command, option, known in (
        ("eigenvalues", "system", SYSTEMS),
        ("critical", "motion", analysis.MOTIONS),
        ("map", "name", PROBLEMS),
        ("study", "name", stored),
    ):
        (parser,) = (each.parser() for each in COMMANDS if each.name == command)
        (choices,) = (each.choices for each in parser.actions if each.dest == option)
        assert tuple(choices or ()) == tuple(known)


def test_help_says_what_counts_as_inverted_and_what_ends_a_run() -> None:
    shown = " ".join(printed("rest --help").split())
    assert DEFINITION in shown
    assert f"exact time: {', '.join(CONDITIONS)}, or where" in shown


def test_version_is_that_of_what_is_installed() -> None:
    assert printed("--version") == f"tippedisk {version('tippedisk')}\n"


@pytest.mark.parametrize(("command", "model"), [("simulate", 1), ("cycles", 4)])
def test_help_says_which_model_is_taken(command: str, model: int) -> None:
    shown = printed(command, "--help")
    assert f"constraints of a model of the paper ({model})\n" in shown


def test_help_says_why_it_says_little_where_python_has_left_its_text_out() -> None:
    for words in ("--help", "critical --help"):
        shown = python("-OO", "-m", "validation", *words.split()).stdout
        assert "is left out where Python runs with -OO.\n" in shown


def options_of(command: Command) -> list[Action]:
    """Options of a command but --help."""
    return [each for each in command.parser().actions if each.option_strings][1:]


@EVERY
def test_nonsense_is_refused_in_one_line_that_names_the_option(command: Command) -> None:
    for action in options_of(command):
        option = action.option_strings[0]
        is_number = action.type in (float, int) or (
            action.dest in QUANTITIES and not QUANTITIES[action.dest].choices
        )
        values = ("glue", "nan") if is_number else ("glue",)
        for value in ("/dev/null/glue", "") if action.dest in PATHS else values:
            words = [NEEDED.get(command.name, ""), BESIDE.get(action.dest, "")]
            assert option in refusal(command.name, *words, f"{option}={value}")
    assert [each.name for each in Path().iterdir()] == ["run.npz"]


@EVERY
def test_help_says_what_every_option_means(command: Command) -> None:
    shown = printed(command.name, "--help")
    usage = shown.partition("\n")[0].partition("[OPTION ...]")[2]
    arguments = [each for each in command.parser().actions if not each.option_strings]
    assert usage.replace(" ...", "").replace("[", "").replace("]", "").split() == [
        each.metavar for each in arguments
    ]
    assert usage.count("[") == sum(each.nargs == "?" for each in arguments)
    for action in options_of(command):
        assert action.option_strings[0] in shown
        assert action.help
        assert not action.help.startswith(" (")
        if action.dest in QUANTITIES and not isinstance(action, BooleanOptionalAction):
            names = action.choices or QUANTITIES[action.dest].choices
            assert all(str(each) in shown for each in names)
            # These may be given as pi/2 or 90deg.
            assert (action.metavar == "ANGLE") == QUANTITIES[action.dest].is_angle
        if action.nargs == 0 and action.dest != "help":
            assert f"--no-{action.option_strings[0][2:]}" in action.option_strings


WRONG = {
    "": "the following arguments are required: COMMAND",
    "simulat": "did you mean simulate?",
    "simulate --mu=--": "argument --mu: expected a value behind =, got '--'",
    "-v": "unrecognized arguments: -v",
    "simulate --spin -inf": "--spin: spin must be a finite number, got -inf",
    "simulate --end 2s": "argument --end: must be a number, got '2s'",
    "simulate --samples 1e3": "argument --samples: must be a whole number, got '1e3'",
}


@pytest.mark.parametrize("words", WRONG)
def test_a_wrong_word_is_refused(words: str) -> None:
    shown = answer(words)
    assert WRONG[words] in shown.err
    assert (shown.code, shown.out, shown.err.count("\n")) == (2, "", 1)


def test_codes_tell_a_fault_from_a_refusal_and_from_a_failed_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def told(error: Exception) -> Answer:
        def broken(**_: object) -> int:
            raise error

        monkeypatch.setattr("validation.commands.scenario.scenario", broken)
        return answer("scenario")

    fault = told(KeyError("speed"))
    assert (fault.code, fault.err.partition(" ")[0]) == (70, "Traceback")
    assert fault.err.endswith("KeyError: 'speed'\n")
    line = "tippedisk scenario: error: no\n"
    assert told(ValueError("no")) == told(OSError("no")) == (2, "", line)
    assert told(ArithmeticError("no")) == (1, "", line)


def test_help_and_wrong_paths_are_answered_before_numerical_imports() -> None:
    wrong = ["simulate --out run.txt", "simulate --scenario missing.toml --out a.npz",
             "rest --plot missing/picture.png", "show missing.npz"]  # fmt: skip
    code = (
        "import sys; from validation import cli; "
        "codes = [cli.main(call.split()) for call in sys.argv[1:]]; "
        "print(codes, {'numpy', 'exudyn', 'matplotlib'} & set(sys.modules))"
    )
    calls = [*wrong, "--help", "simulate --help"]
    done = python("-c", code, *calls)
    assert done.stdout.endswith("[2, 2, 2, 2, 0, 0] set()\n")
    assert done.stderr.count("\n") == len(wrong)


@pytest.mark.parametrize("call", mostly_slow(FINDING, QUICK))
def test_table_picture_and_data_are_made_at_once(call: str) -> None:
    assert json.loads(printed(call, "--json --csv a.csv --plot a.png"))
    assert Path("a.csv").read_text().count("\n") > 1
    assert Path("a.png").stat().st_size > 1000


# --- Completion ---------------------------------------------------------------------------------

COMPLETE = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_tippedisk; echo "${{COMPREPLY[@]}}"
"""

OFFERED = {
    "tippedisk sim": "simulate",
    "tippedisk simulate --source e": "engine",
    "tippedisk simulate --incl": "--inclination",
    "tippedisk map spin-": "spin-friction spin-eccentricity",
    "tippedisk rest --no-bil": "--no-bilateral",
    "tippedisk simulate --law s": "smooth-coulomb stribeck",
}


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize("words", OFFERED)
def test_bash_offers_what_fits(words: str) -> None:
    script = printed("completion bash") + COMPLETE.format(words=words)
    done = subprocess.run(["/bin/bash", "-c", script], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == (f"{OFFERED[words]}\n", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_script_of_a_shell_knows_every_command_and_is_understood(shell: str) -> None:
    script = printed("completion", shell)
    for command in COMMANDS:
        assert f" {command.name} " in script or f":{command.name}:" in script
        for action in command.parser().actions:
            assert all(name.lstrip("-") in script for name in action.option_strings)
    if shell == "fish":
        assert "-l out -r -d 'page to write, .html or - (play.html)'" in script
    if (found := shutil.which(shell)) is not None:
        subprocess.run([found, "-n", "-c", script], check=True)
