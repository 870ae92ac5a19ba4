"""How a run is made: one declaration of each option, for every command and for Python."""

from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal, get_args

from analysis.problem.choices import (
    ENGINE_FORMULATIONS,
    FORMULATIONS,
    INTEGRATORS,
    METHODS,
    SOURCES,
)
from analysis.problem.names import ArgumentError

Layout = Literal["grid", "random", "latin-hypercube", "sobol"]
LAYOUTS: tuple[Layout, ...] = get_args(Layout)
ACCURACIES = ("tolerance", "step", "local_tolerance")
"""Of which a run has one."""

END = 4.0
"""Of each motion of a sweep in s, where none is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How a run is made, by either side.

    None stands for what the side takes by itself. The command line has these fields as options.

    Parameters
    ----------
    source : str
        Who computes.
    formulation : str, optional
        Engine: floating, floating-lie, euler-tree or contact-tree; in-house: index-1, reduced
        (Model 4) or free-body (with --stiffness) (the most accurate).
    tolerance : float, optional
        Largest error of beta and gamma in rad (1e-8).
    step : float, optional
        Engine only: a single run of fixed steps of at most so many s instead.
    local_tolerance : float, optional
        Of a single run whose solver controls its steps, in place of several that agree; no error
        is estimated; engine: DOPRI5, without constraints (Model 1), or the integrator that is
        given.
    integrator : str or Integrator, optional
        Engine only: RK67, RK44, DOPRI5 without constraints (the most accurate).
    method : str, optional
        In-house only: solver; taylor runs compiled (DOP853, stiff friction Radau).
    stop_when : str, callable or iterable of them, optional
        End there, at the exact time: inverted, lost, or where module:function, a function of the
        State, turns negative; given again, wherever the first of them does.
    allow_pulling : bool
        Go on where the ideal contact would have to pull, instead of ending there; friction of
        the load weight acts there as before, and of the load contact not at all.
    time_limit : float, optional
        Processor time in s after which the run ends as it is, or fails if nothing agrees to the
        tolerance by then (none).

    Raises
    ------
    ArgumentError
        If the side is unknown, an option belongs to the other one, or two accuracies are given.
    """

    source: Annotated[str, {"choices": SOURCES}] = "engine"
    formulation: Annotated[str | None, {"choices": (*ENGINE_FORMULATIONS, *FORMULATIONS)}] = None
    tolerance: float | None = None
    step: float | None = None
    local_tolerance: float | None = None
    integrator: Annotated[Any, {"choices": INTEGRATORS}] = None
    method: Annotated[str | None, {"choices": METHODS}] = None
    stop_when: Annotated[Any, {"type": str, "metavar": "CONDITION", "action": "append"}] = None
    allow_pulling: bool = False
    time_limit: float | None = None

    def __post_init__(self) -> None:
        from analysis.problem.checks import choice

        choice("source", self.source, SOURCES)
        if self.formulation is not None:
            both: list[tuple[str, ...]] = [ENGINE_FORMULATIONS, FORMULATIONS]
            known, others = both if self.source == "engine" else both[::-1]
            if isinstance(self.formulation, str) and self.formulation in others:
                wanted = f"must be one of {', '.join(known)} with source {self.source!r}"
                fault = f"{wanted}, got {self.formulation!r} of the other one"
                raise ArgumentError("formulation", fault)
            choice("formulation", self.formulation, known)
        foreign = ("method",) if self.source == "engine" else ("step", "integrator")
        for name in foreign:
            self.refuse(name, f"source {self.source!r}, which does not know it")
        given = list(self.given(*ACCURACIES))
        if len(given) > 1:
            self.refuse(given[1], f"a run with its {given[0]}: give one of {', '.join(given)}")

    def refuse(self, name: str, where: str) -> None:
        """Raise if an option is given that there is no place for."""
        value = getattr(self, name)
        # A zero is none of these, though it equals one.
        if value is not None and value is not False:
            raise ArgumentError(name, f"must be left out for {where}, got {value!r}")

    def given(self, *names: str) -> dict[str, Any]:
        """What is given of some options, by name."""
        values = {name: getattr(self, name) for name in names}
        return {name: value for name, value in values.items() if value is not None}


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseOptions(RunOptions):
    """How each case of a sweep is run: the options of a run, and these.

    Parameters
    ----------
    tolerance : float, optional
        Largest error of beta and gamma in rad (1e-6; to rest 1e-3).
    method : str, optional
        In-house only: solver; taylor runs compiled (DOP853, stiff friction Radau; to
        rest LSODA).
    time_limit : float
        Of each run, processor time in s.
    end : float
        End of each motion in s.
    spacing : float
        Between samples in s.
    to_rest : bool
        Run until the disk lies still, or until the end.
    witnesses : int
        Cases, evenly spread, that the other side runs as well, with the difference.
    witness_tolerance, witness_step : float, optional
        Of that other side, which otherwise runs to the tolerance; the step is the engine's.
    keep : tuple of str
        Series to keep of each run at its samples, such as beta,gamma,normal_force.
    """

    source: Annotated[str, {"choices": SOURCES}] = "in-house"
    time_limit: float = 60.0
    end: float = END
    spacing: float = 5e-3
    to_rest: bool = False
    witnesses: int = 0
    witness_tolerance: float | None = None
    witness_step: float | None = None
    keep: Annotated[tuple[str, ...], {"type": _names, "metavar": "NAMES"}] = ()


OPTIONS = tuple(each.name for each in fields(RunOptions))
"""Names of the fields."""
