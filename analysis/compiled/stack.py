"""Where on the stack compiled code is called from, for the sake of its speed alone."""

from collections.abc import Callable
from time import perf_counter
from typing import TypeVar

T = TypeVar("T")

_ROUNDS = 2


class FasterPlace:
    """Calls a function again and again, from the faster of two places on the stack.

    Batches keep most numbers on the stack, 32 or 64 bytes wide, and LLVM aligns it to 16 bytes
    alone: in one place of two, many of them straddle two lines of the cache, and a batch takes a
    fifth longer. Which one it is hangs on all that has been called before, so that both are
    tried in the first calls. What a function returns is the same in each.
    """

    def __init__(self) -> None:
        self._taken = [0.0, 0.0]
        self._calls = 0

    def call(self, function: Callable[[], T]) -> T:
        """What a function returns, the next one in a row of much the same work."""
        if self._calls >= 2 * _ROUNDS:
            return deeper(function) if self._taken[1] < self._taken[0] else function()
        place = self._calls % 2
        begin = perf_counter()
        result = deeper(function) if place else function()
        self._taken[place] += perf_counter() - begin
        self._calls += 1
        return result


def deeper(function: Callable[[], T]) -> T:
    """What a function returns, called from another place on the stack."""
    # Frames of Python alone lie on the heap. `map` comes back to Python by way of C; others that
    # do so move the stack by multiples of 32 bytes (CPython 3.11), which changes nothing.
    return next(map(_called, (function,)))


def _called(function: Callable[[], T]) -> T:
    return function()
