"""The report: all runs, checks, tables and figures in one self-contained HTML page."""

import base64
import html
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tqdm import tqdm

from analysis.data.files import whole_file
from analysis.data.trajectory import versions
from analysis.data.workers import process_pool
from validation.kit.animation.player import Animation
from validation.kit.figures import Picture
from validation.kit.provenance import machine
from validation.kit.tables import Table

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { line-height: 1.2; } h2 { margin-top: 3rem; border-bottom: 1px solid #ccc; }
figure { margin: 1.5rem 0; } figure img { max-width: 100%; }
figcaption, .note, footer { color: #555; font-size: .9rem; }
table { border-collapse: collapse; font-size: .85rem; margin-top: 1.5rem; display: block;
  overflow-x: auto; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; white-space: nowrap; }
th, td { text-align: left; padding: .2rem .6rem; border-bottom: 1px solid #e3e3e3;
  vertical-align: top; }
th { border-bottom: 2px solid #999; } td.number { text-align: right; white-space: nowrap; }
td.good { color: #00693e; } td.bad { color: #b00020; font-weight: 700; }
nav a { margin-right: 1rem; }
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the report.

    Parameters
    ----------
    name : str
        Anchor.
    title : str
    paragraphs : sequence of str
        Plain text.
    animations : sequence of Animation
    pictures : sequence of Picture
    tables : sequence of Table
    """

    name: str
    title: str
    paragraphs: Sequence[str] = ()
    animations: Sequence[Animation] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()


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
        for animation in section.animations:
            _write(folder / f"{animation.name}.html", animation.page.encode())
        for picture in section.pictures:
            _write(folder / f"{picture.name}.png", picture.png)
            _write(folder / f"{picture.name}.svg", picture.svg.encode())
        for table in section.tables:
            _write(folder / f"{table.name}.csv", table.to_csv().encode())
    page = folder / "report.html"
    _write(page, _page(sections, seconds).encode())
    return page


def _write(path: Path, content: bytes) -> None:
    with whole_file(path) as stream:
        stream.write(content)


def _page(sections: Sequence[Section], seconds: float) -> str:
    links = "".join(
        f'<a href="#{section.name}">{html.escape(section.title)}</a>' for section in sections
    )
    body = "\n".join(_section(section) for section in sections)
    used = ", ".join(
        f"{name} {version}"
        for name, version in versions("exudyn", "numpy", "scipy", "matplotlib").items()
    )
    made = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime())
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>The tippedisk</title><style>{_STYLE}</style></head><body>"
        "<h1>The tippedisk: multibody engine against closed equations</h1>"
        f"<nav>{links}</nav>{body}"
        f"<footer><p>Made on {made} in {seconds:.0f} s with {html.escape(used)}, on "
        f"{html.escape(machine())}. Source: S. Sailer and R. I. Leine, Model reduction of the "
        "tippedisk: a path to the full analysis, Nonlinear Dynamics 105 (2021).</p></footer>"
        "</body></html>"
    )


def _section(section: Section) -> str:
    parts = [f'<h2 id="{section.name}">{html.escape(section.title)}</h2>']
    parts += [f"<p>{html.escape(paragraph)}</p>" for paragraph in section.paragraphs]
    parts += [animation.fragment for animation in section.animations]
    for picture in section.pictures:
        data = base64.b64encode(picture.png).decode()
        parts.append(
            f'<figure><img src="data:image/png;base64,{data}" alt="{html.escape(picture.title)}">'
            f"<figcaption><b>{html.escape(picture.title)}.</b> {html.escape(picture.caption)}"
            "</figcaption></figure>"
        )
    parts += [table.to_html() for table in section.tables if not table.file_only]
    return "\n".join(parts)
