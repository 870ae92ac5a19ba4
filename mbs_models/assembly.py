"""An engine system put together item by item, each with its reason, and what it records."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.problem.checks import Array

Kind = Literal["node", "object", "marker", "load", "sensor"]
KINDS: tuple[Kind, ...] = get_args(Kind)

_STORED = {"storeInternal": True, "writeToFile": False}

Reading = tuple[int, Any]
"""Number of a node, and an output variable of it."""


class Assembly:
    """A system of the engine.

    Attributes
    ----------
    system : exudyn.MainSystem
    reasons : dict
        From kind and number of every item in the system to why it is there.
    """

    def __init__(self) -> None:
        self._container = exu.SystemContainer()
        self.system: Any = self._container.AddSystem()
        self.reasons: dict[tuple[Kind, int], str] = {}

    def add(self, item: Any, why: str) -> int:
        """Add an item to the system under the reason for it; returns its number."""
        name = type(item).__name__
        kind = next(kind for kind in KINDS if name.lower().startswith(kind))
        number = int(getattr(self.system, f"Add{kind.capitalize()}")(item))
        self.reasons[kind, number] = why
        return number

    @cached_property
    def table(self) -> int:
        """Number of the ground object, added when it is first asked for."""
        return self.add(items.ObjectGround(), "the table, which what holds the disk refers to")

    def sense(self, read: Callable[[], Array], why: str) -> int:
        """Have something read at every sample of a run; returns the sensor."""
        sensor = items.SensorUserFunction(
            sensorNumbers=[],
            factors=[],
            sensorUserFunction=lambda *_unused: read(),
            **_STORED,
        )
        return self.add(sensor, f"{why} at every sample, by a user function")

    def finish(self, readings: Sequence[Reading], *, constrained: bool) -> None:
        """Add what is sampled in a run, the readings and any algebraic coordinates; assemble.

        What is added later needs that anew, which forgets initial accelerations.
        """
        self._readings = readings
        self._sensors = [
            self.add(
                items.SensorNode(nodeNumber=node, outputVariableType=output, **_STORED),
                f"{output.name} at every sample",
            )
            for node, output in readings
        ]
        if constrained:
            forces = self.system.systemData.GetAECoordinates
            self._sensors.append(self.sense(forces, "constraint forces"))
        self.system.Assemble()

    def record(self) -> Array:
        """Readings in the engine's current state, shape (k,)."""
        return np.concatenate(
            [self.system.GetNodeOutput(node, output) for node, output in self._readings]
        )

    def samples(self) -> tuple[Array, Array]:
        """Times in s, shape (n,), and what the sensors have stored in a run, shape (n, k)."""
        stored = [
            np.atleast_2d(self.system.GetSensorStoredData(sensor)) for sensor in self._sensors
        ]
        return stored[0][:, 0], np.hstack([values[:, 1:] for values in stored])
