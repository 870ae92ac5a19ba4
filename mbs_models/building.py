"""What is added to an engine system for the disk, item by item, each with its reason."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items

from analysis.data.constraint_set import prescribed
from analysis.data.quantities import Constraint
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES

Kind = Literal["node", "object", "marker", "load", "sensor"]

SLIP_AXES: dict[Constraint, int] = {"no-slip-along": 1, "no-slip-across": 0}
"""Axes of the engine's rolling joint: it holds slip forward and sideways; 2 is the contact."""


class Building(ABC):
    """A scenario as it is built in the engine.

    Parameters
    ----------
    scenario : Scenario
        One that meets no `obstacle`.

    Attributes
    ----------
    scenario : Scenario
    start : State
        That of the scenario.
    system : exudyn.MainSystem
        Assembled, with the start of the scene as its initial state.
    reasons : dict
        From kind and number of every item in the system to why it is there.
    """

    own_equations: ClassVar[tuple[float, ...]] = ()
    """Sizes of the terms of algebraic equations besides those of the constraints."""

    _node: int

    _outputs: ClassVar[tuple[Any, ...]]
    """Output variables of the disk's node that make up a record."""

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:  # noqa: ARG003 - of a formulation without any
        """Why it cannot build a scenario; empty if it can."""
        return ""

    @classmethod
    def has_constraints(cls, scenario: Scenario) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take."""
        return scenario.contact is None or bool(cls.own_equations)

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.start = scenario, scenario.initial_state
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        # Joints by what they hold; the friction functions read the contact's number at run time.
        self._contact: list[int] = []
        self.reasons: dict[tuple[Kind, int], str] = {}
        self._cog: int | None = None
        self._rates: dict[str, int] = {}
        self._build()
        self._sensors = self._add_sensors()
        # What is added later needs this anew, which forgets initial accelerations.
        self.system.Assemble()

    @abstractmethod
    def _build(self) -> None:
        """Add nodes, bodies, markers and joints to `system`."""

    def _readings(self) -> list[tuple[int, Any]]:
        """Nodes, and their output variables, which make up a record."""
        return [(self._node, output) for output in self._outputs]

    def _add_sensors(self) -> list[int]:
        """Add what is sampled in a run: the record, and the algebraic coordinates if any."""
        data, store = self.system.systemData, {"storeInternal": True, "writeToFile": False}
        sensors = [
            self._add(
                items.SensorNode(nodeNumber=node, outputVariableType=output, **store),
                f"{output.name} at every sample",
            )
            for node, output in self._readings()
        ]
        if self.has_constraints(self.scenario):
            forces = items.SensorUserFunction(
                sensorNumbers=[],
                factors=[],
                sensorUserFunction=lambda *_unused: data.GetAECoordinates(),
                **store,
            )
            why = "constraint forces at every sample, by a user function"
            sensors.append(self._add(forces, why))
        return sensors

    def _slip_axes(self) -> dict[Constraint, int]:
        """Axes of the rolling joint along which the constraints hold slip at zero."""
        held = self.scenario.constraints
        return {name: axis for name, axis in SLIP_AXES.items() if name in held}

    def _add(self, item: Any, why: str) -> int:
        """Add an item to the system under the reason for it; returns its number."""
        kind = _kind(item)
        number = int(getattr(self.system, f"Add{kind.capitalize()}")(item))
        self.reasons[kind, number] = why
        return number

    def _add_table(self) -> int:
        """Add the table; returns its object number."""
        return self._add(items.ObjectGround(), "the table, which what holds the disk refers to")

    def _add_origin(self, table: int) -> int:
        """Add a marker at the origin; returns its number."""
        return self._add(items.MarkerBodyRigid(bodyNumber=table), "the table's side of the joints")

    def _add_contact(self, table: int, centre: int) -> None:
        """Close the contact, without the slip that is held at zero."""
        axes, why = [0, 0, 1], "contact with the table"
        held = self._slip_axes()
        for axis in held.values():
            axes[axis] = 1
        if held:
            directions = " and ".join(name.removeprefix("no-slip-") for name in held)
            why += f", without slip {directions} the edge"
        self._contact.append(
            self._add(
                items.ObjectJointRollingDisc(
                    markerNumbers=[table, centre],
                    constrainedAxes=axes,
                    discRadius=self.scenario.disk.radius,
                    discAxis=[0.0, 0.0, 1.0],
                ),
                why,
            )
        )

    def _add_fixed_cog(self, table: int, cog: int) -> None:
        """Hold the centre of gravity above the origin."""
        self._cog = self._add(
            items.ObjectJointSpherical(markerNumbers=[table, cog], constrainedAxes=[1, 1, 0]),
            "holds the centre of gravity above the origin",
        )

    @property
    def held_rates(self) -> list[str]:
        """Coordinates whose rates stay those of the start."""
        return [*prescribed(self.scenario.constraints).values()]

    def _hold_rate(self, name: str, node: int, place: int = 0) -> None:
        """Keep the rate of this coordinate, that of `node` at `place`, as at the start."""
        ground = self._add(items.NodePointGround(), f"what {name} is measured from")
        fixed = self._add(
            items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0), "the ground's coordinate"
        )
        turning = self._add(
            items.MarkerNodeCoordinate(nodeNumber=node, coordinate=place), f"the coordinate {name}"
        )
        self._rates[name] = self._add(
            items.ObjectConnectorCoordinate(
                markerNumbers=[fixed, turning],
                offset=self.start.rates[COORDINATES.index(name)],
                velocityLevel=True,
            ),
            f"holds the rate of {name} constant; its torque is an output",
        )


def table_forces(scenario: Scenario) -> str:
    """What the force law covers by which the table acts on the disk; empty if there is none."""
    loss = scenario.dissipation
    parts = {
        "penalty contact": scenario.contact is not None,
        "friction": scenario.rubs,
        "rolling resistance": loss.rolling_dry > 0.0 or loss.rolling_viscous > 0.0,
        "pivoting friction": loss.pivoting > 0.0,
        "air drag": loss.air_drag > 0.0,
    }
    if scenario.contact is None and not scenario.rubs:
        return ""
    *others, last = [name for name, present in parts.items() if present]
    return f"{', '.join(others)} and {last}" if others else last


def _kind(item: Any) -> Kind:
    name = type(item).__name__
    kinds: tuple[Kind, ...] = get_args(Kind)
    return next(kind for kind in kinds if name.lower().startswith(kind))
