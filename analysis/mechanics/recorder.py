"""Formulas as straight-line code: recorded once on symbols, then run on floats.

A formula for numbers of any kind is called with the symbols of a `Recorder`. What it does with
them becomes Python source, every operation once however many formulas share it, and nothing but
what the results need. Zeros take no time, and what comes of constants alone is worked out once.
"""

from collections.abc import Callable, Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any

from analysis.problem import elementary

_USUAL = {name: getattr(elementary, name) for name in elementary.NAMES}


class Recorder:
    """Keeps what is done with its symbols.

    Parameters
    ----------
    constants, variables : sequence of str
        Names of what is known beforehand and of what comes with each call; symbols from then on.
    """

    def __init__(self, constants: Sequence[str], variables: Sequence[str]) -> None:
        self.functions = dict.fromkeys(_USUAL)
        self.constants = [Symbol(self, name, fixed=True) for name in constants]
        self.variables = [Symbol(self, name, fixed=False) for name in variables]
        self._kept: dict[str, Symbol] = {}

    def keep(self, text: str, *operands: Any) -> "Symbol":
        """Symbol for an operation, such as "{} + {}"; the same one for the same operation."""
        key = text.format(*operands)
        if key not in self._kept:
            symbols = tuple(each for each in operands if isinstance(each, Symbol))
            fixed = all(each.fixed for each in symbols)
            symbol = Symbol(self, f"t{len(self._kept)}", text, operands, fixed=fixed)
            self._kept[key] = symbol
        return self._kept[key]

    def _statements(self, results: Sequence[Any]) -> tuple[list[str], list[str]]:
        """What is worked out of constants alone, and what with each call: "name = text"."""
        uses = {str(each): 2 for each in results}
        for symbol in reversed(self._kept.values()):
            if str(symbol) in uses:
                for each in map(str, symbol.operands):
                    uses[each] = uses.get(each, 0) + 1
        before: list[str] = []
        body: list[str] = []
        inline: dict[str, str] = {}
        for symbol in self._kept.values():
            name = str(symbol)
            text = symbol.text.format(*(inline.get(str(each), each) for each in symbol.operands))
            # A float that gets no name takes half the time.
            if uses.get(name) == 1 and not symbol.fixed:
                inline[name] = f"({text})"
            elif name in uses:
                (before if symbol.fixed else body).append(f"{name} = {text}")
        return before, body

    def source(self, results: Sequence[Any]) -> str:
        """Source of a function `bind` in Python, as `code` returns it."""
        before, body = self._statements(results)
        usual = (f"{each}={each}" if each in _USUAL else each for each in self.functions)
        arguments = [*map(str, self.constants), "*", *usual]
        return "\n".join(
            (
                f"def bind({', '.join(arguments)}, **_):",
                *(f"    {line}" for line in before),
                f"    def formula({', '.join(map(str, self.variables))}):",
                *(f"        {line}" for line in body),
                f"        return {', '.join(map(str, results))}",
                "    return formula",
            )
        )

    def javascript(self, results: Sequence[Any]) -> str:
        """The same in JavaScript: constants and functions go by name, numbers in arrays."""
        before, body = self._statements(results)
        constants, variables = (
            ", ".join(map(str, symbols)) for symbols in (self.constants, self.variables)
        )
        given = ", ".join(self.functions)
        return "\n".join(
            (
                f"([{constants}], {{ {given} }} = Math) => {{",
                *(f"  const {line};" for line in before),
                f"  return ([{variables}]) => {{",
                *(f"    const {line};" for line in body),
                f"    return [{', '.join(map(str, results))}];",
                "  };",
                "}",
            )
        )

    def code(self, results: Sequence[Any]) -> Callable[..., Callable[..., Any]]:
        """From constants to a function, which goes from variables to the results.

        Both are of any kind, as are the functions of `call`, which go by keyword; those of
        `elementary` do for every kind, unless others are given, which may be faster.

        Parameters
        ----------
        results : sequence of symbols or floats
        """
        names: dict[str, Any] = dict(_USUAL)
        exec(self.source(results), names)  # noqa: S102 - formulas of ours, and nothing else
        return names["bind"]


class Symbol:
    """A number to come, which calculates as floats do."""

    __slots__ = ("fixed", "name", "operands", "recorder", "text")

    def __init__(
        self, recorder: Recorder, name: str, text: str = "", operands: Any = (), *, fixed: bool
    ) -> None:
        self.recorder, self.name, self.fixed = recorder, name, fixed
        self.text, self.operands = text, operands

    def __str__(self) -> str:
        return self.name

    # Whether two are equal, or one is zero, nobody knows yet; the same one stands for one key.
    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        raise TypeError("what depends on whether a number equals another one cannot be recorded")

    def __bool__(self) -> bool:
        raise TypeError("what depends on whether a number is zero cannot be recorded")

    def __neg__(self) -> "Symbol":
        return self.recorder.keep("-{}", self)

    def _with(self, text: str, first: Any, second: Any) -> Any:
        """Symbol for an operation; other kinds of numbers work it out by themselves."""
        if not (isinstance(first, _KNOWN) and isinstance(second, _KNOWN)):
            return NotImplemented
        return self.recorder.keep(text, first, second)

    def __add__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._with("{} + {}", self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._with("{} - {}", self, other)

    def __rsub__(self, other: Any) -> Any:
        return -self if _is(other, 0.0) else self._with("{} - {}", other, self)

    def __mul__(self, other: Any) -> Any:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._with("{} * {}", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self if _is(other, 1.0) else self._with("{} / {}", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if _is(other, 0.0) else self._with("{} / {}", other, self)

    def __pow__(self, exponent: float) -> "Symbol":
        return self.recorder.keep("{} ** {}", self, exponent)

    def __rpow__(self, base: float) -> "Symbol":
        return self.recorder.keep("({}) ** {}", base, self)


_KNOWN = (Symbol, float, int)


def _is(operand: Any, number: float) -> bool:
    return isinstance(operand, (float, int)) and operand == number


def call(name: str, *operands: Any) -> Symbol:
    """Symbol for what the function of this name returns; one of the operands is a symbol."""
    recorder = next(each.recorder for each in operands if isinstance(each, Symbol))
    recorder.functions[name] = None
    return recorder.keep(f"{name}({', '.join('{}' for _ in operands)})", *operands)


def pair(name: str, *operands: Any) -> tuple[Symbol, Symbol]:
    """Symbols for the two numbers that the function of this name returns."""
    both = call(name, *operands)
    return both.recorder.keep("{}[0]", both), both.recorder.keep("{}[1]", both)


elementary.register(Symbol, SimpleNamespace(**{name: partial(call, name) for name in _USUAL}))
