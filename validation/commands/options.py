"""From options of the command line, which several commands share, to what they mean."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from analysis import BODIES, LAWS, PenaltyContact, Scenario, StoredRun, load_run, load_scenario
from analysis.problem.checks import Array, positive, within
from analysis.problem.limits import LONGEST_MOTION, MOST_SPINS, SHORTEST_STEP, Effort, duration
from analysis.problem.names import ArgumentError
from analysis.problem.user_modules import Kinds
from analysis.problem.values import read_value
from analysis.problem.variations import changed
from analysis.solve.watch import Progress
from validation.display.progress import progress_bar, say
from validation.sweeps.axes import axis_from

_CONSTRAINTS = ("model", "constraints")
"""Two ways to tell the same."""

_CLASSES: Mapping[str, Kinds[Any]] = {"friction.law": LAWS, "disk.body": BODIES}
"""What a class may be told for, which may be one's own."""


class Problem(NamedTuple):
    """What a call tells of a scenario.

    Parameters
    ----------
    file : Path, optional
        Of a scenario, or of a stored run of either kind (.npz).
    named : mapping
        What changes it: texts by the keys of quantities.
    model : int
        Whose constraints it has where neither tells any.
    """

    file: Path | None
    named: Mapping[str, Any]
    model: int

    def scenario(self, *, rest: bool = False, model: int | None = None) -> Scenario:
        """Scenario of the file, or the default one, with what the options change.

        Parameters
        ----------
        rest : bool
            Whether the default is that of the way to rest.
        model : int, optional
            In place of the file's, unless the options tell constraints.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If the file is none, or an option is out of range or does not fit the rest.
        """
        given = _given(self.named)
        model = model or (self.model if self.file is None else None)
        if model is not None and not given.keys() & {"model", "constraints"}:
            given["model"] = model
        if self.file is None:
            base = _to_rest(given) if rest else Scenario()
        else:
            is_run = self.file.suffix.lower() == ".npz"
            base = load_run(self.file).scenario if is_run else load_scenario(self.file)
        return changed(base, given)

    def check_fixed(self, varied: Collection[str]) -> None:
        """Raise `ArgumentError` if an option tells what varies.

        Parameters
        ----------
        varied : collection of str
            Keys of quantities.
        """
        # A class's parameters stand behind its name.
        for key, value in {**_given(self.named), **self.named}.items():
            same = _CONSTRAINTS if key in _CONSTRAINTS else (key,)
            if not set(same).isdisjoint(varied):
                name = key.rpartition(".")[2]
                raise ArgumentError(name, f"must be left out where it varies, got {value}")


def _given(named: Mapping[str, Any]) -> dict[str, Any]:
    """What the options tell of quantities, by key; a class's parameters stand behind its name."""
    given = {key: read_value(key, value, key.rpartition(".")[2]) for key, value in named.items()}
    for key, classes in _CLASSES.items():
        table, _, option = key.rpartition(".")
        name, *parameters = str(given.get(key, "")).split(",")
        for parameter in parameters:
            argument, equals, text = parameter.partition("=")
            field = f"{table}.{argument.strip()}"
            if not equals:
                raise ArgumentError(
                    option, f"must hold parameter=value behind its name, got {parameter!r}"
                )
            if field in given:
                raise ArgumentError(option, f"tells {argument.strip()}, which is told twice")
            given[field] = read_value(field, text, argument.strip())
        if name:
            given[key] = name
            # Its module is imported before what was stored with it is read.
            classes.find(name)
    return given


def _to_rest(given: dict[str, Any]) -> Scenario:
    """Scenario of the way to rest, whose damping follows from the stiffness and the disk."""
    of_disk = {key: given.pop(key) for key in list(given) if key.startswith("disk.")}
    disk = changed(Scenario(), of_disk).disk
    named = {name: f"contact.{name}" for name in ("stiffness", "half_thickness")}
    given_contact = {name: given.pop(key) for name, key in named.items() if key in given}
    return Scenario.rest(disk=disk, contact=PenaltyContact.rounded(disk, **given_contact))


