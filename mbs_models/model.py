"""An assembled engine system, and the way from its coordinates to the paper's."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.data.checks import Array
from analysis.data.frames import turn_about_vertical
from analysis.data.quantities import Constraint
from analysis.data.scenario import Scenario
from mbs_models.body_contact import forces_on
from mbs_models.loads import normal_forces

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)

Kind = Literal["node", "object", "marker", "load", "sensor"]


_SLIP_AXES: dict[Constraint, int] = {"no-slip-along": 1, "no-slip-across": 0}
"""Axes of the engine's rolling joint: it holds slip forward and sideways; 2 is the contact."""


Floats = Sequence[float]


class Model(ABC):
    """A scenario built in the engine. Each formulation is a class, which holds its traits.

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

    _outputs: ClassVar[tuple[Any, ...]]
    """Output variables of the disk's node that make up a record."""

    _node: int

    own_equations: ClassVar[tuple[float, ...]] = ()
    """Sizes of the terms of algebraic equations besides those of the constraints."""

    has_exact_path: ClassVar[bool] = False
    """Whether `path` is exact to the last digits, so that short differences along it may be taken.

    Rotations that are composed, or parametrised by more than three numbers, lose some.
    """

    exponents: ClassVar[tuple[int, ...] | None] = None
    """Exponents of the step in the error expansion, if not those of the integrator."""

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
        self._spin: int | None = None
        self._build()
        self._sensors = self._add_sensors()
        # What is added later needs this anew, which forgets initial accelerations.
        self.system.Assemble()

    @abstractmethod
    def _build(self) -> None:
        """Add nodes, bodies, markers and joints to `system`."""

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

    def path(self, position: Array, velocity: Array) -> Callable[[float], Array]:
        """From a time in s to the engine's coordinates, shape (n,), at constant velocities."""
        return lambda time: position + time * velocity

    def multipliers(
        self,
        records: Array,  # noqa: ARG002 - for models without multipliers
        algebraic: Array,
        coordinates: Array,
        rates: Array,
    ) -> Array:
        """Constraint forces on the disk in R-frame axes, shape (n, k).

        Parameters
        ----------
        records : ndarray, shape (n, i)
            See `record`.
        algebraic : ndarray, shape (n, m)
            The engine's algebraic coordinates.
        coordinates, rates : ndarray, shape (n, 6)
            Co-rotating coordinates and their rates, as `decode` makes them.
        """
        if self.scenario.contact is not None:
            disk = self.scenario.disk
            if not disk.is_round_disk:
                return forces_on(self.scenario, self.scenario.contact, coordinates, rates)[:, None]
            return normal_forces(self.scenario.contact, disk, coordinates, rates)[:, None]
        # The engine's constraint forces act with a minus sign on the second body.
        contact = algebraic[:, self._equations(self._contact[0])]
        columns = [-contact[:, 2]]
        if self._cog is not None:
            force = -algebraic[:, self._equations(self._cog)]
            columns += list(turn_about_vertical(-coordinates[:, 3], force).T[:2])
        # The joint's forward and lateral axes point against e_x and e_y of the R-frame.
        columns += [contact[:, axis] for axis in self._slip_axes().values()]
        if self._spin is not None:
            columns.append(-algebraic[:, self._equations(self._spin)[0]])
        return np.column_stack(columns)

    def _readings(self) -> list[tuple[int, Any]]:
        """Nodes, and their output variables, which make up a record."""
        return [(self._node, output) for output in self._outputs]

    def record(self) -> Array:
        """Pose and velocity in the engine's current state, shape (k,)."""
        return np.concatenate(
            [self.system.GetNodeOutput(node, output) for node, output in self._readings()]
        )

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

    def samples(self) -> tuple[Array, Array]:
        """Times in s, shape (n,), and what the sensors have stored in a run, shape (n, k)."""
        stored = [np.array(self.system.GetSensorStoredData(sensor)) for sensor in self._sensors]
        stored = [np.atleast_2d(values) for values in stored]
        return stored[0][:, 0], np.hstack([values[:, 1:] for values in stored])

    def position_residuals(self) -> dict[Constraint, float]:
        """By how much the engine's current state breaks the constraints of positions, in m."""
        outputs = exu.OutputVariableType
        # The joint of a sphere tells how far it is off; that of a disk where its contact is.
        output = (
            outputs.Position if self.scenario.disk.is_round_disk else outputs.DisplacementLocal
        )
        height = self.system.GetObjectOutput(self._contact[0], output)[2]
        found: dict[Constraint, float] = {"contact": float(height)}
        if self._cog is not None:
            place = self.system.GetObjectOutput(self._cog, exu.OutputVariableType.Displacement)
            found["fixed-cog"] = float(np.hypot(*place[:2]))
        return found

    def velocity_residuals(self, equations: Array) -> dict[Constraint, float]:
        """By how much it breaks them on velocity level in m/s, from the algebraic equations."""
        contact = equations[self._equations(self._contact[0])]
        found: dict[Constraint, float] = {"contact": float(contact[2])}
        if self._cog is not None:
            found["fixed-cog"] = float(np.hypot(*equations[self._equations(self._cog)][:2]))
        return found | {name: float(contact[axis]) for name, axis in self._slip_axes().items()}

    @property
    def contact_equation(self) -> int | None:
        """Number of the algebraic equation of the normal contact, if there is one."""
        return self._equations(self._contact[0])[2] if self._contact else None

    @property
    def may_pull(self) -> bool:
        """Whether the contact holds the disk down as well as up."""
        return self.scenario.contact is None or self.scenario.contact.bilateral

    def pulls(self) -> bool:
        """Whether the contact's constraint pulls in the engine's current state."""
        equation = self.contact_equation
        # The engine's constraint forces act with a minus sign on the second body.
        return equation is not None and self.system.systemData.GetAECoordinates()[equation] > 0.0

    def friction_under(self, load: float) -> list[float]:
        """Friction on the engine's coordinates under a contact force in N, n floats.

        In the engine's current state, of a law that takes that force as its load.
        """
        raise NotImplementedError

    def _slip_axes(self) -> dict[Constraint, int]:
        """Axes of the rolling joint along which the constraints hold slip at zero."""
        held = self.scenario.constraints
        return {name: axis for name, axis in _SLIP_AXES.items() if name in held}

    def _equations(self, joint: int) -> list[int]:
        return list(self.system.systemData.GetObjectLTGAE(joint))

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

    def _add_constant_spin(self, node: int) -> None:
        """Hold the rate of the first coordinate of `node` at the start's spin."""
        ground = self._add(items.NodePointGround(), "what the spin is measured from")
        fixed = self._add(
            items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0), "the ground's coordinate"
        )
        turning = self._add(
            items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0), "the spin's coordinate"
        )
        self._spin = self._add(
            items.ObjectConnectorCoordinate(
                markerNumbers=[fixed, turning],
                offset=self.start.rates[3],
                velocityLevel=True,
            ),
            "holds the spin constant; its torque is an output",
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
