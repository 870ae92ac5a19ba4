"""An assembled engine system, and the way from its coordinates to the paper's."""

from abc import ABC, abstractmethod
from typing import Any, Literal, NamedTuple

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.checks import Array
from analysis.disk import GRAVITY
from analysis.frames import turn_about_vertical
from mbs_models.friction import ON_FLOATS, ON_SYMBOLS, Functions
from mbs_models.scene import Scene

GRAVITY_VECTOR = [0.0, 0.0, -GRAVITY]


class Residual(NamedTuple):
    """By how much a start breaks a constraint, in m or m/s."""

    constraint: str
    level: Literal["position", "velocity"]
    value: float


class Model(ABC):
    """A scene built in the engine.

    Parameters
    ----------
    scene : Scene
    symbolic : bool
        Whether the friction law is recorded for the engine to evaluate instead of called back in
        Python. Only for the load "weight"; `ValueError` otherwise.

    Attributes
    ----------
    system : exudyn.MainSystem
        Assembled, with the start of the scene as its initial state.
    """

    def __init__(self, scene: Scene, *, symbolic: bool = False) -> None:
        if symbolic and scene.friction.load == "contact":
            raise ValueError("symbolic friction takes the load 'weight' alone, got 'contact'")
        self.scene = scene
        self._symbolic = symbolic
        # What the engine refers to without keeping it alive.
        self._kept: list[Any] = []
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        # Joints by what they hold; the friction functions read the contact's number at run time.
        self._contact: list[int] = []
        self._cog: int | None = None
        self._spin: int | None = None
        self._build()
        self.system.Assemble()

    @abstractmethod
    def _build(self) -> None:
        """Add nodes, bodies, markers and joints to `system`."""

    @abstractmethod
    def record(self) -> Array:
        """Pose and velocity in the engine's current state, shape (k,)."""

    @abstractmethod
    def decode(self, records: Array) -> tuple[Array, Array]:
        """Co-rotating coordinates and rates, each shape (n, 6), from records, shape (n, k).

        Angles taken from rotation matrices lie in (-pi, pi].
        """

    @abstractmethod
    def decode_accelerations(self, second_derivatives: Array) -> Array:
        """Second derivatives of the co-rotating coordinates, shape (6,).

        Parameters
        ----------
        second_derivatives : ndarray, shape (n,)
            Those of the engine's coordinates in its current state.
        """

    def coordinate_rates(self) -> Array:
        """Time derivatives of the engine's coordinates in its current state, shape (n,)."""
        return np.array(self.system.systemData.GetODE2Coordinates_t())

    def multipliers(self, algebraic: Array, coordinates: Array) -> Array:
        """Constraint forces on the disk in R-frame axes, shape (n, k).

        Parameters
        ----------
        algebraic : ndarray, shape (n, m)
            The engine's algebraic coordinates.
        coordinates : ndarray, shape (n, 6)
            Co-rotating coordinates.
        """
        # The engine's constraint forces act with a minus sign on the second body.
        contact = algebraic[:, self._equations(self._contact[0])]
        columns = [-contact[:, 2]]
        if self._cog is not None:
            force = -algebraic[:, self._equations(self._cog)]
            columns += list(turn_about_vertical(-coordinates[:, 3], force).T[:2])
        if self.scene.level >= 3:
            # The joint's forward axis points against e_x of the R-frame.
            columns.append(contact[:, 1])
        if self._spin is not None:
            columns.append(-algebraic[:, self._equations(self._spin)[0]])
        return np.column_stack(columns)

    def start_residuals(self, velocity_residuals: Array) -> list[Residual]:
        """Constraint residuals of the start.

        Parameters
        ----------
        velocity_residuals : ndarray, shape (m,)
            The engine's algebraic equations on velocity level.
        """
        contact = velocity_residuals[self._equations(self._contact[0])]
        height = self.system.GetObjectOutput(self._contact[0], exu.OutputVariableType.Position)[2]
        residuals = [
            Residual("contact g_N", "position", float(height)),
            Residual("contact g_N", "velocity", float(contact[2])),
        ]
        if self._cog is not None:
            place = self.system.GetObjectOutput(self._cog, exu.OutputVariableType.Displacement)
            speed = velocity_residuals[self._equations(self._cog)]
            residuals += [
                Residual("fixed centre of gravity g_S", "position", float(np.hypot(*place[:2]))),
                Residual("fixed centre of gravity g_S", "velocity", float(np.hypot(*speed[:2]))),
            ]
        if self.scene.level >= 3:
            residuals.append(Residual("no tangential slip", "velocity", float(contact[1])))
        return residuals

    @property
    def contact_equation(self) -> int | None:
        """Number of the algebraic equation of the normal contact, if there is one."""
        return self._equations(self._contact[0])[2] if self._contact else None

    def _functions(self) -> Functions:
        return ON_SYMBOLS if self._symbolic else ON_FLOATS

    def _equations(self, joint: int) -> list[int]:
        return list(self.system.systemData.GetObjectLTGAE(joint))

    def _add_table(self) -> tuple[int, int]:
        """Add the table; returns its object number and a marker at the origin."""
        table = self.system.AddObject(items.ObjectGround())
        return table, self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=table))

    def _add_contact(self, table: int, centre: int) -> None:
        """Close the contact; from Model 3 on without slip along e_x of the R-frame."""
        self._contact.append(
            self.system.AddObject(
                items.ObjectJointRollingDisc(
                    markerNumbers=[table, centre],
                    constrainedAxes=[0, int(self.scene.level >= 3), 1],
                    discRadius=self.scene.disk.radius,
                    discAxis=[0.0, 0.0, 1.0],
                )
            )
        )

    def _add_fixed_cog(self, table: int, cog: int) -> None:
        """Hold the centre of gravity above the origin."""
        self._cog = self.system.AddObject(
            items.ObjectJointSpherical(markerNumbers=[table, cog], constrainedAxes=[1, 1, 0])
        )

    def _add_constant_spin(self, node: int) -> None:
        """Hold the rate of the first coordinate of `node` at the start's spin."""
        ground = self.system.AddNode(items.NodePointGround())
        markers = [
            self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=number, coordinate=0))
            for number in (ground, node)
        ]
        self._spin = self.system.AddObject(
            items.ObjectConnectorCoordinate(
                markerNumbers=markers, offset=self.scene.start.rates[3], velocityLevel=True
            )
        )
