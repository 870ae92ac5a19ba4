"""The free disk with the energy that each cause takes, integrated with its motion."""

from typing import Any

import exudyn as exu
import exudyn.itemInterface as items

from analysis.data.dissipation import CAUSES
from mbs_models.floating import FloatingLie

_OUTPUT = exu.OutputVariableType


class Tally(FloatingLie):
    """A free disk on a penalty contact, and what each of `CAUSES` has taken from it.

    The energies are variables of order 1 with the powers as their rates: they go through the same
    stages of the integrator as the motion, under the same control of the step. They are held
    relative to weight times radius, since step control has one tolerance for all variables.

    Attributes
    ----------
    unit : float
        Weight times radius in J, in which records hold the energies.
    """

    def _hold(self) -> None:
        super()._hold()
        zeros = [0.0] * len(CAUSES)
        self.unit = self.scenario.weight * self.scenario.disk.radius
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
        return [power / self.unit for power in load.taken]

    def _readings(self) -> list[tuple[int, Any]]:
        return [*super()._readings(), (self._energies, _OUTPUT.Coordinates)]
