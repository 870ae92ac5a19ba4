"""The one place that loads heyoka."""

from functools import cache
from typing import Any

from analysis.data import elementary


@cache
def heyoka() -> Any:
    """The module heyoka; elementary functions take its symbols from then on.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    try:
        import heyoka as library  # noqa: PLC0415 - an extra, loaded when it is asked for
    except ImportError:
        raise ValueError(
            "method 'taylor' needs heyoka, which is not installed: pip install 'tippedisk[fast]'"
        ) from None
    elementary.register(library.expression, library)
    return library
