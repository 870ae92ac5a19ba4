"""The report's page: its box of verdicts, figure numbers, folded tables and links."""

import dataclasses
import os
import re
import stat
from pathlib import Path
from typing import Any

import pytest

from validation.kit.figures import Picture
from validation.kit.page import ENGINE, PAPER, Drawing, Section, Verdict, page
from validation.kit.report import write
from validation.kit.tables import LONG, SHOWN, Table
from validation.studies import modelled, summary
from validation.studies.work_precision import runs

ROOT = Path(__file__).parents[3]


def picture(name: str, paper: str = "") -> Picture:
    return Picture(name=name, title=f"Title of {name}", caption="", png=b"", svg="", paper=paper)


def long_table(**changes: Any) -> Table:
    table = Table(
        name="long",
        title="Long",
        columns=("case", "error", "holds"),
        rows=[[f"case {number}", float(number % 17), True] for number in range(LONG + 1)],
    )
    return dataclasses.replace(table, **changes)


def made_sections() -> list[Section]:
    """A report in small: just what the box asks for."""
    here, engine = "here, unrounded disk", "engine, unrounded disk"

    def table(name: str, columns: tuple[str, ...], *rows: list[object]) -> Table:
        return Table(name=name, title=name, columns=columns, rows=rows)  # type: ignore[arg-type]

    tables = [
        table(
            "figure-agreement",
            ("model", "inverted after s", "max difference of β, γ in rad", "of normal force in N"),
            *[["Model", time, 2e-9, 3e-8] for time in (0.494, 0.58, 0.766, 0.762)],
        ),
        table(
            "stability-numbers",
            ("quantity", here, engine),
            ["critical spin, closed form (126)", 30.9168, None],
            ["critical spin, computed", 30.9168, 30.9169],
            ["Ω_crit1", 26.874, 26.875],
            ["Ω_crit2", 30.105, 30.105],
        ),
        table("variants", ("variant", "gives both printed speeds"), ["a", "no"], ["b", "no"]),
        table("corners", ("spin in rad/s", "μ/ε in s/m"), [20.0, 0.9], [40.0, 1.9]),
        table("eigenvalues", ("inverted", "at most 1e-6"), [5e-8, True]),
        table("eigenvalues-of-sets", ("constraints", "engine against in-house"), ["all", 2.4e-6]),
        table(
            "crosscheck-models",
            ("accelerations", "constraint forces", "β and γ", "eigenvalues, inverted", "agrees"),
            [1e-10, 4e-10, 5e-9, 5e-8, True],
        ),
        table("claims", ("verdict",), ["yes"], ["no"], ["yes"]),
        table(
            "rest-phases",
            ("dissipation", "source", "inversion", "inversion lost", "rest", "largest difference"),
            ["sliding friction only", "in-house", 0.5, 19.0, None, 1e-6],
            ["dry rolling, pivoting", "engine", 0.48, 10.7, 25.9, None],
            ["dry rolling, pivoting", "in-house", 0.48, 10.7, 25.9, 5e-6],
        ),
        table("work-precision-confirmed", ("runs", "same work"), [20, 20], [4, 3]),
        table("robustness-confirmation", ("of them in the full study", "same verdict"), [30, 29]),
    ]
    return [Section(name="made", title="Made", tables=tables)]


def replaced(name: str, column: str, value: object) -> list[Section]:
    """The same with another value in a column of a table."""
    (section,) = made_sections()
    tables = []
    for table in section.tables:
        rows = [list(row) for row in table.rows]
        if table.name == name:
            for row in rows:
                row[list(table.columns).index(column)] = value  # type: ignore[call-overload]
        tables.append(dataclasses.replace(table, rows=rows))
    return [Section(name="made", title="Made", tables=tables)]


def test_box_answers_the_question_from_the_tables_below_it() -> None:
    box = summary.section(made_sections())
    said = {each.section: each for each in box.verdicts}
    assert 6 <= len(box.verdicts) <= 8
    assert "All 2 checks of this report hold" in box.paragraphs[1]
    assert "Of 3 statements" in box.paragraphs[1]
    assert "2 yes, 1 no" in box.paragraphs[1]
    assert "0.49, 0.58, 0.77 and 0.76 s" in said["inversion"].numbers
    critical, hopf, region = (each for each in box.verdicts if each.section == "stability")
    assert critical.answer == "confirmed"
    assert "engine 30.9169" in critical.numbers
    assert hopf.answer == "not confirmed"
    assert re.search(r"26.87 and 30.1[01] rad", hopf.numbers)
    assert "none of 2 obvious other choices gives" in hopf.certainty
    assert "stable nowhere from 0 to 60" in region.numbers
    assert "Between 0.9 and 1.9 s/m" in region.numbers
    assert "to 4e-10, motions over 2 s to 5e-9 rad" in said["crosscheck"].numbers
    assert said["rest"].answer == "not by sliding friction alone"
    assert "lies still after 25.9 s" in said["rest"].numbers
    assert "23 of 24 runs" in said["work-precision"].certainty
    assert "29 of 30" in said["robustness"].certainty


def test_box_changes_its_answers_with_the_numbers() -> None:
    def answers(name: str, column: str, value: object) -> list[str]:
        return [each.answer for each in summary.section(replaced(name, column, value)).verdicts]

    usual = [each.answer for each in summary.section(made_sections()).verdicts]
    changes = {
        0: ("figure-agreement", "inverted after s", None),
        1: ("stability-numbers", "engine, unrounded disk", 31.2),
        4: ("crosscheck-models", "agrees", False),
        5: ("rest-phases", "rest", 30.0),
    }
    for place, change in changes.items():
        changed = answers(*change)
        assert changed[place] != usual[place], change
    undefined = answers("crosscheck-models", "agrees", "not defined: no eigenvalues")
    assert undefined[4] == "no"
    failed = summary.section(replaced("crosscheck-models", "agrees", False))
    assert "Checks FAIL in: crosscheck-models" in failed.paragraphs[1]


