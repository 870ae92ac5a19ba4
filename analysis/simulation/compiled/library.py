"""The one place that loads heyoka."""

from functools import cache
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

from analysis.problem import elementary


class CannotCompileError(ValueError):
    """What is asked for cannot be compiled; another method may do it."""


def is_installed() -> bool:
    """Whether there is a heyoka to load."""
    return find_spec("heyoka") is not None


def require_heyoka() -> None:
    """Raise `CannotCompileError` if there is none."""
    if not is_installed():
        raise CannotCompileError(
            "method 'taylor' needs heyoka, which is not installed: pip install 'tippedisk[fast]'"
        )


@cache
def heyoka() -> Any:
    """The module heyoka; elementary functions take its symbols from then on.

    Raises
    ------
    CannotCompileError
        If it is not installed.
    """
    require_heyoka()
    import heyoka as library  # noqa: PLC0415 - an extra, loaded when it is asked for

    # Where its cache on disk cannot be written it compiles anew, and would say so on every call.
    library.set_logger_level_error()
    functions = {name: getattr(library, name, None) for name in elementary.NAMES}
    functions["hypot"] = lambda x, y: library.sqrt(x * x + y * y)
    elementary.register(library.expression, SimpleNamespace(**functions))
    return library
