"""The report: all studies measured or confirmed, and two pages with what they found."""

import json
import os
import re
import sqlite3
import time
from base64 import b64decode, b64encode
from collections.abc import Collection, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.data.files import whole_file
from analysis.data.trajectory import versions
from validation import study as kit
from validation.kit.processes import open_processes
from validation.kit.progress import bar, say
from validation.kit.provenance import PACKAGES, Provenance, machine
from validation.kit.sources import behind, digest
from validation.page.content import StudyModule, Verdict
from validation.page.section import PlainSection, Section, environment, table_html
from validation.study import RESULTS, Check, Found, Study

DISK = ("modelled", "inversion", "claims", "stability", "nonlinear", "rest", "maps")
"""Studies of the first page, on the disk,"""

METHOD = ("crosscheck", "work_precision", "robustness", "lean", "numbers")
"""and of the second one, on the method."""

Page = tuple[str, str, Sequence[str]]
"""Name of its file, title, and names of its studies."""

PAGES: Sequence[Page] = (
    ("report.html", "The tippedisk: multibody engine against closed equations", DISK),
    ("method.html", "The tippedisk: how well the method works", METHOD),
)

SOURCES = (
    (
        "S. Sailer and R. I. Leine, Model reduction of the tippedisk, Nonlinear Dynamics (2021)",
        "10.1007/s11071-021-06649-z",
    ),
    ("J. Gerstmayr, Exudyn, Multibody System Dynamics (2024)", "10.1007/s11044-023-09937-1"),
)
"""What everything rests on, with DOIs."""

KEPT = ".kept"
"""Folder inside that of a report with what is measured and drawn."""

