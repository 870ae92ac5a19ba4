"""The report: all studies measured or confirmed, and two pages with what they found."""

import re
import time
from base64 import b64decode
from collections.abc import Collection, Mapping, Sequence
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pandas as pd

from analysis.motion.files import write_whole
from validation import study as studying
from validation.animation import play
from validation.measurement.kept import measured
from validation.measurement.provenance import in_a_line, provenance
from validation.measurement.sources import behind
from validation.page.section import Section, environment, table_html
from validation.parser.kinds import DISK, METHOD
from validation.study import RESULTS, Check, Found, Row, Study, Verdict

Page = tuple[str, str, Sequence[str]]
"""Name of its file, title, and names of its studies."""

PAGES: Sequence[Page] = (
    ("report.html", "The tippedisk: multibody engine against in-house equations", DISK),
    ("method.html", "The tippedisk: how well the method works", METHOD),
)


class MadeSection(NamedTuple):
    """A section as a page takes it.

    Parameters
    ----------
    name, title, html : str
    text : str
        As Markdown without files beside it.
    checks : list of Check
    verdicts : list of Verdict
    files : dict
        As in `Section`.
    """

    name: str
    title: str
    html: str
    text: str
    checks: list[Check]
    verdicts: list[Verdict]
    files: dict[str, str]

    @classmethod
    def of(cls, row: Row) -> "MadeSection":
        """From the row that `draw` makes."""
        kinds = {"checks": Check, "verdicts": Verdict}
        return cls(
            **row | {name: [kind(*each) for each in row[name]] for name, kind in kinds.items()}
        )


class Report(NamedTuple):
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
        checks = self.checks
        return any(check.where == "fresh" for check in checks) and all(c.holds for c in checks)


def as_text(report: Report) -> str:
    """The verdicts and sections of a report as one page of Markdown."""
    verdicts = [
        f"- {each.statement} **{each.answer}**: {each.numbers} ({each.criterion})"
        for section in report.sections
        for each in section.verdicts
    ]
    sections = [f"## {section.title}\n\n{section.text.strip()}" for section in report.sections]
    made = f"Made by `tippedisk report --text FILE`: {in_a_line(provenance())}."
    text = "\n\n".join(["# All results", made, "\n".join(verdicts), *sections])
    return re.sub(r"\n{3,}", "\n\n", text) + "\n"


def find(name: str) -> ModuleType:
    """Module of a study by its name, with hyphens or underscores; others by their full names.

    It has `TITLE`, of its section; `STUDIES`, those that it shows the rows of; and `present`, from
    their tables by name to a `Content`. Its text, NAME.md, lies beside it.

    Raises
    ------
    ValueError
        If there is none.
    """
    known, wanted = (*DISK, *METHOD), name.replace("_", "-")
    if "." not in name and wanted not in known:
        raise ValueError(f"study must be one of {', '.join(known)}, got {wanted!r}")
    name = name.replace("-", "_")
    module = import_module(name if "." in name else f"validation.studies.{name}")
    return import_module(f"{module.__name__}.section") if hasattr(module, "__path__") else module


def short(module: ModuleType) -> str:
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
        As in `validation.measurement.kept.measured`.
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
    wanted = {find(name) for name in only}
    named = [find(name) for *_, names in pages for name in names]
    modules = [module for module in named if module in wanted or not only]
    studies = {study.name: study for module in modules for study in module.STUDIES}
    # What measures times runs last, beside its like.
    ordered = sorted(studies.values(), key=lambda study: study.timed)
    tasks = [task for study in ordered for task in study.tasks(whole=False)]
    found = measured(tasks, folder, workers=workers, fresh=fresh, title="measure")
    sections = dict(zip(modules, _sections(modules, found, folder, results, workers), strict=True))
    shown = [
        {"path": path, "title": title, "sections": some}
        for path, title, names in pages
        if (some := [sections[module] for module in map(find, names) if module in sections])
    ]
    report = Report(page=folder / str(shown[0]["path"]), sections=list(sections.values()))
    made = f"Made in {time.perf_counter() - begin:.0f} s; {in_a_line(provenance())}."
    table = stored_table(modules, results)
    stored = "" if table.empty else table_html(table)
    _write(report, {"pages": shown, "stored": stored, "made": made, "whole": not only})
    return report


# --- Sections ----------------------------------------------------------------------------------


def _sections(
    modules: Sequence[ModuleType], found: Found, folder: Path, results: Path, workers: int | None
) -> list[MadeSection]:
    """Sections of studies, drawn as cases are measured: side by side, where they are not kept."""
    drawings = [_drawing(module, found, results) for module in modules]
    tasks = [task for each in drawings for task in each.tasks(whole=True)]
    made = measured(tasks, folder, workers=workers, title="draw")
    rows = [made[task.key] for task in tasks]
    return [
        _broken(module, repr(row)) if isinstance(row, Exception) else MadeSection.of(*row)
        for module, row in zip(modules, rows, strict=True)
    ]


