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
        return sorted(_public())

    def __getattr__(name: str) -> Any:
        if name.startswith("__") and name != "__all__":
            raise AttributeError(name)
        public = _public()
        globals().update(public, __all__=sorted(public))
        try:
            return globals()[name]
        except KeyError:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}") from None

    def _public() -> dict[str, Any]:
        api = vars(import_module("analysis.api"))
        return {name: each for name, each in api.items() if not name.startswith("_")}
