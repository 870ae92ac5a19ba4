"""Joints that hold the disk on the ideal contact, their equations and their forces."""

from collections.abc import Callable
from functools import cached_property

import exudyn.itemInterface as items
import numpy as np

from analysis.motion.frames import turn_about_vertical
from analysis.problem.bodies import Sphere
from analysis.problem.checks import Array
from analysis.problem.quantities import HELD, Constraint
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from mbs_models.assembly import Assembly

SLIP_AXES: dict[Constraint, int] = {"no-slip-along": 1, "no-slip-across": 0}
"""Axes of the engine's rolling joint: it holds slip forward and sideways; 2 is the contact."""


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
        centre: int,
        disk_marker: Callable[[float, str], int],
        turning: Callable[[str], tuple[int, int]],
    ) -> None:
        """Add them.

        Parameters
        ----------
        centre : int
            Marker at the disk's centre.
        disk_marker : callable
            Adds a marker on the disk, so far from its centre along its x axis, for a reason.
        turning : callable
            From a coordinate whose rate is held to a node and the place in it of that.
        """
        scenario, add, table = self._scenario, self._assembly.add, self._assembly.table
        origin = add(items.MarkerBodyRigid(bodyNumber=table), "the table's side of the joints")
        if isinstance(scenario.disk, Sphere):
            self._level_middle(centre)
        else:
            self._roll(origin, centre)
        if "fixed-cog" in scenario.constraints:
            cog = disk_marker(scenario.disk.eccentricity, "the disk's centre of gravity")
            joint = add(
                items.ObjectJointSpherical(markerNumbers=[origin, cog], constrainedAxes=[1, 1, 0]),
                "holds the centre of gravity above the origin",
            )
            self._held["fixed-cog"] = joint, [0, 1, 2]
        for name in scenario.constraints:
            if coordinate := HELD[name].rate:
                self._held[name] = self._hold_rate(coordinate, *turning(coordinate)), [0]

    def _level_middle(self, centre: int) -> None:
        """Close the contact of a sphere."""
        height = [0.0, 0.0, self._scenario.disk.radius]
        above = self._assembly.add(
            items.MarkerBodyRigid(bodyNumber=self._assembly.table, localPosition=height),
            "the plane in which the middle of a sphere moves",
        )
        joint = self._assembly.add(
            items.ObjectJointGeneric(
                markerNumbers=[above, centre], constrainedAxes=[0, 0, 1, 0, 0, 0]
            ),
            "contact with the table",
        )
        self._held["contact"] = joint, [2]

    def _roll(self, origin: int, centre: int) -> None:
        """Close the contact of a disk, without the slip that is held at zero."""
        held = {
            name: axis for name, axis in SLIP_AXES.items() if name in self._scenario.constraints
        }
        why = "contact with the table"
        if held:
            directions = " and ".join(name.removeprefix("no-slip-") for name in held)
            why += f", without slip {directions} the edge"
        joint = self._assembly.add(
            items.ObjectJointRollingDisc(
                markerNumbers=[origin, centre],
                constrainedAxes=[int(axis in (2, *held.values())) for axis in range(3)],
                discRadius=self._scenario.disk.radius,
                discAxis=[0.0, 0.0, 1.0],
            ),
            why,
        )
        self._held["contact"] = joint, [2]
        self._held |= {name: (joint, [axis]) for name, axis in held.items()}

    def _hold_rate(self, name: str, node: int, place: int) -> int:
        """Keep the rate of this coordinate as at the start; returns the joint."""
        add = self._assembly.add
        ground = add(items.NodePointGround(), f"what {name} is measured from")
        fixed = add(
            items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0), "the ground's coordinate"
        )
        moving = add(
            items.MarkerNodeCoordinate(nodeNumber=node, coordinate=place), f"the coordinate {name}"
        )
        return add(
            items.ObjectConnectorCoordinate(
                markerNumbers=[fixed, moving],
                offset=self._scenario.initial_state.rates[COORDINATES.index(name)],
                velocityLevel=True,
            ),
            f"holds the rate of {name} constant; its torque is an output",
        )

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
