"""Linear nonlinear of spinning upright: what the paper prints, and the engine's eigenvalues.

The command line uses modules of this package; what a report needs is loaded when it is asked for.
"""

from typing import Any


def __getattr__(name: str) -> Any:
    """`TITLE`, `STUDIES` and `present`, as of every study."""
    if name not in ("TITLE", "STUDIES", "present"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from validation.studies.nonlinear import section

    return getattr(section, name)
