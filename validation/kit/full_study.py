"""Results of full studies as files: in the folder of a run, and as they come with the package."""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from analysis.data.files import whole_file

FULL_STUDY = "full_study.json"
"""Name of the file with a full study, in the folder of its results and in the package."""

Study = TypeVar("Study")


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFile(Generic[Study]):
    """How a study is written, read and put into the package.

    Parameters
    ----------
    name : str
        Of the study: "work-precision".
    shipped : Path
        The file in the package.
    pack, unpack : callable
        From a study to plain data, and back.
    breaks : tuple of 2 str
        Text between two rows, and the same with a line break in it: a line for each row keeps
        the differences of two versions readable.
    """

    name: str
    shipped: Path
    pack: Callable[[Study], dict[str, Any]]
    unpack: Callable[[dict[str, Any]], Study]
    breaks: tuple[str, str]

    def write(self, study: Study, path: Path) -> None:
        """Write a study in a compact form.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        stored = self.pack(study)
        text = json.dumps(stored, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        with whole_file(path) as stream:
            stream.write((text.replace(*self.breaks) + "\n").encode())

    def read(self, path: Path) -> Study:
        """Study from a file of `write`.

        Raises
        ------
        ValueError
            If the file is none.
        OSError
            If it cannot be read.
        """
        try:
            return self.unpack(json.loads(path.read_text(encoding="utf-8")))
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"{path} does not hold a {self.name} study: {error!r}") from error

    def read_shipped(self) -> Study | None:
        """The study in the package, None if there is none."""
        return self.read(self.shipped) if self.shipped.is_file() else None

    def ship(
        self,
        arguments: Sequence[str] | None,
        *,
        check: Callable[[Study], None],
        text: Callable[[Study], str],
    ) -> int:
        """Put the study of a finished run into the package, print a text of it; exit code.

        Parameters
        ----------
        arguments : sequence of str, optional
            The folder of the run; by default those of the command line.
        check : callable
            Raises `ValueError` on a study that is not the whole one.
        text : callable
            What to print of the shipped study.
        """
        parser = argparse.ArgumentParser(description=f"Ship a full {self.name} study.")
        parser.add_argument("folder", metavar="DIR", type=Path, help="folder of a full study")
        folder: Path = parser.parse_args(arguments).folder
        try:
            study = self.read(folder / FULL_STUDY)
            check(study)
            self.write(study, self.shipped)
        except (OSError, ValueError) as error:
            print(f"cannot ship: {error}", file=sys.stderr)
            return 1
        print(text(self.read(self.shipped)))
        return 0


def rounded(value: Any, digits: int) -> Any:
    """The same with all numbers in it rounded to so many digits."""
    if isinstance(value, float):
        # JSON knows no infinity; what is that far off is as good as that.
        return min(float(f"{value:.{digits}g}"), 1e300)
    if isinstance(value, dict):
        return {key: rounded(each, digits) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each, digits) for each in value]
    return value
