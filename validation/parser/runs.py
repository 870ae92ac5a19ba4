"""How a run is made: one declaration of each option, for every command and for Python."""

from dataclasses import Field, dataclass, field, fields
from typing import Any

from analysis.data.names import ArgumentError, nearest

SOURCES = ("engine", "in-house")
FORMULATIONS = ("floating", "floating-lie", "euler-tree", "contact-tree")
FORMS = ("index-1", "reduced", "free-body")
INTEGRATORS = (
    *("RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha"),
    *("DOP853", "Radau", "LSODA"),
)
METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor")
CONDITIONS = ("inverted", "lost")


def _option(default: Any, about: str, usual: str = "", **how: Any) -> Any:
    return field(default=default, metadata={"about": about, "usual": usual, "how": how})


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How a run is made, by either side.

    The fields are the options of the command line; each says by its metadata what it means. None
    stands for what the side takes by itself.

    Raises
    ------
    ArgumentError
        If the side is unknown, an option belongs to the other one, or two accuracies are given.
    """

    source: str = _option("engine", "who computes", choices=SOURCES)
    formulation: str | None = _option(
        None,
        "engine: floating, floating-lie, euler-tree or contact-tree; in-house: index-1, reduced "
        "(Model 4) or free-body (with --stiffness)",
        "the most accurate",
        choices=(*FORMULATIONS, *FORMS),
    )
    tolerance: float | None = _option(None, "largest error of beta and gamma in rad", "1e-8")
    step: float | None = _option(None, "engine only: fixed step in s instead")
    local_tolerance: float | None = _option(
        None,
        "of a single run whose solver controls its steps, in place of several that agree; no "
        "error is estimated; engine: DOPRI5, without constraints (Model 1)",
    )
    integrator: Any = _option(
        None,
        "engine only: RK67, RK44, DOPRI5 without constraints",
        "the most accurate",
        choices=INTEGRATORS,
    )
    method: str | None = _option(
        None, "in-house only: solver; taylor runs compiled", "DOP853", choices=METHODS
    )
    stop_when: Any = _option(
        None,
        f"end there, at the exact time: {', '.join(CONDITIONS)}, or where module:function, a "
        "function of the State, turns negative",
        metavar="CONDITION",
        type=str,
    )
    allow_pulling: bool = _option(
        False,
        "go on where the ideal contact would have to pull, instead of ending there; friction "
        "with the load weight still rubs under it, and with the load contact not at all",
    )
    time_limit: float | None = _option(
        None, "processor time in s after which the run ends as it is", "none"
    )

    def __post_init__(self) -> None:
        self._choose("source", SOURCES)
        if self.formulation is not None:
            self._choose("formulation", FORMULATIONS if self.source == "engine" else FORMS)
        foreign = ("method",) if self.source == "engine" else ("step", "integrator")
        for name in foreign:
            self.refuse(name, f"source {self.source!r}, which does not know it")
        given = [name for name in ACCURACIES if getattr(self, name) is not None]
        if len(given) > 1:
            self.refuse(given[1], f"a run with its {given[0]}: give one of {', '.join(given)}")
        if self.source == "engine" and self.local_tolerance is not None:
            name = getattr(self.integrator, "name", self.integrator)
            if name not in (None, "DOPRI5"):
                raise ArgumentError(
                    "integrator",
                    "must be DOPRI5 with a local_tolerance, since the others keep their step, "
                    f"got {name!r}",
                )

    def _choose(self, name: str, allowed: tuple[str, ...]) -> None:
        value = getattr(self, name)
        if value not in allowed:
            fault = f"must be one of {', '.join(allowed)}, got {value!r}"
            raise ArgumentError(name, f"{fault}{nearest(value, allowed)}")

    def refuse(self, name: str, where: str) -> None:
        """Raise if an option is given that there is no place for."""
        value = getattr(self, name)
        # A zero is none of these, though it equals one.
        if value is not None and value is not False:
            raise ArgumentError(name, f"must be left out for {where}, got {value!r}")

    def given(self, *names: str) -> dict[str, Any]:
        """What is given of some options, by name."""
        told = {name: getattr(self, name) for name in names}
        return {name: value for name, value in told.items() if value is not None}


ACCURACIES = ("tolerance", "step", "local_tolerance")
"""Of which a run has one."""

OPTIONS: dict[str, Field[Any]] = {each.name: each for each in fields(RunOptions)}
"""Fields by name."""
