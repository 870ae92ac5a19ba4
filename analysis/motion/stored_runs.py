"""Stored runs of either kind: what `save` has written is read here."""

import json
import os
from typing import Any, TypeVar, overload

from analysis.motion.endings import Ending
from analysis.motion.files import stored_arrays
from analysis.motion.quantities import filled
from analysis.motion.sampled import FORMAT, described
from analysis.motion.spatial_motion import SpatialMotion
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import choice, settings
from analysis.problem.scenario import Scenario
from analysis.problem.user_modules import foreign_names

StoredRun = Trajectory | SpatialMotion
"""What a result file holds."""

_OLDER_SETTINGS = {"form": "formulation"}
"""What files called some settings before."""

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
    choice("kind", kind, (None, Trajectory, SpatialMotion))
    with stored_arrays(path) as held:
        found = SpatialMotion if "quaternions" in held else Trajectory
        if kind not in (None, found):
            raise ValueError(f"kind must be {kind.__name__}, got {found.__name__}")
        given = _description(str(held["meta"]), found)
        given |= {name: held[name] for name in filled(found)}
        return found(**given)


def _description(text: str, kind: type[StoredRun]) -> dict[str, Any]:
    """What a file says of its motion, with scenario and ending as such."""
    meta = json.loads(text)
    if not isinstance(meta, dict):
        raise ValueError(f"meta must be a mapping, got {type(meta).__name__}")
    written = meta.pop("format", 1)
    if written != FORMAT:
        age = "a newer" if isinstance(written, int) and written > FORMAT else "an older"
        raise ValueError(
            f"format must be {FORMAT}, got {written!r}: the file comes from {age} version of "
            "this project"
        )
    for name in meta:
        choice("meta", name, described(kind))
    found = {name: meta[name] for name in described(kind)}
    found["method"] = {
        _OLDER_SETTINGS.get(name, name): each
        for name, each in settings("method", found["method"]).items()
    }
    with foreign_names():
        found["scenario"] = Scenario.from_values(found["scenario"])
    if found["ending"] is not None:
        found["ending"] = Ending(**found["ending"])
    return found
