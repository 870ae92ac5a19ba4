"""Words that tell how a run is made: who computes, in which formulation and by which solver.

They are apart from what does so: whoever offers them loads neither NumPy nor the engine.
"""

from typing import Literal, get_args

Source = Literal["engine", "in-house"]
SOURCES: tuple[Source, ...] = get_args(Source)

Formulation = Literal["index-1", "reduced", "free-body"]
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)
"""Of the in-house equations."""

Method = Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor"]
METHODS: tuple[Method, ...] = get_args(Method)
"""Solvers of the in-house equations."""

EngineFormulation = Literal["floating", "floating-lie", "euler-tree", "contact-tree"]
ENGINE_FORMULATIONS: tuple[EngineFormulation, ...] = get_args(EngineFormulation)

OwnIntegratorName = Literal["RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha"]
AcceleratedName = Literal["DOP853", "Radau", "LSODA"]
IntegratorName = Literal[OwnIntegratorName, AcceleratedName]
INTEGRATORS: tuple[IntegratorName, ...] = get_args(IntegratorName)
"""Of the engine's scenes: the engine's own,"""

ACCELERATED: tuple[IntegratorName, ...] = get_args(AcceleratedName)
"""and those that step the engine's accelerations."""
