"""The free disk with the energy that each cause takes, integrated with its motion."""

from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.data.checks import Array
from analysis.data.dissipation import CAUSES
from mbs_models.floating import FloatingLie

_OUTPUT = exu.OutputVariableType


class Tally(FloatingLie):
    """A free disk on a penalty contact, and what each of `CAUSES` has taken from it.

    The energies are variables of order 1 with the powers as their rates: they go through the same
    stages of the integrator as the motion, under the same control of the step. They are held
    relative to weight times radius, since step control has one tolerance for all variables.
    """

    def _hold(self) -> None:
        super()._hold()
        zeros = [0.0] * len(CAUSES)
        self._unit = self.scenario.weight * self.scenario.disk.radius
        self._energies = self._add(
            items.NodeGenericODE1(
                referenceCoordinates=zeros,
                initialCoordinates=zeros,
                numberOfODE1Coordinates=len(CAUSES),
            ),
            "energy taken by each cause",
        )
        self._add(
            items.ObjectGenericODE1(nodeNumbers=[self._energies], rhsUserFunction=self._powers),
            "power of each cause, by a user function",
        )

    def _powers(self, system: Any, _t: float, _item: int, _energies: Any) -> list[float]:
        def output(variable: Any) -> list[float]:
            return list(system.GetNodeOutput(self._node, variable).tolist())

        matrix = output(_OUTPUT.RotationMatrix)
        assert self.loads is not None
        x, y, z = output(_OUTPUT.Velocity)
        p, q, r = output(_OUTPUT.AngularVelocity)
        load = self.loads.at(
            output(_OUTPUT.Position)[2], (matrix[2], matrix[5], matrix[8]), (x, y, z), (p, q, r)
        )
        return [power / self._unit for power in load.taken]

    @property
    def taken(self) -> Array:
        """Energy in J taken so far by each of `CAUSES`, shape (6,)."""
        energies: Array = np.array(self.system.GetNodeOutput(self._energies, _OUTPUT.Coordinates))
        return energies * self._unit
