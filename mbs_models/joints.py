"""Joints that hold the disk on the ideal contact, their equations and their forces."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import exudyn.itemInterface as items
import numpy as np

from analysis.motion.frames import turn_about_vertical
from analysis.problem.checks import Array
from analysis.problem.quantities import HELD, Constraint
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from mbs_models.assembly import Assembly

SLIP_AXES: dict[Constraint, int] = {"no-slip-along": 1, "no-slip-across": 0}
"""Axes of the engine's rolling joint: it holds slip forward and sideways; 2 is the contact."""


CENTRE = 0.0, "the disk's centre"
"""Where a marker of it stands, and why."""

Gap = Callable[[Any], tuple[float, list[float]]]
"""From coordinates to the height over the table of what touches it, in m, and its slopes."""


class Joints:
    """Joints of a scenario, none until they are added.

    Parameters
    ----------
    assembly : Assembly
        What they are added to.
    scenario : Scenario
    """

    def __init__(self, assembly: Assembly, scenario: Scenario) -> None:
        self._assembly, self._scenario = assembly, scenario
        # By what they hold, and which of their equations do.
        self._held: dict[Constraint, tuple[int, list[int]]] = {}

    def add(
        self,
        disk_marker: Callable[[float, str], int],
        turning: Callable[[str], tuple[int, int]],
        close: Callable[[], int],
    ) -> None:
        """Add them.

        Parameters
        ----------
        disk_marker : callable
            Adds a marker on the disk, so far from its centre along its x axis, for a reason.
        turning : callable
            From a coordinate whose rate is held to a node and the place in it of that.
        close : callable
            Closes the contact of another body than a round disk; returns the joint.
        """
        if self._scenario.disk.is_round_disk:
            self._roll(disk_marker)
        else:
            self._held["contact"] = close(), [0]
        rates = self._scenario.initial_state.rates
        for constraint in self._scenario.constraints:
            if name := HELD[constraint].rate:
                why = f"holds the rate of {name} constant; its torque is an output"
                rate: dict[str, Any] = {
                    "offset": rates[COORDINATES.index(name)],
                    "velocityLevel": True,
                }
                self._held[constraint] = self.hold(name, *turning(name), why, **rate), [0]

    def touch(self, body: int, gap: Gap) -> int:
        """Close the contact of a body of any surface; returns the joint.

        Parameters
        ----------
        body : int
            Object whose coordinates tell the gap below it.
        gap : callable
            See `Gap`.
        """

        def residual(
            _system: Any, _t: Any, _item: Any, q: Any, u: Any, is_velocity: bool
        ) -> list[float]:
            height, slopes = gap(q)
            return [float(np.dot(slopes, u)) if is_velocity else height]

        add, ground = self._assembly.add, self._ground("the contact")
        fixed = add(items.MarkerNodeCoordinates(nodeNumber=ground), "the table's coordinates")
        moving = add(
            items.MarkerObjectODE2Coordinates(objectNumber=body), "the body's coordinates"
        )
        return add(
            items.ObjectConnectorCoordinateVector(
                markerNumbers=[fixed, moving],
                scalingMarker0=np.zeros((1, 1)),
                constraintUserFunction=residual,
                jacobianUserFunction=lambda _s, _t, _i, q, *_unused: np.array([gap(q)[1]]),
            ),
            "contact with the table by a user function",
        )

    def _roll(self, disk_marker: Callable[[float, str], int]) -> None:
        """Close the contact of a disk, without the slip and with the place that are held."""
        add, disk = self._assembly.add, self._scenario.disk
        origin = add(
            items.MarkerBodyRigid(bodyNumber=self._assembly.table),
            "the table's side of the joints",
        )
        held = {
            name: axis for name, axis in SLIP_AXES.items() if name in self._scenario.constraints
        }
        why = "contact with the table"
        if held:
            directions = " and ".join(name.removeprefix("no-slip-") for name in held)
            why += f", without slip {directions} the edge"
        joint = add(
            items.ObjectJointRollingDisc(
                markerNumbers=[origin, disk_marker(*CENTRE)],
                constrainedAxes=[int(axis in (2, *held.values())) for axis in range(3)],
                discRadius=disk.radius,
                discAxis=[0.0, 0.0, 1.0],
            ),
            why,
        )
        self._held["contact"] = joint, [2]
        self._held |= {name: (joint, [axis]) for name, axis in held.items()}
        if "fixed-cog" in self._scenario.constraints:
            cog = disk_marker(disk.eccentricity, "the disk's centre of gravity")
            joint = add(
                items.ObjectJointSpherical(markerNumbers=[origin, cog], constrainedAxes=[1, 1, 0]),
                "holds the centre of gravity above the origin",
            )
            self._held["fixed-cog"] = joint, [0, 1, 2]

    def hold(self, name: str, node: int, place: int, why: str, **how: Any) -> int:
        """Keep a coordinate of a node where the engine counts it from; returns the joint.

        Parameters
        ----------
        name : str
            Of the coordinate.
        node, place : int
            Node, and number of the coordinate in it.
        why : str
            Why the joint is there.
        **how
            Of the engine's item: another offset, or its rate in place of it (`velocityLevel`).
        """
        add, ground = self._assembly.add, self._ground(name)
        fixed = add(
            items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0), "the ground's coordinate"
        )
        moving = add(
            items.MarkerNodeCoordinate(nodeNumber=node, coordinate=place), f"the coordinate {name}"
        )
        return add(items.ObjectConnectorCoordinate(markerNumbers=[fixed, moving], **how), why)

    def _ground(self, name: str) -> int:
        return self._assembly.add(items.NodePointGround(), f"what {name} is measured from")

    @cached_property
    def equations(self) -> dict[Constraint, list[int]]:
        """Numbers of the algebraic equations of each constraint; the last of the COG is idle."""
        numbers = self._assembly.system.systemData.GetObjectLTGAE
        return {
            name: [int(numbers(joint)[axis]) for axis in axes]
            for name in self._scenario.constraints
            if name in self._held
            for joint, axes in [self._held[name]]
        }

    @cached_property
    def contact_equation(self) -> int | None:
        """Number of the algebraic equation of the normal contact, if there is one."""
        return self.equations["contact"][0] if self._held else None

    def contact_force(self, algebraic: Array) -> float:
        """Force in N by which the contact's constraint pushes, from all algebraic coordinates."""
        # The engine's constraint forces act with a minus sign on the second body.
        return -float(algebraic[self.contact_equation])

    def forces(self, carriers: Array, alpha: Array) -> Array:
        """Constraint forces on the disk in R-frame axes, shape (n, k).

        Parameters
        ----------
        carriers : ndarray, shape (n, i)
            What ends with the engine's algebraic coordinates.
        alpha : ndarray, shape (n,)
        """
        columns, count = [], len(self._assembly.system.systemData.GetAECoordinates())
        algebraic = carriers[:, -count:]
        for constraint, rows in self.equations.items():
            # Again with a minus sign; but the rolling joint's forward and lateral axes point
            # against e_x and e_y of the R-frame.
            force = algebraic[:, rows] if constraint in SLIP_AXES else -algebraic[:, rows]
            if constraint == "fixed-cog":
                force = turn_about_vertical(-alpha, force)[:, :2]
            columns.append(force)
        return np.hstack(columns)
