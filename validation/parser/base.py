"""What every part of the parser is made of."""

import argparse
from collections.abc import Iterable
from typing import Any, NoReturn, TypeAlias


def nearest(name: str, known: Iterable[Any]) -> str:
    """As in `analysis.data.names`, which is loaded only where something is wrong."""
    from analysis.data import names  # noqa: PLC0415

    return names.nearest(name, known)


class Parser(argparse.ArgumentParser):
    """Parser whose errors are one line, and tell what a wrong name may stand for."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Options of a call, all of which must be known."""
        options, left = super().parse_known_args(args, namespace)
        if left:
            hints = (nearest(word.partition("=")[0], self._option_string_actions) for word in left)
            self.error(f"unrecognized arguments: {' '.join(left)}{''.join(hints)}")
        return options, left

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += nearest(value, action.choices or ())
            raise

    def error(self, message: str) -> NoReturn:
        """Exit with code 2 and one line."""
        self.exit(2, f"{self.prog}: error: {message}\n")


Commands: TypeAlias = "argparse._SubParsersAction[Parser]"  # noqa: SLF001
"""Takes the subcommands."""
