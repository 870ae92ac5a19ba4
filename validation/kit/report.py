"""The jobs behind a report, and its files: page, figures, tables and animations."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tqdm import tqdm

from analysis.data.files import whole_file
from validation.kit.page import Section, page
from validation.kit.workers import process_pool

__all__ = ["Job", "Section", "run_jobs", "write"]


@dataclass(frozen=True, slots=True)
class Job:
    """A function call to be made in a worker process, under a name its result is found by."""

    key: Any
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = field(default=())


def run_jobs(
    jobs: Iterable[Job], *, workers: int | None = None, title: str = ""
) -> dict[Any, Any]:
    """Run jobs in worker processes with a progress bar on a terminal; results by key.

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
    jobs = list(jobs)
    results: dict[Any, Any] = {}
    with process_pool(workers) as pool:
        futures = {pool.submit(job.function, *job.arguments): job.key for job in jobs}
        bar = tqdm(total=len(jobs), desc=title, disable=None, leave=False)
        try:
            for future in as_completed(futures):
                results[futures[future]] = future.result()
                bar.update()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
        finally:
            bar.close()
    return results


def write(sections: Sequence[Section], folder: Path, *, seconds: float) -> Path:
    """Write the page, the animations as pages, the figures as PNG and SVG and tables as CSV.

    Parameters
    ----------
    sections : sequence of Section
    folder : Path
        Made if it does not exist.
    seconds : float
        Time that the computations took, for the footer.

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
    for section in sections:
        for drawing in section.drawings:
            _write(folder / f"{drawing.name}.svg", drawing.svg.encode())
        for animation in section.animations:
            _write(folder / f"{animation.name}.html", animation.page.encode())
        for picture in section.pictures:
            _write(folder / f"{picture.name}.png", picture.png)
            _write(folder / f"{picture.name}.svg", picture.svg.encode())
        for table in section.tables:
            _write(folder / f"{table.name}.csv", table.to_csv().encode())
    path = folder / "report.html"
    _write(path, page(sections, seconds=seconds).encode())
    return path


def _write(path: Path, content: bytes) -> None:
    with whole_file(path) as stream:
        stream.write(content)
