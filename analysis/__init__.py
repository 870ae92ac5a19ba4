"""In-house mechanics of the tippedisk, independent of the multibody engine.

Source of all equation numbers: S. Sailer and R. I. Leine, "Model reduction of the tippedisk: a
path to the full analysis", Nonlinear Dynamics 105 (2021).

The names of `analysis.api` are those of this package. They are loaded when one of them is first
asked for: whoever needs the declarations of the quantities alone does not wait for SciPy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from analysis.api import *  # noqa: F403
else:  # A type checker would take any name for one that is there.

    def __dir__() -> list[str]:
        # What completes names in a notebook asks for them before any is used.
        return sorted(import_module("analysis.api").__all__)

    def __getattr__(name: str) -> Any:
        if name.startswith("__") and name != "__all__":
            raise AttributeError(name)
        api = import_module("analysis.api")
        globals().update({each: getattr(api, each) for each in api.__all__}, __all__=api.__all__)
        try:
            return globals()[name]
        except KeyError:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}") from None