def stored_runs(files: Sequence[Path], **named: str) -> list[StoredRun]:
    """Stored motions, with what of one's own they were run with.

    Parameters
    ----------
    files : sequence of Path
    **named
        Names of the classes by `law` and `body`, whose modules are imported.

    Raises
    ------
    OSError
        If a file cannot be read.
    ValueError
        If it is none, there is no such class, or no motion was run with it.
    """
    classes = {key.rpartition(".")[2]: known for key, known in _CLASSES.items()}
    for name, each in named.items():
        if "," in each:
            fault = f"must name the class alone, whose numbers are stored, got {each!r}"
            raise ArgumentError(name, fault)
    kinds = {name: classes[name].find(each) for name, each in named.items()}
    runs = [load_run(file) for file in files]
    used = {type(part) for run in runs for part in (run.scenario.friction, run.scenario.disk)}
    for name, kind in kinds.items():
        if kind not in used:
            raise ArgumentError(name, f"belongs to none of the motions, got {kind.__qualname__}")
    return runs


PATIENCE = 60.0
"""Processor time in s from which on a run is announced as it starts."""


@contextmanager
def announced(command: str, effort: Effort, time_limit: float | None = None) -> Iterator[Progress]:
    """Progress of a run; once it has begun it says what it takes, if that is long or in vain.

    So a run that is refused is told in one line. What a time limit ends may take long.

    Parameters
    ----------
    command : str
        Name of the command.
    effort : Effort
    time_limit : float, optional
        Processor time in s that the run may take.

    Raises
    ------
    ValueError
        If the run would take more steps than are made.
    """
    effort.check()
    endless = effort.seconds > PATIENCE and time_limit is None
    hint = "; --time-limit ends it early" if endless else ""
    left = [f"tippedisk {command}: {effort}{hint}"] if endless or effort.doubt else []
    with progress_bar() as progress:

        def tell(now: float, end: float) -> None:
            while left:
                say(left.pop())
            progress(now, end)

        yield tell


def in_cases(count: int) -> str:
    """A number of cases in words."""
    return f"{count} case{'s' * (count != 1)}"


def announce_cases(command: str, cases: str, seconds: float, processes: int, more: str) -> None:
    """Say how many cases are coming, and how long they take together.

    Parameters
    ----------
    command : str
        Name of the command.
    cases : str
        How many, in words.
    seconds : float
        Processor time of all of them.
    processes : int
        That share them.
    more : str
        What else is to be said.
    """
    time, count = duration(seconds / processes), f"{processes} process{'es' * (processes != 1)}"
    say(f"tippedisk {command}: {cases}, roughly {time} on {count}{more}")


def parse_spins(texts: Sequence[str], *, ends: bool = False) -> Array:
    """Spins in rad/s from values, lists and ranges in any order: each once, shape (n,).

    Parameters
    ----------
    texts : sequence of str
        Each a value, values with commas between, or `first:last:number`.
    ends : bool
        Whether first:last will do, since the ends alone are asked for.

    Raises
    ------
    ArgumentError
        If a text is none of these, or a range is empty or longer than `MOST_SPINS`.
    """
    spins: list[Any] = []
    for text in ",".join(texts).split(","):
        try:
            axis = axis_from("start.spin", text)
            within("number", axis.size or 2 * ends, 2 if ":" in text else 1, MOST_SPINS)
        except ValueError as error:
            fault = (
                "must be a value or first:last:number, of different ends and at least 2 and at "
                f"most {MOST_SPINS} spins, got {text!r}"
            )
            raise ArgumentError("spin", fault) from error
        spins += axis.grid or (axis.first, axis.last)
    return np.unique(np.array(spins, dtype=float))


def checked_end(end: float, least: float = SHORTEST_STEP) -> float:
    """Time in s from --end.

    Parameters
    ----------
    end : float
    least : float
        In s, such as the spacing of the samples.

    Raises
    ------
    ArgumentError
        If it is not positive, below `least` or beyond `LONGEST_MOTION`.
    """
    return within("end", positive("end", end), least, LONGEST_MOTION)
