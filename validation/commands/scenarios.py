"""From options of the command line to the scenario that they describe."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis import BODIES, LAWS, PenaltyContact, Scenario, StoredRun, load_run, load_scenario
from analysis.problem.names import ArgumentError
from analysis.problem.values import read_value
from analysis.problem.variations import changed


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """What a call tells of a scenario.

    Parameters
    ----------
    file : Path, optional
        Of a scenario, or of a stored run of either kind (.npz).
    named : mapping
        What changes it: texts by the keys of quantities.
    """

    file: Path | None
    named: Mapping[str, Any]

    def scenario(self, *, rest: bool = False, model: int | None = None) -> Scenario:
        """Scenario of the file, or the default one, with what the options change.

        Parameters
        ----------
        rest : bool
            Whether the default is that of the way to rest.
        model : int, optional
            Its constraints unless the options tell some.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If the file is none, or an option is out of range or does not fit the rest.
        """
        given = _given(self.named)
        if model is not None and not given.keys() & {"model", "constraints"}:
            given["model"] = model
        # Their modules are imported before what was stored with them is read.
        if "friction.law" in given:
            LAWS.find(given["friction.law"])
        if "disk.body" in given:
            BODIES.find(given["disk.body"])
        if self.file is None:
            base = _to_rest(given) if rest else Scenario()
        else:
            stored = self.file.suffix.lower() == ".npz"
            base = load_run(self.file).scenario if stored else load_scenario(self.file)
        return changed(base, given)


def _given(named: Mapping[str, Any]) -> dict[str, Any]:
    """What the options tell of quantities, by key; a class's parameters stand behind its name."""
    given = {key: read_value(key, value, key.rpartition(".")[2]) for key, value in named.items()}
    for key in ("friction.law", "disk.body"):
        table, _, option = key.rpartition(".")
        name, *parameters = str(given.get(key, "")).split(",")
        for parameter in parameters:
            own, equals, text = parameter.partition("=")
            field = f"{table}.{own.strip()}"
            if not equals:
                raise ArgumentError(
                    option, f"must hold parameter=value behind its name, got {parameter!r}"
                )
            if field in given:
                raise ArgumentError(option, f"tells {own.strip()}, which is told twice")
            given[field] = read_value(field, text, own.strip())
        if name:
            given[key] = name
    return given


def _to_rest(given: dict[str, Any]) -> Scenario:
    """Scenario of the way to rest, whose damping follows from the stiffness and the disk."""
    of_disk = {key: given.pop(key) for key in list(given) if key.startswith("disk.")}
    disk = changed(Scenario(), of_disk).disk
    named = {name: f"contact.{name}" for name in ("stiffness", "half_thickness")}
    told = {name: given.pop(key) for name, key in named.items() if key in given}
    return Scenario.rest(disk=disk, contact=PenaltyContact.rounded(disk, **told))


def stored_runs(
    files: Sequence[Path], law: str | None = None, body: str | None = None
) -> list[StoredRun]:
    """Stored motions, with what of one's own they were run with.

    Parameters
    ----------
    files : sequence of Path
    law, body : str, optional
        Names of the classes, whose modules are imported.

    Raises
    ------
    OSError
        If a file cannot be read.
    ValueError
        If it is none, there is no such class, or no motion was run with it.
    """
    kinds: dict[str, type] = {} if law is None else {"law": LAWS.find(law)}
    kinds |= {} if body is None else {"body": BODIES.find(body)}
    runs = [load_run(file) for file in files]
    used = {type(part) for run in runs for part in (run.scenario.friction, run.scenario.disk)}
    for name, kind in kinds.items():
        if kind not in used:
            raise ArgumentError(name, f"belongs to none of the motions, got {kind.__qualname__}")
    return runs