_CONTENTS = ".contents"
"""File with the names of all files of a report."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MadeSection:
    """A section as a page takes it.

    Parameters
    ----------
    name, title, html : str
    text : str
        As Markdown without files beside it.
    checks : list of Check
    verdicts : list of Verdict
    files : dict
        From names to contents.
    """

    name: str
    title: str
    html: str
    text: str
    checks: list[Check]
    verdicts: list[Verdict]
    files: dict[str, bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """A report that has been written.

    Parameters
    ----------
    page : Path
        The first of its pages.
    sections : list of MadeSection
    """

    page: Path
    sections: list[MadeSection]

    @property
    def checks(self) -> list[Check]:
        """Those of all sections."""
        return [check for section in self.sections for check in section.checks]

    @property
    def holds(self) -> bool:
        """Whether everything holds, and something was measured on the spot."""
        return verdict(self.checks)


def verdict(checks: Sequence[Check]) -> bool:
    """Whether all checks hold, at least one of them measured on the spot."""
    return any(check.where == "fresh" for check in checks) and all(c.holds for c in checks)


def as_text(report: Report) -> str:
    """The verdicts and sections of a report as one page of Markdown."""
    verdicts = [
        f"- {each.statement} **{each.answer}**: {each.numbers} ({each.criterion})"
        for section in report.sections
        for each in section.verdicts
    ]
    sections = [f"## {section.title}\n\n{section.text.strip()}" for section in report.sections]
    text = "\n\n".join(["# All results", "\n".join(verdicts), *sections])
    return re.sub(r"\n{3,}", "\n\n", text) + "\n"


def find(name: str) -> StudyModule:
    """Module of a study by its name, with hyphens or underscores; others by their full names.

    Raises
    ------
    ValueError
        If there is none.
    """
    name = name.replace("-", "_")
    if "." not in name and name not in (known := (*DISK, *METHOD)):
        raise ValueError(f"study must be one of {', '.join(known)}, got {name!r}")
    module: Any = import_module(name if "." in name else f"validation.studies.{name}")
    if hasattr(module, "__path__"):
        module = import_module(f"{module.__name__}.section")
    return module  # type: ignore[no-any-return]


def short(module: StudyModule) -> str:
    """Name of a study in pages, files and on the command line."""
    return module.__name__.removesuffix(".section").rpartition(".")[2].replace("_", "-")


def make(
    folder: Path,
    *,
    only: Collection[str] = (),
    fresh: bool = False,
    workers: int | None = None,
    results: Path = RESULTS,
    pages: Sequence[Page] = PAGES,
) -> Report:
    """Measure what is not kept of earlier calls, confirm what is stored, and write the pages.

    Parameters
    ----------
    folder : Path
    only : collection of str
        Names of the sections to make, by default all.
    fresh : bool
        Measure everything again.
    workers : int, optional
        As in `validation.study.measured`.
    results : Path
        Where the stored tables lie.
    pages : sequence of Page

    Raises
    ------
    OSError
        If the folder cannot be written, or another process works in it.
    ValueError
        If there is no section of a name.
    """
    begin = time.perf_counter()
    wanted = {find(name).__name__ for name in only}
    modules = [find(name) for _, _, names in pages for name in names]
    modules = [module for module in modules if not wanted or module.__name__ in wanted]
    studies = {study.name: study for module in modules for study in module.STUDIES}
    with locked(folder):
        # What measures times runs last, beside its like.
        ordered = sorted(studies.values(), key=lambda study: bool(study.timed))
        tasks = [task for study in ordered for task in study.tasks(whole=False)]
        found = kit.measured(tasks, folder / KEPT, workers=workers, fresh=fresh, title="measure")
        sections = _sections(modules, found, folder / KEPT, results, workers)
        made = f"Made in {time.perf_counter() - begin:.0f} s; {_surroundings()}."
        stored = stored_table(modules, results)
        page = _write(folder, pages, sections, stored, made, whole=not only)
        return Report(page=page, sections=sections)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """See to it that no other process works in a folder meanwhile; `OSError` if one does."""
    (folder / KEPT).mkdir(parents=True, exist_ok=True)
    # A lock of SQLite's is known on every system and ends with its process, however that ends.
    path = folder / KEPT / ".lock"
    with closing(sqlite3.connect(path, timeout=0.0, isolation_level=None)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            reason = "another process works in it" if "locked" in str(error) else error
            raise OSError(f"{folder} cannot be written to now: {reason}") from error
        yield


# --- Sections ----------------------------------------------------------------------------------


def _sections(
    modules: Sequence[StudyModule],
    found: Found,
    kept: Path,
    results: Path,
    workers: int | None,
) -> list[MadeSection]:
    """Sections of studies, drawn side by side where they are not kept."""
    made: dict[str, MadeSection] = {}
    calls = {}
    for module in modules:
        names = {study.name for study in module.STUDIES}
        own = {key: rows for key, rows in found.items() if key[0] in names}
        path, identity = kept / f"section-{short(module)}.json", _identity(module, own, results)
        if (known := _kept_section(path, identity)) is not None:
            made[module.__name__] = known
        else:
            calls[module] = (path, identity, own)
    number = os.cpu_count() or 1 if workers is None else workers
    with open_processes(min(number, len(calls))) as pool:
        futures = [
            (module, path, identity, pool.submit(make_section, module.__name__, own, results))
            for module, (path, identity, own) in calls.items()
        ]
        for module, path, identity, future in bar("draw", iterable=futures, unit="sections"):
            error = future.exception()
            made[module.__name__] = _broken(module, repr(error)) if error else future.result()
            if error is None:
                _keep_section(path, identity, made[module.__name__])
    return [made[module.__name__] for module in modules]


def make_section(name: str, found: Found, results: Path) -> MadeSection:
    """Section of a study from what was measured on the spot and what is stored.

    Whatever goes wrong is a check that fails.
    """
    module = find(name)
    checks, rows, about = [], {}, {}
    for study in module.STUDIES:
        try:
            if study.is_stored:
                rows[study.name] = kit.load(study, results)
                about[study.name] = kit.about(study, results)
                checks += kit.confirm(study, found, rows[study.name])
            else:
                rows[study.name] = kit.whole_table(study, found)
                number = len(rows[study.name])
                checks.append(Check(f"{study.name}: rows", number, "some", "fresh", number > 0))
        except (RuntimeError, ValueError, OSError) as error:
            checks.append(Check(f"{study.name}: table", str(error), "is there", "fresh", False))
    try:
        content = module.present(rows)
        section = Section(short(module), content)
        page = section.html(about, _text(module))
        text = PlainSection(short(module), content).filled(about, _text(module))
    except Exception as error:  # noqa: BLE001
        # A section that cannot be made says so, and the report fails.
        return _broken(module, f"{type(error).__name__}: {error}", checks)
    return MadeSection(
        name=short(module),
        title=module.TITLE,
        html=page,
        text=text,
        checks=[*checks, *content.checks],
        verdicts=list(content.verdicts),
        files=section.files,
    )


_NOTHING = "This section could not be made: see the checks that fail."


def _broken(module: StudyModule, reason: str, checks: Sequence[Check] = ()) -> MadeSection:
    name = short(module)
    failed = Check(f"{name}: section", reason, "can be made", "fresh", False)
    return MadeSection(
        name=name,
        title=module.TITLE,
        html=f"<p>{_NOTHING}</p>",
        text=_NOTHING,
        checks=[*checks, failed],
        verdicts=[],
        files={},
    )


def _text(module: StudyModule) -> Path:
    """The text of a study's section, beside its module or in its folder."""
    return Path(module.__file__).parent / f"{short(module).replace('-', '_')}.md"


def _identity(module: StudyModule, found: Found, results: Path) -> str:
    """What a section hangs on: its code and text, the pages' code, and the rows it shows."""
    told: list[Any] = [digest([Path(__file__).parent / "page"]), behind(module.__name__)]
    told += [_surroundings(), _text(module).read_text("utf-8")]
    told += [[*key, rows if isinstance(rows, list) else repr(rows)] for key, rows in found.items()]
    for study in module.STUDIES:
        paths = [results / f"{study.name}.{kind}" for kind in ("csv", "json")]
        told += [sha256(p.read_bytes()).hexdigest() for p in paths if p.is_file()]
    return sha256(json.dumps(told).encode()).hexdigest()


