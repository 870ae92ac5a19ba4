"""A scenario built in the engine, item by item, each with its reason; read and moved.

Each formulation is a class, which holds its traits. States are told in coordinates of the engine
and in those of the paper.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, ClassVar, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.motion.frames import turn_about_vertical
from analysis.problem.checks import Array
from analysis.problem.quantities import HELD, Constraint
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from mbs_models.loads import forces_on

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)

Kind = Literal["node", "object", "marker", "load", "sensor"]
KINDS: tuple[Kind, ...] = get_args(Kind)

Floats = Sequence[float]

Load = Callable[[], float]
"""What presses the disk on the table in the engine's current state, in N."""

Force = Callable[..., list[float]]
"""A user function of an engine item."""

SLIP_AXES: dict[Constraint, int] = {"no-slip-along": 1, "no-slip-across": 0}
"""Axes of the engine's rolling joint: it holds slip forward and sideways; 2 is the contact."""


class Model(ABC):
    """A scenario built in the engine.

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

    name: ClassVar[Formulation]

    has_euler_angles: ClassVar[bool] = False
    """Whether alpha, beta and gamma are coordinates of the engine, singular at a flat disk.

    Otherwise alpha and gamma are taken from a rotation, and known up to whole turns.
    """

    closes_contact: ClassVar[bool] = False
    """Whether the contact is closed without a constraint; its force comes from accelerations."""

    exponents: ClassVar[tuple[int, ...] | None] = None
    """Exponents of the step in the error expansion, if not those of the integrator."""

    own_equations: ClassVar[tuple[float, ...]] = ()
    """Sizes of the terms of algebraic equations besides those of the constraints."""

    _outputs: ClassVar[tuple[Any, ...]]
    """Output variables of the disk's node that make up a record."""

    _order: ClassVar[tuple[int, ...]] = ()
    """Places of the node's coordinates among the paper's, if it has these."""

    _node: int
    _table: int
    _centre: int

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:  # noqa: ARG003 - of a formulation without any
        """Why it cannot build a scenario; empty if it can."""
        return ""

    @classmethod
    def has_constraints(cls, scenario: Scenario) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take."""
        is_held = scenario.contact is None and not cls.closes_contact
        return is_held or bool(cls.own_equations)

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.start = scenario, scenario.initial_state
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        self.reasons: dict[tuple[Kind, int], str] = {}
        # Joints by what they hold, and which of their equations do.
        self._joints: dict[Constraint, tuple[int, list[int]]] = {}
        self._build()
        self._sensors = self._add_sensors()
        # What is added later needs this anew, which forgets initial accelerations.
        self.system.Assemble()

    # --- Building it -----------------------------------------------------------------------------

    @abstractmethod
    def _build(self) -> None:
        """Add nodes, bodies, markers and joints to `system`."""

    @abstractmethod
    def act(self, force: Force, name: str) -> None:
        """Have a user function of this name act on the disk."""

    @abstractmethod
    def friction(self, load: Load) -> Force:
        """User function of friction under a load."""

    def _contact_force(self) -> Force:
        """User function of a penalty contact, with friction and losses."""
        raise NotImplementedError

    def _disk_marker(self, offset: float, why: str) -> int:
        """Add a marker on the disk, so far from its centre along its x axis."""
        raise NotImplementedError

    def _turning(self, coordinate: str) -> tuple[int, int]:
        """Node, and place in it, of a coordinate whose rate is held."""
        return self._node, self._order.index(COORDINATES.index(coordinate))

    def _add(self, item: Any, why: str) -> int:
        """Add an item to the system under the reason for it; returns its number."""
        name = type(item).__name__
        kind = next(kind for kind in KINDS if name.lower().startswith(kind))
        number = int(getattr(self.system, f"Add{kind.capitalize()}")(item))
        self.reasons[kind, number] = why
        return number

    def _add_table(self) -> int:
        return self._add(items.ObjectGround(), "the table, which what holds the disk refers to")

    def _add_forces(self) -> None:
        """Add friction, or a penalty contact with all that goes with it."""
        if self.scenario.contact is not None:
            self.act(self._contact_force(), "penalty contact with friction and losses")
        elif self.scenario.rubs:
            self.act(self.friction(self._load()), "friction")

    def _load(self) -> Load:
        """What presses the disk on the table, constant or the contact's multiplier."""
        scenario, data = self.scenario, self.system.systemData
        if scenario.friction.load == "weight":
            weight = scenario.weight
            return lambda: weight
        # The multiplier of the present Newton iterate: the converged step has no lag. A contact
        # that pulls rubs with no load.
        return lambda: max(0.0, self.contact_force(data.GetAECoordinates()))

    def _hold(self) -> None:
        """Add the joints that hold the disk on the ideal contact."""
        scenario = self.scenario
        origin = self._add(
            items.MarkerBodyRigid(bodyNumber=self._table), "the table's side of the joints"
        )
        self._close_contact(origin)
        if "fixed-cog" in scenario.constraints:
            cog = self._disk_marker(scenario.disk.eccentricity, "the disk's centre of gravity")
            joint = self._add(
                items.ObjectJointSpherical(markerNumbers=[origin, cog], constrainedAxes=[1, 1, 0]),
                "holds the centre of gravity above the origin",
            )
            self._joints["fixed-cog"] = joint, [0, 1, 2]
        for name in scenario.constraints:
            if coordinate := HELD[name].rate:
                self._joints[name] = self._hold_rate(coordinate), [0]

    def _close_contact(self, origin: int) -> None:
        """Close the contact, without the slip that is held at zero."""
        held = {
            name: axis for name, axis in SLIP_AXES.items() if name in self.scenario.constraints
        }
        why = "contact with the table"
        if held:
            directions = " and ".join(name.removeprefix("no-slip-") for name in held)
            why += f", without slip {directions} the edge"
        joint = self._add(
            items.ObjectJointRollingDisc(
                markerNumbers=[origin, self._centre],
                constrainedAxes=[int(axis in (2, *held.values())) for axis in range(3)],
                discRadius=self.scenario.disk.radius,
                discAxis=[0.0, 0.0, 1.0],
            ),
            why,
        )
        self._joints["contact"] = joint, [2]
        self._joints |= {name: (joint, [axis]) for name, axis in held.items()}

    def _hold_rate(self, name: str) -> int:
        """Keep the rate of this coordinate as at the start; returns the joint."""
        node, place = self._turning(name)
        ground = self._add(items.NodePointGround(), f"what {name} is measured from")
        fixed = self._add(
            items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0), "the ground's coordinate"
        )
        turning = self._add(
            items.MarkerNodeCoordinate(nodeNumber=node, coordinate=place), f"the coordinate {name}"
        )
        return self._add(
            items.ObjectConnectorCoordinate(
                markerNumbers=[fixed, turning],
                offset=self.start.rates[COORDINATES.index(name)],
                velocityLevel=True,
            ),
            f"holds the rate of {name} constant; its torque is an output",
        )

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

    # --- Its states ------------------------------------------------------------------------------

    @abstractmethod
    def decode(self, records: Array) -> tuple[Array, Array]:
        """Co-rotating coordinates and rates, each shape (n, 6), from records, shape (n, k).

        Angles taken from rotation matrices lie in (-pi, pi].
        """

    @abstractmethod
    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        """The engine's coordinates and velocities, n each, from the six co-rotating ones each."""

    @abstractmethod
    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Array:
        """Second derivatives of the co-rotating coordinates, shape (6,).

        Parameters
        ----------
        second_derivatives : ndarray, shape (n,)
            Those of the engine's coordinates in its current state.
        coordinates, rates : sequence of 6 floats
            The same state. Taken back from a rotation, alpha of a nearly flat disk is uncertain.
        """

    def moved(self, position: Array, velocity: Array, time: float) -> Array:
        """The engine's coordinates after so many s of turning one way, shape (n,)."""
        return position + time * velocity

    def multipliers(
        self,
        ahead: Array,  # noqa: ARG002 - for models without multipliers
        algebraic: Array,
        coordinates: Array,
        rates: Array,
    ) -> Array:
        """Constraint forces on the disk in R-frame axes, shape (n, k).

        Parameters
        ----------
        ahead : ndarray, shape (n, i)
            Second derivatives of the engine's coordinates, or records that end with them.
        algebraic : ndarray, shape (n, m)
            The engine's algebraic coordinates.
        coordinates, rates : ndarray, shape (n, 6)
            Co-rotating coordinates and their rates, as `decode` makes them.
        """
        if self.scenario.contact is not None:
            return forces_on(self.scenario, coordinates, rates)[:, None]
        columns = []
        for constraint, rows in self.equations.items():
            # The engine's constraint forces act with a minus sign on the second body. The rolling
            # joint's forward and lateral axes point against e_x and e_y of the R-frame.
            force = algebraic[:, rows] if constraint in SLIP_AXES else -algebraic[:, rows]
            if constraint == "fixed-cog":
                force = turn_about_vertical(-coordinates[:, 3], force)[:, :2]
            columns.append(force)
        return np.hstack(columns)

    def record(self) -> Array:
        """Pose and velocity in the engine's current state, shape (k,)."""
        return np.concatenate(
            [self.system.GetNodeOutput(node, output) for node, output in self._readings()]
        )

    def samples(self) -> tuple[Array, Array]:
        """Times in s, shape (n,), and what the sensors have stored in a run, shape (n, k)."""
        stored = [np.array(self.system.GetSensorStoredData(sensor)) for sensor in self._sensors]
        stored = [np.atleast_2d(values) for values in stored]
        return stored[0][:, 0], np.hstack([values[:, 1:] for values in stored])

    @cached_property
    def equations(self) -> dict[Constraint, list[int]]:
        """Numbers of the algebraic equations of each constraint; the last of the COG is idle."""
        numbers = self.system.systemData.GetObjectLTGAE
        found: dict[Constraint, list[int]] = {}
        for name in self.scenario.constraints:
            if name in self._joints:
                joint, axes = self._joints[name]
                found[name] = [int(numbers(joint)[axis]) for axis in axes]
        return found

    @cached_property
    def contact_equation(self) -> int | None:
        """Number of the algebraic equation of the normal contact, if there is one."""
        return self.equations["contact"][0] if self._joints else None

    @property
    def held_rates(self) -> list[str]:
        """Coordinates whose rates stay those of the start."""
        return [rate for name in self.scenario.constraints if (rate := HELD[name].rate)]

    @property
    def may_pull(self) -> bool:
        """Whether the contact holds the disk down as well as up."""
        return self.scenario.contact is None or self.scenario.contact.bilateral

    def contact_force(self, algebraic: Array) -> float:
        """Force in N by which the contact's constraint pushes, from all algebraic coordinates."""
        # The engine's constraint forces act with a minus sign on the second body.
        return -float(algebraic[self.contact_equation])
