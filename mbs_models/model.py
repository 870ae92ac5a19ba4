"""An assembled engine system that is read and moved, in its coordinates and in the paper's."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import ClassVar, Literal, get_args

import numpy as np

from analysis.data.checks import Array
from analysis.data.frames import turn_about_vertical
from analysis.data.quantities import HELD, Constraint
from mbs_models.body_contact import forces_on
from mbs_models.building import SLIP_AXES, Building

Formulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)

Floats = Sequence[float]


class Model(Building):
    """A scenario built in the engine. Each formulation is a class, which holds its traits."""

    name: ClassVar[Formulation]

    has_euler_angles: ClassVar[bool] = False
    """Whether alpha, beta and gamma are coordinates of the engine, singular at a flat disk.

    Otherwise alpha and gamma are taken from a rotation, and known up to whole turns.
    """

    closes_contact: ClassVar[bool] = False
    """Whether the contact is closed without a constraint; its force comes from accelerations."""

    has_exact_path: ClassVar[bool] = False
    """Whether `path` is exact to the last digits, so that short differences along it may be taken.

    Rotations that are composed, or parametrised by more than three numbers, lose some.
    """

    exponents: ClassVar[tuple[int, ...] | None] = None
    """Exponents of the step in the error expansion, if not those of the integrator."""

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

        def of(joint: int) -> list[int]:
            return list(self.system.systemData.GetObjectLTGAE(joint))

        found: dict[Constraint, list[int]] = {}
        if self._contact:
            found["contact"] = [of(self._contact[0])[2]]
        if self._cog is not None:
            found["fixed-cog"] = of(self._cog)
        for name, axis in self._slip_axes().items():
            found[name] = [of(self._contact[0])[axis]]
        for name in self.scenario.constraints:
            if coordinate := HELD[name].rate:
                found[name] = of(self._rates[coordinate])
        return found

    @property
    def contact_equation(self) -> int | None:
        """Number of the algebraic equation of the normal contact, if there is one."""
        return self.equations["contact"][0] if self._contact else None

    @property
    def may_pull(self) -> bool:
        """Whether the contact holds the disk down as well as up."""
        return self.scenario.contact is None or self.scenario.contact.bilateral

    def pulls(self) -> bool:
        """Whether the contact's constraint pulls in the engine's current state."""
        equation = self.contact_equation
        # The engine's constraint forces act with a minus sign on the second body.
        return equation is not None and self.system.systemData.GetAECoordinates()[equation] > 0.0