def _drawing(module: ModuleType, found: Found, results: Path) -> Study:
    """A section as a study of its own, whose row is what is on the page."""
    names = {study.name for study in module.STUDIES}
    tables = {key: found[key] for key in sorted(found) if key[0] in names}
    stored = [results / f"{name}.{kind}" for name in sorted(names) for kind in ("csv", "json")]
    sources = [behind(module.__name__), repr(tables)]
    beside = [_text(module), *sorted(_text(module).parent.glob("*.svg")), *stored]
    sources += [path.read_text("utf-8") for path in beside if path.is_file()]
    return Study(
        name=f"section-{short(module)}",
        cases=lambda: {"section": (module.__name__, tables, results)},
        measure=draw,
        rests_on=sha256("\0".join(sources).encode()).hexdigest(),
    )


def draw(case: tuple[str, Found, Path]) -> list[Row]:
    """The row of a section: the fields of a `MadeSection` as plain data.

    It is made of what was measured on the spot and what is stored. Whatever goes wrong is a check
    that fails.
    """
    name, found, results = case
    module = find(name)
    checks, rows, about = [], {}, {}
    for study in module.STUDIES:
        try:
            if study.is_stored:
                rows[study.name] = studying.load(study, results)
                about[study.name] = studying.about(study, results)
                checks += studying.confirm(study, found, rows[study.name])
            else:
                rows[study.name] = studying.whole_table(study, found)
                number = len(rows[study.name])
                checks.append(Check(f"{study.name}: rows", number, "some", "fresh", number > 0))
        except (ArithmeticError, ValueError, OSError) as error:
            checks.append(Check(f"{study.name}: table", str(error), "is there", "fresh", False))
    try:
        content = module.present(rows)
        section = Section(short(module), content, _text(module))
        html, text = section.filled(vars(module) | {"about": about})
        checks += content.checks
        made = MadeSection(
            short(module), module.TITLE, html, text, checks, section.verdicts, section.files
        )
    except Exception as error:  # noqa: BLE001
        # A section that cannot be made says so, and the report fails.
        made = _broken(module, f"{type(error).__name__}: {error}", checks)
    return [made._asdict()]


def _broken(module: ModuleType, reason: str, checks: Sequence[Check] = ()) -> MadeSection:
    name, nothing = short(module), "This section could not be made: see the checks that fail."
    failed = Check(f"{name}: section", reason, "can be made", "fresh", False)
    page = f"<p>{nothing}</p>"
    return MadeSection(name, module.TITLE, page, nothing, [*checks, failed], [], {})


def _text(module: ModuleType) -> Path:
    """The text of a study's section, beside its module or in its folder."""
    return Path(str(module.__file__)).parent / f"{short(module).replace('-', '_')}.md"


# --- Pages -------------------------------------------------------------------------------------


def _write(report: Report, names: Mapping[str, Any]) -> None:
    """Write the pages and the files beside them, the first page last."""
    folder, checks = report.page.parent, report.checks
    files = {name: text for section in report.sections for name, text in section.files.items()}
    table = pd.DataFrame(checks, columns=list(Check._fields))
    files["checks.csv"] = table.to_csv(index=False, lineterminator="\n")
    files["play.html"] = play.page().text
    template = environment(Path(__file__).parent / "page").get_template("page.html")
    known = {**names, "checks": checks, "good": report.holds}
    for page in reversed(names["pages"]):
        files[page["path"]] = template.render(known, page=page)
    for name, content in files.items():
        write_whole(folder / name, b64decode(content) if name.endswith(".png") else content)


def stored_table(modules: Sequence[ModuleType], results: Path) -> pd.DataFrame:
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
            about = studying.about(study, results)
            same = about["code"] == behind(study.measure.__module__)
            rows.append(
                {
                    "stored results": study.name,
                    "cases": len(study.cases()),
                    "of these measured again": len(study.sample),
                    "made with": in_a_line(about["provenance"]),
                    "code since": "the same" if same else "changed",
                }
            )
    return pd.DataFrame(rows)


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
    ArithmeticError
        If cases crashed; all others are kept for the next call.
    OSError
        If a folder cannot be written, or another process works in it.
    """
    made_with = provenance()  # The commit may move on meanwhile.
    tasks = study.tasks(whole=True)
    found = measured(tasks, folder, workers=workers, fresh=fresh, title=study.name)
    table = studying.whole_table(study, found)
    results.mkdir(parents=True, exist_ok=True)
    studying.write(study, table, made_with, results)
    return table
