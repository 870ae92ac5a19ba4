"""Silence for the engine."""

from collections.abc import Iterator
from contextlib import contextmanager

import exudyn as exu


@contextmanager
def quiet() -> Iterator[None]:
    """Keep the engine from printing."""
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before
