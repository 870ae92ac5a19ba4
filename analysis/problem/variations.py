"""Variations of a scenario: some quantities changed, in one or in many members at once."""

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import InitVar, dataclass, replace
from numbers import Integral
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from analysis.problem.bodies import BODIES
from analysis.problem.body import Body
from analysis.problem.checks import float_array, instance, several, switch
from analysis.problem.contact import PenaltyContact
from analysis.problem.disk import Disk
from analysis.problem.elementary import DividedError, Members, Rows
from analysis.problem.friction import LAWS
from analysis.problem.names import ArgumentError, full_name
from analysis.problem.quantities import RING, SIX, declared
from analysis.problem.scenario import KINDS, Scenario, as_plain, made_part, maker, told_constraints
from analysis.problem.start import Start
from analysis.problem.user_modules import error_text
from analysis.problem.values import Value, read_value

T = TypeVar("T")
Numbers = dict[str, Any]
Values = npt.NDArray[Any]


def check_fields(scenario: Scenario, values: Mapping[str, Any]) -> None:
    """Check that quantities can be varied together in a scenario.

    Parameters
    ----------
    scenario : Scenario
    values : mapping
        One of the values of each, by key.

    Raises
    ------
    ArgumentError
        If the scenario has no such quantity.
    """
    for table, given in _by_table(values).items():
        if table == "contact" and scenario.contact is None:
            key = f"contact.{next(iter(given))}"
            raise ArgumentError(key, "needs a penalty contact, and the scenario's is ideal")
        if table:
            maker(table, _merged(scenario, table, given, scenario.disk))
        else:
            told_constraints(**given)


