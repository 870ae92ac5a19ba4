"""A scenario built in the engine, and its states in the engine's coordinates and in the paper's.

Each formulation is a class, which holds its traits.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import ClassVar

import numpy as np

from analysis.motion import frames
from analysis.problem.checks import Array
from analysis.problem.choices import EngineFormulation
from analysis.problem.scenario import Scenario
from mbs_models.assembly import Assembly
from mbs_models.joints import Joints
from mbs_models.loads import Loads, loads_of

Floats = Sequence[float]

Reading = Callable[[], Array]
"""What reads something of the engine's current state, shape (k,)."""

Load = Callable[[], float]
"""What presses the disk on the table in the engine's current state, in N."""

Force = Callable[..., list[float]]
"""A user function of an engine item."""


class Model(ABC):
    """A scenario built in the engine.

    Parameters
    ----------
    scenario : Scenario
        One that meets no `obstacle`.
    slip_part : float
        Part of the slip that friction is asked at, and by which its force is divided: 1 but where
        its slope at no slip is wanted.

    Attributes
    ----------
    scenario : Scenario
    slip_part : float
    start : State
        That of the scenario.
    assembly : Assembly
    system : exudyn.MainSystem
        Assembled, with the start of the scene as its initial state.
    joints : Joints
    """

    name: ClassVar[EngineFormulation]

    has_euler_angles: ClassVar[bool] = False
    """Whether alpha, beta and gamma are coordinates of the engine, singular at a flat disk.

    Otherwise alpha and gamma are taken from a rotation, and known up to whole turns.
    """

    quick_from: ClassVar[float] = 1e-10
    """Error in a step from which on accelerations may be quick and noisier; see `Probe.solved`."""

    closes_contact: ClassVar[bool] = False
    """Whether the contact is closed without a constraint; its force comes from accelerations."""

    exponents: ClassVar[tuple[int, ...] | None] = None
    """Exponents of the step in the error expansion, if not those of the integrator."""

    has_norm: ClassVar[bool] = False
    """Whether the norm of its rotation parameters is held by an algebraic equation."""

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:  # noqa: ARG003 - of a formulation without any
        """Why it cannot build a scenario; empty if it can."""
        return ""

    @classmethod
    def has_constraints(cls, scenario: Scenario) -> bool:
        """Whether algebraic equations are left, which explicit integrators cannot take."""
        is_held = scenario.contact is None and not cls.closes_contact
        return is_held or cls.has_norm

    def __init__(self, scenario: Scenario, slip_part: float = 1.0) -> None:
        self.scenario, self.start = scenario, scenario.initial_state
        self.slip_part = slip_part
        self.assembly = Assembly()
        self.system = self.assembly.system
        self.joints = Joints(self.assembly, scenario)
        self._build()
        # What is added later needs that anew, which forgets initial accelerations.
        self.system.Assemble()
        self._readings = [*self.pose_readings(), self.system.systemData.GetAECoordinates]

    def close(self) -> None:
        """Free what the system holds; nothing can be done with it any more.

        Its user functions hold it, where Python looks for no cycle: without this, it stays.
        """
        self.system.Reset()

    @abstractmethod
    def _build(self) -> None:
        """Add nodes, bodies, markers and joints."""

    # --- What acts on the disk -------------------------------------------------------------------

    @cached_property
    def loads(self) -> Loads:
        """What acts on the disk at its centre on a penalty contact."""
        return loads_of(self.scenario, self.slip_part)

    @abstractmethod
    def act(self, force: Force, name: str) -> None:
        """Have a user function of this name act on the disk."""

    @abstractmethod
    def friction(self, load: Load) -> Force:
        """User function of friction under a load."""

    def _contact_force(self) -> Force:
        """User function of a penalty contact, with friction and losses."""
        raise NotImplementedError

    def _add_forces(self) -> None:
        """Add friction, or a penalty contact with all that goes with it."""
        scenario = self.scenario
        if scenario.contact is not None:
            takes = " and friction" * scenario.rubs + " and losses" * scenario.dissipation.is_on
            self.act(self._contact_force(), f"penalty contact{takes}")
        elif scenario.rubs:
            self.act(self.friction(self._load()), "friction")

    def _load(self) -> Load:
        """What presses the disk on the table, constant or the contact's multiplier."""
        scenario, data = self.scenario, self.system.systemData
        if scenario.friction.load == "weight":
            weight = scenario.weight
            return lambda: weight
        # The multiplier of the present Newton iterate: the converged step has no lag. A contact
        # that pulls rubs with no load.
        return lambda: max(0.0, self.joints.contact_force(data.GetAECoordinates()))

    # --- Its states ------------------------------------------------------------------------------

    @abstractmethod
    def pose_readings(self) -> list[Reading]:
        """What to read of a state for `decode`, one after the other."""

    def read(self) -> list[Array]:
        """The engine's current state: what makes a record, one after the other."""
        return [read() for read in self._readings]

    def record(self) -> Array:
        """Record of the engine's current state, shape (k,)."""
        return np.concatenate(self.read())

    @abstractmethod
    def decode(self, records: Array) -> tuple[Array, Array]:
        """Co-rotating coordinates and rates, each shape (n, 6), from n records, shape (n, k).

        Angles taken from rotation matrices lie in (-pi, pi].
        """

    @abstractmethod
    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        """The engine's coordinates and velocities, n each, from the six co-rotating ones each."""

    @abstractmethod
    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Floats:
        """Second derivatives of the six co-rotating coordinates.

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

    def residual_rate(self, position: Array, velocity: Array) -> Array | None:  # noqa: ARG002
        """Rate of velocity-level residuals at constant velocities, shape (m,), if it is known.

        Otherwise it comes from differences; see `Probe`.
        """
        return None

    def multipliers(self, carriers: Array, coordinates: Array, rates: Array) -> Array:
        """Constraint forces on the disk in R-frame axes, shape (n, k).

        Parameters
        ----------
        carriers : ndarray, shape (n, i)
            The engine's algebraic coordinates, or second derivatives of the others where it
            `closes_contact`; or records, which end with them.
        coordinates, rates : ndarray, shape (n, 6)
            Co-rotating coordinates and their rates, as `decode` makes them.
        """
        if self.scenario.contact is not None:
            placed, moving = frames.poses(coordinates), frames.twists(coordinates, rates)
            return np.array([[load.normal] for load, _ in self.loads.along(*placed, *moving)])
        return self.joints.forces(carriers, coordinates[:, 3])
