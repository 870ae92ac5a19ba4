"""The jobs behind a report, and its files: page, figures, tables and animations."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import as_completed
from os import cpu_count
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from analysis.data.workers import Pool
from validation.kit.clock import processor_time
from validation.kit.page import Section, page
from validation.kit.parts import Job, Part, Store, open_store
from validation.kit.progress import bar, duration, say

__all__ = ["Job", "Section", "run_jobs", "run_kept", "run_parts", "write"]

PAGE = "report.html"

CONTENTS = ".contents"
"""File with the names of all files of a report, one a line."""

_UNFINISHED = b"<!doctype html><title>Unfinished</title><p>This report is being written.</p>"
"""In place of a page while the files beside it are written."""

_SUFFIXES = {".html", ".png", ".svg", ".csv"}
"""Of the files of a report."""


def run_jobs(
    jobs: Iterable[Job], *, workers: int | None = None, title: str = ""
) -> dict[Any, Any]:
    """Run jobs in worker processes with a progress bar; results by key.

    Scenes are rebuilt in the workers from their descriptions, since the engine's systems cannot
    be sent. The first error of a job is raised.

    Parameters
    ----------
    jobs : iterable of Job
    workers : int, optional
        Number of processes, by default that of the cores.
    title : str
        Shown in front of the progress bar.
    """
    parts = run_parts(list(jobs), workers=workers, title=title)
    return {key: part.result for key, part in parts.items()}


def run_parts(
    jobs: Sequence[Job],
    *,
    workers: int | None = None,
    title: str = "",
    store: Store | None = None,
    tell: Callable[[Job], None] | None = None,
) -> dict[Any, Part]:
    """The same with the processor time of each job.

    Parameters
    ----------
    jobs, workers, title
        As in `run_jobs`.
    store : Store, optional
        Gets every part as soon as it is finished, so that an interruption loses no others.
    tell : callable, optional
        Called after every finished job.
    """
    results: dict[Any, Part] = {}
    errors: list[BaseException] = []
    if not jobs:
        return results
    with Pool(workers) as pool:
        futures = {pool.submit(_timed, job.function, job.arguments): job for job in jobs}
        shown = bar(title, total=len(jobs), unit="parts")
        try:
            for future in as_completed(futures):
                if future.cancelled():
                    continue
                if (error := future.exception()) is not None:
                    # What is running and what has finished beside it is still kept.
                    errors.append(error)
                    for each in futures:
                        each.cancel()
                    continue
                job = futures[future]
                results[job.key] = part = future.result()
                if store is not None:
                    store.keep(job, part)
                shown.update()
                if tell is not None:
                    tell(job)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
        finally:
            shown.close()
    if errors:
        raise errors[0]
    return results


def run_kept(
    jobs: Sequence[Job],
    folder: Path,
    *,
    workers: int | None = None,
    title: str = "",
    fresh: bool = False,
    seconds: float = 0.0,
) -> dict[Any, Part]:
    """What an earlier call has left finished in a folder, and the rest run and left there.

    Parameters
    ----------
    jobs, workers, title
        As in `run_jobs`.
    folder : Path
        Finished parts lie in its `parts.FOLDER`.
    fresh : bool
        Run all of them again.
    seconds : float
        Processor time that all of them take, roughly; 0 if nobody knows.

    Raises
    ------
    OSError
        If the folder cannot be made, or another process works in it.
    """
    with open_store(folder) as store:
        if fresh:
            store.forget(jobs)
        kept = {job.key: part for job in jobs if (part := store.find(job)) is not None}
        left = [job for job in jobs if job.key not in kept]
        ahead = seconds * len(left) / max(1, len(jobs)) / (workers or cpu_count() or 1)
        words = f"; the others take some {duration(ahead)} on an idle machine" if ahead else ""
        say(f"{title}: {len(jobs)} parts, {len(kept)} of them kept from before{words}")
        return kept | run_parts(left, workers=workers, title=title, store=store)


def _timed(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Part:
    begin = processor_time()
    result = function(*arguments)
    return Part(result, processor_time() - begin)


def write(sections: Sequence[Section], folder: Path, *, made: str, whole: bool = True) -> Path:
    """Write the page, the animations as pages, the figures as PNG and SVG and tables as CSV.

    The page of an earlier report goes first and the new one comes last, so that no page stands
    beside files of another report.

    Parameters
    ----------
    sections : sequence of Section
    folder : Path
        Made if it does not exist.
    made : str
        How it was made, for the foot of the page.
    whole : bool
        Whether these are all sections: files of an earlier report in the folder that this one
        does not have are then removed.

    Returns
    -------
    Path
        The page, `report.html`.

    Raises
    ------
    OSError
        If the folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / PAGE
    if path.exists():
        _write(path, _UNFINISHED)
    files = dict(_files(sections))
    earlier = contents(folder)
    if whole:
        for name in earlier - files.keys():
            (folder / name).unlink()
        earlier = set()
    _write(folder / CONTENTS, "\n".join(sorted(earlier | files.keys() | {PAGE})).encode())
    for name, content in files.items():
        _write(folder / name, content)
    _write(path, page(sections, made=made).encode())
    return path


def _files(sections: Iterable[Section]) -> Iterable[tuple[str, bytes]]:
    for section in sections:
        for drawing in section.drawings:
            yield f"{drawing.name}.svg", drawing.svg.encode()
        for animation in section.animations:
            yield f"{animation.name}.html", animation.page.encode()
        for picture in section.pictures:
            yield f"{picture.name}.png", picture.png
            yield f"{picture.name}.svg", picture.svg.encode()
        for table in section.tables:
            yield f"{table.name}.csv", table.to_csv().encode()


def contents(folder: Path) -> set[str]:
    """Names of the files that an earlier report has left in a folder and noted."""
    try:
        names = (folder / CONTENTS).read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return set()
    return set(names) & _reportlike(folder)


def foreign(folder: Path) -> list[str]:
    """Names of the files in a folder that look like a report's and are not of the one there."""
    return sorted(_reportlike(folder) - contents(folder))


def _reportlike(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if path.suffix in _SUFFIXES and path.is_file()}


def _write(path: Path, content: bytes) -> None:
    with whole_file(path) as stream:
        stream.write(content)
