"""Stored runs of either kind: what `save` has written is read here."""

import os
import zipfile
from typing import Any, TypeVar, overload

from analysis.data.files import read_archive
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.trajectory import Trajectory

StoredRun = Trajectory | SpatialMotion
"""What a result file holds."""

_NAMED = 3
"""Most members of a foreign archive that an error names."""

Kind = TypeVar("Kind", bound=StoredRun)


@overload
def load_run(path: str | os.PathLike[str]) -> StoredRun: ...
@overload
def load_run(path: str | os.PathLike[str], kind: type[Kind]) -> Kind: ...
def load_run(path: str | os.PathLike[str], kind: Any = None) -> Any:
    """Read a stored run, of either kind or of the one named.

    Parameters
    ----------
    path : path-like
        File that `Trajectory.save` or `SpatialMotion.save` has written.
    kind : {Trajectory, SpatialMotion}, optional
        What it must hold; by default either.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is damaged, is of another version of this project, or holds something else.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from analysis import Scenario, load_run, simulate
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     simulate(Scenario(), [0.0, 0.01]).save(Path(folder) / "run.npz")
    ...     run = load_run(Path(folder) / "run.npz")
    >>> run.source, run.times.size
    ('in-house', 2)
    """
    if kind is None:
        kind = _kind(path)
    return read_archive(path, kind.STORED_AS, kind.STORED_ARRAYS, kind.from_arrays)


def _kind(path: str | os.PathLike[str]) -> type[StoredRun]:
    """What a file says that it holds."""
    try:
        with zipfile.ZipFile(path) as stored:
            names = stored.namelist()
    except (zipfile.BadZipFile, EOFError, RuntimeError) as error:
        raise ValueError(f"{path} is not a readable motion: {error}") from error
    for kind in (SpatialMotion, Trajectory):
        if f"{kind.STORED_ARRAYS[-1]}.npy" in names:
            return kind
    held = ", ".join(map(repr, names[:_NAMED])) + ("" if len(names) <= _NAMED else ", …")
    raise ValueError(f"{path} is not a readable motion: it holds {held or 'nothing'}")