def _kept_section(path: Path, identity: str) -> MadeSection | None:
    """A section that an earlier call has left, if nothing has changed since."""
    try:
        known = json.loads(path.read_text("utf-8"))
        if known.pop("identity") != identity:
            return None
        known["checks"] = [Check(*each) for each in known["checks"]]
        known["verdicts"] = [Verdict(**each) for each in known["verdicts"]]
        known["files"] = {n: b64decode(text) for n, text in known["files"].items()}
        return MadeSection(**known)
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _keep_section(path: Path, identity: str, section: MadeSection) -> None:
    told = {
        "identity": identity,
        "name": section.name,
        "title": section.title,
        "html": section.html,
        "text": section.text,
        "checks": [[_told(value) for value in check] for check in section.checks],
        "verdicts": [asdict(each) for each in section.verdicts],
        "files": {name: b64encode(text).decode() for name, text in section.files.items()},
    }
    with whole_file(path) as stream:
        stream.write(json.dumps(told).encode())


def _told(value: Any) -> Any:
    value = value.item() if hasattr(value, "item") else value
    return value if isinstance(value, str | int | float | None) else str(value)


# --- Pages -------------------------------------------------------------------------------------


def _write(
    folder: Path,
    pages: Sequence[Page],
    sections: Sequence[MadeSection],
    stored: pd.DataFrame,
    made: str,
    *,
    whole: bool,
) -> Path:
    """Write the pages and the files beside them, the first page last; remove those of before."""
    checks = [check for section in sections for check in section.checks]
    files = {name: text for section in sections for name, text in section.files.items()}
    table = pd.DataFrame(checks, columns=list(Check._fields))
    files["checks.csv"] = table.to_csv(index=False, lineterminator="\n").encode()
    template = environment(Path(__file__).parent / "page").get_template("page.html")
    shown = []
    for path, title, names in pages:
        on_it = [s for s in sections if s.name in {short(find(name)) for name in names}]
        shown += [{"path": path, "title": title, "sections": on_it}] if on_it else []
    common = {
        "style": (Path(__file__).parent / "page" / "page.css").read_text("utf-8"),
        "pages": shown,
        "checks": checks,
        "good": verdict(checks),
        "whole": whole,
        "made": made,
        "sources": SOURCES,
        "stored": table_html(stored),
    }
    for each in reversed(shown):
        path = str(each["path"])
        files[path] = template.render(common, page=each).encode()
    earlier = _earlier(folder)
    for name in (earlier - files.keys()) if whole else ():
        (folder / name).unlink(missing_ok=True)
    contents = files.keys() | (set() if whole else earlier)
    _put(folder / _CONTENTS, "\n".join(sorted(contents)).encode())
    for name, content in files.items():
        _put(folder / name, content)
    return folder / str(shown[0]["path"])


def _put(path: Path, content: bytes) -> None:
    with whole_file(path) as stream:
        stream.write(content)


def _earlier(folder: Path) -> set[str]:
    """Names of the files that an earlier report has left in a folder."""
    try:
        names = (folder / _CONTENTS).read_text("utf-8").split()
    except (OSError, ValueError):
        return set()
    return {name for name in names if Path(name).name == name}


def stored_table(modules: Sequence[StudyModule], results: Path) -> pd.DataFrame:
    """What comes with the package: how much, made when, where and with what.

    Parameters
    ----------
    modules : sequence of module
    results : Path
        Where the tables lie.
    """
    rows = []
    for study in (study for module in modules for study in module.STUDIES):
        if study.is_stored and (results / f"{study.name}.json").is_file():
            about = kit.about(study, results)
            same = about["code"] == behind(study.measure.__module__)
            rows.append(
                {
                    "stored results": study.name,
                    "cases": len(study.cases()),
                    "of these measured again": len(study.sample),
                    "made with": Provenance(**about["provenance"]).text(),
                    "code since": "the same" if same else "changed",
                }
            )
    return pd.DataFrame(rows)


def _surroundings() -> str:
    used = ", ".join(f"{name} {version}" for name, version in versions(*PACKAGES).items())
    return f"{used}, on {machine()}"


# --- Stored tables ------------------------------------------------------------------------------


def measure(
    study: Study,
    folder: Path,
    *,
    results: Path = RESULTS,
    fresh: bool = False,
    workers: int | None = None,
) -> pd.DataFrame:
    """Measure all cases of a study, going on where an earlier call stopped, and store its table.

    Parameters
    ----------
    study : Study
    folder : Path
        For what is finished.
    results : Path
        Gets the table.
    fresh : bool
        Measure everything again.
    workers : int, optional
        Number of processes, by default that of the cores.

    Raises
    ------
    RuntimeError
        If cases crashed; all others are kept for the next call.
    OSError
        If a folder cannot be written, or another process works in it.
    """
    provenance = Provenance.here()  # The commit may move on meanwhile.
    with locked(folder):
        tasks = study.tasks(whole=True)
        found = kit.measured(tasks, folder / KEPT, workers=workers, fresh=fresh, title=study.name)
    table = kit.whole_table(study, found)
    results.mkdir(parents=True, exist_ok=True)
    kit.write(study, table, provenance, results)
    say(f"{study.name}: {len(table)} rows of {len(study.cases())} cases, {provenance.text()}")
    return table