def changed(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """Scenario with some quantities changed.

    Parameters
    ----------
    scenario : Scenario
    changes : mapping
        Values by key; a `Members` changes all members of an ensemble.

    Raises
    ------
    ArgumentError
        If a value is out of range or does not fit the rest.
    """
    numbers = _by_table(changes)
    parts: dict[str, Any] = {}
    if "" in numbers:
        told = told_constraints(**numbers[""])
        is_text = isinstance(told, str)
        parts["constraints"] = re.split(r"\s*[+,]\s*", told.strip()) if is_text else told
    # What a new contact is like follows from the disk, which comes before it.
    for table in (*KINDS, "start"):
        if table in numbers:
            disk = parts.get("disk", scenario.disk)
            parts[table] = made_part(table, _merged(scenario, table, numbers[table], disk))
    return replace(scenario, **parts)


def _by_table(values: Mapping[str, Any]) -> dict[str, Numbers]:
    found: dict[str, Numbers] = {}
    for key, value in values.items():
        table, _, name = key.rpartition(".")
        found.setdefault(table, {})[name] = value
    return found


def _merged(scenario: Scenario, table: str, given: Numbers, disk: Body) -> Numbers:
    """Data of a part with some of it changed; a new contact is one for this disk."""
    part = getattr(scenario, table)
    if table == "disk":
        return _body(part, given)
    if table == "friction":
        return LAWS.merged(part, given)
    if table == "start" and not isinstance(part, Start):
        fault = "cannot change: the start is told by its coordinates and rates"
        raise ArgumentError(next(iter(given)), fault)
    if part is None:
        if "stiffness" not in given:
            name, value = next(iter(given.items()))
            fault = f"needs a penalty contact, told by its stiffness, got {value}"
            raise ArgumentError(name, fault)
        part = PenaltyContact.damped(given["stiffness"], disk)
    return as_plain(part) | given


def _body(disk: Body, given: Numbers) -> Numbers:
    """Data of a body with some of it changed; with a geometry, from which the others follow."""
    if "name" in given:
        disk = made_part("disk", {"name": given["name"]})
    told = {name: value for name, value in given.items() if name != "name"}
    if "body" in told and BODIES.find(told["body"]) is type(disk):
        # To name what it is changes nothing.
        del told["body"]
    known = as_plain(disk)
    if not told or told.keys() >= {*RING}:
        return told or known
    geometry = [name for name in RING if name in told]
    is_told = "body" in told or told.keys() >= {*SIX}
    if is_told or not isinstance(disk, Disk) or not geometry:
        return BODIES.merged(disk, told)
    if known.keys() != {*RING}:
        raise ArgumentError(
            geometry[0],
            "varies a ring alone, of which mass and moments of inertia follow, and the "
            f"scenario's disk is another: give all of {', '.join(RING)}, or all of "
            f"{', '.join(SIX)}",
        )
    # What does not go together is named by what is given, without the rest of the ring.
    is_mixed = told.keys() - {*RING} and told.keys() - {*SIX}
    return told if is_mixed else known | told


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Ensemble:
    """Scenarios that differ in some of their fields.

    Everything is checked by the rules of a single scenario, for all members at once.

    Parameters
    ----------
    scenario : Scenario
        With whatever does not vary.
    fields : mapping
        From the dotted name of a field, as a scenario's file has it ("start.spin"), or its last
        part alone where that is enough ("spin"), to its values, each shape (m,), m > 0. Fields
        are those that a sweep may vary.
    check : bool
        Whether all members are checked at once; those that are no scenarios else fail alone,
        where they are run.

    Raises
    ------
    ValueError
        If the scenario has no such field, shapes differ, or a member is no scenario; that member
        and why are named.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Ensemble, Scenario
    >>> spins = Ensemble(scenario=Scenario(), fields={"spin": np.linspace(20.0, 60.0, 5)})
    >>> len(spins), spins[1].start.spin
    (5, 30.0)
    """

    scenario: Scenario
    fields: Mapping[str, Values]
    check: InitVar[bool] = True

    def __post_init__(self, check: bool) -> None:
        instance("scenario", self.scenario, Scenario)
        if not isinstance(self.fields, Mapping) or not self.fields:
            raise ArgumentError("fields", f"must map names to arrays, got {self.fields!r}")
        found: dict[str, Values] = {}
        for given, values in self.fields.items():
            name = full_name(given, "fields")
            if name in found:
                raise ValueError(f"fields must hold each field once, got {name} twice")
            found[name] = _values(name, values)
        if len({values.shape for values in found.values()}) > 1:
            shapes = (f"{values.shape} of {name}" for name, values in found.items())
            raise ValueError(f"fields must have one shape, got {' and '.join(shapes)}")
        object.__setattr__(self, "fields", found)
        if not switch("check", check):
            return
        check_fields(self.scenario, self._values(0))
        for rows, made in self.map_groups(lambda scenario: scenario):
            if isinstance(made, Exception):
                raise ValueError(f"member {rows[0]} of fields: {made}") from None

    def __len__(self) -> int:
        return len(next(iter(self.fields.values())))

    def __getitem__(self, member: int) -> Scenario:
        """Scenario of a member."""
        return changed(self.scenario, self._values(self.number(member)))

    def number(self, member: int) -> int:
        """Number of a member from either end, or `IndexError`."""
        count = len(self)
        if not isinstance(member, Integral) or not -count <= member < count:
            raise IndexError(f"member must lie from {-count} to {count - 1}, got {member!r}")
        return int(member) % count

    def __iter__(self) -> Iterator[Scenario]:
        return (self[member] for member in range(len(self)))

    def __repr__(self) -> str:
        return f"Ensemble({len(self)} times {self.scenario.name}: {', '.join(self.fields)})"

    def subset(self, rows: Rows | slice) -> "Ensemble":
        """Ensemble of some of the members, which need no further check."""
        fields = {name: values[rows] for name, values in self.fields.items()}
        return Ensemble(scenario=self.scenario, fields=fields, check=False)

    def map_groups(
        self, function: Callable[[Scenario], T]
    ) -> Iterator[tuple[Rows, T | Exception]]:
        """Call a function for the scenarios of members that go the same way in it.

        Parameters
        ----------
        function : callable
            Of a scenario whose fields that vary are `Members`.

        Yields
        ------
        rows : ndarray of int, shape (k,)
            Numbers of members.
        result
            Of the function, or the error that it ended in for a single member; such members come
            last, in order.
        """
        numbers = {name: each for name, each in self.fields.items() if each.dtype.kind == "f"}
        pending, alone = list(self._by_words()), [np.empty(0, dtype=int)]
        while pending:
            words, rows = pending.pop()
            some = {name: each[rows].view(Members) for name, each in numbers.items()}
            try:
                # What overflows is looked at member by member.
                with np.errstate(over="raise", divide="raise", invalid="raise"):
                    result = function(changed(self.scenario, {**words, **some}))
            except DividedError as divided:
                pending += [(words, rows[~divided.mask]), (words, rows[divided.mask])]
            except (Exception, SystemExit):  # noqa: BLE001 - a law of one's own may raise any
                # It may be the error of some of them alone.
                alone.append(rows)
            else:
                yield rows, result
        yield from one_by_one(function, self, np.sort(np.concatenate(alone)).tolist())

    def _values(self, member: int) -> dict[str, Value]:
        return {name: values[member].item() for name, values in self.fields.items()}

    def _by_words(self) -> Iterator[tuple[Mapping[str, Value], Rows]]:
        """Members that differ in numbers alone."""
        words = {name: each for name, each in self.fields.items() if each.dtype.kind != "f"}
        groups: defaultdict[tuple[Value, ...], list[int]] = defaultdict(list)
        for member in range(len(self)):
            groups[tuple(each[member].item() for each in words.values())].append(member)
        for key, rows in groups.items():
            yield dict(zip(words, key, strict=True)), np.array(rows)


def one_by_one(
    function: Callable[[Scenario], T],
    scenarios: Ensemble | Sequence[Scenario],
    rows: Iterable[int],
) -> Iterator[tuple[Rows, T | Exception]]:
    """Call a function for single scenarios; see `Ensemble.map_groups`."""
    for row in rows:
        try:
            yield np.array([row]), function(scenarios[row])
        except Exception as error:  # noqa: BLE001 - a law of one's own may raise any
            yield np.array([row]), error
        except SystemExit as error:
            yield np.array([row]), RuntimeError(error_text(error))


def _values(name: str, given: npt.ArrayLike) -> Values:
    """Clean values of a field, shape (m,), that nobody can change."""
    if declared(name).is_word:
        values = np.array([read_value(name, each) for each in several(name, given, "values")])
    else:
        values = float_array(name, given)
    if values.ndim != 1 or not values.size:
        raise ValueError(f"{name} must have shape (m,), m > 0, got {values.shape}")
    values.setflags(write=False)
    return values