def test_box_says_that_a_model_is_unstable_at_all_where_no_region_is_found() -> None:
    (section,) = made_sections()
    tables = [
        dataclasses.replace(each, rows=[]) if each.name == "corners" else each
        for each in section.tables
    ]
    region = summary.section([dataclasses.replace(section, tables=tables)]).verdicts[3]
    assert region.answer == "yes"
    assert region.numbers.endswith("No region is found in which it is stable.")


def test_box_finds_the_fastest_way_by_the_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    def way() -> Verdict:
        found = summary.section(made_sections()).verdicts
        return next(each for each in found if each.section == "work-precision")

    assert (way().answer, way().good) == ("the one without constraints, where there is one", True)
    fastest = runs.fastest

    def constrained(found: list[runs.Run], goal: float) -> runs.Run | None:
        return fastest([run for run in found if run.formulation != "contact-tree"], goal)

    monkeypatch.setattr(summary, "fastest", constrained)
    assert way().answer.startswith("not the one without constraints")
    assert not way().good


def test_figures_are_numbered_as_they_are_read_and_name_the_papers() -> None:
    drawing = Drawing(name="sketch", title="Sketch", caption="", svg="<svg></svg>")
    text = page(
        [
            Section(name="a", title="A", drawings=[drawing], pictures=[picture("p", "Fig. 7")]),
            Section(name="b", title="B", pictures=[picture("q")]),
        ],
        made="in 1 s",
    )
    captions = re.findall(r"<figcaption><b>(.*?)</b>", text)
    assert captions == [
        "Figure 1: Sketch.",
        "Figure 2 (paper: Fig. 7): Title of p.",
        "Figure 3: Title of q.",
    ]


def test_long_table_shows_its_worst_rows_and_every_failed_one() -> None:
    table = long_table(worst="error")
    rows = [list(row) for row in table.rows]
    rows[0][2] = False
    text = dataclasses.replace(table, rows=rows).to_html()
    shown, folded = text.split("<details>")
    assert re.findall(r"case \d+", shown) == ["case 0", *(f"case {n}" for n in (9, 10, 11, 12))]
    assert len(re.findall(r"case \d+", shown)) == SHOWN
    assert re.findall(r"case \d+", folded) == [f"case {n}" for n in range(LONG + 1)]
    assert "<details>" not in long_table(folded=False).to_html()
    assert "<details>" not in long_table(rows=rows[1:]).to_html()


def test_page_shows_four_digits_and_the_file_all() -> None:
    table = long_table(rows=[["a", 123.456789, True], ["b", 98765.4321, True]])
    assert ">123.5<" in table.to_html()
    assert ">98765<" in table.to_html()
    assert "123.456789" in table.to_csv()


def test_every_cell_says_its_heading_on_a_narrow_screen() -> None:
    text = long_table(columns=("case", "a < b", "holds"), folded=False).to_html()
    assert text.count('data-head="a &lt; b"') == LONG + 1


def test_unknown_worst_column_is_refused() -> None:
    with pytest.raises(ValueError, match="worst must be one of case, error, holds"):
        long_table(worst="size")


def test_page_links_every_file_beside_it(tmp_path: Path) -> None:
    sections = [modelled.section({}), Section(name="made", title="Made", tables=[
        long_table(file_only=True)], pictures=[picture("p")])]  # fmt: skip
    text = write(sections, tmp_path, made="in 1 s").read_text()
    beside = {path.name for path in tmp_path.iterdir()} - {"report.html", ".contents"}
    assert {"coordinates.svg", "parameters.csv", "long.csv", "p.png", "p.svg"} <= beside
    linked = set(re.findall(r'href="([^"#:]+)"', text))
    assert linked == beside


@pytest.mark.skipif(os.name != "posix", reason="links and modes of POSIX")
def test_page_is_written_through_a_link_and_keeps_its_mode(tmp_path: Path) -> None:
    (tmp_path / "report").mkdir()
    target, link = tmp_path / "page.html", tmp_path / "report" / "report.html"
    target.touch(mode=0o600)
    link.symlink_to(target)
    write(made_sections(), tmp_path / "report", made="in a year")
    assert link.is_symlink()
    assert stat.S_IMODE(target.stat().st_mode) == 0o600
    assert "in a year" in target.read_text()


def test_page_names_the_sources_that_the_citation_file_names() -> None:
    text = page([], made="in 1 s")
    cited = re.findall(r"doi: (\S+)", (ROOT / "CITATION.cff").read_text())
    assert cited == [PAPER[1], ENGINE[1]]
    assert all(f"https://doi.org/{doi}" in text for doi in cited)


def test_parameters_are_those_of_the_default_scenario() -> None:
    rows = {row[1]: row[3] for row in modelled.parameters().rows}
    assert rows["coefficient"] == 0.3
    assert rows["mass"] == pytest.approx(0.4354247, rel=1e-6)
    assert rows["moment of inertia about G, z"] == pytest.approx(468.0816, rel=1e-6)
    assert rows["centre, Models 2 to 4: −e cos γ"] == pytest.approx(-0.2496, rel=1e-3)
    assert rows["coefficient of dry rolling resistance"] == 1e-3
